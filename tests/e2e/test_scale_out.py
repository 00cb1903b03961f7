"""One API process and two workers on PostgreSQL, as an operator starts them; one is killed while it grades."""

import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
from sqlalchemy import text
from sqlmodel import Session

from grader.store.database import Database
from tests.fakes.prepared import Forked, Prepared
from tests.fakes.waiting import wait_until

ROOT = Path(__file__).resolve().parents[2]
PATIENCE_S = 120.0  # only ever waited for in full when a test fails
QUICK = {"GRADER_LEASE_S": "3", "GRADER_HEARTBEAT_S": "0.5", "GRADER_INSTRUCTOR_TOKEN": "3q9fKx72LmVb0pTzQQ"}
_END_STORING = (
    "SELECT pg_terminate_backend(pid, 60000) FROM pg_locks"
    " WHERE relation = 'grading'::regclass AND NOT granted"
)


@contextmanager
def process(
    prepared: Prepared, log_file: Path, url: str, *arguments: str, module: str = "grader"
) -> Iterator[Forked]:
    settings = {**QUICK, "GRADER_DATABASE_URL": url}
    with log_file.open("ab") as log:
        started = prepared.start(module, *arguments, log=log.fileno(), **settings)
    with started:
        try:
            yield started
        finally:
            started.send_signal(signal.SIGTERM)
            assert started.wait() in (0, -signal.SIGKILL)


@contextmanager
def serving(prepared: Prepared, folder: Path, url: str, module: str = "grader") -> Iterator[httpx.Client]:
    log = folder / "serve.log"
    log.touch()
    with process(prepared, log, url, "serve", "--port", "0", "--slots", "0", module=module):
        wait_until(lambda: re.search(r"http://127\.0\.0\.1:\d+", log.read_text()), PATIENCE_S)
        address = re.search(r"http://127\.0\.0\.1:\d+", log.read_text())
        assert address is not None
        # a connection that rests for long may end just when the next request is sent
        limits = httpx.Limits(max_keepalive_connections=0)
        with httpx.Client(
            base_url=address.group(), timeout=PATIENCE_S, trust_env=False, limits=limits
        ) as client:
            yield client


def upload(client: httpx.Client, student: str, source: bytes) -> str:
    answer = client.post(
        "/api/v1/submissions",
        files={"file": ("hello_node.py", source)},
        data={"assignment": "hello", "student": student},
    )
    assert answer.status_code == 202, answer.text
    return str(answer.headers["Location"])


def grading_pid(session: Session) -> int | None:
    worker = session.execute(text("SELECT worker FROM submission WHERE state = 'running'")).scalar()
    return int(worker.split(":")[1]) if worker else None


def test_a_worker_killed_while_it_grades_costs_nobody_a_grading(
    postgres_url: str, tmp_path: Path, prepared: Prepared
) -> None:
    hello = (ROOT / "lesson" / "hello_node.py").read_bytes()
    database = Database(postgres_url)
    with serving(prepared, tmp_path, postgres_url) as client:
        urls = [upload(client, "first", hello)]
        logs = [tmp_path / "one.log", tmp_path / "other.log"]
        worker = (postgres_url, "worker", "--slots", "1")
        with process(prepared, logs[0], *worker) as one, process(prepared, logs[1], *worker) as other:
            with database.writing() as session:
                session.execute(text("LOCK grading IN SHARE MODE"))  # no result is stored before the kill
                wait_until(lambda: grading_pid(session), PATIENCE_S, pause_s=0.05)
                pid = grading_pid(session)
                victim, survivors_log = (one, logs[1]) if one.pid == pid else (other, logs[0])
                victim.kill()
                victim.wait()
                session.execute(text(_END_STORING))
            urls += [upload(client, f"s{number}", hello) for number in range(3)]
            wait_until(
                lambda: all(client.get(url).json()["status"] == "graded" for url in urls),
                PATIENCE_S,
                pause_s=0.25,  # a lease runs out meanwhile
            )
        documents = [client.get(url).json() for url in urls]
        assert {document["score"] for document in documents} == {documents[0]["max_score"]}
    with database.reading() as session:
        gradings = session.execute(text("SELECT count(*), count(DISTINCT submission_id) FROM grading")).one()
        attempts = (
            session.execute(text("SELECT attempt FROM submission ORDER BY received_at")).scalars().all()
        )
    database.close()
    assert tuple(gradings) == (len(urls), len(urls))
    assert attempts == [2, 1, 1, 1]
    assert "Traceback" not in survivors_log.read_text()
