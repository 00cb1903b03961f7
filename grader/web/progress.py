"""A submission's way as it happens, for the page that waits: `grader.routes.events` for visitors with cookies."""

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Depends, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.sse import EventSourceResponse, ServerSentEvent

from grader.routes.dependencies import ServicesDep, SubmissionId
from grader.routes.events import LastEventId, events, owner_of, progress_event, watched
from grader.use_cases.following import Watch
from grader.web import access
from grader.web.access import VisitorDep
from grader.web.pages import language_of

router = APIRouter(prefix="/submissions/{submission_id}", include_in_schema=False)


async def _watched(
    request: Request,
    services: ServicesDep,
    visitor: VisitorDep,
    submission_id: SubmissionId,
    last_event_id: LastEventId = None,
) -> AsyncIterator[Watch]:
    await run_in_threadpool(access.seen, services, visitor, submission_id)
    owner = owner_of(visitor.caller, f"visitor {visitor.student}")
    async with watched(request, services, ("submission", submission_id), owner, last_event_id) as watch:
        yield watch


@router.get("/events", response_class=EventSourceResponse)
async def follow(
    request: Request,
    services: ServicesDep,
    watch: Annotated[Watch, Depends(_watched)],
    last_event_id: LastEventId = None,
) -> AsyncIterator[ServerSentEvent]:
    """Send where the submission stands whenever that changes; ends when it is graded."""
    language, life_s = language_of(request), services.watching.limits.life_s
    async for event in events(watch, last_event_id, life_s, lambda one: progress_event(one, language)):
        yield event
