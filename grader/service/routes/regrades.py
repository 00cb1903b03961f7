"""Grading again: first on trial, with what would change, then applied with a reason or discarded."""

from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Query, Response
from pydantic import AliasPath, Field, StringConstraints

from grader.contracts.regrade import Regrade, RegradeState, Wanted, Which
from grader.service.requests.dependencies import (
    SIGHT,
    Address,
    ErrandDep,
    InstructorDep,
    QueryWhole,
    RegradeId,
    StaffDep,
    SubmissionId,
)
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases import regrading
from grader.use_cases.bodies import Body

router = APIRouter(prefix="/api/v1/regrades", tags=["regrades"])
of_submission = APIRouter(prefix="/api/v1/submissions", tags=["regrades"], dependencies=[SIGHT])
_MOST = 100_000
_ON_READ = ("forbidden", "invalid_request")


class RegradeOrder(Body):
    """Which submissions are graded again, with the assignment as it is now."""

    assignment: Annotated[str, Field(max_length=64, examples=["square"])]
    which: Which = Field(
        default="all",
        description="Of each student the `latest` or `best` graded one, `all` graded ones, or those that the "
        "service failed to grade (`faults`).",
    )
    students: list[Annotated[str, Field(max_length=64)]] = Field(
        default_factory=list, max_length=500, description="Only theirs; empty: everybody's."
    )


class Decision(Body):
    """Why a re-grade is applied, discarded or undone."""

    reason: Annotated[
        str,
        StringConstraints(strip_whitespace=True, min_length=1, max_length=1_000),
        Field(examples=["the tolerance was too tight"]),
    ]


class ItemChangeView(View):
    """What one rubric item earned before and earns now; null where the rubric does not have it."""

    item: str = Field(examples=["closed"])
    before: float | None = Field(examples=[0.0])
    after: float | None = Field(examples=[5.0])


class ScoreChangeView(View):
    """What happens to one submission."""

    submission: Address = Field(description="Its address.")
    student: str = Field(examples=["20260123"])
    before: float | None = Field(description="Null: it had no grading.", examples=[5.0])
    after: float | None = Field(examples=[10.0])
    items: list[ItemChangeView]
    kept: list[str] = Field(description="Items whose judgement by a person stands in the new grading, too.")
    void: list[str] = Field(
        description="Items whose judgement does not, as their points changed: a person judges them again, or the "
        "machine's points count."
    )


class RegradeSummary(View):
    """A re-grade: while `open` and `waiting` is 0 it can be applied."""

    id: str
    assignment: str = Field(validation_alias=AliasPath("wanted", "assignment"))
    which: Which = Field(validation_alias=AliasPath("wanted", "which"))
    students: list[str] = Field(validation_alias=AliasPath("wanted", "students"))
    state: RegradeState
    created_at: datetime
    created_by: str
    decided_at: datetime | None
    decided_by: str
    reason: str
    waiting: int = Field(description="Trial gradings still to be made.", examples=[0])
    failed: int = Field(description="That the service failed to make: these stay as they are.", examples=[0])
    same: int = Field(description="Submissions that nothing changes for.", examples=[25])
    gain: int = Field(description="Submissions whose score rises.", examples=[4])
    lose: int = Field(description="Submissions whose score falls.", examples=[1])
    undone_at: datetime | None
    undone_by: str
    undone_reason: str
    kept: int = Field(description="Judgements by people that stand in the new gradings.", examples=[0])
    changed: int = Field(description="Submissions whose score or items change.", examples=[6])


class RegradeView(RegradeSummary):
    """A re-grade and what it changes."""

    changes: list[ScoreChangeView] = Field(
        description="In order of student; the whole trial, even while it runs, or the page asked for."
    )


class RegradeList(View):
    """Re-grades, newest first."""

    regrades: list[RegradeSummary]


class ToldChangeView(View):
    """What a re-grade changed of one submission, as its student is told."""

    at: datetime
    undone: bool = Field(description="A re-grade was undone, and this is what that changed.")
    reason: str = Field(examples=["the tolerance was too tight"])
    before: float | None = Field(
        validation_alias=AliasPath("change", "before"),
        description="The score; null: none, or items are hidden that are part of it.",
        examples=[5.0],
    )
    after: float | None = Field(validation_alias=AliasPath("change", "after"), examples=[10.0])
    items: list[ItemChangeView] = Field(validation_alias=AliasPath("change", "items"))
    seen: bool = Field(description="The student has opened the submission's page since.")


class ToldChanges(View):
    """What re-grades changed of a submission, the latest first."""

    changes: list[ToldChangeView]


class PastGradingView(View):
    """One grading of a submission."""

    attempt: int
    finished_at: datetime
    grader_version: str = Field(examples=["0.1.0"])
    assignment_version: int = Field(examples=[1])
    verdict: str = Field(validation_alias="status", examples=["graded"])
    score: float | None = Field(
        description="What the machine gave, without points by people; null: it left items to them."
    )
    max_score: float
    report_sha256: str
    by: str = Field(description="Who applied the re-grade it came from; empty: the upload itself.")
    reason: str
    stands: bool = Field(description="The one that counts: the last one, unless its re-grade was undone.")


class History(View):
    """All gradings of a submission, oldest first."""

    gradings: list[PastGradingView]


@router.post(
    "",
    status_code=202,
    summary="Grade again, on trial",
    responses=responses(
        *_ON_READ,
        "malformed_body",
        "too_large",
        "assignment_not_found",
        "unknown_student",
        "nothing_to_regrade",
        "regrade_open",
        "course_archived",
    ),
)
def start(errand: InstructorDep, response: Response, order: RegradeOrder) -> RegradeView:
    """Queue trial gradings behind all fresh submissions. Nothing changes until they are applied."""
    students = tuple(order.students)
    wanted = Wanted(assignment=order.assignment, which=order.which, students=students)
    opened = regrading.open_regrade(errand.services, errand.caller, wanted)
    response.headers["Location"] = f"/api/v1/regrades/{opened.id}"
    return _view(opened)


@router.get("", summary="All re-grades", responses=responses("forbidden"))
def read_all(errand: StaffDep) -> RegradeList:
    """Return the re-grades of the caller's course."""
    return RegradeList(
        regrades=[
            RegradeSummary.of(regrade) for regrade in regrading.all_regrades(errand.services, errand.caller)
        ]
    )


@router.get("/{regrade_id}", summary="What changes", responses=responses(*_ON_READ, "regrade_not_found"))
def read(
    errand: StaffDep,
    regrade_id: RegradeId,
    *,
    offset: Annotated[QueryWhole, Query(ge=0, le=_MOST, description="Changes left out at the start.")] = 0,
    limit: Annotated[QueryWhole | None, Query(ge=1, le=_MOST, description="Most changes; null: all.")] = None,
) -> RegradeView:
    """Return how far a re-grade is, who gains and who loses, by which item. Counts are of all changes."""
    regrade = regrading.regrade_of(errand.services, errand.caller, regrade_id)
    return _view(regrade, slice(offset, None if limit is None else offset + limit))


@router.post(
    "/{regrade_id}/apply",
    summary="Make it count",
    responses=responses(
        *_ON_READ, "malformed_body", "too_large", "regrade_not_found", "regrade_running", "regrade_decided"
    ),
)
def apply(errand: InstructorDep, regrade_id: RegradeId, decision: Decision) -> RegradeView:
    """Make the trial gradings the submissions' latest; earlier ones stay in their history."""
    return _view(regrading.decide(errand.services, errand.caller, regrade_id, "apply", decision.reason))


@router.post(
    "/{regrade_id}/discard",
    summary="Forget it",
    responses=responses(*_ON_READ, "malformed_body", "too_large", "regrade_not_found", "regrade_decided"),
)
def discard(errand: InstructorDep, regrade_id: RegradeId, decision: Decision) -> RegradeView:
    """Drop the trial gradings; every submission stays as it is."""
    return _view(regrading.decide(errand.services, errand.caller, regrade_id, "discard", decision.reason))


@router.post(
    "/{regrade_id}/undo",
    summary="Let the earlier gradings count again",
    responses=responses(
        *_ON_READ,
        "malformed_body",
        "too_large",
        "course_archived",
        "regrade_not_found",
        "regrade_not_applied",
        "regrade_superseded",
    ),
)
def undo(errand: InstructorDep, regrade_id: RegradeId, decision: Decision) -> RegradeView:
    """Let the gradings stand again that an applied re-grade replaced, all of them; judgements by people stay.

    Later re-grades of the same submissions must be undone first.
    """
    return _view(regrading.decide(errand.services, errand.caller, regrade_id, "undo", decision.reason))


@of_submission.get(
    "/{submission_id}/changes",
    summary="What re-grades changed",
    responses=responses("invalid_request", "submission_not_found"),
)
def read_changes(errand: ErrandDep, submission_id: SubmissionId) -> ToldChanges:
    """Return old and new points, when and why, as the page of the submission tells its student.

    Items that are hidden from the caller are left out. Reading it here does not mark it as seen.
    """
    changes = regrading.told_changes(errand.services, errand.caller, submission_id)
    return ToldChanges(changes=[ToldChangeView.of(change) for change in changes])


@of_submission.get(
    "/{submission_id}/gradings",
    summary="Every grading of a submission",
    responses=responses("forbidden", "invalid_request", "submission_not_found"),
)
def read_history(errand: StaffDep, submission_id: SubmissionId) -> History:
    """Return when, with which versions and why a submission was graded, and by whom again."""
    gradings = regrading.history(errand.services, errand.caller, submission_id)
    return History(gradings=[PastGradingView.of(grading) for grading in gradings])


def _view(regrade: Regrade, shown: slice = slice(None)) -> RegradeView:
    """Return a re-grade with the changes in the slice `shown`."""
    view = RegradeView.of(regrade)
    view.changes = view.changes[shown]
    return view
