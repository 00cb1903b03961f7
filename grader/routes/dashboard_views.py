"""The dashboard's document, from what the store counted and the assignments' own texts."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from statistics import fmean
from typing import Literal

from pydantic import BaseModel, Field

from grader.contracts.assignment import Assignment
from grader.contracts.dashboard import ClassState, ItemFailures, MistakeCount, Progress
from grader.contracts.report import GradeStatus
from grader.contracts.rubric import summed
from grader.contracts.submission import QueueState, SubmissionState
from grader.contracts.text import Language
from grader.routes.health import QueueView, WorkerView
from grader.routes.submission_views import SUBMISSIONS

_BINS = 10
STUCK_ATTEMPTS = 3


class CellView(BaseModel):
    """One student at one assignment."""

    best_score: float | None = Field(description="Null while nothing was scored.", examples=[8.5])
    max_score: float | None = Field(examples=[10.0])
    passed: bool
    waits_for_person: bool = Field(description="An answer of theirs is still to be judged.")
    status: SubmissionState = Field(description="Of the latest submission.", examples=["graded"])
    verdict: GradeStatus | None = Field(description="Of the latest submission.", examples=["graded"])
    attempts: int = Field(description="Faults of the service do not count.", examples=[3])
    last_activity_at: datetime
    best_submission: str | None = Field(description="Address of the first that reached it.")
    counted_score: float | None = Field(description="Kept of the attempt that counts.", examples=[8.5])
    counted_submission: str | None = Field(description="Address of that attempt.")
    latest_submission: str

    @property
    def stuck(self) -> bool:
        """Whether the student tried often and has not passed."""
        return not self.passed and not self.waits_for_person and self.attempts >= STUCK_ATTEMPTS


class StudentView(BaseModel):
    """One row of the class matrix."""

    student: str = Field(examples=["20260123"])
    total_score: float = Field(description="Sum of the scores that count.", examples=[48.5])
    assignments: dict[str, CellView] = Field(description="By id; assignments not begun are left out.")


class BinView(BaseModel):
    """Students whose best score lies in [from, to) per cent of the points; the last bin includes 100."""

    from_percent: int = Field(examples=[90])
    to_percent: int = Field(examples=[100])
    students: int = Field(examples=[12])


class FailedItemView(BaseModel):
    """One rubric item and how many students fail it."""

    id: str = Field(examples=["angles"])
    title: str = Field(examples=["Exterior angles"])
    count: int = Field(description="Students who failed it at least once.", examples=[9])
    still: int = Field(description="Students who fail it in their best submission, too.", examples=[4])


class MistakeView(BaseModel):
    """One recognised mistake and how many students made it."""

    code: str = Field(examples=["degrees_for_radians"])
    students: int = Field(examples=[7])


class AssignmentStatistics(BaseModel):
    """What one assignment shows about the class."""

    id: str = Field(examples=["square"])
    title: str = Field(examples=["Drive a square"])
    max_score: float | None = Field(examples=[10.0])
    students: int = Field(description="Who submitted.", examples=[28])
    waiting_for_person: int = Field(description="Students whose newest answer is to be judged.", examples=[0])
    submissions: int = Field(examples=[71])
    passed: int = Field(examples=[21])
    pass_rate: float | None = Field(description="Of those with a score; null: nobody has.", examples=[0.75])
    mean_score: float | None = Field(description="Of the best scores.", examples=[8.1])
    score_distribution: list[BinView]
    mean_attempts_to_pass: float | None = Field(
        description="Of those who passed, up to the first attempt that did; before lateness.", examples=[1.8]
    )
    most_failed_items: list[FailedItemView] = Field(description="Most failed first.")
    most_common_mistakes: list[MistakeView] = Field(description="Most common first.")


class RiskView(BaseModel):
    """A student who may need help."""

    student: str = Field(examples=["20260123"])
    reason: Literal["not_started", "stuck"] = Field(
        description="Handed in nothing at all; or tried an assignment three times or more without passing."
    )
    assignment: str | None = Field(description="Where the student is stuck.", examples=["square"])
    attempts: int = Field(examples=[4])


class DashboardView(BaseModel):
    """The class at a glance."""

    generated_at: datetime
    pass_fraction: float = Field(description="Share of the points that counts as passed.", examples=[0.6])
    students: list[StudentView]
    total_students: int = Field(description="That fit the filters, on all pages.", examples=[30])
    at_risk: list[RiskView]
    waiting_for_person: int = Field(description="Answers to be judged, in all.", examples=[0])
    assignments: list[AssignmentStatistics]
    queue: QueueView
    oldest_queued_at: datetime | None
    workers: list[WorkerView]


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
        queue=QueueView(
            queued=queue.queued, running=queue.running, infrastructure_error=queue.infrastructure_errors
        ),
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
    title = one.item if assignment is None else assignment.item_title(one.item, language)
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
