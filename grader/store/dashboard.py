"""What an instructor asks about a class: the matrix of its work, and what is failed and mistaken most.

Counting a whole class anew takes a tenth of a second for 6,300 submissions, and while a class is graded
something changes all the time. So the class is counted cell by cell, where a cell is one student at one
assignment. Every cell has a mark that differs whenever its submissions, their gradings or the rules differ.
All marks are one grouped query, and only cells whose mark is new are counted again.
"""

import threading
from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from sqlalchemy import ColumnElement, Select, and_, case, func, select
from sqlmodel import Session, SQLModel, col

from grader.contracts.dashboard import ClassState, ItemFailures, MistakeCount, StudentProgress
from grader.contracts.judgement import settled
from grader.contracts.report import GradeStatus
from grader.contracts.rubric import ItemScore, ItemStatus
from grader.contracts.submission import Judgement, SubmissionState
from grader.store.courses import in_class
from grader.store.database import Database
from grader.store.intake import as_attempts
from grader.store.judgements import judgement
from grader.store.rules import CourseRules, rules_of
from grader.store.tables import (
    AuditRow,
    GradedItemRow,
    GradedMistakeRow,
    JudgementRow,
    SubmissionRow,
)

Place = tuple[str, str]
"""A student and an assignment."""

Mark = tuple[Any, ...]
_PASSING = (SubmissionState.QUEUED, SubmissionState.RUNNING, SubmissionState.INFRASTRUCTURE_ERROR)
_FEW_STUDENTS = 200  # up to here asked for by name; for more, reading the whole class costs no more


@dataclass(frozen=True, slots=True)
class CountedCell:
    """One student at one assignment.

    Attributes:
        mark: differs between cells that differ.
        failed: items failed in at least one graded submission. still: in the best one.
        mistakes: codes of the mistakes recognised in any.
    """

    mark: Mark
    progress: StudentProgress
    failed: frozenset[str]
    still: frozenset[str]
    mistakes: frozenset[str]


@dataclass(frozen=True, slots=True)
class _CountedClass:
    """What was last counted about a course."""

    state: ClassState
    cells: dict[Place, CountedCell]


class Dashboard:
    """Counts over all submissions; safe to share between threads."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._latest: dict[str | None, _CountedClass] = {}
        self._counting = threading.Lock()

    def state(self, course: str | None = None, students: frozenset[str] | None = None) -> ClassState:
        """Count everything of a course on one snapshot, students in order of name; with `students` only theirs.

        Without courses (None) everything that was handed in is one class. While nothing changes, counting
        again is a matter of looking at the marks.
        """
        whole = self._whole(course)
        if students is None:
            return whole.state
        cells = [cell for (student, _), cell in whole.cells.items() if student in students]
        return _state(cells, f"{whole.state.mark} {sorted(students)}")

    def cells(self, course: str | None) -> Mapping[Place, CountedCell]:
        """Return what `state` counts, by student and assignment."""
        return self._whole(course).cells

    def _whole(self, course: str | None) -> _CountedClass:
        with self._database.reading() as session:
            mark = _mark(session, course)
            known = self._latest.get(course)
            if known is not None and known.state.mark == mark:
                return known
        # One count at a time: the next caller finds it made.
        with (
            self._counting,
            self._database.reading() as session,
        ):
            return self._count(session, course)

    def _count(self, session: Session, course: str | None) -> _CountedClass:
        mark, known = _mark(session, course), self._latest.get(course)
        if known is not None and known.state.mark == mark:
            return known
        before = {} if known is None else known.cells
        cells = counted(session, course, rules_of(session, course), before)
        made = self._latest[course] = _CountedClass(_state(cells.values(), mark), cells)
        return made


def _state(cells: Collection[CountedCell], mark: str) -> ClassState:
    return ClassState(
        progress=tuple(cell.progress for cell in cells),
        failures=_failures(cells),
        mistakes=_mistakes(cells),
        mark=mark,
    )


def _mark(session: Session, course: str | None) -> str:
    """Return what changes with everything that is counted: claims, gradings, states, people and rules.

    Claims and gradings raise their numbers for ever, so no two changes cancel out; people, rules, judgements and
    re-grades are in the audit log.
    """
    row = SubmissionRow
    sums = select(
        col(row.state),
        func.count(),
        func.min(col(row.id)),  # another one when the oldest are erased
        func.sum(col(row.attempt)),
        func.sum(func.coalesce(col(row.graded_attempt), 0)),
    ).where(col(row.course) == course, col(row.regrade).is_(None))
    states = session.execute(sums.group_by(col(row.state)).order_by(col(row.state))).all()
    # their number, not the newest: on PostgreSQL an older one may be committed later
    changes = session.execute(
        select(func.count()).select_from(AuditRow).where(col(AuditRow.course) == course)
    ).scalar_one()
    return repr(([tuple(one) for one in states], changes))


def _failures(cells: Iterable[CountedCell]) -> tuple[ItemFailures, ...]:
    ever: Counter[tuple[str, str]] = Counter()
    still: Counter[tuple[str, str]] = Counter()
    for cell in cells:
        assignment = cell.progress.assignment
        ever.update((assignment, item) for item in cell.failed)
        still.update((assignment, item) for item in cell.still)
    failures = (
        ItemFailures(assignment=assignment, item=item, ever=count, still=still[assignment, item])
        for (assignment, item), count in ever.items()
    )
    return tuple(sorted(failures, key=lambda one: (one.assignment, -one.ever, one.item)))


def _mistakes(cells: Iterable[CountedCell]) -> tuple[MistakeCount, ...]:
    made = Counter((cell.progress.assignment, code) for cell in cells for code in cell.mistakes)
    counts = (
        MistakeCount(assignment=assignment, code=code, students=count)
        for (assignment, code), count in made.items()
    )
    return tuple(sorted(counts, key=lambda one: (one.assignment, -one.students, one.code)))


def counted(
    session: Session, course: str | None, known: CourseRules, before: Mapping[Place, CountedCell]
) -> dict[Place, CountedCell]:
    """Return every cell of a class in order of student and assignment, taking from `before` what still holds."""
    marks = _marks(session, course, known)
    new = {place for place, mark in marks.items() if place not in before or before[place].mark != mark}
    fresh = _read(session, course, known, marks, new) if new else {}
    return {place: fresh[place] if place in new else before[place] for place in marks}


def _marks(session: Session, course: str | None, known: CourseRules) -> dict[Place, Mark]:
    """Return the mark of each cell.

    Claims and gradings raise their numbers for ever and judgements are only added, so no two changes cancel out.
    What is erased is the oldest: then there is another first one.
    """
    row = SubmissionRow
    place = (col(row.student), col(row.assignment))
    numbers = (
        func.count(),
        func.min(col(row.id)),
        func.sum(col(row.attempt)),
        func.sum(func.coalesce(col(row.graded_attempt), 0)),
        *(func.sum(case((col(row.state) == state.value, 1), else_=0)) for state in _PASSING),
    )
    grouped = select(*place, *numbers).where(in_class(course)).group_by(*place).order_by(*place)
    judged = (
        select(*place, func.count())
        .join(JudgementRow, col(JudgementRow.submission_id) == col(row.id))
        .where(in_class(course))
        .group_by(*place)
    )
    judgements = {(student, assignment): count for student, assignment, count in session.execute(judged)}
    return {
        (student, assignment): (
            *changing,
            judgements.get((student, assignment), 0),
            known.of(assignment, student),
            known.extension(assignment, student),
        )
        for student, assignment, *changing in session.execute(grouped)
    }


def _read(
    session: Session,
    course: str | None,
    known: CourseRules,
    marks: Mapping[Place, Mark],
    places: Collection[Place],
) -> dict[Place, CountedCell]:
    among = and_(in_class(course), _among(places))
    failed = _failed(session, among)
    mistakes = _by_submission(session, _recognised(among))
    cells = {}
    for place, rows in groupby(session.execute(_submissions(among)), lambda row: (row[0], row[1])):
        if place not in places:
            continue
        own = list(rows)
        progress = _progress(own, known)
        cells[place] = CountedCell(
            mark=marks[place],
            progress=progress,
            failed=_union(failed.get(row.id, ()) for row in own),
            still=frozenset(failed.get(progress.best_submission or "", ())),
            mistakes=_union(mistakes.get(row.id, ()) for row in own),
        )
    return cells


def _among(places: Collection[Place]) -> ColumnElement[bool]:
    """Return a condition that holds for `places`, and perhaps for others."""
    students, assignments = ({place[i] for place in places} for i in range(2))
    among = col(SubmissionRow.assignment).in_(assignments)
    return among if len(students) > _FEW_STUDENTS else and_(among, col(SubmissionRow.student).in_(students))


def _submissions(among: ColumnElement[bool]) -> Any:
    row = SubmissionRow
    order = (col(row.student), col(row.assignment), col(row.received_at), col(row.id))
    told = (col(row.state), col(row.verdict), col(row.score), col(row.max_score), col(row.to_judge))
    return select(*order, *told).where(among).order_by(*order)


def _failed_items(among: ColumnElement[bool]) -> Select[str, str]:
    failed = col(GradedItemRow.status) == ItemStatus.FAILED.value
    return (
        select(col(SubmissionRow.id), col(GradedItemRow.item))
        .join_from(SubmissionRow, GradedItemRow, _of_latest_grading(GradedItemRow))
        .where(failed, among)
    )


def _failed(session: Session, among: ColumnElement[bool]) -> dict[str, list[str]]:
    """Return the failed items of latest gradings by submission, with what people gave."""
    failed = _by_submission(session, _failed_items(among))
    given = (
        select(JudgementRow)
        .join(SubmissionRow, col(JudgementRow.submission_id) == col(SubmissionRow.id))
        .where(among)
    )
    judgements: dict[str, list[Judgement]] = defaultdict(list)
    for row in session.execute(given).scalars():
        judgements[row.submission_id].append(judgement(row))
    machine: dict[str, list[ItemScore]] = defaultdict(list)
    for submission, *told in session.execute(_judged_items(among)) if judgements else ():
        item, points, earned, status = told
        machine[submission].append(ItemScore(item, points, earned, ItemStatus(status)))
    for submission, items in machine.items():
        whole = settled(items, judgements[submission])
        failed[submission] = [one.item for one in whole if one.status is ItemStatus.FAILED]
    return failed


def _judged_items(among: ColumnElement[bool]) -> Any:
    """Select every item of the latest gradings of submissions that people judged."""
    item = GradedItemRow
    told = (col(item.item), col(item.points), col(item.earned), col(item.status))
    return (
        select(col(SubmissionRow.id), *told)
        .join_from(SubmissionRow, item, _of_latest_grading(item))
        .where(col(SubmissionRow.id).in_(select(col(JudgementRow.submission_id))), among)
    )


def _recognised(among: ColumnElement[bool]) -> Select[str, str]:
    return (
        select(col(SubmissionRow.id), col(GradedMistakeRow.code))
        .join_from(SubmissionRow, GradedMistakeRow, _of_latest_grading(GradedMistakeRow))
        .where(among)
    )


def _of_latest_grading(row: type[SQLModel]) -> ColumnElement[bool]:
    return and_(
        col(SubmissionRow.id) == row.submission_id,  # type: ignore[attr-defined]
        col(SubmissionRow.graded_attempt) == row.attempt,  # type: ignore[attr-defined]
    )


def _by_submission(session: Session, statement: Select[str, str]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = defaultdict(list)
    for submission, value in session.execute(statement):
        found[submission].append(value)
    return found


def _union(sets: Iterable[Iterable[str]]) -> frozenset[str]:
    return frozenset().union(*sets)


def _progress(own: list[Any], known: CourseRules) -> StudentProgress:
    """Sum up one student's submissions to one assignment, given in order of arrival."""
    latest = own[-1]
    scored = [row for row in own if row.score is not None]
    best = max(scored, key=lambda row: row.score, default=None)  # the first of equals
    attempts = as_attempts(own)
    extension = known.extension(latest.assignment, latest.student)
    manual = next((row for row in reversed(own) if row.to_judge is not None), None)
    counting = known.of(latest.assignment, latest.student).counting(extension, attempts)
    return StudentProgress(
        student=latest.student,
        assignment=latest.assignment,
        attempts=sum(one.costs for one in attempts),
        best_score=None if best is None else best.score,
        max_score=None if best is None else best.max_score,
        best_submission=None if best is None else best.id,
        counted_score=None if counting is None else counting.score,
        counted_submission=None if counting is None else counting.attempt.id,
        latest_submission=latest.id,
        state=SubmissionState(latest.state),
        verdict=None if latest.verdict is None else GradeStatus(latest.verdict),
        last_activity_at=latest.received_at,
        waits_for_person=manual is not None and bool(manual.to_judge),
        shares=tuple(
            row.score / row.max_score if row.score is not None and row.max_score else None
            for row, one in zip(own, attempts, strict=True)
            if one.costs
        ),
    )
