"""The whole service over HTTP with a grader that needs no physics: upload, grade, restart, look again."""

import hashlib
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest

from grader.api import create_app
from grader.contracts.grading import SandboxState
from grader.settings import Settings
from grader.store.clock import utc_now
from grader.store.workers import presence
from grader.use_cases.services import Services
from grader.worker import Worker, WorkerConfig, WorkerParts
from tests.fakes import server
from tests.fakes.grading import FakeGrader
from tests.fakes.waiting import wait_until

ROOT = Path(__file__).resolve().parents[2]
INSTRUCTOR = {"Authorization": f"Bearer {server.TOKEN}"}
PATIENCE_S = 60.0  # only ever waited for in full when a test fails
SCRIPTS = {f"s{number}": f"good {'good' * (number % 2)} # {number}\n".encode() for number in range(12)}


def _worker(services: Services, config: WorkerConfig) -> Worker:
    parts = WorkerParts(
        queue=services.queue,
        workers=services.workers,
        assignments=services.assignments,
        make_grader=FakeGrader,
        probe=lambda: SandboxState(ready=True, isolation="fake"),
        doorbell=services.doorbell,
        clock=services.clock,
    )
    return Worker(parts, config)


@contextmanager
def opened(url: str, slots: int = 2) -> Iterator[tuple[Services, httpx.Client]]:
    """Run everything but physics: store, workers in threads, HTTP."""
    with server.services(Settings(database_url=url), utc_now) as services:
        worker = _worker(services, WorkerConfig(slots=slots))
        worker.start()
        try:
            with server.serving(server.application(services)) as client:
                yield services, client
        finally:
            worker.stop()


def upload(client: httpx.Client, student: str, source: bytes) -> str:
    response = client.post(
        "/api/v1/submissions",
        files={"file": ("square.py", source)},
        data={"assignment": "square", "student": student},
    )
    assert response.status_code == 202, response.text
    return response.headers["Location"]


def scores(client: httpx.Client) -> dict[str, float]:
    document = client.get("/api/v1/dashboard", headers=INSTRUCTOR).json()
    return {one["student"]: one["assignments"]["square"]["best_score"] for one in document["students"]}


def test_a_class_is_graded_and_remembered(database_url: str) -> None:
    with opened(database_url) as (_, client):
        urls = {student: upload(client, student, source) for student, source in SCRIPTS.items()}
        wait_until(
            lambda: all(client.get(url).json()["status"] == "graded" for url in urls.values()), PATIENCE_S
        )
        assert client.get("/healthz").json()["status"] == "ok"
        before = scores(client)
        reports = {student: client.get(url + "/report").content for student, url in urls.items()}
    assert before == {student: 5.0 * source.count(b"good") for student, source in SCRIPTS.items()}
    with opened(database_url, slots=0) as (_, client):
        assert scores(client) == before
        assert client.get("/healthz").status_code == 503
        for student, url in urls.items():
            assert client.get(url + "/report").content == reports[student]
            assert client.get(url).json()["sha256"] == hashlib.sha256(SCRIPTS[student]).hexdigest()
            assert client.get(url + "/trajectory").json()["end_ns"] == 2_000_000_000


def test_what_waits_at_a_restart_is_graded_after_it(sqlite_url: str) -> None:
    with opened(sqlite_url, slots=0) as (_, client):
        urls = [upload(client, student, source) for student, source in SCRIPTS.items()]
    with opened(sqlite_url) as (_, client):
        wait_until(lambda: all(client.get(url).json()["status"] == "graded" for url in urls), PATIENCE_S)


SERVERS = """
import os, socket, sys
import uvicorn
from tests.e2e.test_service import application_in
listener = socket.socket(fileno=int(sys.argv[1]))
for url in sys.stdin:
    if (child := os.fork()) == 0:
        uvicorn.Server(uvicorn.Config(application_in(url.strip()), log_config=None)).run(sockets=[listener])
        os._exit(0)
    print(child, flush=True)
    os.waitpid(child, 0)
    print("gone", flush=True)
"""
LEASE_S, HEARTBEAT_S = 1.5, 0.3  # of gradings without physics


def application_in(url: str):
    """Return an application whose workers live in this very process, to be killed with it."""

    @contextmanager
    def services() -> Iterator[Services]:
        with (
            server.services(Settings(database_url=url), utc_now, lease_s=LEASE_S) as made,
            presence(url, lambda: made.queue.reconcile(all_running=True)),
        ):
            worker = _worker(made, WorkerConfig(slots=2, heartbeat_s=HEARTBEAT_S))
            worker.start()
            yield made
            worker.stop()

    return create_app(services)


@dataclass(frozen=True)
class Servers:
    """Starts servers, each a fork of one prepared process. The socket they listen to outlives them."""

    origin: subprocess.Popen[str]
    address: str

    @contextmanager
    def client(self, url: str) -> Iterator[httpx.Client]:
        """Yield a client of a server that is killed when the context ends."""
        self.origin.stdin.write(url + "\n")
        self.origin.stdin.flush()
        pid = int(self.origin.stdout.readline())
        try:
            # what is sent before the server answers waits in the socket
            with httpx.Client(base_url=self.address, timeout=PATIENCE_S, trust_env=False) as client:
                yield client
        finally:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
            assert self.origin.stdout.readline() == "gone\n"


@pytest.fixture(scope="module")
def servers() -> Iterator[Servers]:
    with socket.create_server(("127.0.0.1", 0), backlog=64) as listener:
        command = [sys.executable, "-c", SERVERS, str(listener.fileno())]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        with subprocess.Popen(
            command, pass_fds=(listener.fileno(),), env=environment, text=True, **pipes
        ) as origin:
            yield Servers(origin, f"http://127.0.0.1:{listener.getsockname()[1]}")
            origin.stdin.close()


def test_killing_the_server_at_any_moment_loses_nothing(servers: Servers, sqlite_url: str) -> None:
    accepted: dict[str, tuple[str, bytes]] = {}
    students = iter(range(1000))
    for round_number in range(2):
        with servers.client(sqlite_url) as client:
            for _ in range(4 + 4 * round_number):
                student = f"s{next(students)}"
                source = f"good # {student}\n".encode()
                accepted[student] = (upload(client, student, source), source)
        # some are graded, some under way, some wait
    with servers.client(sqlite_url) as client:
        wait_until(
            lambda: all(client.get(url).json()["status"] == "graded" for url, _ in accepted.values()),
            PATIENCE_S,
            pause_s=HEARTBEAT_S / 2,  # leases run out meanwhile, and each look takes a request for each file
        )
        for url, source in accepted.values():
            assert client.get(url).json()["sha256"] == hashlib.sha256(source).hexdigest()
        assert scores(client) == dict.fromkeys(accepted, 5.0)
