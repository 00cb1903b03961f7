"""The class at a glance, for instructors."""

from fastapi import APIRouter, Response

from grader.routes.access import ENTRY_PROBLEMS, StaffDep
from grader.routes.dashboard_views import DashboardView, overview
from grader.routes.health import alive
from grader.routes.problems import responses
from grader.routes.services import ServicesDep
from grader.routes.submissions import LanguageDep

router = APIRouter(prefix="/api/v1/dashboard", tags=["dashboard"])


@router.get(
    "", summary="The class at a glance", responses=responses(*ENTRY_PROBLEMS, "forbidden", "invalid_request")
)
def read(services: ServicesDep, caller: StaffDep, response: Response, language: LanguageDep) -> DashboardView:
    """Return students by assignments, what each assignment shows about the class, and the queue."""
    response.headers.update(
        {"Content-Language": language, "Vary": "Accept-Language, Authorization", "Cache-Control": "no-store"}
    )
    return overview(
        services.dashboard.state(caller.course),
        services.assignments.all(),
        services.queue.state(),
        alive(services),
        generated_at=services.clock(),
        pass_fraction=services.settings.pass_fraction,
        language=language,
    )
