"""What the car did: the trajectory as columns of numbers, as a picture, and as a ROS bag."""

import gzip
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Response
from pydantic import Field

from grader.service.requests.answers import accepts_gzip, plot, trajectory_answer
from grader.service.requests.dependencies import COSTLY, DRAWN, ErrandDep, LanguageDep, SubmissionId
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases import recordings

router = APIRouter(prefix="/api/v1/submissions", tags=["recordings"])
CaseQuery = Annotated[str | None, Query(description="Which run; the first when left out.", max_length=64)]
_BAG_MEDIA_TYPE = "application/octet-stream"
_PLOT_PROBLEMS = (
    "submission_not_found",
    "no_trajectory",
    "assignment_not_found",
    "not_graded_yet",
    "invalid_request",
)


def _described(media_type: str, form: str) -> dict[str, Any]:
    return {
        "description": "One run's path over the ideal figure, with what was measured.",
        "content": {media_type: {"schema": {"type": "string", "format": form}}},
    }


class ContactView(View):
    """The car touched a wall."""

    start_ns: int = Field(examples=[2_000_000_000])
    end_ns: int = Field(examples=[2_500_000_000])
    wall: str = Field(description="`left`, `right`, `top` or `bottom`.", examples=["right"])


class TrajectoryView(View):
    """Poses over virtual time in turtlesim's frame, one column per quantity, all of one length.

    Between two samples further apart than 16 ms the car stood still.
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
    commanded: dict[str, Any] | None = Field(
        default=None,
        description="Where commands came faster than turtlesim takes them: the motion if each had been obeyed at "
        "once, in the same columns.",
    )
    pictures: list[tuple[int, str]] = Field(
        default=[], description="Of a PyBullet world alone: [t_ns, PNG in Base64].", examples=[[]]
    )


@router.get(
    "/{submission_id}/trajectory",
    dependencies=[COSTLY],
    summary="The trajectory as columns",
    response_class=Response,
    responses={
        200: {"model": TrajectoryView, "description": "The recorded trajectory; the ETag is its SHA-256."},
        **responses("submission_not_found", "no_trajectory", "not_graded_yet", "invalid_request"),
    },
)
def read_trajectory(
    errand: ErrandDep,
    submission_id: SubmissionId,
    case: CaseQuery = None,
    accept_encoding: Annotated[str | None, Header(include_in_schema=False)] = None,
) -> Response:
    """Return what the trusted simulator recorded in one run of the script."""
    return trajectory_answer(
        recordings.trajectory(errand.services, errand.caller, submission_id, case), accept_encoding
    )


@router.get(
    "/{submission_id}/recording.mcap",
    dependencies=[COSTLY],
    summary="The run as a ROS bag",
    response_class=Response,
    responses={
        200: {
            "description": "One run as MCAP: commands, poses, tf, log, driven and wanted path, rubric. "
            "`ros2 bag`, Foxglove, Lichtblick and PlotJuggler open it.",
            "content": {_BAG_MEDIA_TYPE: {"schema": {"type": "string", "format": "binary"}}},
        },
        **responses(*_PLOT_PROBLEMS, "bags_not_installed"),
    },
)
def read_bag(
    errand: ErrandDep,
    submission_id: SubmissionId,
    case: CaseQuery = None,
    accept_encoding: Annotated[str | None, Header(include_in_schema=False)] = None,
) -> Response:
    """Return the same bytes each time; they are made when asked for, and nothing is run again."""
    bag = recordings.bag(errand.services, errand.caller, submission_id, case)
    headers = {
        "ETag": f'"{bag.tag}"',
        "Vary": "Accept-Encoding",
        "Content-Disposition": f'attachment; filename="{bag.name}"',
    }
    if not accepts_gzip(accept_encoding):
        return Response(bag.content, media_type=_BAG_MEDIA_TYPE, headers=headers)
    headers["Content-Encoding"] = "gzip"
    return Response(gzip.compress(bag.content, mtime=0), media_type=_BAG_MEDIA_TYPE, headers=headers)


@router.get(
    "/{submission_id}/plot.png",
    dependencies=[DRAWN],
    summary="The trajectory as a picture",
    response_class=Response,
    responses={200: _described("image/png", "binary"), **responses(*_PLOT_PROBLEMS)},
)
async def read_plot(
    errand: ErrandDep, submission_id: SubmissionId, language: LanguageDep, *, case: CaseQuery = None
) -> Response:
    """Return a PNG with labels in the language asked for."""
    return await plot(errand, submission_id, case, language, "png")


@router.get(
    "/{submission_id}/plot.svg",
    dependencies=[DRAWN],
    summary="The trajectory as a drawing that scales",
    response_class=Response,
    responses={200: _described("image/svg+xml", "xml"), **responses(*_PLOT_PROBLEMS)},
)
async def read_drawing(
    errand: ErrandDep, submission_id: SubmissionId, language: LanguageDep, *, case: CaseQuery = None
) -> Response:
    """Return an SVG, text as outlines, with labels in the language asked for."""
    return await plot(errand, submission_id, case, language, "svg")
