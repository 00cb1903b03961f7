"""A service whose workers need no physics, and as a module a process of one that can be killed.

    python -m tests.fakes.mortal URL

serves the database at the address URL until it is killed; its own address is the first line that it prints.
"""

import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import uvicorn

from grader.api import create_app
from grader.contracts.grading import SandboxState
from grader.operation.settings import Settings
from grader.service.worker import Worker, WorkerConfig, WorkerParts
from grader.store.clock import utc_now
from grader.store.workers import presence
from grader.use_cases.services import Services
from tests.fakes import server
from tests.fakes.grading import FakeGrader

LEASE_S, HEARTBEAT_S = 1.5, 0.3  # of gradings without physics


def worker_of(services: Services, config: WorkerConfig) -> Worker:
    """Return a worker in this process."""
    parts = WorkerParts(
        queue=services.queue,
        workers=services.workers,
        assignments=services.assignments,
        make_grader=FakeGrader,
        probe=lambda: SandboxState(ready=True, isolation="fake"),
        doorbell=services.doorbell,
        clock=services.clock,
        metrics=services.metrics,
    )
    return Worker(parts, config)


def _serve(url: str) -> None:
    @contextmanager
    def services() -> Iterator[Services]:
        with (
            server.services(Settings(database_url=url), utc_now, lease_s=LEASE_S) as made,
            presence(url, lambda: made.queue.reconcile(all_running=True)),
        ):
            worker = worker_of(made, WorkerConfig(slots=2, heartbeat_s=HEARTBEAT_S))
            worker.start()
            yield made
            worker.stop()

    listener = socket.create_server(("127.0.0.1", 0), backlog=64)
    print(f"http://127.0.0.1:{listener.getsockname()[1]}", flush=True)
    # what is sent before the server answers waits in the socket
    uvicorn.Server(uvicorn.Config(create_app(services), log_config=None)).run(sockets=[listener])


if __name__ == "__main__":
    _serve(sys.argv[1])
