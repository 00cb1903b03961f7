"""Filling in the dashboard's document, from what the store counted and the assignments' own texts."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from statistics import fmean

from grader.contracts.assignment import Assignment
from grader.contracts.dashboard import ClassState, ItemFailures, MistakeCount, Progress
from grader.contracts.rubric import summed
from grader.contracts.submission import QueueState
from grader.contracts.text import Language
from grader.routes.dashboard_views import (
    AssignmentStatistics,
    BinView,
    CellView,
    DashboardView,
    FailedItemView,
    MistakeView,
    RiskView,
    StudentView,
)
from grader.routes.dependencies import SUBMISSIONS
from grader.routes.health import WorkerView, queue_view
from grader.use_cases.assignments import item_title

_BINS = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class Selection:
    """Which students a dashboard shows. `limit` None: all."""

    search: str = ""
    at_risk: bool = False
    offset: int = 0
    limit: int | None = None


@dataclass(frozen=True)
class _Told:
    """What the statistics of an assignment are made of."""

    progress: list[Progress]
    failures: list[ItemFailures]
    mistakes: list[MistakeCount]


def overview(  # noqa: PLR0913
    state: ClassState,
    assignments: Sequence[Assignment],
    queue: QueueState,
    workers: list[WorkerView],
    *,
    roster: Sequence[str],
    generated_at: datetime,
    pass_fraction: float,
    language: Language,
) -> DashboardView:
    """Return the dashboard. Assignments no longer published still show while they have submissions."""
    students: dict[str, dict[str, CellView]] = defaultdict(dict)
    told: dict[str, _Told] = defaultdict(lambda: _Told([], [], []))
    for one in state.progress:
        students[one.student][one.assignment] = _cell(one, pass_fraction)
        told[one.assignment].progress.append(one)
    for failure in state.failures:
        told[failure.assignment].failures.append(failure)
    for mistake in state.mistakes:
        told[mistake.assignment].mistakes.append(mistake)
    known = {assignment.id: assignment for assignment in assignments}
    ids = [*known, *sorted(set(told) - set(known))]
    return DashboardView(
        generated_at=generated_at,
        pass_fraction=pass_fraction,
        students=[_student(student, cells) for student, cells in students.items()],
        total_students=len(students),
        at_risk=_at_risk(students, roster),
        waiting_for_person=sum(one.waiting_submission is not None for one in state.progress),
        assignments=[_statistics(id_, known.get(id_), told[id_], pass_fraction, language) for id_ in ids],
        queue=queue_view(queue),
        oldest_queued_at=queue.oldest_queued_at,
        workers=workers,
    )


def selected(view: DashboardView, selection: Selection) -> DashboardView:
    """Return the dashboard with the chosen students only."""
    risky = {one.student for one in view.at_risk}
    fitting = [
        one
        for one in view.students
        if selection.search in one.student and (not selection.at_risk or one.student in risky)
    ]
    end = None if selection.limit is None else selection.offset + selection.limit
    page = fitting[selection.offset : end]
    return view.model_copy(update={"students": page, "total_students": len(fitting)})


def _at_risk(students: Mapping[str, Mapping[str, CellView]], roster: Sequence[str]) -> list[RiskView]:
    idle = [
        RiskView(student=one, reason="not_started", assignment=None, attempts=0)
        for one in roster
        if one not in students
    ]
    stuck = [
        RiskView(student=student, reason="stuck", assignment=assignment, attempts=cell.attempts)
        for student, cells in students.items()
        for assignment, cell in cells.items()
        if cell.stuck
    ]
    return idle + stuck


def _mean_attempts_to_pass(progress: Iterable[Progress], pass_fraction: float) -> float | None:
    needed = [
        next(
            (
                i
                for i, share in enumerate(one.shares, start=1)
                if share is not None and share >= pass_fraction
            ),
            None,
        )
        for one in progress
    ]
    passed = [one for one in needed if one is not None]
    return round(fmean(passed), 2) if passed else None


def _student(student: str, cells: dict[str, CellView]) -> StudentView:
    total = summed(cell.counted_score for cell in cells.values() if cell.counted_score is not None)
    return StudentView(student=student, total_score=total, assignments=cells)


def _cell(progress: Progress, pass_fraction: float) -> CellView:
    return CellView(
        best_score=progress.best_score,
        max_score=progress.max_score,
        passed=_passed(progress, pass_fraction),
        waits_for_person=progress.waiting_submission is not None,
        status=progress.state,
        verdict=progress.verdict,
        attempts=progress.attempts,
        last_activity_at=progress.last_activity_at,
        best_submission=_address(progress.best_submission),
        counted_score=progress.counted_score,
        counted_submission=_address(progress.counted_submission),
        latest_submission=SUBMISSIONS + progress.latest_submission,
    )


def _address(submission: str | None) -> str | None:
    return None if submission is None else SUBMISSIONS + submission


def _passed(progress: Progress, pass_fraction: float) -> bool:
    score, most = progress.counted_score, progress.max_score
    return score is not None and most is not None and score >= pass_fraction * most


def _statistics(
    assignment_id: str,
    assignment: Assignment | None,
    told: _Told,
    pass_fraction: float,
    language: Language,
) -> AssignmentStatistics:
    students = len(told.progress)
    passed = sum(_passed(one, pass_fraction) for one in told.progress)
    scored = sum(one.counted_score is not None for one in told.progress)
    scores = [one.best_score for one in told.progress if one.best_score is not None]
    return AssignmentStatistics(
        id=assignment_id,
        title=assignment_id if assignment is None else assignment.title.get(language),
        max_score=None if assignment is None else assignment.max_score,
        students=students,
        waiting_for_person=sum(one.waiting_submission is not None for one in told.progress),
        submissions=sum(one.attempts for one in told.progress),
        passed=passed,
        pass_rate=passed / scored if scored else None,
        mean_score=round(fmean(scores), 2) if scores else None,
        score_distribution=_distribution(told.progress),
        mean_attempts_to_pass=_mean_attempts_to_pass(told.progress, pass_fraction),
        most_failed_items=[_failed(failure, assignment, language) for failure in told.failures],
        most_common_mistakes=[MistakeView(code=one.code, students=one.students) for one in told.mistakes],
    )


def _failed(one: ItemFailures, assignment: Assignment | None, language: Language) -> FailedItemView:
    title = item_title(assignment, one.item, language)
    return FailedItemView(id=one.item, title=title, count=one.ever, still=one.still)


def _distribution(progress: Iterable[Progress]) -> list[BinView]:
    counts = [0] * _BINS
    for one in progress:
        if one.best_score is not None and one.max_score:
            counts[min(int(one.best_score / one.max_score * _BINS), _BINS - 1)] += 1
    width = 100 // _BINS
    return [
        BinView(from_percent=number * width, to_percent=(number + 1) * width, students=count)
        for number, count in enumerate(counts)
    ]
