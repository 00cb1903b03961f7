"""The gradebook as a page: the points that count, for everybody, and as files for other systems."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import Annotated

from fastapi import APIRouter, Depends, Query, Request, Response
from pydantic import Field

from grader.contracts.assignment import Assignment
from grader.contracts.dashboard import StudentProgress
from grader.contracts.identity import Member
from grader.contracts.rubric import summed
from grader.use_cases import gradebook
from grader.use_cases.gradebook import Format, Scores
from grader.web.access import ServicesDep, StaffDep, require_staff
from grader.web.pages import language_of, page
from grader.web.paging import PageQuery, cut

router = APIRouter(prefix="/class", include_in_schema=False, dependencies=[Depends(require_staff)])


class BookQuery(PageQuery):
    """Which students are shown: those whose id or name contains `search`, one page of them."""

    search: str = Field(default="", max_length=100)


@dataclass(frozen=True, slots=True, kw_only=True)
class BookLine:
    """One student. `cells` in the order of the assignments, None where nothing was handed in."""

    member: Member
    total: float
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
    members: Sequence[Member], scores: Scores, assignments: Sequence[Assignment], query: BookQuery
) -> Book:
    """Return the page of the gradebook that `query` asks for; beyond the last page, the last."""
    wanted = query.search.strip().lower()
    fitting = [one for one in members if wanted in one.id.lower() or wanted in one.name.lower()]
    shown, query, pages = cut(fitting, query)
    return Book(
        lines=tuple(_line(one, scores, assignments) for one in shown),
        means=tuple(_mean(one.id, members, scores) for one in assignments),
        found=len(fitting),
        all=len(members),
        pages=pages,
        query=query,
    )


@router.get("/gradebook")
def read(
    request: Request, services: ServicesDep, visitor: StaffDep, query: Annotated[BookQuery, Query()]
) -> Response:
    """Show the points that count by student and assignment."""
    members, scores = gradebook.book(services, visitor.caller)
    assignments = services.assignments.all()
    return page(
        request,
        "gradebook.html",
        book=book_page(members, scores, assignments, query),
        assignments=assignments,
        pass_fraction=services.settings.pass_fraction,
    )


@router.get("/gradebook.csv")
def download(
    request: Request, services: ServicesDep, visitor: StaffDep, format: Annotated[Format, Query()] = "plain"
) -> Response:
    """Return the whole gradebook as a file."""
    table = gradebook.gradebook_csv(services, visitor.caller, language_of(request), format)
    headers = {
        "Content-Disposition": f'attachment; filename="gradebook-{format}.csv"',
        "Cache-Control": "no-store",
        "Vary": "Accept-Language, Authorization",
    }
    return Response(table, media_type="text/csv; charset=utf-8", headers=headers)


def _line(member: Member, scores: Scores, assignments: Sequence[Assignment]) -> BookLine:
    cells = tuple(scores.get((member.id, one.id)) for one in assignments)
    counted = [one.counted_score for one in cells if one is not None and one.counted_score is not None]
    return BookLine(member=member, total=summed(counted), cells=cells)


def _mean(assignment_id: str, members: Sequence[Member], scores: Scores) -> float | None:
    reached = [scores.get((one.id, assignment_id)) for one in members]
    counted = [one.counted_score for one in reached if one is not None and one.counted_score is not None]
    return round(fmean(counted), 2) if counted else None
