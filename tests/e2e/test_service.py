"""The whole service over HTTP with a grader that needs no physics: upload, grade, restart, look again."""

import hashlib
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx

from grader.api import create_app
from grader.contracts.grading import SandboxState
from grader.routes.services import Services
from grader.settings import Settings
from grader.store.columns import utc_now
from grader.store.database import Database
from grader.store.schema import migrate
from grader.store.workers import presence
from grader.worker import Worker, WorkerConfig, WorkerParts
from tests.fakes import server
from tests.fakes.grading import FakeGrader
from tests.fakes.waiting import wait_until

ROOT = Path(__file__).resolve().parents[2]
INSTRUCTOR = {"Authorization": f"Bearer {server.TOKEN}"}
PATIENCE_S = 60.0  # only ever waited for in full when a test fails
SCRIPTS = {f"s{number}": f"good {'good' * (number % 2)} # {number}\n".encode() for number in range(12)}


@contextmanager
def opened(url: str, slots: int = 2) -> Iterator[tuple[Services, httpx.Client]]:
    """Run everything but physics: store, workers in threads, HTTP."""
    services = server.services(Settings(database_url=url), utc_now)
    parts = WorkerParts(
        queue=services.queue,
        workers=services.workers,
        assignments=services.assignments,
        make_grader=FakeGrader,
        probe=lambda: SandboxState(ready=True, isolation="fake"),
        doorbell=services.doorbell,
        clock=services.clock,
    )
    worker = Worker(parts, WorkerConfig(slots=slots))
    worker.start()
    try:
        with server.serving(server.application(services)) as client:
            yield services, client
    finally:
        worker.stop()
        services.plots.close()
        services.submissions._database.close()


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


def test_what_waits_at_a_restart_is_graded_after_it(database_url: str) -> None:
    with opened(database_url, slots=0) as (_, client):
        urls = [upload(client, student, source) for student, source in SCRIPTS.items()]
    with opened(database_url) as (_, client):
        wait_until(lambda: all(client.get(url).json()["status"] == "graded" for url in urls), PATIENCE_S)


SERVER = """
import socket, sys
import uvicorn
from tests.e2e.test_service import application_in
listener = socket.socket(fileno=int(sys.argv[2]))
uvicorn.Server(uvicorn.Config(application_in(sys.argv[1]), log_config=None)).run(sockets=[listener])
"""


def application_in(folder: str):
    """Return an application whose workers live in this very process, to be killed with it."""

    @contextmanager
    def services() -> Iterator[Services]:
        settings = Settings(database_url=f"sqlite:///{folder}/grader.db")
        made = server.services(settings, utc_now)
        parts = WorkerParts(
            queue=made.queue,
            workers=made.workers,
            assignments=made.assignments,
            make_grader=FakeGrader,
            probe=lambda: SandboxState(ready=True),
            doorbell=made.doorbell,
            clock=made.clock,
        )
        with presence(settings.database_url, lambda: made.queue.reconcile(all_running=True)):
            worker = Worker(parts, WorkerConfig(slots=2))
            worker.start()
            yield made
            worker.stop()

    return create_app(services)


@contextmanager
def server_process(folder: Path, listener: socket.socket) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(
        [sys.executable, "-c", SERVER, str(folder), str(listener.fileno())],
        pass_fds=(listener.fileno(),),
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def test_killing_the_server_at_any_moment_loses_nothing(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'grader.db'}")
    migrate(database)
    database.close()
    accepted: dict[str, tuple[str, bytes]] = {}
    students = iter(range(1000))
    # the listening socket outlives the servers, so clients of the next one queue up in it
    with socket.create_server(("127.0.0.1", 0), backlog=64) as listener:
        base = f"http://127.0.0.1:{listener.getsockname()[1]}"
        for round_number in range(2):
            with (
                server_process(tmp_path, listener) as process,
                httpx.Client(base_url=base, timeout=PATIENCE_S, trust_env=False) as client,
            ):
                for _ in range(4 + 4 * round_number):
                    student = f"s{next(students)}"
                    source = f"good # {student}\n".encode()
                    accepted[student] = (upload(client, student, source), source)
                process.send_signal(signal.SIGKILL)  # some are graded, some under way, some wait
        with (
            server_process(tmp_path, listener),
            httpx.Client(base_url=base, timeout=PATIENCE_S, trust_env=False) as client,
        ):
            wait_until(
                lambda: all(client.get(url).json()["status"] == "graded" for url, _ in accepted.values()),
                PATIENCE_S,
            )
            for url, source in accepted.values():
                assert client.get(url).json()["sha256"] == hashlib.sha256(source).hexdigest()
            assert scores(client) == dict.fromkeys(accepted, 5.0)
