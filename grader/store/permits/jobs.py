"""What a permit looks like as a job of Procrastinate, and how one is deferred inside our transaction."""

from collections.abc import Sequence
from datetime import datetime

from procrastinate import SyncPsycopgConnector
from procrastinate.exceptions import AlreadyEnqueued, ConnectorException
from procrastinate.jobs import Job
from procrastinate.manager import JobManager
from sqlalchemy import ColumnElement, Connection, func
from sqlmodel import Session, col

from grader.contracts.errors import InfrastructureError
from grader.store.announcing import Waiting
from grader.store.tables import SubmissionRow

QUEUE = "grading"
TASK = "grade"
_LOCK = "sub"

_jobs = JobManager(SyncPsycopgConnector())  # never opened: every call brings its connection


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
    """Defer a permit for each of `waiting` in the transaction of `session`.

    A permit that waits already is not doubled: the collision is undone to a savepoint, the transaction goes on.

    Raises:
        InfrastructureError: the database does not answer, or has no queue.
    """
    jobs = [_job(one, now) for one in waiting]
    if not jobs or _deferred(session, jobs):
        return
    for job in jobs if len(jobs) > 1 else ():
        _deferred(session, [job])


def defer_first(session: Session, waiting: Waiting, now: datetime) -> None:
    """Defer the permit of a row that the transaction of `session` inserts: no other can have its lock.

    Raises:
        InfrastructureError: as `defer`, and when what was sent together with it failed.
    """
    _defer(session.connection(), [_job(waiting, now)])


def _deferred(session: Session, jobs: list[Job]) -> bool:
    connection = session.connection()
    savepoint = connection.begin_nested()
    try:
        _defer(connection, jobs)
    except AlreadyEnqueued:
        savepoint.rollback()
        return False
    savepoint.commit()
    return True


def _defer(connection: Connection, jobs: list[Job]) -> None:
    try:
        _jobs.batch_defer_jobs(jobs, connection=connection.connection.driver_connection)
    except ConnectorException as error:
        raise InfrastructureError(f"the queue does not answer: {_reason(error)}") from error


def _reason(error: ConnectorException) -> str:
    return " ".join(str(error.__cause__ or error).split())


def _job(waiting: Waiting, now: datetime) -> Job:
    return Job(
        queue=QUEUE,
        task_name=TASK,
        task_kwargs={"submission": waiting.submission_id, "attempt": waiting.attempt},
        priority=-waiting.priority,  # Procrastinate's larger numbers go first
        lock=None,
        queueing_lock=lock_of(waiting.submission_id, waiting.attempt),
        scheduled_at=waiting.due_at if waiting.due_at > now else None,
    )
