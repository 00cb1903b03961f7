"""The page where a script is written and run for practice, then handed in."""

import json
from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Depends, File, Request, Response, UploadFile
from fastapi.sse import EventSourceResponse, ServerSentEvent

from grader.contracts.errors import RefusedError
from grader.messages import on_page
from grader.service.requests.middleware import UploadRoute
from grader.service.routes.practice import events
from grader.service.web.access import COSTLY, KnownDep, language_of
from grader.service.web.errors import form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import fragment, page
from grader.service.web.result import figure_document, replay_words, result_page, stream_text
from grader.use_cases.assignments import terms_of
from grader.use_cases.handing_in import most_upload_bytes
from grader.use_cases.practising import Practice, UnderWay, practisable, practising

router = APIRouter(prefix="/assignments/{assignment_id}/practice", include_in_schema=False)
runs = APIRouter(
    prefix="/assignments/{assignment_id}/practice", include_in_schema=False, route_class=UploadRoute
)
_WORDS = ("next", "waiting", "running", "virtual_time", "done", "lost", "reset_sure", "editor")


@router.get("", dependencies=[COSTLY])
def read(errand: KnownDep, assignment_id: str) -> Response:
    """Show the editor with the assignment's starter, or what this browser had in it."""
    caller, language = errand.caller, errand.language
    assignment = practisable(errand.services, caller, assignment_id)
    errand.services.practice.warm_up()
    terms = terms_of(errand.services, caller, assignment.id)
    closed = None if terms.refusal is None else RefusedError(terms.refusal.code)
    return page(
        errand.request,
        "practice.html",
        assignment=assignment,
        starter=errand.services.assignments.of(caller.course).starter(assignment.id).decode(errors="replace"),
        file_name=f"{assignment.id}.py",
        off=None
        if errand.services.practice.offered
        else form_problem(RefusedError("practice_off"), language),
        terms=terms,
        closed=None if closed is None else form_problem(closed, language),
        words={name: on_page(language, f"practice.{name}") for name in _WORDS},
    )


async def _begun(
    errand: KnownDep, assignment_id: str, file: Annotated[UploadFile, File()]
) -> AsyncIterator[UnderWay]:
    content = await file.read(most_upload_bytes(errand.services) + 1)
    async with practising(errand.services, errand.caller, assignment_id, file.filename or "", content) as run:
        yield run


@runs.post("", response_class=EventSourceResponse, dependencies=OWN_FORM)
async def run(request: Request, run: Annotated[UnderWay, Depends(_begun)]) -> AsyncIterator[ServerSentEvent]:
    """Run what is in the editor; tell where that is, and at last a part of the page with the data of its replay.

    The interface's events but for the last one.
    """
    async for event in events(request, run, lambda seen: _shown(request, seen)):
        yield event


def _shown(request: Request, seen: Practice) -> dict[str, Any]:
    language = language_of(request)
    moved = seen.trajectory is not None and (
        seen.figure is None or seen.figure.view not in ("log", "frames", "talk")
    )
    html = fragment(
        request,
        "practice_result.html",
        result=result_page(seen.report, seen.assignment, language),
        run=next(iter(seen.report.runs), None),
        replay=moved,
        replay_words=replay_words(language),
        cut={one.case: (stream_text(one.stdout), stream_text(one.stderr)) for one in seen.cut_output},
        cases=seen.cases,
        rough=seen.assignment.world.profile == "rough",
    )
    document: dict[str, Any] = {"html": html, "trajectory": None, "sketch": {}}
    if moved and seen.trajectory is not None:
        document["trajectory"] = json.loads(seen.trajectory)
        document["sketch"] = {} if seen.figure is None else figure_document(seen.figure, language)
    return document
