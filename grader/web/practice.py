"""The page where a script is written and run for practice, then handed in; and the car that is driven live."""

import json
from typing import Annotated, Any

from fastapi import APIRouter, Depends, File, Request, Response, UploadFile
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import JSONResponse

from grader.contracts.errors import RefusedError
from grader.contracts.text import Language
from grader.messages import on_page
from grader.routes.middleware import UploadRoute
from grader.telemetry.context import note
from grader.use_cases.assignments import terms_of
from grader.use_cases.handing_in import most_upload_bytes
from grader.use_cases.practising import Practice, practisable, practise
from grader.web import access
from grader.web.access import COSTLY, ServicesDep, VisitorDep
from grader.web.errors import form_problem
from grader.web.forms import require_own_form
from grader.web.pages import fragment, language_of, page
from grader.web.result import figure_document, replay_words, result_page, stream_text

router = APIRouter(prefix="/assignments/{assignment_id}/practice", include_in_schema=False)
runs = APIRouter(
    prefix="/assignments/{assignment_id}/practice", include_in_schema=False, route_class=UploadRoute
)
_WORDS = ("running", "done", "lost", "reset_sure", "editor")


@router.get("", dependencies=[COSTLY])
def read(request: Request, services: ServicesDep, visitor: VisitorDep, assignment_id: str) -> Response:
    """Show the editor with the assignment's starter, or what this browser had in it."""
    access.require_known(visitor)
    caller, language = visitor.caller, language_of(request)
    assignment = practisable(services, caller, assignment_id)
    services.practice.warm_up()
    terms = terms_of(services, caller, assignment.id)
    closed = None if terms.refusal is None else RefusedError(terms.refusal.code)
    return page(
        request,
        "practice.html",
        assignment=assignment,
        starter=services.assignments.of(caller.course).starter(assignment.id).decode(errors="replace"),
        file_name=f"{assignment.id}.py",
        off=None if services.practice.offered else form_problem(RefusedError("practice_off"), language),
        terms=terms,
        closed=None if closed is None else form_problem(closed, language),
        words={name: on_page(language, f"practice.{name}") for name in _WORDS},
    )


@runs.post("", dependencies=[Depends(require_own_form)])
async def run(
    request: Request,
    services: ServicesDep,
    visitor: VisitorDep,
    assignment_id: str,
    file: Annotated[UploadFile, File()],
) -> Response:
    """Run what is in the editor; answer with the result as a part of the page, and the data of its replay."""
    access.require_known(visitor)
    content = await file.read(most_upload_bytes(services) + 1)
    language = language_of(request)
    try:
        seen = await practise(services, visitor.caller, assignment_id, file.filename or "", content)
    except RefusedError as problem:
        note(code=problem.code)
        return _refusal(problem, language)
    return await run_in_threadpool(_answer, request, seen, language)


def _refusal(problem: RefusedError, language: Language) -> Response:
    told = form_problem(problem, language, field="file")
    wait_s = problem.retry_after_s
    headers = {"Cache-Control": "no-store"} | ({} if wait_s is None else {"Retry-After": str(wait_s)})
    words = [told.title, told.detail, told.fix]
    document = {"refused": [one for one in dict.fromkeys(words) if one], "retry_after_s": wait_s}
    return JSONResponse(document, told.status, headers)


def _answer(request: Request, seen: Practice, language: Language) -> Response:
    moved = seen.trajectory is not None and not (seen.figure is not None and seen.figure.view == "log")
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
    return JSONResponse(document, headers={"Cache-Control": "no-store"})
