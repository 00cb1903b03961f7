"""What an instructor asks of the rows.

Two narrow reads and one pass over them: ranking with window functions in the database took five times as long
on a class of 6,300 submissions.
"""

from collections import defaultdict
from collections.abc import Iterable
from itertools import groupby
from typing import Any

from sqlalchemy import ColumnElement, and_, distinct, func, select
from sqlmodel import Session, col

from grader import policy as rules
from grader.contracts.dashboard import ClassState, ItemFailures, MistakeCount, Progress
from grader.contracts.identity import Role
from grader.contracts.policy import Attempt
from grader.contracts.report import GradeStatus
from grader.contracts.rubric import ItemStatus
from grader.contracts.submission import SubmissionState
from grader.store.course_tables import AuditRow, MemberRow
from grader.store.database import Database
from grader.store.intake import costs_an_attempt
from grader.store.policies import Rules, rules_of
from grader.store.tables import GradedItemRow, GradedMistakeRow, SubmissionRow


class Dashboard:
    """Counts over all submissions; safe to share between threads."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._latest: dict[str | None, ClassState] = {}

    def state(self, course: str | None = None) -> ClassState:
        """Count everything of a course on one snapshot, students in order of name.

        Without courses (None) everything that was handed in is one class. While nothing changes, counting
        again is a matter of looking at the marks.
        """
        with self._database.reading() as session:
            mark = _mark(session, course)
            known = self._latest.get(course)
            if known is not None and known.mark == mark:
                return known
            progress = _progress(session, course, rules_of(session, course))
            best = {one.best_submission for one in progress}
            state = ClassState(
                progress=progress,
                failures=_failures(session, course, best),
                mistakes=_mistakes(session, course),
                mark=mark,
            )
        self._latest[course] = state
        return state


def _mark(session: Session, course: str | None) -> str:
    """Return what changes with everything that is counted: claims, gradings, states, people and rules.

    Claims and gradings raise their numbers for ever, so no two changes cancel out; people, rules and re-grades
    are in the audit log.
    """
    row = SubmissionRow
    sums = select(
        col(row.state),
        func.count(),
        func.sum(col(row.attempt)),
        func.sum(func.coalesce(col(row.graded_attempt), 0)),
    ).where(col(row.course) == course, col(row.regrade).is_(None))
    states = session.execute(sums.group_by(col(row.state)).order_by(col(row.state))).all()
    # their number, not the newest: on PostgreSQL an older one may be committed later
    changes = session.execute(
        select(func.count()).select_from(AuditRow).where(col(AuditRow.course) == course)
    ).scalar_one()
    return repr(([tuple(one) for one in states], changes))


def in_class(course: str | None) -> ColumnElement[bool]:
    """What belongs to a class: its students' work, not what its staff hands in to try things out."""
    if course is None:
        return and_(col(SubmissionRow.course).is_(None), col(SubmissionRow.regrade).is_(None))
    students = select(col(MemberRow.person)).where(
        col(MemberRow.course) == course, col(MemberRow.role) == Role.STUDENT.value
    )
    return and_(col(SubmissionRow.course) == course, col(SubmissionRow.student).in_(students))


def _progress(session: Session, course: str | None, known: Rules) -> tuple[Progress, ...]:
    columns = (
        col(SubmissionRow.student),
        col(SubmissionRow.assignment),
        col(SubmissionRow.received_at),
        col(SubmissionRow.id),
    )
    statement = (
        select(
            *columns,
            col(SubmissionRow.state),
            col(SubmissionRow.verdict),
            col(SubmissionRow.score),
            col(SubmissionRow.max_score),
            col(SubmissionRow.to_judge),
        )
        .where(in_class(course))
        .order_by(*columns)
    )
    rows = session.execute(statement)
    return tuple(
        _one_progress(list(own), known) for _, own in groupby(rows, lambda row: (row.student, row.assignment))
    )


def _one_progress(own: list[Any], known: Rules) -> Progress:
    """Sum up one student's submissions to one assignment, given in order of arrival."""
    latest = own[-1]
    scored = [row for row in own if row.score is not None]
    best = max(scored, key=lambda row: row.score, default=None)  # the first of equals
    attempts = [
        Attempt(
            id=row.id,
            received_at=row.received_at,
            score=row.score,
            costs=costs_an_attempt(row.state, row.verdict),
        )
        for row in own
    ]
    extension = known.extension(latest.assignment, latest.student)
    manual = next((row for row in reversed(own) if row.to_judge is not None), None)
    counted = rules.counting(known.policy(latest.assignment), extension, attempts)
    return Progress(
        student=latest.student,
        assignment=latest.assignment,
        attempts=sum(one.costs for one in attempts),
        best_score=None if best is None else best.score,
        max_score=None if best is None else best.max_score,
        best_submission=None if best is None else best.id,
        counted_score=None if counted is None else counted.score,
        counted_submission=None if counted is None else counted.attempt.id,
        latest_submission=latest.id,
        state=SubmissionState(latest.state),
        verdict=None if latest.verdict is None else GradeStatus(latest.verdict),
        last_activity_at=latest.received_at,
        waiting_submission=manual.id if manual is not None and manual.to_judge else None,
        shares=tuple(
            row.score / row.max_score if row.score is not None and row.max_score else None
            for row, one in zip(own, attempts, strict=True)
            if one.costs
        ),
    )


def _failures(session: Session, course: str | None, best: set[str | None]) -> tuple[ItemFailures, ...]:
    statement = (
        select(
            col(SubmissionRow.assignment),
            col(GradedItemRow.item),
            col(SubmissionRow.student),
            col(SubmissionRow.id),
        )
        .join_from(SubmissionRow, GradedItemRow, _of_latest_grading(GradedItemRow))
        .where(col(GradedItemRow.status) == ItemStatus.FAILED.value, in_class(course))
    )
    ever: dict[tuple[str, str], set[str]] = defaultdict(set)
    still: dict[tuple[str, str], set[str]] = defaultdict(set)
    for assignment, item, student, submission_id in session.execute(statement):
        ever[assignment, item].add(student)
        if submission_id in best:
            still[assignment, item].add(student)
    counted = (
        ItemFailures(assignment=assignment, item=item, ever=len(students), still=len(still[assignment, item]))
        for (assignment, item), students in ever.items()
    )
    return tuple(_most_first(counted))


def _most_first(failures: Iterable[ItemFailures]) -> list[ItemFailures]:
    return sorted(failures, key=lambda one: (one.assignment, -one.ever, one.item))


def _mistakes(session: Session, course: str | None) -> tuple[MistakeCount, ...]:
    students = func.count(distinct(col(SubmissionRow.student)))
    code, assignment = col(GradedMistakeRow.code), col(SubmissionRow.assignment)
    statement = (
        select(assignment, code, students)
        .join_from(SubmissionRow, GradedMistakeRow, _of_latest_grading(GradedMistakeRow))
        .where(in_class(course))
        .group_by(assignment, code)
        .order_by(assignment, students.desc(), code)
    )
    return tuple(
        MistakeCount(assignment=row[0], code=row[1], students=row[2]) for row in session.execute(statement)
    )


def _of_latest_grading(row: type[GradedItemRow] | type[GradedMistakeRow]) -> Any:
    return and_(
        col(SubmissionRow.id) == col(row.submission_id),
        col(SubmissionRow.graded_attempt) == col(row.attempt),
    )
