"""Waiting for what other threads and processes do."""

import threading
from collections.abc import Callable

PATIENCE_S = 60.0  # only ever waited for in full when a test fails
_PAUSE_S = 0.01


def wait_until(
    condition: Callable[[], object], patience_s: float = PATIENCE_S, pause_s: float = _PAUSE_S
) -> None:
    """Return once `condition` holds; fail when it does not within about `patience_s`."""
    pause = threading.Event()
    for _ in range(int(patience_s / pause_s)):
        if condition():
            return
        pause.wait(pause_s)
    raise AssertionError("it never happened")
