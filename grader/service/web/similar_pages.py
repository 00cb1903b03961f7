"""Similar scripts, as pages: who shares places that few have, and two scripts side by side with these marked."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Depends, Query, Response
from starlette.concurrency import run_in_threadpool

from grader.contracts.identity import Caller
from grader.contracts.text import Language
from grader.service.web.access import PageErrand, StaffDep, require_staff
from grader.service.web.pages import page
from grader.service.web.source import source_view
from grader.similarity.places import Range
from grader.store.scripts import HandedIn
from grader.use_cases.assignments import published
from grader.use_cases.people import names, person
from grader.use_cases.services import Services
from grader.use_cases.similar import SideBySide, side_by_side, similar

router = APIRouter(prefix="/class/similar", include_in_schema=False, dependencies=[Depends(require_staff)])
_Id = Annotated[str, Query(max_length=64)]


@dataclass(frozen=True, slots=True)
class MarkedLine:
    """One line of a script. `alike`: whether the other has it, too. `begins`: places that begin here, from 1."""

    number: int
    text: str
    alike: bool
    begins: tuple[tuple[int, Range], ...]


@dataclass(frozen=True, slots=True)
class MarkedScript:
    """One of two scripts side by side. `side`: A or B. `share`: of its own code, what the other has as well."""

    side: str
    handed_in: HandedIn
    student: str
    share: float
    lines: Sequence[MarkedLine]
    left_out: int


@router.get("/{assignment_id}")
async def read_similar(errand: StaffDep, assignment_id: str) -> Response:
    """Show which scripts have something in common that few have, and which drove alike."""
    found = await similar(errand.services, errand.caller, assignment_id)

    def made() -> Response:
        known = names(errand.services, errand.caller)
        people = {
            script.student: person(known, script.student)
            for pair in (*found.pairs, *found.same_drives)
            for script in (pair.first, pair.second)
        }
        title = _title(errand.services, errand.caller, assignment_id, errand.language)
        return page(errand.request, "similar.html", title=title, similar=found, people=people)

    return await run_in_threadpool(made)


@router.get("/{assignment_id}/pair")
async def read_pair(errand: StaffDep, assignment_id: str, first: _Id, second: _Id) -> Response:
    """Show two of these scripts side by side, with what they have in common marked."""
    shown = await side_by_side(errand.services, errand.caller, assignment_id, first, second)

    def made() -> Response:
        title = _title(errand.services, errand.caller, assignment_id, errand.language)
        scripts = _scripts(errand, shown)
        return page(
            errand.request,
            "similar_pair.html",
            title=title,
            assignment_id=assignment_id,
            pair=shown.pair.found,
            scripts=scripts,
        )

    return await run_in_threadpool(made)


def _title(services: Services, caller: Caller, assignment_id: str, language: Language) -> str:
    assignment = published(services, caller, assignment_id)
    return assignment_id if assignment is None else assignment.title.get(language)


def _scripts(errand: PageErrand, shown: SideBySide) -> tuple[MarkedScript, MarkedScript]:
    known, pair = names(errand.services, errand.caller), shown.pair
    ours = [(place.first, place.second) for place in pair.found.places]
    theirs = [(there, here) for here, there in ours]

    def marked(
        side: str, handed_in: HandedIn, share: float, source: bytes, places: Sequence[tuple[Range, Range]]
    ) -> MarkedScript:
        lines, left_out = _lines(source, places)
        return MarkedScript(side, handed_in, person(known, handed_in.student), share, lines, left_out)

    return (
        marked("A", pair.first, pair.found.first_share, shown.first_source, ours),
        marked("B", pair.second, pair.found.second_share, shown.second_source, theirs),
    )


def _lines(source: bytes, places: Sequence[tuple[Range, Range]]) -> tuple[Sequence[MarkedLine], int]:
    """Return the lines of a file, each place given as the lines here and the lines there; and how many follow."""
    view = source_view(source, {})
    alike = {number for here, _ in places for number in range(here.first_line, here.last_line + 1)}
    begins: dict[int, list[tuple[int, Range]]] = defaultdict(list)
    for number, (here, there) in enumerate(places, start=1):
        begins[here.first_line].append((number, there))
    lines = [
        MarkedLine(line.number, line.text, line.number in alike, tuple(begins[line.number]))
        for line in view.lines
    ]
    return lines, view.left_out
