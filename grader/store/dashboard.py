"""What an instructor asks about a class: the matrix of its work, and what is failed and mistaken most.

The class is counted cell by cell, where a cell is one student at one assignment, and kept. What a look costs
depends on what has changed since the one before, not on the size of the class:

- Submissions change only while they are open. So a look reads those that are open, those that were open at the
  look before, and those that ended since shortly before it (`_Window`). Cells whose submissions differ are counted
  again.
- People, rules, judgements and re-grades are in the audit log, and what is erased changes the number of
  submissions. When either number is not what it should be, the whole class is looked at. Every cell has a mark
  that differs whenever its submissions, their gradings or the rules differ, and cells whose mark is new are
  counted again.
"""

import hashlib
import threading
from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from itertools import groupby
from typing import Any

from sqlalchemy import ColumnElement, Select, and_, case, func, select, union_all
from sqlmodel import Session, SQLModel, col

from grader.contracts.dashboard import (
    AssignmentState,
    ClassState,
    ItemFailures,
    MistakeCount,
    StudentProgress,
    StudentState,
)
from grader.contracts.judgement import settled
from grader.contracts.report import GradeStatus
from grader.contracts.rubric import ItemScore, ItemStatus
from grader.contracts.submission import Judgement, SubmissionState
from grader.store.clock import Clock
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
_OPEN = (SubmissionState.QUEUED.value, SubmissionState.RUNNING.value)
_ENDED_STATUSES = (GradeStatus.GRADED.value, GradeStatus.NEEDS_MANUAL.value)
_MARGIN = timedelta(minutes=1)  # between the instant that a row says and its commit
_DIGEST_BYTES = 8
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


_Submission = tuple[str, str, int, int | None, str]
"""Student, assignment, claims, the grading that stands, state."""


@dataclass(frozen=True, slots=True)
class _Window:
    """The submissions of a course that may have changed lately, at one look.

    Attributes:
        since: those that ended later are in it, beside those that are open.
        rows: by id. open: the ids of those that are not graded.
        submissions: how many there are in all, trials included. changes: of people, rules and grades.
    """

    since: datetime
    rows: Mapping[str, _Submission]
    open: frozenset[str]
    submissions: int
    changes: int

    def same(self, other: "_Window") -> bool:
        """Whether nothing has changed between two looks."""
        same_numbers = (self.submissions, self.changes, self.open) == (
            other.submissions,
            other.changes,
            other.open,
        )
        return same_numbers and all(other.rows.get(id_) == row for id_, row in self.rows.items())


@dataclass(frozen=True, slots=True)
class _CountedClass:
    """What was last counted about a course."""

    window: _Window
    cells: Mapping[Place, CountedCell]
    state: ClassState
    digest: int
    parts: dict[frozenset[str], ClassState] = field(default_factory=dict)


class Dashboard:
    """Counts over all submissions; safe to share between threads."""

    def __init__(self, database: Database, clock: Clock) -> None:
        self._database = database
        self._clock = clock
        self._latest: dict[str | None, _CountedClass] = {}
        self._counting = threading.Lock()

    def state(self, course: str | None = None, students: frozenset[str] | None = None) -> ClassState:
        """Count everything of a course on one snapshot, students in order of name; with `students` only theirs.

        Without courses (None) everything that was handed in is one class.
        """
        whole = self._whole(course)
        if students is None:
            return whole.state
        part = whole.parts.get(students)
        if part is None:
            cells = {place: cell for place, cell in whole.cells.items() if place[0] in students}
            part = _state(cells, f"{whole.state.mark} {sorted(students)}", None, set(cells))
            whole.parts[students] = part
        return part

    def cells(self, course: str | None) -> Mapping[Place, CountedCell]:
        """Return what `state` counts, by student and assignment."""
        return self._whole(course).cells

    def _whole(self, course: str | None) -> _CountedClass:
        with self._counting, self._database.reading() as session:  # the next caller finds it counted
            before = self._latest.get(course)
            window = _window(session, course, self._clock() - _MARGIN)
            if before is not None and window.same(before.window):
                return before
            places = None if before is None else _changed(before.window, window)
            counted_class = self._latest[course] = _count(session, course, before, window, places)
            return counted_class


def _count(
    session: Session,
    course: str | None,
    earlier: _CountedClass | None,
    window: _Window,
    places: set[Place] | None,
) -> _CountedClass:
    """Count `places` again, or where nobody knows which (None), all that differ from `earlier`."""
    before: Mapping[Place, CountedCell] = {} if earlier is None else earlier.cells
    rules = rules_of(session, course)
    if places is None:
        cells = counted(session, course, rules, before)
        places = {one for one in before.keys() | cells.keys() if before.get(one) is not cells.get(one)}
    else:
        marks = _marks(session, course, rules, places)
        fresh = _read(session, course, rules, marks, places) if places else {}
        cells = {
            place: cell for place, cell in before.items() if place in fresh or place not in places
        } | fresh
        if fresh.keys() - before.keys():
            cells = dict(sorted(cells.items()))
    digest = 0 if earlier is None else earlier.digest
    for place in places:
        digest ^= _digest(place, before.get(place)) ^ _digest(place, cells.get(place))
    mark = f"{digest:x} {window.changes}"
    state = _state(cells, mark, None if earlier is None else earlier.state, places)
    return _CountedClass(window, cells, state, digest)


def _digest(place: Place, cell: CountedCell | None) -> int:
    if cell is None:
        return 0
    content = repr((place, cell.mark)).encode()
    return int.from_bytes(hashlib.blake2b(content, digest_size=_DIGEST_BYTES).digest(), "big")


def _window(session: Session, course: str | None, since: datetime) -> _Window:
    row = SubmissionRow
    shown = (row.student, row.assignment, row.attempt, row.graded_attempt, row.state)
    # of all courses: the databases would look for those of one by an index of that, which has all its submissions
    columns = (col(row.id), col(row.course), col(row.regrade), *(col(column) for column in shown))
    open_ = select(*columns).where(col(row.state).in_(_OPEN))
    ended = select(*columns).where(col(row.finished_at) >= since)
    recent = session.execute(union_all(open_, ended))
    rows = {id_: tuple(values) for id_, of, regrade, *values in recent if of == course and regrade is None}
    submissions = select(func.count()).select_from(row).where(col(row.course) == course)
    # their number, not the newest: on PostgreSQL an older one may be committed later
    changes = select(func.count()).select_from(AuditRow).where(col(AuditRow.course) == course)
    return _Window(
        since,
        rows,
        frozenset(id_ for id_, values in rows.items() if values[-1] in _OPEN),
        session.execute(submissions).scalar_one(),
        session.execute(changes).scalar_one(),
    )


def _changed(before: _Window, now: _Window) -> set[Place] | None:
    """Return the cells that changed between two looks; None if nobody knows which."""
    new = now.rows.keys() - before.rows.keys()
    if before.changes != now.changes or before.submissions + len(new) != now.submissions:
        return None
    differ = {(row[0], row[1]) for id_, row in now.rows.items() if before.rows.get(id_) != row}
    gone = before.open - now.rows.keys()
    return differ | {(before.rows[id_][0], before.rows[id_][1]) for id_ in gone}


def _state(
    cells: Mapping[Place, CountedCell], mark: str, before: ClassState | None, places: Collection[Place]
) -> ClassState:
    """Return the state of a class in which only `places` differ from `before`."""
    changed_students, changed_assignments = ({place[i] for place in places} for i in range(2))
    of_student: dict[str, list[CountedCell]] = defaultdict(list)
    of_assignment: dict[str, list[CountedCell]] = defaultdict(list)
    for (student, assignment), cell in cells.items():
        if student in changed_students:
            of_student[student].append(cell)
        if assignment in changed_assignments:
            of_assignment[assignment].append(cell)
    students = {} if before is None else dict(before.students)
    assignments = {} if before is None else dict(before.assignments)
    for student in changed_students:
        students.pop(student, None)
    for assignment in changed_assignments:
        assignments.pop(assignment, None)
    students |= {
        student: StudentState(progress=tuple(cell.progress for cell in own))
        for student, own in of_student.items()
    }
    assignments |= {assignment: _assignment_state(own) for assignment, own in of_assignment.items()}
    return ClassState(
        students=dict(sorted(students.items())), assignments=dict(sorted(assignments.items())), mark=mark
    )


def _assignment_state(cells: Collection[CountedCell]) -> AssignmentState:
    return AssignmentState(
        progress=tuple(cell.progress for cell in cells), failures=_failures(cells), mistakes=_mistakes(cells)
    )


def _failures(cells: Iterable[CountedCell]) -> tuple[ItemFailures, ...]:
    ever: Counter[str] = Counter()
    still: Counter[str] = Counter()
    for cell in cells:
        ever.update(cell.failed)
        still.update(cell.still)
    failures = (ItemFailures(item=item, ever=count, still=still[item]) for item, count in ever.items())
    return tuple(sorted(failures, key=lambda failure: (-failure.ever, failure.item)))


def _mistakes(cells: Iterable[CountedCell]) -> tuple[MistakeCount, ...]:
    students_of = Counter(code for cell in cells for code in cell.mistakes)
    counts = (MistakeCount(code=code, students=count) for code, count in students_of.items())
    return tuple(sorted(counts, key=lambda count: (-count.students, count.code)))


def counted(
    session: Session, course: str | None, rules: CourseRules, before: Mapping[Place, CountedCell]
) -> dict[Place, CountedCell]:
    """Return every cell of a class in order of student and assignment, taking from `before` what still holds."""
    marks = _marks(session, course, rules)
    new = {place for place, mark in marks.items() if place not in before or before[place].mark != mark}
    fresh = _read(session, course, rules, marks, new) if new else {}
    return {place: fresh[place] if place in new else before[place] for place in marks}


def _marks(
    session: Session, course: str | None, rules: CourseRules, places: Collection[Place] | None = None
) -> dict[Place, Mark]:
    """Return the mark of each cell, or of `places` and perhaps of others.

    Claims and gradings raise their numbers for ever and judgements are only added, so no two changes cancel out.
    What is erased is the oldest: then there is another first one.
    """
    row = SubmissionRow
    among = in_class(course) if places is None else and_(in_class(course), _among(places))
    place = (col(row.student), col(row.assignment))
    numbers = (
        func.count(),
        func.min(col(row.id)),
        func.sum(col(row.attempt)),
        func.sum(func.coalesce(col(row.graded_attempt), 0)),
        *(func.sum(case((col(row.state) == state.value, 1), else_=0)) for state in _PASSING),
    )
    grouped = select(*place, *numbers).where(among).group_by(*place).order_by(*place)
    judged = (
        select(*place, func.count())
        .join(JudgementRow, col(JudgementRow.submission_id) == col(row.id))
        .where(among)
        .group_by(*place)
    )
    judgements = {(student, assignment): count for student, assignment, count in session.execute(judged)}
    return {
        (student, assignment): (
            *changing,
            judgements.get((student, assignment), 0),
            rules.of(assignment, student),
            rules.extension(assignment, student),
        )
        for student, assignment, *changing in session.execute(grouped)
    }


def _read(
    session: Session,
    course: str | None,
    rules: CourseRules,
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
        progress = _progress(own, rules)
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
    columns = (col(row.state), col(row.verdict), col(row.score), col(row.max_score), col(row.to_judge))
    return select(*order, *columns).where(among).order_by(*order)


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
    judged_rows = (
        select(JudgementRow)
        .join(SubmissionRow, col(JudgementRow.submission_id) == col(SubmissionRow.id))
        .where(among)
    )
    judgements: dict[str, list[Judgement]] = defaultdict(list)
    for row in session.execute(judged_rows).scalars():
        judgements[row.submission_id].append(judgement(row))
    machine: dict[str, list[ItemScore]] = defaultdict(list)
    for submission, *values in session.execute(_judged_items(among)) if judgements else ():
        item, points, earned, status = values
        machine[submission].append(ItemScore(item, points, earned, ItemStatus(status)))
    for submission, items in machine.items():
        whole = settled(items, judgements[submission])
        failed[submission] = [one.item for one in whole if one.status is ItemStatus.FAILED]
    return failed


def _judged_items(among: ColumnElement[bool]) -> Any:
    """Select every item of the latest gradings of submissions that people judged."""
    item = GradedItemRow
    columns = (col(item.item), col(item.points), col(item.earned), col(item.status))
    return (
        select(col(SubmissionRow.id), *columns)
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
    by_submission: dict[str, list[str]] = defaultdict(list)
    for submission, value in session.execute(statement):
        by_submission[submission].append(value)
    return by_submission


def _union(sets: Iterable[Iterable[str]]) -> frozenset[str]:
    return frozenset().union(*sets)


def _progress(own: list[Any], rules: CourseRules) -> StudentProgress:
    """Sum up one student's submissions to one assignment, given in order of arrival."""
    latest = own[-1]
    scored = [row for row in own if row.score is not None]
    best = max(scored, key=lambda row: row.score, default=None)  # the first of equals
    attempts = as_attempts(own)
    extension = rules.extension(latest.assignment, latest.student)
    manual = next((row for row in reversed(own) if row.to_judge is not None), None)
    counting = rules.of(latest.assignment, latest.student).counting(extension, attempts)
    return StudentProgress(
        student=latest.student,
        assignment=latest.assignment,
        attempts=sum(attempt.costs for attempt in attempts),
        best_score=None if best is None else best.score,
        max_score=None if best is None else best.max_score,
        best_submission=None if best is None else best.id,
        counted_score=None if counting is None else counting.score,
        counted_submission=None if counting is None else counting.attempt.id,
        latest_submission=latest.id,
        state=SubmissionState(latest.state),
        verdict=None if latest.verdict is None else GradeStatus(latest.verdict),
        last_activity_at=latest.received_at,
        crashes=_crashes(own),
        waits_for_person=manual is not None and bool(manual.to_judge),
        shares=tuple(
            row.score / row.max_score if row.score is not None and row.max_score else None
            for row, one in zip(own, attempts, strict=True)
            if one.costs
        ),
    )


def _crashes(own: list[Any]) -> int:
    """Return how many of the latest graded submissions, one after the other, did not run to their end."""
    ends = [row.verdict for row in reversed(own) if row.verdict is not None]
    return next((count for count, end in enumerate(ends) if end in _ENDED_STATUSES), len(ends))
