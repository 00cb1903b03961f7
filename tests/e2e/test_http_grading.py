"""The service with nothing faked: `grader serve`, uploads over HTTP, the real sandbox, car and checks."""

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from rich.console import Console

from grader.commands.demo import Upload, await_grades, hand_in, serving
from grader.contracts.codec import from_plain
from grader.contracts.report import GradeReport
from tests.e2e.grading_slot import LESSON, catalog

SCRIPTS = {"hello": "hello_node.py", "straight": "straight_mover.py", "square": "square_mover.py"}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    with serving(tmp_path_factory.mktemp("service")) as client:
        yield client


def graded(client: httpx.Client, *uploads: Upload) -> list[dict[str, object]]:
    locations = [hand_in(client, upload) for upload in uploads]
    await_grades(client, locations, Console(quiet=True))
    return [client.get(location).raise_for_status().json() for location in locations]


def test_the_lessons_scripts_get_the_very_report_that_check_prints(client: httpx.Client) -> None:
    uploads = [Upload("s001", assignment, LESSON / name) for assignment, name in SCRIPTS.items()]
    for upload, answer in zip(uploads, graded(client, *uploads), strict=True):
        command = [sys.executable, "-m", "grader", "check", str(upload.path), "--json"]
        local = subprocess.run(command, capture_output=True, check=True).stdout
        report = from_plain(GradeReport, json.loads(local))
        assert report.score == 100
        assert answer["report_sha256"] == report.sha256()


def test_a_file_that_is_not_python_is_refused_with_line_and_reason(
    client: httpx.Client, tmp_path: Path
) -> None:
    script = tmp_path / "broken.py"
    script.write_text("import rclpy\ndef main()\n    pass\n")
    answer = client.post(
        "/api/v1/submissions",
        data={"student": "s002", "assignment": "hello"},
        files={"file": (script.name, script.read_bytes(), "text/x-python")},
    )
    assert answer.status_code == 422
    assert answer.headers["content-type"].startswith("application/problem+json")
    problem = answer.json()
    assert problem["line"] == 2
    assert "expected ':'" in problem["detail"]


def test_trajectory_and_plot_of_a_graded_submission(client: httpx.Client) -> None:
    (answer,) = graded(client, Upload("s003", "square", LESSON / "square_mover.py"))
    location = f"/api/v1/submissions/{answer['id']}"
    trajectory = client.get(f"{location}/trajectory").raise_for_status().json()
    assert len(trajectory["t_ns"]) == len(trajectory["x_m"]) > 500
    plot = client.get(f"{location}/plot.png").raise_for_status()
    assert plot.headers["content-type"] == "image/png"
    assert plot.content.startswith(b"\x89PNG")


def test_healthz_says_that_the_sandbox_was_proven(client: httpx.Client) -> None:
    health = client.get("/healthz").raise_for_status().json()
    assert health["sandbox"]["ready"] is True


def test_a_text_is_accepted_graded_or_kept_for_a_person(client: httpx.Client) -> None:
    solutions = {
        name: catalog().folder(name) / "solution.txt" for name in ("calculation", "theory_keep_publishing")
    }
    number, essay = graded(client, *(Upload("s004", name, path) for name, path in solutions.items()))
    assert (number["verdict"], number["score"]) == ("graded", 100)
    assert (essay["verdict"], essay["score"]) == ("needs_manual", None)
    for answer in (number, essay):
        plot = client.get(f"/api/v1/submissions/{answer['id']}/plot.png")
        assert plot.status_code == 404
    location = f"/api/v1/submissions/{essay['id']}"
    for item in client.get(f"{location}/judgements").raise_for_status().json()["items"]:
        body = {"points": item["points"], "comment": "right"}
        client.put(f"{location}/judgements/{item['item']}", json=body).raise_for_status()
    judged = client.get(location).raise_for_status().json()
    assert (judged["verdict"], judged["score"], judged["to_judge"]) == ("graded", 100, 0)
    assert judged["report_sha256"] == essay["report_sha256"]


@pytest.mark.parametrize(("assignment", "name"), [("calculation", "answer.py"), ("square", "square.txt")])
def test_a_script_for_a_question_is_refused_and_the_other_way_round(
    client: httpx.Client, assignment: str, name: str
) -> None:
    answer = client.post(
        "/api/v1/submissions",
        data={"student": "s005", "assignment": assignment},
        files={"file": (name, b"12 s", "text/plain")},
    )
    assert answer.status_code == 415
    assert answer.json()["code"] == "wrong_file_type"
