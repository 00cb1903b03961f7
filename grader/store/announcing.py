"""The seam between the rows that wait and whatever brings work to workers.

The submission's row is the truth in every mode; an announcement is what makes a worker look at the rows soon.
On SQLite workers are local, hear the doorbell and poll: nothing is announced. On PostgreSQL every row that
becomes ``queued`` gets a job in the same transaction: `grader.store.permits`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Protocol

from sqlalchemy import Connection
from sqlmodel import Session

from grader.contracts.submission import Claim
from grader.store.tables import SubmissionRow


@dataclass(frozen=True, slots=True, kw_only=True)
class Waiting:
    """A row that is ``queued``. Smaller `priority` goes first; it is not due before `due_at`.

    Attributes:
        attempt: how often the row has been claimed, which tells each time it waits from the others.
    """

    submission_id: str
    attempt: int
    priority: int
    due_at: datetime


def waiting_as(row: SubmissionRow) -> Waiting:
    """Return what is to be announced of a row that waits."""
    return Waiting(submission_id=row.id, attempt=row.attempt, priority=row.priority, due_at=row.not_before)


class Announcer(Protocol):
    """Makes workers look for rows that wait. Every method belongs to the transaction that it is given."""

    def queued(self, session: Session, waiting: Sequence[Waiting], now: datetime) -> None:
        """Announce rows that this transaction makes ``queued``; those announced already stay so.

        May be sent `together`.
        """
        ...

    def claimed(self, connection: Connection, claim: Claim) -> None:
        """Take the announcement of a row away that this transaction claimed without having been told of one.

        May be sent `together`.
        """
        ...

    def mend(self, session: Session, now: datetime) -> int:
        """Make up for announcements that were lost, and clear away what is left of dead workers' work.

        Returns:
            How many rows were announced again.
        """
        ...


class Unannounced:
    """Announces nothing: the workers are local and look by themselves."""

    def queued(self, session: Session, waiting: Sequence[Waiting], now: datetime) -> None:
        """Do nothing."""

    def claimed(self, connection: Connection, claim: Claim) -> None:
        """Do nothing."""

    def mend(self, session: Session, now: datetime) -> int:
        """Do nothing."""
        return 0
