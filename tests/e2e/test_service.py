"""The whole service over HTTP with a grader that needs no physics: upload, grade, restart, look again."""

import hashlib
import signal
from collections.abc import Iterator
from contextlib import contextmanager

import httpx

from grader.operation.settings import Settings
from grader.service.worker import WorkerConfig
from grader.store.clock import utc_now
from grader.use_cases.services import Services
from tests.fakes import server
from tests.fakes.mortal import HEARTBEAT_S, worker_of
from tests.fakes.prepared import Prepared
from tests.fakes.waiting import wait_until

INSTRUCTOR = {"Authorization": f"Bearer {server.TOKEN}"}
PATIENCE_S = 60.0  # only ever waited for in full when a test fails
SCRIPTS = {f"s{number}": f"good {'good' * (number % 2)} # {number}\n".encode() for number in range(12)}


@contextmanager
def opened(url: str, slots: int = 2) -> Iterator[tuple[Services, httpx.Client]]:
    """Run everything but physics: store, workers in threads, HTTP."""
    with server.services(Settings(database_url=url), utc_now) as services:
        worker = worker_of(services, WorkerConfig(slots=slots))
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


@contextmanager
def mortal(prepared: Prepared, url: str) -> Iterator[httpx.Client]:
    """Yield a client of a server that is killed when the context ends, its workers with it."""
    with (
        prepared.start("tests.fakes.mortal", url) as served,
        httpx.Client(
            base_url=served.stderr.readline().strip(), timeout=PATIENCE_S, trust_env=False
        ) as client,
    ):
        yield client
        served.kill()
        assert served.wait() == -signal.SIGKILL


def test_killing_the_server_at_any_moment_loses_nothing(prepared: Prepared, sqlite_url: str) -> None:
    accepted: dict[str, tuple[str, bytes]] = {}
    students = iter(range(1000))
    for round_number in range(2):
        with mortal(prepared, sqlite_url) as client:
            for _ in range(4 + 4 * round_number):
                student = f"s{next(students)}"
                source = f"good # {student}\n".encode()
                accepted[student] = (upload(client, student, source), source)
        # some are graded, some under way, some wait
    with mortal(prepared, sqlite_url) as client:
        wait_until(
            lambda: all(client.get(url).json()["status"] == "graded" for url, _ in accepted.values()),
            PATIENCE_S,
            pause_s=HEARTBEAT_S / 2,  # leases run out meanwhile, and each look takes a request for each file
        )
        for url, source in accepted.values():
            assert client.get(url).json()["sha256"] == hashlib.sha256(source).hexdigest()
        assert scores(client) == dict.fromkeys(accepted, 5.0)
