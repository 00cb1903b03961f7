"""Which scripts of a class are alike at places that few have: for staff to look at, part of no score."""

from fastapi import APIRouter, Response
from pydantic import Field
from starlette.concurrency import run_in_threadpool

from grader.service.requests.dependencies import Address, AssignmentId, StaffDep
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases.comparing import Similar, SimilarPair
from grader.use_cases.similar import similar

router = APIRouter(prefix="/api/v1/assignments", tags=["assignments"])


class RangeView(View):
    """Lines of a file, from 1, both included."""

    first_line: int = Field(examples=[12])
    last_line: int = Field(examples=[31])


class PlaceView(View):
    """What two scripts have in common at one place of each."""

    first: RangeView
    second: RangeView


class SimilarScriptView(View):
    """One student's script."""

    student: str = Field(examples=["20260123"])
    submission: Address
    share: float = Field(description="Of its own code, how much the other has as well.", examples=[0.85])


class SimilarPairView(View):
    """Two scripts with something in common that few have."""

    first: SimilarScriptView
    second: SimilarScriptView
    weight: float = Field(
        description="Of all that they share, the more the fewer students have it.", examples=[74.2]
    )
    same_file: bool = Field(description="The files are equal byte by byte.")
    same_commands: bool = Field(description="They sent the same commands at the same times.")
    places: list[PlaceView] = Field(description="Where they are alike; the first 50.")


class SimilarView(View):
    """What the scripts of a class have in common, of each student the one that counts.

    Left out are the starters, the solutions, the lesson's listings and what staff handed in, and what more than
    `few` students have.
    """

    assignment: str = Field(examples=["square"])
    compared: int = Field(description="Scripts with enough of their own.", examples=[31])
    not_compared: int = Field(description="Of more than 1,000 scripts, the oldest.", examples=[0])
    few: int = Field(description="The most students who may share what still counts.", examples=[12])
    too_little: list[str] = Field(description="Students with too little of their own.", examples=[["s1"]])
    pairs: list[SimilarPairView] = Field(description="Most and rarest places first; at most 100.")
    left_out: int = Field(description="Pairs after the last that is listed.", examples=[0])
    same_commands: list[SimilarPairView] = Field(
        description="Different texts that sent the same commands at the same times; at most 100."
    )


@router.get(
    "/{assignment_id}/similar",
    summary="Scripts that are alike where few are",
    response_model=SimilarView,
    responses=responses("forbidden", "assignment_not_found", "no_scripts", "invalid_request"),
)
async def read(errand: StaffDep, assignment_id: AssignmentId) -> Response:
    """Return where a person should look. It does not say that anybody copied, and no score depends on it.

    It takes a second for a class of 300, and is kept until a script or a grading changes.
    """
    pairs = await similar(errand.services, errand.caller, assignment_id)
    body = await run_in_threadpool(_json, pairs)
    return Response(body, media_type="application/json", headers={"Cache-Control": "no-store"})


def _json(found: Similar) -> str:
    pairs, same_drives = ([_pair(pair) for pair in listed] for listed in (found.pairs, found.same_drives))
    return SimilarView.of(found, pairs=pairs, same_commands=same_drives).model_dump_json()


def _pair(one: SimilarPair) -> SimilarPairView:
    pair = one.found
    first, second = (
        SimilarScriptView(student=side.student, submission=side.submission, share=share)
        for side, share in ((one.first, pair.first_share), (one.second, pair.second_share))
    )
    return SimilarPairView.of(pair, first=first, second=second, same_commands=pair.same_drive)
