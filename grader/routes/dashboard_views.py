"""The document that the dashboard shows."""

from datetime import datetime
from typing import Literal

from pydantic import BaseModel, Field

from grader.contracts.report import GradeStatus
from grader.contracts.submission import SubmissionState
from grader.routes.health import QueueView, WorkerView

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
