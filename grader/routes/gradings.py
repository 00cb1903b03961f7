"""The gradings that a submission has had."""

from datetime import datetime

from fastapi import APIRouter
from pydantic import BaseModel, Field

from grader.contracts.regrade import PastGrading
from grader.routes.dependencies import ENTRY_PROBLEMS, SIGHT, ServicesDep, StaffDep, SubmissionId
from grader.routes.problems import responses

router = APIRouter(prefix="/api/v1/submissions", tags=["regrades"], dependencies=[SIGHT])


class PastGradingView(BaseModel):
    """One grading of a submission."""

    attempt: int
    finished_at: datetime
    grader_version: str = Field(examples=["0.1.0"])
    assignment_version: int = Field(examples=[1])
    verdict: str = Field(examples=["graded"])
    score: float | None = Field(
        description="What the machine gave, without points by people; null: it left items to them."
    )
    max_score: float
    report_sha256: str
    by: str = Field(description="Who applied the re-grade it came from; empty: the upload itself.")
    reason: str


class History(BaseModel):
    """All gradings of a submission, oldest first; the last one stands."""

    gradings: list[PastGradingView]


@router.get(
    "/{submission_id}/gradings",
    summary="Every grading of a submission",
    responses=responses(*ENTRY_PROBLEMS, "forbidden", "invalid_request", "submission_not_found"),
)
def read_history(services: ServicesDep, _caller: StaffDep, submission_id: SubmissionId) -> History:
    """Return when, with which versions and why a submission was graded, and by whom again."""
    return History(gradings=[_past(one) for one in services.regrades.history(submission_id)])


def _past(grading: PastGrading) -> PastGradingView:
    return PastGradingView(
        attempt=grading.attempt,
        finished_at=grading.finished_at,
        grader_version=grading.grader_version,
        assignment_version=grading.assignment_version,
        verdict=grading.status,
        score=grading.score,
        max_score=grading.max_score,
        report_sha256=grading.report_sha256,
        by=grading.by,
        reason=grading.reason,
    )
