"""A hint, inside one process, that a submission waits. Missing one costs a poll interval, nothing else."""

import threading


class Doorbell:
    """Wakes everybody who waits. A ring between looking and waiting is not missed."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._rings = 0

    def ring(self) -> None:
        """Wake everybody."""
        with self._changed:
            self._rings += 1
            self._changed.notify_all()

    def heard(self) -> int:
        """Return a mark of now; read it before looking for work."""
        with self._changed:
            return self._rings

    def wait(self, heard: int, timeout_s: float) -> None:
        """Return once the bell rang after the mark `heard`, or after `timeout_s`."""
        with self._changed:
            self._changed.wait_for(lambda: self._rings != heard, timeout_s)
