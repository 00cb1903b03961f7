"""What a permit looks like as a job of Procrastinate, and how one is deferred inside our transaction."""

from collections.abc import Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, DateTime, Integer, String, column, func, table, text
from sqlalchemy.dialects.postgresql import JSONB, insert
from sqlmodel import Session, col

from grader.store.announcing import Waiting
from grader.store.tables import SubmissionRow

QUEUE = "grading"
TASK = "grade"
_LOCK = "sub"

JOBS = table(
    "procrastinate_jobs",
    column("queue_name", String),
    column("task_name", String),
    column("priority", Integer),
    column("queueing_lock", String),
    column("args", JSONB),
    column("status"),
    column("scheduled_at", DateTime(timezone=True)),
)
_NEW = insert(JOBS)
_DEFER = _NEW.on_conflict_do_update(
    index_elements=["queueing_lock"],
    index_where=text("status = 'todo'"),
    set_={"scheduled_at": _NEW.excluded.scheduled_at},
)


def lock_of(submission_id: str, attempt: int) -> str:
    """Return the queueing lock of a permit: at most one of it waits.

    A row that waits again gets another permit although its first one may wait still, because its slot came with
    the permit of another row: there must be as many permits as rows that wait.
    """
    return f"{_LOCK}-{submission_id}-{attempt}"


def lock_of_row() -> ColumnElement[str]:
    """Return `lock_of` as an expression over the columns of `SubmissionRow`."""
    return func.concat(_LOCK, "-", col(SubmissionRow.id), "-", col(SubmissionRow.attempt))


def defer(session: Session, waiting: Sequence[Waiting], now: datetime) -> None:
    """Defer a permit for each of `waiting` in the transaction of `session`; one that waits already is moved.

    Procrastinate's own way does not return before the server has answered, and fails as a whole where one waits.
    """
    if waiting:
        session.connection().execute(_DEFER, [_values(one, now) for one in waiting])


def _values(waiting: Waiting, now: datetime) -> dict[str, Any]:
    return {
        "queue_name": QUEUE,
        "task_name": TASK,
        "args": {"submission": waiting.submission_id, "attempt": waiting.attempt},
        "priority": -waiting.priority,  # Procrastinate's larger numbers go first
        "queueing_lock": lock_of(waiting.submission_id, waiting.attempt),
        "scheduled_at": waiting.due_at if waiting.due_at > now else None,
    }
