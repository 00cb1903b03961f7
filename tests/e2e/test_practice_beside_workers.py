"""Practice where one process serves and others grade, as an operator starts them, on both kinds of database."""

from contextlib import closing
from datetime import timedelta
from pathlib import Path

import httpx

from grader.contracts.identity import Role, RosterEntry
from grader.store.clock import clock_of
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.tokens import Tokens
from tests.conftest import first_on_sqlite
from tests.e2e.test_scale_out import PATIENCE_S, process, serving
from tests.fakes.prepared import Prepared
from tests.fakes.waiting import wait_until

IMPATIENT = "tests.fakes.impatient"
HELLO = (Path(__file__).resolve().parents[2] / "lesson" / "hello_node.py").read_bytes()


def token_of_a_student(url: str) -> str:
    with closing(Database(url)) as database, clock_of(database) as clock:
        courses = Courses(database, clock)
        courses.create("ros", "ROS 2", "Asia/Shanghai", "setup")
        courses.import_roster("ros", [RosterEntry(id="li", name="", role=Role.STUDENT)], "setup")
        return Tokens(database, clock).issue("ros", "li", timedelta(days=1), "setup")[1]


def send(client: httpx.Client, path: str) -> httpx.Response:
    return client.post(path, files={"file": ("hello_node.py", HELLO)}, data={"assignment": "hello"})


@first_on_sqlite
def test_practice_runs_in_the_process_that_serves_and_after_what_others_grade(
    database_url: str, tmp_path: Path, prepared: Prepared
) -> None:
    token = token_of_a_student(database_url)
    with serving(prepared, tmp_path, database_url, IMPATIENT) as client:
        client.headers["Authorization"] = f"Bearer {token}"
        seen = send(client, "/api/v1/practice")
        assert seen.status_code == 200, seen.text
        assert {item["status"] for item in seen.json()["items"]} == {"passed"}

        handed_in = send(client, "/api/v1/submissions")
        assert handed_in.status_code == 202, handed_in.text
        refused = send(client, "/api/v1/practice")  # nobody grades yet, so the submission waits
        assert (refused.status_code, refused.json()["code"]) == (503, "practice_waits")

        with process(prepared, tmp_path / "worker.log", database_url, "worker", "--slots", "1"):
            url = handed_in.headers["Location"]
            wait_until(lambda: client.get(url).json()["status"] == "graded", PATIENCE_S, pause_s=0.05)
            assert send(client, "/api/v1/practice").status_code == 200
    assert "Traceback" not in (tmp_path / "serve.log").read_text()
