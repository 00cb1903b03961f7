"""Ending streams of events when the process is told to stop, whichever server runs the application.

A server that stops waits for the answers under way first and ends the application afterwards: too late for
streams, which live for a minute. So the application hears the signal, too.
"""

import asyncio
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

_SIGNALS = (signal.SIGTERM, signal.SIGINT)


@contextmanager
def told_to_stop(end: Callable[[], None]) -> Iterator[None]:
    """Call `end` in the running event loop at SIGTERM and Ctrl+C, before the server does what it does then.

    Where the loop does not run in the main thread nobody gets signals, and nothing happens.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    loop = asyncio.get_running_loop()
    before = {number: handler for number in _SIGNALS if callable(handler := signal.getsignal(number))}

    def hear(number: int, frame: FrameType | None) -> None:
        loop.call_soon_threadsafe(end)  # not at once: what `end` locks may be locked where the signal struck
        before[signal.Signals(number)](number, frame)

    for number in before:
        signal.signal(number, hear)
    try:
        yield
    finally:
        for number, handler in before.items():
            if signal.getsignal(number) is hear:
                signal.signal(number, handler)
