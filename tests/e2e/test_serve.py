"""`grader serve` as an operator starts it: a real process, the real sandbox, the car and the lesson's scripts."""

import json
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
from rich.console import Console

from grader.commands.demo import DemoUpload, await_grades, hand_in, serving
from grader.contracts.record import from_json
from grader.contracts.report import GradeReport
from tests.e2e.grading_slot import LESSON, catalog
from tests.fakes.prepared import Prepared

Terminal = Callable[..., subprocess.CompletedProcess[str]]
SCRIPTS = {"hello": "hello_node.py", "straight": "straight_mover.py", "square": "square_mover.py"}
STUDENT = "20260123"


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """One service for all tests, asked with the operator's token."""
    with serving(tmp_path_factory.mktemp("service")) as client:
        yield client


def graded(client: httpx.Client, *uploads: DemoUpload) -> list[str]:
    locations = [hand_in(client, upload) for upload in uploads]
    await_grades(client, locations, Console(quiet=True))
    return locations


@pytest.fixture(scope="module")
def lesson(client: httpx.Client) -> dict[str, str]:
    """Where the submissions of the lesson's scripts are found, by assignment."""
    uploads = [
        DemoUpload(STUDENT, assignment, name, (LESSON / name).read_bytes())
        for assignment, name in SCRIPTS.items()
    ]
    return dict(zip(SCRIPTS, graded(client, *uploads), strict=True))


def refused(client: httpx.Client, assignment: str, name: str, source: bytes) -> httpx.Response:
    answer = client.post(
        "/api/v1/submissions",
        data={"student": STUDENT, "assignment": assignment},
        files={"file": (name, source, "text/plain")},
        headers={"Accept-Language": "en"},
    )
    assert answer.headers["content-type"].startswith("application/problem+json")
    return answer


@pytest.mark.parametrize("assignment", SCRIPTS)
def test_the_lessons_scripts_get_the_very_report_that_check_prints(
    client: httpx.Client, lesson: dict[str, str], assignment: str, at_terminal: Terminal
) -> None:
    local = at_terminal("check", LESSON / SCRIPTS[assignment], "--json").stdout.strip().encode()
    report = from_json(GradeReport, local)
    assert report.score == report.max_score == 100
    document = client.get(lesson[assignment]).json()
    assert (document["verdict"], document["score"]) == ("graded", 100)
    assert document["report_sha256"] == report.sha256()
    assert client.get(lesson[assignment] + "/report").content == local


def test_what_was_driven_can_be_looked_at(client: httpx.Client, lesson: dict[str, str]) -> None:
    columns = client.get(lesson["square"] + "/trajectory").json()
    lengths = {len(columns[name]) for name in ("t_ns", "x_m", "y_m", "heading_rad", "v_mps", "w_radps")}
    assert len(lengths) == 1
    assert lengths.pop() > 500
    plot = client.get(lesson["square"] + "/plot.png").raise_for_status()
    assert plot.headers["content-type"] == "image/png"
    assert plot.content.startswith(b"\x89PNG")


def test_a_square_is_no_pentagon_and_a_crash_is_the_students(client: httpx.Client) -> None:
    crash = b"import rclpy\n\nrclpy.init()\nrclpy.crete_node('x')\n"
    square = (LESSON / "square_mover.py").read_bytes()
    uploads = (("pentagon", "square_mover.py", square), ("hello", "crash.py", crash))
    other, crashed = graded(client, *(DemoUpload(STUDENT, *one) for one in uploads))
    document = client.get(other, params={"lang": "en"}).json()
    assert document["score"] < document["max_score"]
    failed = [item for item in document["rubric"] if item["status"] == "failed"]
    assert failed
    assert all(item["message"] and item["hint"] for item in failed)
    (run,) = client.get(crashed).json()["runs"]
    assert (run["status"], run["blame"]) == ("crashed", "student")
    assert (run["error"]["type"], run["error"]["line"]) == ("AttributeError", 4)


def test_a_text_is_accepted_graded_or_kept_for_a_person(client: httpx.Client) -> None:
    solutions = {
        name: catalog().scripts(name)["solution.txt"] for name in ("calculation", "theory_keep_publishing")
    }
    places = graded(client, *(DemoUpload("s004", name, "a.txt", text) for name, text in solutions.items()))
    number, essay = (client.get(place).raise_for_status().json() for place in places)
    assert (number["verdict"], number["score"]) == ("graded", 100)
    assert (essay["verdict"], essay["score"]) == ("needs_manual", None)
    assert [client.get(place + "/plot.png").status_code for place in places] == [404, 404]
    location = places[1]
    items = client.get(f"{location}/judgements").raise_for_status().json()["items"]
    for item in (one for one in items if one["waits"]):
        body = {"points": item["points"], "comment": "right"}
        client.put(f"{location}/judgements/{item['item']}", json=body).raise_for_status()
    judged = client.get(location).raise_for_status().json()
    assert (judged["verdict"], judged["score"], judged["to_judge"]) == ("graded", 100, 0)
    assert judged["report_sha256"] == essay["report_sha256"]


def test_a_syntax_error_is_refused_with_its_place(client: httpx.Client) -> None:
    answer = refused(client, "square", "bad.py", b"import rclpy\nif True:\n    print('hi'\nx = 1\n")
    document = answer.json()
    assert (answer.status_code, document["code"], document["line"]) == (422, "syntax_error", 3)
    assert (document["text"], document["column"]) == ("    print('hi'", 10)
    assert "never closed" in document["detail"]


@pytest.mark.parametrize(("assignment", "name"), [("calculation", "answer.py"), ("square", "square.txt")])
def test_a_script_for_a_question_is_refused_and_the_other_way_round(
    client: httpx.Client, assignment: str, name: str
) -> None:
    answer = refused(client, assignment, name, b"12 s")
    assert (answer.status_code, answer.json()["code"]) == (415, "wrong_file_type")


def test_healthz_says_that_the_sandbox_was_proven(client: httpx.Client) -> None:
    health = client.get("/healthz").raise_for_status().json()
    assert health["sandbox"]["ready"] is True


def test_the_dashboard_needs_the_operators_token(client: httpx.Client, lesson: dict[str, str]) -> None:
    assert httpx.get(client.base_url.join("/api/v1/dashboard"), trust_env=False).status_code == 401
    document = client.get("/api/v1/dashboard").raise_for_status().json()
    assert STUDENT in [one["student"] for one in document["students"]]
    token = client.headers["Authorization"].removeprefix("Bearer ")
    assert token not in json.dumps(document)


def test_a_second_server_on_the_same_port_says_so(
    client: httpx.Client, tmp_path: Path, prepared: Prepared
) -> None:
    port = str(client.base_url.port)
    with prepared.start("grader", "serve", "--port", port, "--data", str(tmp_path)) as failed:
        said = failed.stderr.read()
        assert failed.wait() == 2
    assert said.startswith(f"grader: 无法监听 127.0.0.1 的 {port} 端口：已被别的程序占用")
    assert "Traceback" not in said
