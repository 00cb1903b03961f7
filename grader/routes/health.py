"""Whether the service can do its work."""

from datetime import datetime
from typing import Literal

from fastapi import APIRouter, Response
from pydantic import BaseModel, Field

from grader import __version__
from grader.contracts.submission import QueueState, WorkerState
from grader.routes.dependencies import ServicesDep
from grader.routes.problems import responses
from grader.use_cases.services import Services

router = APIRouter(tags=["health"])


class SandboxView(BaseModel):
    """Whether submissions can be confined; nothing is graded otherwise."""

    ready: bool
    isolation: str = Field(description="Mode or active layers.", examples=["seccomp+landlock"])
    detail: str = Field(description="What is missing; empty when all is well.", examples=[""])


class QueueView(BaseModel):
    """Submissions by state."""

    queued: int = Field(examples=[0])
    running: int = Field(examples=[1])
    infrastructure_error: int = Field(description="Given up by the service's own fault.", examples=[0])


class WorkerView(BaseModel):
    """A worker process that is alive."""

    id: str = Field(examples=["lab-pc:4711:9f2c01aa"])
    slots: int = Field(description="Gradings it can run at once.", examples=[2])
    busy: int = Field(examples=[1])
    sandbox: SandboxView
    started_at: datetime
    seen_at: datetime


class Health(BaseModel):
    """State of the service."""

    status: Literal["ok", "degraded"] = Field(
        description="`degraded`: uploads are accepted and kept, but nothing grades them right now."
    )
    version: str = Field(examples=["0.1.0"])
    sandbox: SandboxView
    queue: QueueView
    oldest_queued_at: datetime | None = Field(description="Since when the first one has been waiting.")
    workers: list[WorkerView]


@router.head("/healthz", include_in_schema=False)  # what many monitors send
@router.get(
    "/healthz",
    summary="State of the service",
    responses={
        503: {"model": Health, "description": "Degraded: uploads are kept, nothing grades them right now."},
        **{status: one for status, one in responses().items() if status != 503},
    },
)
def read(services: ServicesDep, response: Response) -> Health:
    """Return queue, workers and sandbox; 503 when nothing would be graded."""
    health = health_of(services)
    response.status_code = 200 if health.status == "ok" else 503
    response.headers["Cache-Control"] = "no-store"
    return health


def health_of(services: Services) -> Health:
    """Return queue, workers and sandbox."""
    workers = alive(services)
    ready = [worker for worker in workers if worker.sandbox.ready and worker.slots > 0]
    state = services.queue.state()
    return Health(
        status="ok" if ready else "degraded",
        version=__version__,
        sandbox=_sandbox(ready or workers),
        queue=queue_view(state),
        oldest_queued_at=state.oldest_queued_at,
        workers=workers,
    )


def queue_view(state: QueueState) -> QueueView:
    """Return how much is waiting, as the interface shows it."""
    return QueueView(
        queued=state.queued, running=state.running, infrastructure_error=state.infrastructure_errors
    )


def alive(services: Services) -> list[WorkerView]:
    """Return the workers that were heard of lately."""
    return [_worker(state) for state in services.workers.alive(services.settings.silent_s)]


def _worker(state: WorkerState) -> WorkerView:
    sandbox = SandboxView(ready=state.sandbox_ready, isolation=state.isolation, detail=state.detail)
    return WorkerView(
        id=state.id,
        slots=state.slots,
        busy=state.busy,
        sandbox=sandbox,
        started_at=state.started_at,
        seen_at=state.seen_at,
    )


def _sandbox(workers: list[WorkerView]) -> SandboxView:
    if not workers:
        return SandboxView(ready=False, isolation="", detail="no worker is alive")
    return workers[0].sandbox
