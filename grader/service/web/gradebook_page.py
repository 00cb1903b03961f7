"""The gradebook as a page: the points that count, for everybody, and as files for other systems."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import Annotated, Literal

from fastapi import APIRouter, Depends, File, Form, Query, Response, UploadFile
from pydantic import Field

from grader.contracts.assignment import Assignment
from grader.contracts.dashboard import StudentProgress
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Member, sections_of
from grader.contracts.rubric import summed
from grader.formats.sheets.writing import MEDIA_TYPE
from grader.service.requests.answers import to_save
from grader.service.web.access import PageErrand, StaffDep, require_staff
from grader.service.web.errors import FormProblem, form_problem
from grader.service.web.forms import MOST_FILE_BYTES, OWN_FORM
from grader.service.web.pages import page
from grader.service.web.paging import PageQuery, cut
from grader.use_cases import gradebook
from grader.use_cases.assignments import in_course
from grader.use_cases.gradebook import Format, Scores

Section = Annotated[str, Query(max_length=64)]
Column = Annotated[str, Query(min_length=1, max_length=100)]
router = APIRouter(prefix="/class", include_in_schema=False, dependencies=[Depends(require_staff)])


class BookQuery(PageQuery):
    """Which students are shown: of a section, those whose id or name contains `search`, one page of them."""

    search: str = Field(default="", max_length=100)
    section: str = Field(default="", max_length=64)


@dataclass(frozen=True, slots=True, kw_only=True)
class BookLine:
    """One student. `cells` in the order of the assignments, None where nothing was handed in."""

    member: Member
    total: float
    percent: float | None
    cells: tuple[StudentProgress | None, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Book:
    """One page of the gradebook. `means` of the points that count, None where there are none."""

    lines: tuple[BookLine, ...]
    means: tuple[float | None, ...]
    found: int
    all: int
    pages: int
    query: BookQuery


def book_page(
    members: Sequence[Member],
    scores: Scores,
    assignments: Sequence[Assignment],
    query: BookQuery,
    percent: Mapping[str, float | None],
) -> Book:
    """Return the page of the gradebook that `query` asks for; beyond the last page, the last."""
    wanted = query.search.strip().lower()
    fitting = [one for one in members if wanted in one.id.lower() or wanted in one.name.lower()]
    shown, query, pages = cut(fitting, query)
    return Book(
        lines=tuple(_line(one, scores, assignments, percent[one.id]) for one in shown),
        means=tuple(_mean(one.id, members, scores) for one in assignments),
        found=len(fitting),
        all=len(members),
        pages=pages,
        query=query,
    )


@router.get("/gradebook")
def read(errand: StaffDep, query: Annotated[BookQuery, Query()]) -> Response:
    """Show the points that count by student and assignment."""
    return _gradebook_page(errand, query)


@router.get("/gradebook.csv")
def download(
    errand: StaffDep, format: Annotated[Format, Query()] = "plain", section: Section = ""
) -> Response:
    """Return the gradebook as CSV."""
    table = gradebook.gradebook_csv(errand.services, errand.caller, format, section)
    return _file(table, f"gradebook-{format}.csv", "text/csv; charset=utf-8")


@router.get("/gradebook.xlsx")
def download_workbook(
    errand: StaffDep,
    layout: Annotated[Literal["full", "registry"], Query()] = "full",
    column: Column = "成绩",
    assignment: Annotated[str, Query(max_length=64)] = "",
    section: Section = "",
) -> Response:
    """Return the gradebook as a workbook, or one column of it."""
    caller, language = errand.caller, errand.language
    if layout == "full":
        content = gradebook.gradebook_workbook(errand.services, caller, language, section)
    else:
        content = gradebook.registry_workbook(
            errand.services, caller, language, column=column, assignment=assignment, section=section
        )
    return _file(content, "gradebook.xlsx" if layout == "full" else "registry.xlsx", MEDIA_TYPE)


@router.post("/gradebook/fill", dependencies=OWN_FORM)
def fill_in(
    errand: StaffDep,
    file: Annotated[UploadFile, File()],
    column: Annotated[str, Form(max_length=100)] = "",
    assignment: Annotated[str, Form(max_length=64)] = "",
) -> Response:
    """Show what was filled into a teacher's own sheet, and offer it; or show the page with what is wrong."""
    try:
        filled = gradebook.fill_in(
            errand.services, errand.caller, file.file.read(MOST_FILE_BYTES + 1), column, assignment
        )
    except RefusedError as error:
        problem = form_problem(error, errand.language, field="file")
        headings = error.members.get("headings", ())
        return _gradebook_page(errand, BookQuery(), problem, (column, assignment), headings)
    data = base64.b64encode(filled.content).decode()
    return page(
        errand.request,
        "gradebook_filled.html",
        filled=filled,
        address=f"data:{MEDIA_TYPE};base64,{data}",
        name=_filled_name(file.filename or ""),
    )


def _filled_name(name: str) -> str:
    """Return what the filled sheet is called: as the teacher's, which is .xlsx now if it was not."""
    return f"{name.rpartition('.')[0] or 'filled'}.xlsx"


def _file(content: str | bytes, name: str, media_type: str) -> Response:
    return Response(content, 200, to_save(name, Vary="Accept-Language, Authorization"), media_type)


def _gradebook_page(
    errand: PageErrand,
    query: BookQuery,
    problem: FormProblem | None = None,
    typed: tuple[str, str] = ("", ""),
    headings: Sequence[str] = (),
) -> Response:
    """Show the page. `typed`: the column and the assignment to fill in; `headings`: of the sheet."""
    members, scores = gradebook.book(errand.services, errand.caller)
    assignments = in_course(errand.services, errand.caller)
    chosen = [one for one in members if not query.section or query.section in one.sections]
    return page(
        errand.request,
        "gradebook.html",
        status=200 if problem is None else problem.status,
        book=book_page(
            chosen,
            scores,
            assignments,
            query,
            gradebook.percentages(errand.services, errand.caller, chosen, scores),
        ),
        assignments=assignments,
        sections=sections_of(members),
        pass_fraction=errand.services.settings.pass_fraction,
        problem=problem,
        column=typed[0],
        filling=typed[1],
        headings=headings,
    )


def _line(
    member: Member, scores: Scores, assignments: Sequence[Assignment], percent: float | None
) -> BookLine:
    cells = tuple(scores.get((member.id, one.id)) for one in assignments)
    counted = [one.counted_score for one in cells if one is not None and one.counted_score is not None]
    return BookLine(member=member, total=summed(counted), percent=percent, cells=cells)


def _mean(assignment_id: str, members: Sequence[Member], scores: Scores) -> float | None:
    reached = [scores.get((one.id, assignment_id)) for one in members]
    counted = [one.counted_score for one in reached if one is not None and one.counted_score is not None]
    return round(fmean(counted), 2) if counted else None
