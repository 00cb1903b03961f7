"""Grades for other systems: the gradebook, and single reports in other graders' formats."""

from typing import Annotated, Literal

from fastapi import APIRouter, Depends, File, Query, Response, UploadFile
from fastapi.responses import JSONResponse

from grader.formats.sheets.writing import MEDIA_TYPE
from grader.service.requests.answers import to_save
from grader.service.requests.dependencies import (
    COSTLY,
    SIGHT,
    ErrandDep,
    LanguageDep,
    SectionDep,
    StaffDep,
    SubmissionId,
)
from grader.service.requests.middleware import MOST_BYTES, known_parts
from grader.service.routes.problems import responses
from grader.use_cases.gradebook import (
    Format,
    exported,
    fill_in,
    gradebook_csv,
    gradebook_workbook,
    registry_workbook,
)

router = APIRouter(prefix="/api/v1", tags=["gradebook"])
exports = APIRouter(prefix="/api/v1/submissions", tags=["gradebook"], dependencies=[SIGHT, COSTLY])
AssignmentQuery = Annotated[
    str,
    Query(
        max_length=64,
        description="Whose points; left out: the percentage of all points.",
        examples=["square"],
    ),
]
ColumnQuery = Annotated[str, Query(min_length=1, max_length=100, examples=["平时成绩"])]
_WORKBOOK = {MEDIA_TYPE: {"schema": {"type": "string", "format": "binary"}}}
_JSON = {"application/json": {"schema": {"type": "object"}}}
_ONE = ("submission_not_found", "not_graded_yet", "invalid_request")


@router.get(
    "/gradebook.csv",
    summary="The gradebook",
    response_class=Response,
    responses={
        200: {
            "description": "CSV in UTF-8: every student of the course, the points that count by the rules.",
            "content": {"text/csv": {"schema": {"type": "string"}}},
        },
        **responses("forbidden", "invalid_request"),
    },
)
def read_gradebook(
    errand: StaffDep,
    section: SectionDep,
    format: Annotated[Format, Query(description="`canvas`: as Canvas imports grades.")] = "plain",
) -> Response:
    """Return everybody's points; without courses of everybody who handed something in."""
    headers = to_save(f"gradebook-{format}.csv", Vary="Authorization")
    table = gradebook_csv(errand.services, errand.caller, format, section)
    return Response(table, media_type="text/csv; charset=utf-8", headers=headers)


@router.get(
    "/gradebook.xlsx",
    summary="The gradebook as a workbook",
    response_class=Response,
    responses={
        200: {
            "description": "Everybody's points, or one column of them for a registry.",
            "content": _WORKBOOK,
        },
        **responses("forbidden", "assignment_not_found", "invalid_request"),
    },
)
def read_workbook(  # noqa: PLR0913, PLR0917
    errand: StaffDep,
    language: LanguageDep,
    section: SectionDep,
    layout: Annotated[
        Literal["full", "registry"], Query(description="`registry`: id, name and the column `column` alone.")
    ] = "full",
    column: ColumnQuery = "成绩",
    assignment: AssignmentQuery = "",
) -> Response:
    """Return everybody's points as spreadsheet programs keep them."""
    if layout == "full":
        return as_workbook(
            gradebook_workbook(errand.services, errand.caller, language, section), "gradebook.xlsx"
        )
    book = registry_workbook(
        errand.services, errand.caller, language, column=column, assignment=assignment, section=section
    )
    return as_workbook(book, "registry.xlsx")


@router.post(
    "/gradebook/fill",
    dependencies=[Depends(known_parts)],
    summary="Fill points into a sheet of one's own",
    response_class=Response,
    responses={
        200: {
            "description": "The sheet with points in it. Of .xlsx nothing else changes; other formats become "
            "a plain .xlsx. The headers X-Filled-Rows, X-Unknown-Rows and X-Ambiguous-Rows count rows.",
            "content": _WORKBOOK,
        },
        **responses(
            "forbidden",
            "assignment_not_found",
            "invalid_request",
            "invalid_sheet",
            "malformed_body",
            "too_large",
        ),
    },
)
def fill_sheet(
    errand: StaffDep,
    file: Annotated[UploadFile, File(description=".xlsx, .xls, .ods or CSV; at most 1 MiB.")],
    column: ColumnQuery,
    assignment: AssignmentQuery = "",
) -> Response:
    """Return a teacher's own sheet with everybody's points in the column called `column`."""
    filled = fill_in(errand.services, errand.caller, file.file.read(MOST_BYTES + 1), column, assignment)
    response = as_workbook(filled.content, "filled.xlsx")
    response.headers["X-Filled-Rows"] = str(filled.filled)
    response.headers["X-Unknown-Rows"] = str(len(filled.unknown))
    response.headers["X-Ambiguous-Rows"] = str(len(filled.ambiguous))
    return response


def as_workbook(content: bytes, name: str) -> Response:
    """Return a workbook as an answer to be saved."""
    return Response(content, 200, to_save(name, Vary="Accept-Language, Authorization"), MEDIA_TYPE)


@exports.get(
    "/{submission_id}/gradescope.json",
    summary="The report as Gradescope's results.json",
    response_class=JSONResponse,
    responses={
        200: {"description": "Ready to be written to results.json by an autograder.", "content": _JSON},
        **responses(*_ONE),
    },
)
def read_gradescope(errand: ErrandDep, language: LanguageDep, submission_id: SubmissionId) -> Response:
    """Return what a Gradescope autograder writes."""
    document = exported(errand.services, errand.caller, submission_id, "gradescope", language)
    return JSONResponse(document, headers={"Cache-Control": "no-store"})


@exports.get(
    "/{submission_id}/prairielearn.json",
    summary="The report as PrairieLearn's results.json",
    response_class=JSONResponse,
    responses={200: {"description": "Without the plot.", "content": _JSON}, **responses(*_ONE)},
)
def read_prairielearn(errand: ErrandDep, language: LanguageDep, submission_id: SubmissionId) -> Response:
    """Return what a PrairieLearn external grader writes."""
    document = exported(errand.services, errand.caller, submission_id, "prairielearn", language)
    return JSONResponse(document, headers={"Cache-Control": "no-store"})
