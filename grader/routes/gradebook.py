"""Grades for other systems: the gradebook, and single reports in other graders' formats."""

from typing import Annotated

from fastapi import APIRouter, Query, Response
from fastapi.responses import JSONResponse

from grader.routes.dependencies import (
    COSTLY,
    ENTRY_PROBLEMS,
    SIGHT,
    CallerDep,
    LanguageDep,
    ServicesDep,
    StaffDep,
    SubmissionId,
)
from grader.routes.problems import responses
from grader.use_cases.gradebook import Format, exported, gradebook_csv

router = APIRouter(prefix="/api/v1", tags=["gradebook"])
exports = APIRouter(prefix="/api/v1/submissions", tags=["gradebook"], dependencies=[SIGHT, COSTLY])
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
    headers = {
        "Content-Disposition": f'attachment; filename="gradebook-{format}.csv"',
        "Cache-Control": "no-store",
        "Vary": "Accept-Language, Authorization",
    }
    table = gradebook_csv(services, caller, language, format)
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
