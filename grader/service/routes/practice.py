"""Running a script for practice: the answer tells what was seen, and nothing of it is kept."""

import json
from collections.abc import AsyncIterator, Callable
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.sse import EventSourceResponse, ServerSentEvent
from pydantic import Field

from grader.contracts.errors import InfrastructureError, RefusedError
from grader.contracts.grading import RunProgress
from grader.contracts.report import GradeStatus
from grader.contracts.text import Language
from grader.service.requests.dependencies import ErrandDep, LanguageDep
from grader.service.requests.middleware import UploadRoute, known_parts
from grader.service.routes.problems import problem_of, responses
from grader.service.routes.submissions import (
    AssignmentField,
    RunView,
    SeenItemView,
    UploadedFile,
    item_view,
    run_view,
)
from grader.service.routes.views import View
from grader.use_cases.handing_in import most_upload_bytes
from grader.use_cases.practising import Practice, UnderWay, practising

router = APIRouter(
    prefix="/api/v1/practice",
    tags=["practice"],
    route_class=UploadRoute,
    dependencies=[Depends(known_parts)],
)
_PROBLEMS = (
    "no_course",
    "assignment_not_found",
    "practice_scripts_only",
    "practice_off",
    "practice_full",
    "malformed_body",
    "too_large",
    "unsupported_media_type",
    "wrong_file_type",
    "invalid_request",
    "empty",
    "not_utf8",
    "contains_nul",
)


class PracticeView(View):
    """What a practice run showed. There are no points: only handing in earns them."""

    assignment: str = Field(examples=["square"])
    assignment_version: int = Field(examples=[1])
    status: GradeStatus = Field(description="How the run ended.", examples=["graded"])
    hint: str = Field(description="The one next step that matters most.")
    mistakes: list[str] = Field(description="Codes of recognised mistakes, likeliest first.")
    items: list[SeenItemView] = Field(description="Items that the caller sees.")
    runs: list[RunView] = Field(description="The run of the assignment's first case.")
    trajectory: dict[str, Any] | None = Field(
        description="What the car did, as `/api/v1/submissions/{id}/trajectory` tells it; null: nothing."
    )


class PracticeWaitingView(View):
    """Data of an event `waiting`: the run has not begun."""

    before: int = Field(description="How many runs have to end before it.", examples=[0])


class PracticeRunningView(View):
    """Data of an event `running`: how far the run is."""

    virtual_s: float = Field(description="Virtual time, in seconds.", examples=[12.4])
    stdout: str = Field(description="The last whole lines of standard output, 2,000 characters at most.")
    stderr: str = Field(description="The same of standard error, where nodes log to.")


async def _begun(
    errand: ErrandDep, file: UploadedFile, assignment: AssignmentField
) -> AsyncIterator[UnderWay]:
    content = await file.read(most_upload_bytes(errand.services) + 1)
    async with practising(errand.services, errand.caller, assignment, file.filename or "", content) as run:
        yield run


UnderWayDep = Annotated[UnderWay, Depends(_begun)]


@router.post("", summary="Run a script for practice", responses=responses(*_PROBLEMS, "practice_waits"))
async def run(run: UnderWayDep, language: LanguageDep, response: Response) -> PracticeView:
    """Run a script in the sandbox in virtual time and tell what was seen. It costs no attempt; nothing is kept."""
    practice = await run.result()
    response.headers.update(
        {"Content-Language": language, "Vary": "Accept-Language", "Cache-Control": "no-store"}
    )
    return _view(practice, language)


@router.post(
    "/events",
    summary="Run a script for practice, and follow it",
    response_class=EventSourceResponse,
    responses={
        200: {
            "description": "Events `waiting` (their data: `PracticeWaitingView`) and `running` "
            "(`PracticeRunningView`), and at last `seen` (`PracticeView`) or `refused` (`Problem`)."
        },
        **responses(*_PROBLEMS),
    },
)
async def follow(request: Request, run: UnderWayDep, language: LanguageDep) -> AsyncIterator[ServerSentEvent]:
    """Do the same, and tell meanwhile how many are before it and how far it is. Going away gives up the place."""
    async for event in events(request, run, lambda seen: _view(seen, language)):
        yield event


async def events(
    request: Request, run: UnderWay, view: Callable[[Practice], Any]
) -> AsyncIterator[ServerSentEvent]:
    """Yield where a run is as that changes, and last what `view` makes, in a thread, of what it showed."""
    async for where in run.where():
        yield _where(where)
    try:
        practice = await run.result()
    except (RefusedError, InfrastructureError) as error:
        yield ServerSentEvent(data=await problem_of(request, error), event="refused")
        return
    yield ServerSentEvent(data=await run_in_threadpool(view, practice), event="seen")


def _where(where: RunProgress | int) -> ServerSentEvent:
    if isinstance(where, int):
        return ServerSentEvent(data=PracticeWaitingView(before=where), event="waiting")
    view = PracticeRunningView(virtual_s=where.t_ns / 1e9, stdout=where.stdout, stderr=where.stderr)
    return ServerSentEvent(data=view, event="running")


def _view(seen: Practice, language: Language) -> PracticeView:
    report = json.loads(seen.report.canonical_bytes())
    items = [item_view(item, language).model_dump() for item in report["items"]]
    return PracticeView(
        assignment=seen.report.assignment,
        assignment_version=seen.report.assignment_version,
        status=seen.report.status,
        hint=seen.report.hint.get(language),
        mistakes=list(seen.report.mistakes),
        items=[SeenItemView.model_validate(item) for item in items],
        runs=[run_view(one) for one in report["runs"]],
        trajectory=None if seen.trajectory is None else json.loads(seen.trajectory),
    )
