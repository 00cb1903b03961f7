"""The class at a glance, for instructors."""

import hashlib
import json
from dataclasses import asdict
from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Header, Query, Response
from pydantic import AliasPath, Field

from grader.contracts.dashboard import ClassState
from grader.contracts.report import GradeStatus
from grader.contracts.submission import SubmissionState
from grader.contracts.text import Language
from grader.service.requests.dependencies import (
    Address,
    AssignmentId,
    Errand,
    LanguageDep,
    QueryWhole,
    SectionDep,
    StaffDep,
    is_held,
)
from grader.service.routes.health import QueueView, WorkerView, worker_views
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases.assignments import in_course
from grader.use_cases.concerned import Concern, concerned
from grader.use_cases.dashboard import Overview, Selection, class_state, costs, overview, selected
from grader.use_cases.risk import Reason, mark_of

router = APIRouter(prefix="/api/v1/dashboard", tags=["dashboard"])
of_assignment = APIRouter(prefix="/api/v1/assignments", tags=["dashboard"])
_MOST = 100_000
_PAGE = 100
Offset = Annotated[QueryWhole, Query(ge=0, le=_MOST, description="Lines left out at the start of each list.")]
Limit = Annotated[QueryWhole, Query(ge=1, le=_MOST, description="Most lines of each list of students.")]


class CellView(View):
    """One student at one assignment."""

    best_score: float | None = Field(description="Null while nothing was scored.", examples=[8.5])
    max_score: float | None = Field(examples=[10.0])
    passed: bool
    waits_for_person: bool = Field(description="An answer of theirs is still to be judged.")
    status: SubmissionState = Field(
        validation_alias="state", description="Of the latest submission.", examples=["graded"]
    )
    verdict: GradeStatus | None = Field(description="Of the latest submission.", examples=["graded"])
    attempts: int = Field(description="Faults of the service do not count.", examples=[3])
    last_activity_at: datetime
    best_submission: Address | None = Field(description="Address of the first that reached it.")
    counted_score: float | None = Field(description="Kept of the attempt that counts.", examples=[8.5])
    counted_submission: Address | None = Field(description="Address of that attempt.")
    latest_submission: Address


class StudentView(View):
    """One row of the class matrix."""

    student: str = Field(examples=["20260123"])
    name: str = Field(description="Empty where there is none.", examples=["李雷"])
    sections: list[str] = Field(examples=[["A"]])
    total_score: float = Field(description="Sum of the scores that count.", examples=[48.5])
    assignments: dict[str, CellView] = Field(description="By id; assignments not begun are left out.")


class BinView(View):
    """Students whose best score lies in [from, to) per cent of the points; the last bin includes 100."""

    from_percent: int = Field(examples=[90])
    to_percent: int = Field(examples=[100])
    students: int = Field(examples=[12])


class FailedItemView(View):
    """One rubric item and how many students fail it."""

    id: str = Field(examples=["angles"])
    title: str = Field(examples=["Exterior angles"])
    count: int = Field(description="Students who failed it at least once.", examples=[9])
    still: int = Field(description="Students who fail it in their best submission, too.", examples=[4])


class MistakeView(View):
    """One recognised mistake and how many students made it."""

    code: str = Field(examples=["degrees_for_radians"])
    students: int = Field(examples=[7])


class AssignmentStatistics(View):
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


class RiskView(View):
    """A student who may need help."""

    student: str = Field(examples=["20260123"])
    name: str = Field(examples=["李雷"])
    reason: Reason = Field(
        description="The most urgent one. `refused`: uploads were refused and none accepted since; `crashed`: the "
        "latest two attempts or more did not run to their end; `stuck`: three attempts or more without passing; "
        "`due_soon`, `overdue`: nothing handed in, or nothing that passes; `not_started`: nothing in the course."
    )
    assignment: str | None = Field(description="Where.", examples=["square"])
    attempts: int = Field(description="Of `refused`: how many uploads.", examples=[4])
    due: datetime | None = Field(description="The student's own due date.")


class DashboardView(View):
    """The class at a glance."""

    generated_at: datetime
    pass_fraction: float = Field(description="Share of the points that counts as passed.", examples=[0.6])
    students: list[StudentView]
    total_students: int = Field(description="That fit the filters, on all pages.", examples=[30])
    at_risk: list[RiskView] = Field(
        description="Each student once, the most urgent first: who tries and fails, then whose due date is near, "
        "is over, who has not begun."
    )
    total_at_risk: int = Field(description="On all pages.", examples=[12])
    next_offset: int | None = Field(description="The `offset` of the next page; null: this is the last.")
    waiting_for_person: int = Field(description="Answers to be judged, in all.", examples=[0])
    assignments: list[AssignmentStatistics]
    queue: QueueView
    oldest_queued_at: datetime | None
    workers: list[WorkerView]


class CostView(View):
    """What one student's gradings cost the service in the last hour."""

    student: str = Field(examples=["20260123"])
    slot_s: float = Field(description="For how long they held a slot.", examples=[12.5])
    gradings: int = Field(description="That ended or run.", examples=[3])
    waiting: int = Field(examples=[1])
    tries: int = Field(description="How often they were begun.", examples=[3])
    given_up: int = Field(description="That ended as `infrastructure_error`.", examples=[0])


class CostsView(View):
    """Who costs the service how much; whoever costs most comes first."""

    students: list[CostView]


class ConcernedView(View):
    """A student whom a number is about."""

    student: str = Field(examples=["20260123"])
    name: str
    sections: list[str]
    still: bool = Field(description="The item is failed in the best submission, too.")
    attempts: int = Field(validation_alias=AliasPath("progress", "attempts"), examples=[4])
    best_score: float | None = Field(validation_alias=AliasPath("progress", "best_score"), examples=[45.0])
    latest_submission: Address = Field(validation_alias=AliasPath("progress", "latest_submission"))
    status: str = Field(validation_alias=AliasPath("progress", "state"), examples=["graded"])
    verdict: str | None = Field(validation_alias=AliasPath("progress", "verdict"), examples=["crashed"])


class ConcernedList(View):
    """Students whom a number is about."""

    students: list[ConcernedView]


@router.get(
    "/costs",
    summary="Who costs the service how much",
    responses=responses("forbidden", "invalid_request"),
)
def read_costs(errand: StaffDep, response: Response, offset: Offset = 0, limit: Limit = _PAGE) -> CostsView:
    """Return how long the gradings of each student took in the last hour, and how many wait."""
    response.headers["Cache-Control"] = "no-store"
    students = costs(errand.services, errand.caller)[offset : offset + limit]
    return CostsView(students=[CostView.of(student) for student in students])


@router.get(
    "",
    summary="The class at a glance",
    response_model=DashboardView,
    responses={
        200: {
            "headers": {"ETag": {"description": "Of everything but instants.", "schema": {"type": "string"}}}
        },
        304: {"description": "Nothing changed since the answer with the ETag of If-None-Match."},
        **responses("forbidden", "invalid_request"),
    },
)
def read_class(  # noqa: PLR0913
    errand: StaffDep,
    language: LanguageDep,
    *,
    search: Annotated[
        str, Query(max_length=100, description="Only students whose id or name contains this.")
    ] = "",
    section: SectionDep,
    at_risk: Annotated[bool, Query(description="Only students who are at risk.")] = False,
    offset: Offset = 0,
    limit: Limit = _PAGE,
    if_none_match: Annotated[str | None, Header(max_length=1_000)] = None,
) -> Response:
    """Return students by assignments, what each assignment shows about the class, and the queue.

    Filters and pages choose students; the statistics are always about everybody.
    """
    selection = Selection(search=search, section=section, at_risk=at_risk, offset=offset, limit=limit)
    state = class_state(errand.services, errand.caller)
    tag = _tag(errand, state, language, selection)
    headers = {"Content-Language": language, "Vary": "Accept-Language, Authorization", "ETag": tag}
    if if_none_match is not None and is_held(if_none_match, tag):
        return Response(status_code=304, headers=headers)
    shown = _view(selected(overview(errand.services, errand.caller, state, language), selection))
    return Response(shown.model_dump_json(), media_type="application/json", headers=headers)


def _view(whole: Overview) -> DashboardView:
    queue = whole.health.queue
    return DashboardView.of(
        whole,
        queue=QueueView.of(queue),
        oldest_queued_at=queue.oldest_queued_at,
        workers=worker_views(whole.health.workers),
    )


def _tag(errand: Errand, state: ClassState, language: Language, selection: Selection) -> str:
    """Return a weak ETag of everything shown but the instants of this answer and of heartbeats."""
    alive = worker_views(errand.services.workers.alive(errand.services.settings.silent_s))
    workers = [worker.model_dump(mode="json", exclude={"seen_at"}) for worker in alive]
    versions = [
        (assignment.id, assignment.version, assignment.title.get(language))
        for assignment in in_course(errand.services, errand.caller)
    ]
    queue = asdict(errand.services.queue.state())
    services, course = errand.services, errand.caller.course
    risk = mark_of(services.refused.of(course), services.rules.of(course), services.clock())
    shown = [
        state.mark,
        risk,
        queue,
        workers,
        versions,
        language,
        errand.services.settings.pass_fraction,
        asdict(selection),
    ]
    return f'W/"{hashlib.sha256(json.dumps(shown, default=str).encode()).hexdigest()[:32]}"'


@of_assignment.get(
    "/{assignment_id}/students",
    summary="Who is behind a number",
    responses=responses("forbidden", "assignment_not_found", "invalid_request"),
)
def read_concerned(  # noqa: PLR0913
    errand: StaffDep,
    assignment_id: AssignmentId,
    *,
    item: Annotated[str | None, Query(max_length=128, description="They failed it at least once.")] = None,
    mistake: Annotated[str | None, Query(max_length=64, description="They made it at least once.")] = None,
    status: Annotated[
        str | None, Query(max_length=32, description="`status` or `verdict` of their latest submission.")
    ] = None,
    offset: Offset = 0,
    limit: Limit = _PAGE,
) -> ConcernedList:
    """Return the students who handed in for an assignment and fit: who still fails, and tried most, first."""
    students = concerned(
        errand.services, errand.caller, assignment_id, Concern(item=item, mistake=mistake, status=status)
    )
    return ConcernedList(
        students=[ConcernedView.of(student) for student in students[offset : offset + limit]]
    )
