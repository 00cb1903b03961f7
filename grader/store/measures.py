"""What the rows say about queue and workers at one instant, for whoever watches the service."""

from sqlalchemy import func, select
from sqlmodel import col

from grader.contracts.submission import SubmissionState
from grader.contracts.telemetry import QueueDepth, ServiceState
from grader.store.columns import Clock
from grader.store.database import Database
from grader.store.tables import SubmissionRow
from grader.store.workers import Workers


class Measures:
    """Counts for operators; safe to share between threads."""

    def __init__(self, database: Database, workers: Workers, clock: Clock, silent_s: float) -> None:
        """`silent_s`: after how long a worker that says nothing no longer counts as alive."""
        self._database = database
        self._workers = workers
        self._clock = clock
        self._silent_s = silent_s

    def state(self) -> ServiceState:
        """Count what waits, runs and is done, by priority, and who works.

        Raises:
            InfrastructureError: the database does not answer.
        """
        state, priority = col(SubmissionRow.state), col(SubmissionRow.priority)
        counts = select(state, priority, func.count()).group_by(state, priority).order_by(state, priority)
        oldest = select(func.min(col(SubmissionRow.queued_at))).where(state == SubmissionState.QUEUED.value)
        with self._database.reading() as session:
            depths = tuple(
                QueueDepth(state=row[0], priority=row[1], count=row[2]) for row in session.execute(counts)
            )
            oldest_queued_at = session.execute(oldest).scalar_one()
        return ServiceState(
            at=self._clock(),
            depths=depths,
            oldest_queued_at=oldest_queued_at,
            workers=self._workers.alive(self._silent_s),
        )
