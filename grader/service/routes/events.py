"""Progress as it happens: server-sent events (WHATWG HTML, section 9.2) for a submission and for the class.

Whether somebody may watch is settled before the stream begins, exactly as for the plain answers. Events say where
things stand, never how they were graded: what is hidden from a student cannot be in them.
"""

import asyncio
import signal
import threading
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from datetime import datetime
from types import FrameType
from typing import Annotated, Any

from fastapi import APIRouter, Depends, FastAPI, Header, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.sse import EventSourceResponse, ServerSentEvent
from pydantic import Field

from grader.contracts.identity import Caller
from grader.contracts.progress import ClassStanding, Standing
from grader.contracts.submission import SubmissionState
from grader.contracts.text import Language
from grader.render.labels import status_word
from grader.service.requests.dependencies import (
    SIGHT,
    ErrandDep,
    LanguageDep,
    ServicesDep,
    StaffDep,
    SubmissionId,
)
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases.callers import name_of
from grader.use_cases.following import Subject, SubjectWatch
from grader.use_cases.services import Services

submission = APIRouter(prefix="/api/v1/submissions", tags=["submissions"], dependencies=[SIGHT])
dashboard = APIRouter(prefix="/api/v1/dashboard", tags=["dashboard"])

RETRY_MS = 2_000
"""How long a browser waits before it opens a stream that ended again."""

LastEventId = Annotated[
    str | None,
    Header(
        alias="Last-Event-ID",
        max_length=200,
        description="Id of the last event that was received: what has not changed since is not repeated.",
    ),
]
_SIGNALS = (signal.SIGTERM, signal.SIGINT)
_PROBLEMS = ("too_many_streams", "streams_full")


class ProgressView(View):
    """Data of an event `progress`: where a submission stands."""

    status: SubmissionState = Field(examples=["queued"])
    text: str = Field(description="The same in words.", examples=["waiting"])
    open: bool = Field(description="Whether more will happen; the stream ends when not.")
    queue_position: int | None = Field(description="How many are before it while it waits.", examples=[3])
    estimated_finish_at: datetime | None = Field(description="Null when nobody can say.")


class ClassProgressView(View):
    """Data of an event `class`: the class's submissions by state. Whoever wants more asks for the dashboard."""

    queued: int = Field(examples=[4])
    running: int = Field(examples=[2])
    graded: int = Field(examples=[187])
    infrastructure_error: int = Field(description="Given up by the service's own fault.", examples=[0])


@dataclass(frozen=True, slots=True, kw_only=True)
class Owner:
    """Who a stream counts for. `is_known`: a token says who it is, so streams are not counted by address."""

    name: str
    is_known: bool


class NothingNewError(Exception):
    """The client has received the last event there will be. The status 204 tells a browser not to reconnect."""


@contextmanager
def told_to_stop(end: Callable[[], None]) -> Iterator[None]:
    """Call `end` in the running event loop at SIGTERM and Ctrl+C, before the server does what it does then.

    A server that stops waits for the answers under way before it ends the application. Streams live for a minute,
    so they must hear the signal themselves. Where the loop does not run in the main thread nobody gets signals,
    and nothing happens.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    loop = asyncio.get_running_loop()
    before = {number: handler for number in _SIGNALS if callable(handler := signal.getsignal(number))}

    def hear(number: int, frame: FrameType | None) -> None:
        loop.call_soon_threadsafe(end)  # later: the interrupted code may hold a lock that `end` takes
        before[signal.Signals(number)](number, frame)

    for number in before:
        signal.signal(number, hear)
    try:
        yield
    finally:
        for number, handler in before.items():
            if signal.getsignal(number) is hear:
                signal.signal(number, handler)


def install(app: FastAPI) -> None:
    """Let `app` end streams that have nothing more to say."""

    async def over(request: Request, error: Exception) -> Response:
        return Response(status_code=204)

    app.add_exception_handler(NothingNewError, over)


@asynccontextmanager
async def watched(
    request: Request, services: Services, subject: Subject, owner: Owner, last_event_id: str | None
) -> AsyncIterator[SubjectWatch]:
    """Yield a watch that knows where `subject` stands; it counts as a stream until the answer is over.

    Raises:
        RefusedError: there are too many streams. NothingNewError: `last_event_id` names the last event of all.
    """
    address = None if owner.is_known or request.client is None else request.client.host
    with services.watching.watch(subject, owner.name, address) as watch:
        standing = await run_in_threadpool(services.watching.look, subject)
        if standing is not None:
            if standing.is_final and standing.mark == last_event_id:
                raise NothingNewError
            watch.tell(standing)
        yield watch


async def events(
    watch: SubjectWatch,
    last_event_id: str | None,
    life_s: float,
    event: Callable[[Any], ServerSentEvent],
) -> AsyncIterator[ServerSentEvent]:
    """Yield an event for each change until there will be no more, at most for `life_s`."""
    yield ServerSentEvent(retry=RETRY_MS)
    clock = asyncio.get_running_loop().time
    end_s = clock() + life_s
    while (standing := await watch.news(end_s - clock())) is not None:
        if standing.mark != last_event_id:
            yield event(standing)
        last_event_id = None
        if standing.is_final:
            return


def progress_event(standing: Standing, language: Language) -> ServerSentEvent:
    """Return the event that says where a submission stands."""
    view = ProgressView(
        status=standing.state,
        text=status_word(standing.state, language),
        open=not standing.is_final,
        queue_position=standing.position,
        estimated_finish_at=standing.estimated_at,
    )
    return ServerSentEvent(data=view, event="progress", id=standing.mark)


def owner_of(caller: Caller, otherwise: str) -> Owner:
    """Return who the caller's streams count for; `otherwise` names a caller without a token."""
    name = name_of(caller)
    return Owner(name=name or otherwise, is_known=name is not None)


async def _watched_submission(
    errand: ErrandDep, request: Request, submission_id: SubmissionId, last_event_id: LastEventId = None
) -> AsyncIterator[SubjectWatch]:
    owner = owner_of(errand.caller, f"submission {submission_id}")
    async with watched(
        request, errand.services, ("submission", submission_id), owner, last_event_id
    ) as watch:
        yield watch


async def _watched_class(
    errand: StaffDep, request: Request, last_event_id: LastEventId = None
) -> AsyncIterator[SubjectWatch]:
    owner = owner_of(errand.caller, "")
    async with watched(
        request, errand.services, ("class", errand.caller.course), owner, last_event_id
    ) as watch:
        yield watch


@submission.get(
    "/{submission_id}/events",
    summary="A submission's way, as it happens",
    response_class=EventSourceResponse,
    responses={
        200: {"description": "Events `progress` (their data: `ProgressView`) until it is graded."},
        204: {"description": "Nothing more will happen, and the last event was received."},
        **responses("submission_not_found", "invalid_request", *_PROBLEMS),
    },
)
async def follow_submission(
    services: ServicesDep,
    watch: Annotated[SubjectWatch, Depends(_watched_submission)],
    language: LanguageDep,
    last_event_id: LastEventId = None,
) -> AsyncIterator[ServerSentEvent]:
    """Send the state, the place in the queue and the estimate whenever they change; ends when it is graded."""
    life_s = services.watching.limits.life_s
    async for event in events(watch, last_event_id, life_s, lambda one: progress_event(one, language)):
        yield event


@dashboard.get(
    "/events",
    summary="The class, as it happens",
    response_class=EventSourceResponse,
    responses={
        200: {"description": "Events `class` (their data: `ClassProgressView`) until the client goes."},
        **responses("forbidden", "invalid_request", *_PROBLEMS),
    },
)
async def follow_class(
    services: ServicesDep,
    watch: Annotated[SubjectWatch, Depends(_watched_class)],
    last_event_id: LastEventId = None,
) -> AsyncIterator[ServerSentEvent]:
    """Send how many submissions are in which state whenever the dashboard may have changed."""
    life_s = services.watching.limits.life_s
    async for event in events(watch, last_event_id, life_s, _class_event):
        yield event


def _class_event(standing: ClassStanding) -> ServerSentEvent:
    view = ClassProgressView(
        queued=standing.queued,
        running=standing.running,
        graded=standing.graded,
        infrastructure_error=standing.infrastructure_errors,
    )
    return ServerSentEvent(data=view, event="class", id=standing.mark)
