"""When a slot looks for work: whoever brings it there, the rows decide what it gets."""

import logging
import threading
from collections.abc import Callable
from typing import Protocol

from grader.contracts.errors import InfrastructureError
from grader.store.doorbell import Doorbell

_log = logging.getLogger(__name__)


class WorkSource(Protocol):
    """Tells the slots of one worker when to look for work. Used once: start, drain, close."""

    def start(self, slots: int, ready: Callable[[], bool]) -> None:
        """Begin to bring work to `slots` slots, for as long as `ready` says that it may be taken."""
        ...

    def serve(self, step: Callable[[], bool]) -> None:
        """Call `step` in this thread whenever there may be work, until draining; it says whether there was."""
        ...

    def drain(self) -> None:
        """Bring no more work; `serve` returns when its present step ends."""
        ...

    def close(self) -> None:
        """Put everything away, once the slots have ended."""
        ...


class PolledWork:
    """Work of this very machine: the doorbell says that there is some, and a look now and then finds the rest."""

    def __init__(self, doorbell: Doorbell, poll_s: float) -> None:
        self._doorbell = doorbell
        self._poll_s = poll_s
        self._draining = threading.Event()

    def start(self, slots: int, ready: Callable[[], bool]) -> None:
        """Do nothing: a slot that is not ready finds nothing."""

    def serve(self, step: Callable[[], bool]) -> None:
        """Look, and look again at once for as long as there was something."""
        while not self._draining.is_set():
            heard = self._doorbell.heard()
            busy = attempted(step)
            if not busy and not self._draining.is_set():
                self._doorbell.wait(heard, self._poll_s)

    def drain(self) -> None:
        """Wake who waits."""
        self._draining.set()
        self._doorbell.ring()

    def close(self) -> None:
        """Do nothing."""


def attempted(step: Callable[[], bool]) -> bool:
    """Call `step`; False when it failed: the database is away, and leases heal what was under way."""
    try:
        return step()
    except InfrastructureError as error:  # twice a second while a disk is full, say
        _log.warning("a slot could not take work: %s", error)
        return False
    except Exception:
        _log.exception("a slot could not take work")
        return False
