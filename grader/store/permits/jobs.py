"""What a permit looks like as a job of Procrastinate, and how one is deferred inside our transaction."""

from collections.abc import Sequence
from datetime import datetime

from procrastinate import SyncPsycopgConnector
from procrastinate.exceptions import AlreadyEnqueued, ConnectorException
from procrastinate.jobs import Job
from procrastinate.manager import JobManager
from sqlmodel import Session

from grader.contracts.errors import InfrastructureError
from grader.store.announcing import Waiting

QUEUE = "grading"
TASK = "grade"
ARGUMENT = "submission"

_jobs = JobManager(SyncPsycopgConnector())  # never opened: every call brings its connection


def lock_of(submission_id: str) -> str:
    """Return the queueing lock of a row's permit: at most one of it waits."""
    return f"sub-{submission_id}"


def defer(session: Session, waiting: Sequence[Waiting], now: datetime) -> None:
    """Defer a permit for each of `waiting` in the transaction of `session`.

    A row whose permit waits already keeps it: the collision is undone to a savepoint, the transaction goes on.

    Raises:
        InfrastructureError: the database does not answer, or has no queue.
    """
    jobs = [_job(one, now) for one in waiting]
    if not jobs or _deferred(session, jobs):
        return
    for job in jobs if len(jobs) > 1 else ():
        _deferred(session, [job])


def _deferred(session: Session, jobs: list[Job]) -> bool:
    connection = session.connection()
    savepoint = connection.begin_nested()
    try:
        _jobs.batch_defer_jobs(jobs, connection=connection.connection.driver_connection)
    except AlreadyEnqueued:
        savepoint.rollback()
        return False
    except ConnectorException as error:
        raise InfrastructureError(f"the queue does not answer: {_reason(error)}") from error
    savepoint.commit()
    return True


def _reason(error: ConnectorException) -> str:
    return " ".join(str(error.__cause__ or error).split())


def _job(waiting: Waiting, now: datetime) -> Job:
    return Job(
        queue=QUEUE,
        task_name=TASK,
        task_kwargs={ARGUMENT: waiting.submission_id},
        priority=-waiting.priority,  # Procrastinate's larger numbers go first
        lock=None,
        queueing_lock=lock_of(waiting.submission_id),
        scheduled_at=waiting.due_at if waiting.due_at > now else None,
    )
