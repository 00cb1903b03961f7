"""How slots learn that a submission waits.

The submission's row is the truth. Everything here is only a hint to look at the rows soon, and a lost hint costs a
little time: slots look by themselves, too. They hear a `Doorbell`, which is rung in the same process, or by the
service for its own worker. Between machines a job carries the hint; see `grader.store.jobs`.
"""

import logging
import threading
from collections.abc import Callable

from sqlalchemy import Connection, text

from grader.contracts.errors import InfrastructureError

NEWS_CONNECTIONS = 2
"""Of a worker to PostgreSQL, to learn that something waits: one listens, outside of Procrastinate's pool."""
JOB_QUEUE, JOB_TASK = "grading", "look"
_TELL = text("INSERT INTO procrastinate_jobs (queue_name, task_name) VALUES (:queue, :task)")
_log = logging.getLogger(__name__)


def tell_workers(connection: Connection) -> None:
    """Have a worker on another machine look once the transaction is committed. A SQLite file has none."""
    if connection.dialect.name != "sqlite":
        connection.execute(_TELL, {"queue": JOB_QUEUE, "task": JOB_TASK})


class Doorbell:
    """A hint that something changed. Missing one costs a poll interval, nothing else.

    Ringing wakes everybody who waits. A ring between looking and waiting is not missed.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._rings = 0
        self._elsewhere: Callable[[], None] | None = None

    def tell(self, elsewhere: Callable[[], None]) -> None:
        """Have `elsewhere` called at each ring from now on: it wakes those of another process."""
        self._elsewhere = elsewhere

    def ring(self) -> None:
        """Wake everybody, those of the other process as well."""
        self.ring_here()
        if self._elsewhere is not None:
            self._elsewhere()

    def ring_here(self) -> None:
        """Wake those of this process."""
        with self._changed:
            self._rings += 1
            self._changed.notify_all()

    def heard(self) -> int:
        """Return the number of rings so far; read it before looking for work."""
        with self._changed:
            return self._rings

    def wait(self, heard: int, timeout_s: float) -> None:
        """Return once the bell rang after `heard` was read, or after `timeout_s`."""
        with self._changed:
            self._changed.wait_for(lambda: self._rings != heard, timeout_s)


class PolledWork:
    """Work on this machine: the doorbell tells of some of it, and polling finds the rest."""

    def __init__(self, doorbell: Doorbell, poll_s: float) -> None:
        self._doorbell = doorbell
        self._poll_s = poll_s
        self._draining = threading.Event()

    def serve(self, step: Callable[[], bool]) -> None:
        """Look, and look again at once for as long as there was something."""
        while not self._draining.is_set():
            heard = self._doorbell.heard()
            busy = attempted(step)
            if not busy and not self._draining.is_set():
                self._doorbell.wait(heard, self._poll_s)

    def drain(self) -> None:
        """Wake the slots that wait, so that they end."""
        self._draining.set()
        self._doorbell.ring()


def attempted(step: Callable[[], bool]) -> bool:
    """Call `step`; False when it failed. Then the database is away, and leases heal what was under way."""
    try:
        return step()
    except InfrastructureError as error:  # no traceback: a full disk causes this twice a second
        _log.warning("a slot could not take work: %s", error)
        return False
    except Exception:
        _log.exception("a slot could not take work")
        return False
