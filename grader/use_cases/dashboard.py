"""The class at a glance, from what the store counted and the assignments' own texts."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from datetime import datetime
from functools import lru_cache
from statistics import fmean

from grader.contracts.assignment import Assignment
from grader.contracts.dashboard import (
    AssignmentState,
    ClassState,
    MistakeCount,
    StudentProgress,
    StudentState,
)
from grader.contracts.identity import Caller, Member, Role
from grader.contracts.rubric import summed
from grader.contracts.submission import PersonCost
from grader.contracts.text import Language
from grader.use_cases.assignments import in_course, item_title
from grader.use_cases.callers import require_staff
from grader.use_cases.people import members
from grader.use_cases.risk import Cell, Risk, risks
from grader.use_cases.services import ServiceHealth, Services

_BINS = 10
_KEPT_STUDENTS, _KEPT_ASSIGNMENTS = 20_000, 1_000  # of all courses; beyond these, counted at each look
_NOBODY = AssignmentState(progress=(), failures=(), mistakes=())
# asked once: a class has thousands of cells
_PROGRESS = tuple(field.name for field in fields(StudentProgress))


@dataclass(frozen=True, slots=True, kw_only=True)
class StudentLine:
    """One row of the class matrix. `assignments` by id, without those not begun."""

    student: str
    name: str
    sections: tuple[str, ...]
    total_score: float
    assignments: Mapping[str, Cell]


@dataclass(frozen=True, slots=True, kw_only=True)
class Bin:
    """Students whose best score lies in [from, to) per cent of the points; the last bin includes 100."""

    from_percent: int
    to_percent: int
    students: int


@dataclass(frozen=True, slots=True, kw_only=True)
class FailedItem:
    """How many students failed one rubric item at least once, and `still` in their best submission."""

    id: str
    title: str
    count: int
    still: int


@dataclass(frozen=True, slots=True, kw_only=True)
class AssignmentOverview:
    """What one assignment shows about the class.

    Attributes:
        students: who submitted. pass_rate: of those with a score; None: nobody has.
        mean_score: of the best scores. mean_attempts_to_pass: up to the first attempt that did, before lateness.
        most_failed_items, most_common_mistakes: the most frequent first.
    """

    id: str
    title: str
    max_score: float | None
    students: int
    waiting_for_person: int
    submissions: int
    passed: int
    pass_rate: float | None
    mean_score: float | None
    score_distribution: Sequence[Bin]
    mean_attempts_to_pass: float | None
    most_failed_items: Sequence[FailedItem]
    most_common_mistakes: Sequence[MistakeCount]


@dataclass(frozen=True, slots=True, kw_only=True)
class Overview:
    """The class at a glance.

    Attributes:
        students: who handed in. roster: the students of the course.
        total_students, total_at_risk: on all pages; of students those that fit the selection.
        next_offset: where the next page of both begins; None: this is the last.
    """

    generated_at: datetime
    pass_fraction: float
    students: Sequence[StudentLine]
    roster: Sequence[Member]
    total_students: int
    at_risk: Sequence[Risk]
    total_at_risk: int
    next_offset: int | None
    waiting_for_person: int
    assignments: Sequence[AssignmentOverview]
    health: ServiceHealth


@dataclass(frozen=True, slots=True, kw_only=True)
class Selection:
    """Which students an overview shows: id or name contains `search`, of a section; `limit` in each list."""

    search: str = ""
    section: str = ""
    at_risk: bool = False
    offset: int = 0
    limit: int = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class _Done:
    """What a student has done, cells by assignment."""

    cells: Mapping[str, Cell]
    total_score: float


def costs(services: Services, caller: Caller) -> tuple[PersonCost, ...]:
    """Return what the gradings of each of the class cost in the last hour, whoever cost most first. For staff."""
    require_staff(caller)
    return tuple(cost for cost in services.costs.lately(caller.course) if caller.looks_after(cost.student))


def overview(services: Services, caller: Caller, state: ClassState, language: Language) -> Overview:
    """Return the whole class in `state`.

    Assignments that are no longer published still show while they have submissions. For staff.
    """
    require_staff(caller)
    pass_fraction = services.settings.pass_fraction
    students = {student: _done(one, pass_fraction) for student, one in state.students.items()}
    statistics = {id_: _statistics(one, pass_fraction) for id_, one in state.assignments.items()}
    nothing = _statistics(_NOBODY, pass_fraction)
    assignments = {assignment.id: assignment for assignment in in_course(services, caller)}
    ids = [*assignments, *sorted(set(statistics) - set(assignments))]
    roster = {member.id: member for member in members(services, caller, Role.STUDENT)}
    lines = [_student(student, done, roster.get(student)) for student, done in students.items()]
    at_risk = risks(
        {student: done.cells for student, done in students.items()},
        roster,
        services.refused.of(caller.course),
        services.rules.of(caller.course),
        assignments,
        services.clock(),
    )
    return Overview(
        generated_at=services.clock(),
        pass_fraction=pass_fraction,
        students=lines,
        roster=tuple(roster.values()),
        total_students=len(students),
        at_risk=at_risk,
        total_at_risk=len(at_risk),
        next_offset=None,
        waiting_for_person=sum(statistic.waiting_for_person for statistic in statistics.values()),
        assignments=[
            _named(statistics.get(id_, nothing), id_, assignments.get(id_), language) for id_ in ids
        ],
        health=services.health(),
    )


def class_state(services: Services, caller: Caller) -> ClassState:
    """Return what is counted about the caller's class. For staff."""
    require_staff(caller)
    return services.dashboard.state(caller.course, caller.students)


def selected(whole: Overview, selection: Selection) -> Overview:
    """Return a page of the overview with the chosen students only; whoever is at risk is chosen in any case."""
    risky, wanted = {risk.student for risk in whole.at_risk}, selection.search.strip().casefold()
    fitting = [
        student
        for student in whole.students
        if (wanted in student.student.casefold() or wanted in student.name.casefold())
        and (not selection.section or selection.section in student.sections)
        and (not selection.at_risk or student.student in risky)
    ]
    end = selection.offset + selection.limit
    return replace(
        whole,
        students=fitting[selection.offset : end],
        total_students=len(fitting),
        at_risk=whole.at_risk[selection.offset : end],
        next_offset=end if end < max(len(fitting), len(whole.at_risk)) else None,
    )


def _name(member: Member | None) -> str:
    return "" if member is None else member.name


def _mean_attempts_to_pass(progress: Iterable[StudentProgress], pass_fraction: float) -> float | None:
    needed = [
        next(
            (
                i
                for i, share in enumerate(cell.shares, start=1)
                if share is not None and share >= pass_fraction
            ),
            None,
        )
        for cell in progress
    ]
    passed = [count for count in needed if count is not None]
    return round(fmean(passed), 2) if passed else None


def _student(student: str, done: _Done, member: Member | None) -> StudentLine:
    return StudentLine(
        student=student,
        name=_name(member),
        sections=() if member is None else member.sections,
        total_score=done.total_score,
        assignments=done.cells,
    )


@lru_cache(maxsize=_KEPT_STUDENTS)
def _done(student: StudentState, pass_fraction: float) -> _Done:
    """Return what a student has done. Most students are the same at the next look."""
    cells = [_cell(cell, pass_fraction) for cell in student.progress]
    return _Done(
        cells={cell.assignment: cell for cell in cells},
        total_score=summed(cell.counted_score for cell in cells if cell.counted_score is not None),
    )


def _cell(progress: StudentProgress, pass_fraction: float) -> Cell:
    shown = {name: getattr(progress, name) for name in _PROGRESS}
    return Cell(**shown, passed=_passed(progress, pass_fraction))


def _passed(progress: StudentProgress, pass_fraction: float) -> bool:
    score, most = progress.counted_score, progress.max_score
    return score is not None and most is not None and score >= pass_fraction * most


def _named(
    overview: AssignmentOverview, assignment_id: str, assignment: Assignment | None, language: Language
) -> AssignmentOverview:
    """Return the statistics of an assignment with its texts."""
    return replace(
        overview,
        id=assignment_id,
        title=assignment_id if assignment is None else assignment.title.get(language),
        max_score=None if assignment is None else assignment.max_score,
        most_failed_items=[
            replace(item, title=item_title(assignment, item.id, language))
            for item in overview.most_failed_items
        ],
    )


@lru_cache(maxsize=_KEPT_ASSIGNMENTS)
def _statistics(state: AssignmentState, pass_fraction: float) -> AssignmentOverview:
    """Return the statistics of an assignment without its texts. Most assignments are the same at the next look."""
    students = len(state.progress)
    passed = sum(_passed(cell, pass_fraction) for cell in state.progress)
    scored = sum(cell.counted_score is not None for cell in state.progress)
    scores = [cell.best_score for cell in state.progress if cell.best_score is not None]
    return AssignmentOverview(
        id="",
        title="",
        max_score=None,
        students=students,
        waiting_for_person=sum(cell.waits_for_person for cell in state.progress),
        submissions=sum(cell.attempts for cell in state.progress),
        passed=passed,
        pass_rate=passed / scored if scored else None,
        mean_score=round(fmean(scores), 2) if scores else None,
        score_distribution=_distribution(state.progress),
        mean_attempts_to_pass=_mean_attempts_to_pass(state.progress, pass_fraction),
        most_failed_items=[
            FailedItem(id=failure.item, title="", count=failure.ever, still=failure.still)
            for failure in state.failures
        ],
        most_common_mistakes=state.mistakes,
    )


def _distribution(progress: Iterable[StudentProgress]) -> list[Bin]:
    counts = [0] * _BINS
    for cell in progress:
        if cell.best_score is not None and cell.max_score:
            counts[min(int(cell.best_score / cell.max_score * _BINS), _BINS - 1)] += 1
    width = 100 // _BINS
    return [
        Bin(from_percent=number * width, to_percent=(number + 1) * width, students=count)
        for number, count in enumerate(counts)
    ]
