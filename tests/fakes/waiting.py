"""Waiting for what other threads and processes do."""

import threading
from collections.abc import Callable

PATIENCE_S = 30.0  # only ever waited for in full when a test fails
_PAUSE_S = 0.01


def wait_until(condition: Callable[[], object], patience_s: float = PATIENCE_S) -> None:
    """Return once `condition` holds; fail when it does not within about `patience_s`."""
    pause = threading.Event()
    for _ in range(int(patience_s / _PAUSE_S)):
        if condition():
            return
        pause.wait(_PAUSE_S)
    raise AssertionError("it never happened")
