"""How slots learn that a submission waits.

The submission's row is the truth. Everything here is only a hint to look at the rows soon, and a lost hint
costs a little time. `Announcer` is the side of whoever queues rows, `WorkSource` the side of the slots. On
SQLite the slots are on the same machine: nothing is announced, they hear a `Doorbell` and poll. On PostgreSQL
every row that becomes ``queued`` gets a job in the same transaction; see `grader.store.permits`.
"""

import logging
import threading
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Protocol

from sqlmodel import Session, col

from grader.contracts.errors import InfrastructureError
from grader.contracts.submission import Claim
from grader.store.tables import SubmissionRow

PERMIT_CONNECTIONS = 2
"""Of a worker to PostgreSQL, to learn that something waits: one listens, outside of Procrastinate's pool."""
_log = logging.getLogger(__name__)
ANNOUNCED = (
    col(SubmissionRow.id),
    col(SubmissionRow.attempt),
    col(SubmissionRow.priority),
    col(SubmissionRow.not_before),
)
"""The columns that `announcements` takes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Announcement:
    """A row that is ``queued``. Smaller `priority` goes first; it is not due before `due_at`.

    Attributes:
        attempt: how often the row has been claimed. A row that is queued again has a higher one.
    """

    submission_id: str
    attempt: int
    priority: int
    due_at: datetime


def announcements(rows: Iterable[Any]) -> list[Announcement]:
    """Return the announcements of rows of the columns `ANNOUNCED`."""
    return [
        Announcement(submission_id=row[0], attempt=row[1], priority=row[2], due_at=row[3]) for row in rows
    ]


def announcement_of(row: SubmissionRow) -> Announcement:
    """Return the announcement of a queued row."""
    return Announcement(
        submission_id=row.id, attempt=row.attempt, priority=row.priority, due_at=row.not_before
    )


class Announcer(Protocol):
    """Makes slots look for queued rows. Every method belongs to the transaction of the session it is given."""

    def queued(self, session: Session, announcements: Sequence[Announcement], now: datetime) -> None:
        """Announce rows that this transaction makes ``queued``; those announced already stay so."""
        ...

    def claimed(self, session: Session, claim: Claim) -> None:
        """Take back the announcement of a row that this transaction claimed without having been told of it."""
        ...

    def mend(self, session: Session, now: datetime) -> int:
        """Replace announcements that were lost, and clear away what dead workers left.

        Returns:
            How many rows were announced again.
        """
        ...


class Unannounced:
    """Announces nothing: the workers are local and look by themselves."""

    def queued(self, session: Session, announcements: Sequence[Announcement], now: datetime) -> None:
        """Do nothing."""

    def claimed(self, session: Session, claim: Claim) -> None:
        """Do nothing."""

    def mend(self, session: Session, now: datetime) -> int:
        """Do nothing."""
        return 0


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
    """Work on this machine: the doorbell tells of some of it, and polling finds the rest."""

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
        """Wake the slots that wait, so that they end."""
        self._draining.set()
        self._doorbell.ring()

    def close(self) -> None:
        """Do nothing."""


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
