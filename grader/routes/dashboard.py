"""The class at a glance, for instructors."""

import hashlib
import json
from dataclasses import asdict
from typing import Annotated

from fastapi import APIRouter, Header, Query, Response

from grader.contracts.dashboard import ClassState
from grader.contracts.identity import Caller, Role
from grader.contracts.text import Language
from grader.routes.dashboard_document import Selection, overview, selected
from grader.routes.dashboard_views import DashboardView
from grader.routes.dependencies import ENTRY_PROBLEMS, LanguageDep, QueryWhole, ServicesDep, StaffDep
from grader.routes.health import worker_views
from grader.routes.problems import responses
from grader.use_cases.services import Services

router = APIRouter(prefix="/api/v1/dashboard", tags=["dashboard"])
_MOST = 100_000


@router.get(
    "",
    summary="The class at a glance",
    response_model=DashboardView,
    responses={
        200: {
            "headers": {"ETag": {"description": "Of everything but instants.", "schema": {"type": "string"}}}
        },
        304: {"description": "Nothing changed since the answer with the ETag of If-None-Match."},
        **responses(*ENTRY_PROBLEMS, "forbidden", "invalid_request"),
    },
)
def read_class(  # noqa: PLR0913
    services: ServicesDep,
    caller: StaffDep,
    language: LanguageDep,
    *,
    search: Annotated[str, Query(max_length=100, description="Only students whose id contains this.")] = "",
    at_risk: Annotated[bool, Query(description="Only students who have not started or are stuck.")] = False,
    offset: Annotated[QueryWhole, Query(ge=0, le=_MOST, description="Students left out at the start.")] = 0,
    limit: Annotated[
        QueryWhole | None, Query(ge=1, le=_MOST, description="Most students; null: all.")
    ] = None,
    if_none_match: Annotated[str | None, Header(max_length=1_000)] = None,
) -> Response:
    """Return students by assignments, what each assignment shows about the class, and the queue.

    Filters and pages choose students; the statistics are always about everybody.
    """
    selection = Selection(search=search, at_risk=at_risk, offset=offset, limit=limit)
    state = services.dashboard.state(caller.course)
    tag = _tag(services, state, language, selection)
    headers = {
        "Content-Language": language,
        "Vary": "Accept-Language, Authorization",
        "Cache-Control": "private, no-cache",
        "ETag": tag,
    }
    if if_none_match is not None and tag in (one.strip() for one in if_none_match.split(",")):
        return Response(status_code=304, headers=headers)
    document = selected(class_overview(services, caller, state, language), selection).model_dump_json()
    return Response(document, media_type="application/json", headers=headers)  # checked when it was made


def class_overview(
    services: Services, caller: Caller, state: ClassState, language: Language
) -> DashboardView:
    """Return the whole class in `state`."""
    roster = services.courses.members(caller.course, Role.STUDENT)
    return overview(
        state,
        services.assignments.all(),
        services.queue.state(),
        worker_views(services.workers.alive(services.settings.silent_s)),
        roster=tuple(member.id for member in roster),
        generated_at=services.clock(),
        pass_fraction=services.settings.pass_fraction,
        language=language,
    )


def _tag(services: Services, state: ClassState, language: Language, selection: Selection) -> str:
    """Return a weak ETag of everything shown but the instants of this answer and of heartbeats."""
    alive = worker_views(services.workers.alive(services.settings.silent_s))
    workers = [worker.model_dump(mode="json", exclude={"seen_at"}) for worker in alive]
    versions = [(one.id, one.version, one.title.get(language)) for one in services.assignments.all()]
    queue = asdict(services.queue.state())
    shown = [
        state.mark,
        queue,
        workers,
        versions,
        language,
        services.settings.pass_fraction,
        asdict(selection),
    ]
    return f'W/"{hashlib.sha256(json.dumps(shown, default=str).encode()).hexdigest()[:32]}"'
