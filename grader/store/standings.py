"""The state of submissions, classes and the whole service: small queries for those who watch it change."""

import hashlib
from collections import defaultdict
from collections.abc import Collection
from typing import Any

from sqlalchemy import and_, func, or_, select
from sqlmodel import Session, col

from grader.contracts.progress import ClassStanding, ExplanationStanding, Standing
from grader.contracts.submission import SubmissionState
from grader.contracts.telemetry import QueueDepth, ServiceState
from grader.store.clock import Clock
from grader.store.database import Database, StorePart
from grader.store.tables import AuditRow, ExplanationRow, SubmissionRow
from grader.store.workers import Workers

_MARK_CHARACTERS = 16


class Standings(StorePart):
    """Reads where submissions and classes stand; safe to share between threads."""

    def of(self, submissions: Collection[str]) -> dict[str, Standing]:
        """Return where `submissions` stand, by id; those that do not exist are left out."""
        if not submissions:
            return {}
        row = SubmissionRow
        statement = select(col(row.id), col(row.state), col(row.attempt), col(row.started_at)).where(
            col(row.id).in_(submissions)
        )
        with self._database.reading() as session:
            rows = session.execute(statement).all()
            waiting = any(one[1] == SubmissionState.QUEUED.value for one in rows)
            positions = _positions(session) if waiting else {}
        return {
            id_: Standing(
                id=id_,
                state=SubmissionState(state),
                attempt=attempt,
                position=positions.get(id_),
                started_at=started_at,
            )
            for id_, state, attempt, started_at in rows
        }

    def of_explanations(self, submissions: Collection[str]) -> dict[str, ExplanationStanding]:
        """Return where the explanations of `submissions` stand, by id."""
        if not submissions:
            return {}
        row, explanation = SubmissionRow, ExplanationRow
        of_latest = and_(
            col(explanation.submission_id) == col(row.id),
            col(explanation.attempt) == col(row.graded_attempt),
            col(explanation.finished_at).is_(None),
        )
        statement = (
            select(col(row.id), col(row.graded_attempt), col(explanation.attempt))
            .join_from(row, explanation, of_latest, isouter=True)
            .where(col(row.id).in_(submissions))
        )
        return {
            id_: ExplanationStanding(attempt=attempt, is_final=awaited is None)
            for id_, attempt, awaited in self._rows(statement)
        }

    def of_classes(self, courses: Collection[str | None]) -> dict[str | None, ClassStanding]:
        """Return where the classes of `courses` stand; None is the class of a service without courses."""
        if not courses:
            return {}
        with self._database.reading() as session:
            counts, changes = _counts(session, courses), _changes(session, courses)
        return {course: _class(counts[course], changes.get(course)) for course in courses}


def _positions(session: Session) -> dict[str, int]:
    """Return how many are before each waiting submission.

    The index has the whole queue in order; numbering and joining it in the database took many times as long.
    """
    row = SubmissionRow
    queue = (
        select(col(row.id))
        .where(col(row.state) == SubmissionState.QUEUED.value)
        .order_by(col(row.priority), col(row.turn_at), col(row.id))
    )
    return {id_: position for position, id_ in enumerate(session.execute(queue).scalars())}


def _counts(
    session: Session, courses: Collection[str | None]
) -> dict[str | None, dict[str, tuple[Any, ...]]]:
    """Count by course and state. Claims and gradings raise their numbers for ever: no two changes cancel out."""
    row = SubmissionRow
    statement = (
        select(
            col(row.course),
            col(row.state),
            func.count(),
            func.sum(col(row.attempt)),
            func.sum(func.coalesce(col(row.graded_attempt), 0)),
        )
        .where(_among(col(row.course), courses), col(row.regrade).is_(None))
        .group_by(col(row.course), col(row.state))
    )
    counts: dict[str | None, dict[str, tuple[Any, ...]]] = defaultdict(dict)
    for course, state, *numbers in session.execute(statement):
        counts[course][state] = tuple(int(number) for number in numbers)
    return counts


def _changes(session: Session, courses: Collection[str | None]) -> dict[str | None, int]:
    """Count each course's changes of people, rules and grades.

    Not the newest's number: on PostgreSQL an older one may be committed later.
    """
    course = col(AuditRow.course)
    statement = select(course, func.count()).where(_among(course, courses)).group_by(course)
    return {row[0]: row[1] for row in session.execute(statement)}


def _among(column: Any, courses: Collection[str | None]) -> Any:
    named = [course for course in courses if course is not None]
    return or_(column.in_(named), column.is_(None)) if None in courses else column.in_(named)


def _class(states: dict[str, tuple[Any, ...]], changes: int | None) -> ClassStanding:
    content = repr((sorted(states.items()), changes))

    def count(state: SubmissionState) -> int:
        return int(states[state.value][0]) if state.value in states else 0

    return ClassStanding(
        queued=count(SubmissionState.QUEUED),
        running=count(SubmissionState.RUNNING),
        graded=count(SubmissionState.GRADED),
        infrastructure_errors=count(SubmissionState.INFRASTRUCTURE_ERROR),
        mark=hashlib.sha256(content.encode()).hexdigest()[:_MARK_CHARACTERS],
    )


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

        Raises InfrastructureError: the database does not answer.
        """
        state, priority = col(SubmissionRow.state), col(SubmissionRow.priority)
        counts = select(state, priority, func.count()).group_by(state, priority).order_by(state, priority)
        fresh = state == SubmissionState.QUEUED.value, priority == 0  # re-grades may wait for days
        oldest = select(func.min(col(SubmissionRow.queued_at))).where(*fresh)
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
            free_bytes=self._database.free_bytes(),
        )
