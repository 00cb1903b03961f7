"""The page where a script is written and run for practice, then handed in."""

import json
from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Depends, File, Query, Request, Response, UploadFile
from fastapi.sse import EventSourceResponse, ServerSentEvent

from grader.contracts.errors import RefusedError
from grader.contracts.report import report_from
from grader.contracts.submission import StoredReport, Submission
from grader.contracts.upload import decoded
from grader.messages import on_page
from grader.service.requests.middleware import UploadRoute
from grader.service.routes.practice import events
from grader.service.web.access import COSTLY, KnownDep, PageErrand, language_of, seen
from grader.service.web.errors import form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.line_links import lines_named
from grader.service.web.pages import fragment, page
from grader.service.web.result import figure_document, replay_words, result_page, stream_text
from grader.service.web.source import failing_lines
from grader.use_cases.assignments import terms_of
from grader.use_cases.drafting import draft_of, keep_draft
from grader.use_cases.explaining import told_of
from grader.use_cases.handing_in import most_upload_bytes
from grader.use_cases.practising import Practice, UnderWay, practisable, practising
from grader.use_cases.submissions import history

router = APIRouter(prefix="/assignments/{assignment_id}/practice", include_in_schema=False)
runs = APIRouter(
    prefix="/assignments/{assignment_id}/practice", include_in_schema=False, route_class=UploadRoute
)
_WORDS = (
    "next",
    "waiting",
    "running",
    "virtual_time",
    "done",
    "lost",
    "reset_sure",
    "editor",
    "kept",
    "not_kept",
)


@router.get("", dependencies=[COSTLY])
def read(
    errand: KnownDep, assignment_id: str, mend: Annotated[str | None, Query(max_length=64)] = None
) -> Response:
    """Show the editor with what the visitor was last writing, else the assignment's starter.

    `mend`: a submission whose program and marked lines are put there instead.
    """
    caller, language = errand.caller, errand.language
    assignment = practisable(errand.services, caller, assignment_id)
    own = history(errand.services, caller, errand.visitor.student or "", assignment.id)
    errand.services.practice.warm_up()
    terms = terms_of(errand.services, caller, assignment.id)
    closed = None if terms.refusal is None else RefusedError(terms.refusal.code)
    return page(
        errand.request,
        "practice.html",
        assignment=assignment,
        starter=errand.services.assignments.of(caller.course).starter(assignment.id).decode(errors="replace"),
        opened={
            "draft": draft_of(errand.services, caller, assignment.id),
            **({} if mend is None else _brought(errand, assignment.id, mend)),
        },
        last=own[0].submission.id if own else None,
        file_name=f"{assignment.id}.py",
        off=None
        if errand.services.practice.offered
        else form_problem(RefusedError("practice_off"), language),
        terms=terms,
        closed=None if closed is None else form_problem(closed, language),
        words={name: on_page(language, f"practice.{name}") for name in _WORDS},
    )


def _brought(errand: PageErrand, assignment_id: str, submission_id: str) -> dict[str, Any]:
    """Return the program of a submission, and what was said of which of its lines."""
    submission, stored = seen(errand, submission_id)
    if submission.assignment != assignment_id:
        raise RefusedError("submission_not_found")
    source = errand.services.submissions.source(submission.id) or b""
    marks: list[dict[str, Any]] = []
    if stored is not None:
        report = report_from(stored.content)
        failing = failing_lines(source, report.runs)
        marks = [{"line": line, "text": said} for line, some in failing.items() for said in some]
        guessed = dict.fromkeys(lines_named(report.hint.get(errand.language)), "")
        hinted = _hinted(errand, submission, stored) or guessed
        marks += [{"line": line, "text": fact} for line, fact in hinted.items() if line not in failing]
    return {"brought": decoded(source), "marks": marks}


def _hinted(errand: PageErrand, submission: Submission, stored: StoredReport) -> dict[int, str]:
    """Return the lines of the changes that were tried, each with what was measured."""
    rules = errand.services.rules.about(submission.course, submission.student, submission.assignment)
    told = told_of(errand.services, errand.caller, submission, stored, rules)
    language = errand.language
    return {
        line: step.fact.get(language) for step in told.steps for line in lines_named(step.line.get(language))
    }


@runs.post("/draft", dependencies=OWN_FORM)
def keep(
    errand: KnownDep, assignment_id: str, file: Annotated[UploadFile, File()]
) -> dict[str, dict[str, Any] | None]:
    """Keep what the visitor is writing, and say what Python has against it."""
    content = file.file.read(most_upload_bytes(errand.services) + 1)
    objection = keep_draft(errand.services, errand.caller, assignment_id, content)
    if objection is None or objection.detail is None:
        return {"problem": None}
    return {"problem": {"line": objection.members["line"], "text": objection.detail.get(errand.language)}}


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
    async for event in events(request, run, lambda practice: _shown(request, practice)):
        yield event


def _shown(request: Request, practice: Practice) -> dict[str, Any]:
    language = language_of(request)
    moved = practice.trajectory is not None and (
        practice.figure is None or practice.figure.view not in ("log", "frames", "talk")
    )
    html = fragment(
        request,
        "practice_result.html",
        result=result_page(practice.report, practice.assignment, language),
        run=next(iter(practice.report.runs), None),
        replay=moved,
        replay_words=replay_words(language),
        cut={
            output.case: (stream_text(output.stdout), stream_text(output.stderr))
            for output in practice.cut_output
        },
        cases=practice.cases,
        untouched=practice.untouched,
        rough=practice.assignment.world.profile == "rough",
    )
    document: dict[str, Any] = {"html": html, "trajectory": None, "sketch": {}}
    if moved and practice.trajectory is not None:
        document["trajectory"] = json.loads(practice.trajectory)
        document["sketch"] = {} if practice.figure is None else figure_document(practice.figure, language)
    return document
