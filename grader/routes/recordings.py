"""What the car did: the trajectory as columns of numbers, and as a picture."""

import gzip
from dataclasses import replace
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Response
from fastapi.concurrency import run_in_threadpool
from pydantic import BaseModel, Field

from grader.contracts.assignment import Assignment
from grader.contracts.errors import RefusedError
from grader.contracts.figure import PictureForm
from grader.contracts.identity import Caller
from grader.contracts.judgement import judged
from grader.contracts.submission import StoredReport
from grader.contracts.text import Language
from grader.routes.dependencies import ENTRY_PROBLEMS, CallerDep, LanguageDep, ServicesDep, SubmissionId
from grader.routes.problems import responses
from grader.routes.submissions import SIGHT
from grader.use_cases.assignments import require_published
from grader.use_cases.pictures import PlotSpec
from grader.use_cases.services import Services
from grader.use_cases.visibility import graded, shown_assignment

router = APIRouter(prefix="/api/v1/submissions", tags=["recordings"], dependencies=[SIGHT])
CaseQuery = Annotated[str | None, Query(description="Which run; the first when left out.", max_length=64)]
_MEDIA_TYPES: dict[PictureForm, str] = {"png": "image/png", "svg": "image/svg+xml"}
_PLOT_PROBLEMS = (
    *ENTRY_PROBLEMS,
    "submission_not_found",
    "no_trajectory",
    "assignment_not_found",
    "not_graded_yet",
    "invalid_request",
)


def _picture(media_type: str, form: str) -> dict[str, Any]:
    return {
        "description": "One run's path over the ideal figure, with what was measured.",
        "content": {media_type: {"schema": {"type": "string", "format": form}}},
    }


class ContactView(BaseModel):
    """The car touched a wall."""

    start_ns: int = Field(examples=[2_000_000_000])
    end_ns: int = Field(examples=[2_500_000_000])
    wall: str = Field(description="`left`, `right`, `top` or `bottom`.", examples=["right"])


class TrajectoryView(BaseModel):
    """Poses over virtual time in turtlesim's frame, one column per quantity, all of one length.

    Between two samples further apart than 1/60 s the car stood still.
    """

    t_ns: list[int] = Field(description="Virtual nanoseconds.", examples=[[0, 16_666_667]])
    x_m: list[float] = Field(description="Metres to the right.", examples=[[5.544445, 5.561112]])
    y_m: list[float] = Field(description="Metres up.", examples=[[5.544445, 5.544445]])
    heading_rad: list[float] = Field(description="Counter-clockwise, unwrapped.", examples=[[0.0, 0.0]])
    v_mps: list[float] = Field(description="Measured speed along the heading.", examples=[[0.0, 1.0]])
    w_radps: list[float] = Field(description="Measured yaw rate.", examples=[[0.0, 0.0]])
    end_ns: int = Field(description="End of the episode.", examples=[60_000_000_000])
    jumps: list[int] = Field(description="Samples reached by teleport or reset.", examples=[[]])
    contacts: list[ContactView]
    commands: list[tuple[int, float, float]] = Field(
        description="[t_ns, v_mps, w_radps] as received.", examples=[[[0, 1.0, 0.0]]]
    )


@router.get(
    "/{submission_id}/trajectory",
    summary="The trajectory as columns",
    response_class=Response,
    responses={
        200: {"model": TrajectoryView, "description": "The recorded trajectory; the ETag is its SHA-256."},
        **responses(
            *ENTRY_PROBLEMS, "submission_not_found", "no_trajectory", "not_graded_yet", "invalid_request"
        ),
    },
)
def read_trajectory(
    services: ServicesDep,
    submission_id: SubmissionId,
    case: CaseQuery = None,
    accept_encoding: Annotated[str | None, Header(include_in_schema=False)] = None,
) -> Response:
    """Return what the trusted simulator recorded in one run of the script."""
    return trajectory(services, submission_id, case, accept_encoding)


def trajectory(
    services: Services, submission_id: str, case: str | None, accept_encoding: str | None
) -> Response:
    """Return the answer with a recorded trajectory, compressed if `accept_encoding` takes that.

    Raises:
        RefusedError: there is no grading, or nothing was recorded in such a run.
    """
    _, report = graded(services, submission_id)
    content, sha256 = _recorded(services, report, case)
    headers = {"ETag": f'"{sha256}"', "Vary": "Accept-Encoding"}
    if "gzip" in (accept_encoding or "").lower():
        headers["Content-Encoding"] = "gzip"  # kept compressed: sent as it lies there
    else:
        content = gzip.decompress(content)
    return Response(content, media_type="application/json", headers=headers)


@router.get(
    "/{submission_id}/plot.png",
    summary="The trajectory as a picture",
    response_class=Response,
    responses={200: _picture("image/png", "binary"), **responses(*_PLOT_PROBLEMS)},
)
async def read_plot(
    services: ServicesDep,
    submission_id: SubmissionId,
    language: LanguageDep,
    caller: CallerDep,
    *,
    case: CaseQuery = None,
) -> Response:
    """Return a PNG with labels in the language asked for."""
    return await picture(services, submission_id, caller, language, "png", case)


@router.get(
    "/{submission_id}/plot.svg",
    summary="The trajectory as a drawing that scales",
    response_class=Response,
    responses={200: _picture("image/svg+xml", "xml"), **responses(*_PLOT_PROBLEMS)},
)
async def read_drawing(
    services: ServicesDep,
    submission_id: SubmissionId,
    language: LanguageDep,
    caller: CallerDep,
    *,
    case: CaseQuery = None,
) -> Response:
    """Return an SVG, text as outlines, with labels in the language asked for."""
    return await picture(services, submission_id, caller, language, "svg", case)


async def picture(  # noqa: PLR0913, PLR0917
    services: Services,
    submission_id: str,
    caller: Caller,
    language: Language,
    form: PictureForm,
    case: str | None,
) -> Response:
    """Return the answer with the picture of one run, as `caller` may see it.

    Raises:
        RefusedError: there is no grading, nothing was recorded in such a run, or nobody knows the assignment.
    """
    assignment, report, recorded, case_id = await run_in_threadpool(
        _drawable, services, submission_id, caller, case
    )
    spec = PlotSpec(case=case_id, language=language, form=form)
    drawn = await services.plots.get(assignment, report, recorded, spec)
    headers = {
        "ETag": f'"{report.sha256}-{case_id}-{language}-{form}"',
        "Content-Language": language,
        "Vary": "Accept-Language",
        "Cache-Control": "private, no-cache",
    }
    return Response(drawn, media_type=_MEDIA_TYPES[form], headers=headers)


def _recorded(services: Services, report: StoredReport, case: str | None) -> tuple[bytes, str]:
    case_id = _case_id(report, case)
    content = services.submissions.trajectory(report, case_id)
    if content is None:
        raise RefusedError("no_trajectory", field="case", allowed=list(report.cases))
    return content, report.cases[case_id]


def _case_id(report: StoredReport, case: str | None) -> str:
    return case if case is not None else next(iter(report.cases), "")


def _drawable(
    services: Services, submission_id: str, caller: Caller, case: str | None
) -> tuple[Assignment, StoredReport, bytes, str]:
    submission, report = graded(services, submission_id, caller)
    graded_one = services.submissions.graded_assignment(report)
    known = graded_one or require_published(services, submission.assignment)
    assignment = shown_assignment(services, caller, known)
    content, _ = _recorded(services, report, case)
    if report.judgements:  # the picture has the score
        whole = judged(report)
        report = replace(report, content=whole.canonical_bytes(), sha256=whole.sha256())
    return assignment, report, gzip.decompress(content), _case_id(report, case)
