"""Stopping `grader serve` while it grades and is watched: a real process, the real sandbox."""

import json
import os
import signal
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import httpx
import pytest

from grader.contracts.submission import SubmissionState
from grader.store.clock import utc_now
from grader.store.database import Database
from grader.store.occupancy import alone
from tests.conftest import first_on_sqlite
from tests.fakes.prepared import Forked, Prepared
from tests.fakes.submissions import Submissions
from tests.fakes.waiting import wait_until

TOKEN = "3q9fKx72LmVb0pTzQQ"
PATIENCE_S = 120.0  # only ever waited for in full when the test fails
BUSY = "number = 0\nwhile True:\n    number += 1  # {}\n"


@pytest.fixture
def process(database_url: str, prepared: Prepared) -> Iterator[Forked]:
    settings = {
        "GRADER_DATABASE_URL": database_url,
        "GRADER_INSTRUCTOR_TOKEN": TOKEN,
        "GRADER_LOG_FORMAT": "json",
        "GRADER_DRAIN_S": "0.1",
        "GRADER_POLL_S": "0.1",
    }
    with prepared.start("grader", "serve", "--port", "0", "--slots", "1", **settings) as started:
        yield started


@first_on_sqlite
def test_told_to_stop_it_ends_streams_returns_gradings_and_loses_nothing(
    process: Forked, database_url: str
) -> None:
    said = (json.loads(line)["message"] for line in process.stderr)
    address = next(one for one in said if one.startswith("listening on ")).removeprefix("listening on ")
    with httpx.Client(base_url=address, timeout=PATIENCE_S, trust_env=False) as client:
        ids = [_upload(client, number) for number in range(2)]
        headers = {"Authorization": f"Bearer {TOKEN}"}
        with (
            client.stream("GET", f"/api/v1/submissions/{ids[0]}/events") as progress,
            client.stream("GET", "/api/v1/dashboard/events", headers=headers) as dashboard,
        ):
            lines, others = progress.iter_lines(), dashboard.iter_lines()
            while '"running"' not in next(lines):
                pass
            next(others)
            process.send_signal(signal.SIGTERM)
            assert list(lines) is not None  # both end as answers do: a broken one would raise
            assert list(others) is not None
    records = [json.loads(line) for line in process.stderr]
    assert process.wait(PATIENCE_S) == 0
    _all_wait(database_url, ids)
    assert {one["submission"] for one in records if "back to the queue" in one["message"]} == {ids[0]}
    uploads = [one for one in records if one.get("code") == "accepted"]
    assert [(one["submission"], one["route"], one["status"]) for one in uploads] == [
        (id_, "/api/v1/submissions", 202) for id_ in ids
    ]
    assert TOKEN not in str(records)


@first_on_sqlite
def test_a_worker_that_is_killed_is_replaced_and_none_outlives_its_service(
    process: Forked, database_url: str
) -> None:
    said = (json.loads(line)["message"] for line in process.stderr)
    address = next(one for one in said if one.startswith("listening on ")).removeprefix("listening on ")
    first, second = _worker(said), None
    os.kill(first, signal.SIGKILL)
    second = _worker(said)
    assert second != first
    with httpx.Client(base_url=address, timeout=PATIENCE_S, trust_env=False) as client:
        id_ = _upload(client, 1, b"print(1)\n")
    with closing(Database(database_url)) as database:
        submissions = Submissions(database, utc_now)
        wait_until(lambda: submissions.get(id_).state is SubmissionState.GRADED)
    process.kill()
    wait_until(lambda: not Path(f"/proc/{second}").exists())


def _worker(said: Iterator[str]) -> int:
    """Wait until a worker grades; return its process."""
    line = next(one for one in said if one.startswith("worker ") and " grades" in one)
    return int(line.split(":")[-2])


@pytest.mark.parametrize(
    ("command", "database_url"),
    [(["serve", "--port", "0"], "sqlite_url"), (["worker"], "postgres_url")],
    indirect=["database_url"],
    ids=["serve on sqlite", "worker on postgresql"],
)
def test_told_to_stop_while_it_waits_for_the_database_it_stops(
    command: list[str], database_url: str, prepared: Prepared
) -> None:
    database = Database(database_url)
    told = ["grader", *command, "--slots", "1"]
    with alone(database), prepared.start(*told, GRADER_DATABASE_URL=database_url) as waiting:
        while "waiting until that has ended" not in (line := waiting.stderr.readline()):
            assert line
        waiting.send_signal(signal.SIGTERM)
        assert waiting.wait(PATIENCE_S) == 0
    database.close()


def _upload(client: httpx.Client, number: int, source: bytes = b"") -> str:
    response = client.post(
        "/api/v1/submissions",
        files={"file": ("busy.py", source or BUSY.format(number).encode())},
        data={"assignment": "hello", "student": f"s{number}"},
    )
    assert response.status_code == 202, response.text
    return str(response.json()["id"])


def _all_wait(url: str, ids: list[str]) -> None:
    database = Database(url)
    try:
        found = [Submissions(database, utc_now).get(id_) for id_ in ids]
    finally:
        database.close()
    assert [(one.state, one.tries) for one in found] == [(SubmissionState.QUEUED, 0)] * len(ids)


def test_another_server_of_the_application_ends_streams_first_as_well(
    sqlite_url: str, prepared: Prepared
) -> None:
    settings = {
        "GRADER_DATABASE_URL": sqlite_url,
        "GRADER_INSTRUCTOR_TOKEN": TOKEN,
        "GRADER_SLOTS": "0",
    }
    with prepared.start("uvicorn", "grader.api:app", "--port", "0", **settings) as started:
        while " running on " not in (line := started.stderr.readline()):
            assert line
        address = line.split(" running on ")[1].split()[0]
        with (
            httpx.Client(base_url=address, timeout=PATIENCE_S, trust_env=False) as client,
            client.stream(
                "GET", "/api/v1/dashboard/events", headers={"Authorization": f"Bearer {TOKEN}"}
            ) as stream,
        ):
            lines = stream.iter_lines()
            next(lines)
            started.send_signal(signal.SIGTERM)
            rest = list(lines)  # it ends as answers do: a broken one would raise
            assert not [line for line in rest if line.startswith(":")]  # one that lives on says so
        assert "Waiting for application shutdown" in started.stderr.read()
        started.wait(PATIENCE_S)
