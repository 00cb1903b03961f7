"""Grades for other systems: the gradebook, and single reports in other graders' formats."""

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response
from fastapi.responses import JSONResponse

from grader.contracts.identity import Caller, Member, Role
from grader.contracts.judgement import judged
from grader.contracts.text import Language
from grader.render.documents import to_gradescope, to_prairielearn
from grader.routes.dependencies import (
    ENTRY_PROBLEMS,
    SIGHT,
    CallerDep,
    LanguageDep,
    ServicesDep,
    StaffDep,
    SubmissionId,
)
from grader.routes.gradebook_tables import Scores, canvas, plain
from grader.routes.problems import responses
from grader.use_cases.services import Services
from grader.use_cases.visibility import graded

router = APIRouter(prefix="/api/v1", tags=["gradebook"])
exports = APIRouter(prefix="/api/v1/submissions", tags=["gradebook"], dependencies=[SIGHT])
Format = Literal["plain", "canvas"]
Platform = Literal["gradescope", "prairielearn"]
_JSON = {"application/json": {"schema": {"type": "object"}}}
_ONE = (*ENTRY_PROBLEMS, "submission_not_found", "not_graded_yet", "invalid_request")


@router.get(
    "/gradebook.csv",
    summary="The gradebook",
    response_class=Response,
    responses={
        200: {
            "description": "CSV in UTF-8: every student of the course, the points that count by the rules.",
            "content": {"text/csv": {"schema": {"type": "string"}}},
        },
        **responses(*ENTRY_PROBLEMS, "forbidden", "invalid_request"),
    },
)
def read_gradebook(
    services: ServicesDep,
    caller: StaffDep,
    language: LanguageDep,
    format: Annotated[Format, Query(description="`canvas`: as Canvas imports grades.")] = "plain",
) -> Response:
    """Return everybody's points; without courses of everybody who handed something in."""
    return gradebook_file(services, caller, language, format)


def gradebook_file(services: Services, caller: Caller, language: Language, format: Format) -> Response:
    """Return the answer with the gradebook as a file to be saved."""
    members, scores = book(services, caller)
    assignments = services.assignments.all()
    table = (
        canvas(members, assignments, scores, language)
        if format == "canvas"
        else plain(members, assignments, scores)
    )
    headers = {
        "Content-Disposition": f'attachment; filename="gradebook-{format}.csv"',
        "Cache-Control": "no-store",
        "Vary": "Accept-Language, Authorization",
    }
    return Response(table, media_type="text/csv; charset=utf-8", headers=headers)


@exports.get(
    "/{submission_id}/gradescope.json",
    summary="The report as Gradescope's results.json",
    response_class=JSONResponse,
    responses={
        200: {"description": "Ready to be written to results.json by an autograder.", "content": _JSON},
        **responses(*_ONE),
    },
)
def read_gradescope(
    services: ServicesDep, caller: CallerDep, language: LanguageDep, submission_id: SubmissionId
) -> Response:
    """Return what a Gradescope autograder writes."""
    document = exported(services, caller, submission_id, "gradescope", language)
    return JSONResponse(document, headers={"Cache-Control": "no-store"})


@exports.get(
    "/{submission_id}/prairielearn.json",
    summary="The report as PrairieLearn's results.json",
    response_class=JSONResponse,
    responses={200: {"description": "Without the plot.", "content": _JSON}, **responses(*_ONE)},
)
def read_prairielearn(
    services: ServicesDep, caller: CallerDep, language: LanguageDep, submission_id: SubmissionId
) -> Response:
    """Return what a PrairieLearn external grader writes."""
    document = exported(services, caller, submission_id, "prairielearn", language)
    return JSONResponse(document, headers={"Cache-Control": "no-store"})


def book(services: Services, caller: Caller) -> tuple[tuple[Member, ...], Scores]:
    """Return everybody who has a line in the gradebook, and what they reached by student and assignment."""
    progress = services.dashboard.state(caller.course).progress
    members = services.courses.members(caller.course, Role.STUDENT) or _seen(
        {one.student for one in progress}
    )
    return members, {(one.student, one.assignment): one for one in progress}


def exported(
    services: Services, caller: Caller, submission_id: str, platform: Platform, language: Language
) -> dict[str, object]:
    """Return the report of a submission as `caller` may see it, with the points that people gave, for a platform.

    Raises:
        RefusedError: there is no such submission, or no grading yet.
    """
    _, stored = graded(services, caller, submission_id)
    if platform == "prairielearn":
        return to_prairielearn(judged(stored), language)
    return to_gradescope(judged(stored), language, stored.sha256)


def _seen(students: set[str]) -> tuple[Member, ...]:
    return tuple(Member(course="", id=one, name="", role=Role.STUDENT) for one in sorted(students))
