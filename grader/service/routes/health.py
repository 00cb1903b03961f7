"""Whether the service can do its work."""

from collections.abc import Iterable, Sequence
from datetime import datetime
from typing import Literal

from fastapi import APIRouter, Response
from pydantic import Field

from grader import __version__
from grader.contracts.submission import WorkerState
from grader.service.requests.dependencies import ServicesDep
from grader.service.routes.problems import public_responses
from grader.service.routes.views import View
from grader.use_cases.services import ServiceHealth

router = APIRouter(tags=["health"])


class SandboxView(View):
    """Whether submissions can be confined; nothing is graded otherwise."""

    ready: bool
    isolation: str = Field(description="Mode or active layers.", examples=["seccomp+landlock"])
    detail: str = Field(description="What is missing; empty when all is well.", examples=[""])


class QueueView(View):
    """Submissions by state."""

    queued: int = Field(examples=[0])
    running: int = Field(examples=[1])
    infrastructure_error: int = Field(
        validation_alias="infrastructure_errors",
        description="Given up by the service's own fault.",
        examples=[0],
    )


class WorkerView(View):
    """A worker process that is alive."""

    id: str = Field(examples=["lab-pc:4711:9f2c01aa"])
    slots: int = Field(description="Gradings it can run at once.", examples=[2])
    busy: int = Field(examples=[1])
    sandbox: SandboxView
    started_at: datetime
    seen_at: datetime


class Health(View):
    """State of the service."""

    status: Literal["ok", "degraded"] = Field(
        description="`degraded`: uploads are kept, but nothing grades them right now; or the disk is full."
    )
    detail: str = Field(description="What is wrong with the disk; empty when nothing is.", examples=[""])
    version: str = Field(examples=["0.1.0"])
    sandbox: SandboxView
    queue: QueueView
    oldest_queued_at: datetime | None = Field(description="Since when the first one has been waiting.")
    workers: list[WorkerView]
    broken_assignments: list[str] = Field(
        description="Ids of assignments whose files are wrong; the service page says why.", examples=[[]]
    )


@router.get(
    "/healthz",
    summary="State of the service",
    responses={
        503: {"model": Health, "description": "Degraded: uploads are kept, nothing grades them right now."},
        **{status: one for status, one in public_responses().items() if status != 503},
    },
)
def read(services: ServicesDep, response: Response) -> Health:
    """Return queue, workers and sandbox; 503 when nothing would be graded."""
    health = services.health()
    fine = bool(health.ready) and not health.disk_is_full
    response.status_code = 200 if fine else 503
    response.headers["Cache-Control"] = "no-store"
    return Health(
        status="ok" if fine else "degraded",
        detail=_of_disk(health),
        version=__version__,
        sandbox=_sandbox(health.ready or health.workers),
        queue=QueueView.of(health.queue),
        oldest_queued_at=health.queue.oldest_queued_at,
        workers=worker_views(health.workers),
        broken_assignments=sorted(services.assignments.of(None).troubles()),
    )


def _of_disk(health: ServiceHealth) -> str:
    if not health.disk_is_full or health.free_bytes is None:
        return ""
    return f"the disk of the database is full: {health.free_bytes / 1e6:.0f} MB are left; uploads are refused"


def worker_views(workers: Iterable[WorkerState]) -> list[WorkerView]:
    """Return workers as the interface shows them."""
    return [WorkerView.of(worker, sandbox=_sandbox((worker,))) for worker in workers]


def _sandbox(workers: Sequence[WorkerState]) -> SandboxView:
    """Return the sandbox of the first worker."""
    if not workers:
        return SandboxView(ready=False, isolation="", detail="no worker is alive")
    first = workers[0]
    return SandboxView(ready=first.sandbox_ready, isolation=first.isolation, detail=first.detail)
