"""What the routes work with, handed to them by the composition root."""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request

from grader.contracts.grading import AssignmentSource, Preflight
from grader.routes.access import InstructorGate
from grader.routes.plots import PlotCache
from grader.settings import Settings
from grader.store.columns import Clock
from grader.store.dashboard import Dashboard
from grader.store.doorbell import Doorbell
from grader.store.queue import Queue
from grader.store.submissions import Submissions
from grader.store.workers import Workers


@dataclass(frozen=True, slots=True, kw_only=True)
class Services:
    """Everything an endpoint may use."""

    settings: Settings
    assignments: AssignmentSource
    submissions: Submissions
    queue: Queue
    workers: Workers
    dashboard: Dashboard
    preflight: Preflight
    plots: PlotCache
    gate: InstructorGate
    doorbell: Doorbell
    clock: Clock


def _services(request: Request) -> Services:
    services: Services = request.app.state.services
    return services


ServicesDep = Annotated[Services, Depends(_services)]
