"""`grader serve` as an operator starts it: a real process, the real sandbox, the lesson's scripts."""

import json
import os
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest

ROOT = Path(__file__).resolve().parents[2]
LESSON = ROOT / "lesson"
TOKEN = "3q9fKx72LmVb0pTzQQ"
INSTRUCTOR = {"Authorization": f"Bearer {TOKEN}"}
PATIENCE_S = 120.0  # only ever waited for in full when a test fails


def wait_until(condition: Callable[[], bool]) -> None:
    pause = threading.Event()
    for _ in range(int(PATIENCE_S / 0.05)):
        if condition():
            return
        pause.wait(0.05)
    raise AssertionError("it never happened")


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "grader", *arguments]


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    data = tmp_path_factory.mktemp("served")
    process = subprocess.Popen(
        command("serve", "--port", "0", "--slots", "1", "--data", str(data)),
        cwd=ROOT,
        # what nobody reads until the end must not fill the pipe
        env={**os.environ, "GRADER_INSTRUCTOR_TOKEN": TOKEN, "GRADER_LOG_LEVEL": "warning"},
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    address = re.search(r"http://127\.0\.0\.1:\d+", process.stderr.readline())
    assert address is not None
    with httpx.Client(base_url=address.group(), timeout=PATIENCE_S, trust_env=False) as client:
        wait_until(lambda: client.get("/healthz").status_code == 200)
        yield client
    process.send_signal(signal.SIGTERM)
    rest = process.stderr.read()
    assert process.wait() == 0
    assert "Traceback" not in rest
    process.stderr.close()


def upload(client: httpx.Client, name: str, source: bytes, assignment: str) -> httpx.Response:
    return client.post(
        "/api/v1/submissions",
        files={"file": (name, source)},
        data={"assignment": assignment, "student": "20260123"},
        headers={"Accept-Language": "en"},
    )


def graded(client: httpx.Client, name: str, source: bytes, assignment: str) -> str:
    response = upload(client, name, source, assignment)
    assert response.status_code == 202, response.text
    url = response.headers["Location"]
    wait_until(lambda: client.get(url).json()["status"] not in ("queued", "running"))
    return url


@pytest.mark.parametrize(
    ("name", "assignment"),
    [("hello_node.py", "hello"), ("straight_mover.py", "straight"), ("square_mover.py", "square")],
)
def test_the_lessons_scripts_get_full_marks_as_on_the_command_line(
    served: httpx.Client, name: str, assignment: str
) -> None:
    url = graded(served, name, (LESSON / name).read_bytes(), assignment)
    document = served.get(url).json()
    assert (document["verdict"], document["score"]) == ("graded", document["max_score"])
    checked = subprocess.run(
        command("check", str(LESSON / name), "--assignment", assignment, "--json"),
        cwd=ROOT,
        capture_output=True,
        check=True,
    )
    assert served.get(url + "/report").content == checked.stdout.strip()


def test_what_was_driven_can_be_looked_at(served: httpx.Client) -> None:
    url = graded(served, "square_mover.py", (LESSON / "square_mover.py").read_bytes(), "square")
    columns = served.get(url + "/trajectory").json()
    lengths = {len(columns[name]) for name in ("t_ns", "x_m", "y_m", "heading_rad", "v_mps", "w_radps")}
    assert len(lengths) == 1
    plot = served.get(url + "/plot.png")
    assert plot.content.startswith(b"\x89PNG")


def test_a_square_is_no_pentagon_and_the_report_says_why(served: httpx.Client) -> None:
    url = graded(served, "square_mover.py", (LESSON / "square_mover.py").read_bytes(), "pentagon")
    document = served.get(url, params={"lang": "en"}).json()
    assert document["score"] < document["max_score"]
    failed = [item for item in document["rubric"] if item["status"] == "failed"]
    assert failed
    assert all(item["message"] and item["hint"] for item in failed)


def test_a_syntax_error_is_refused_with_its_place(served: httpx.Client) -> None:
    response = upload(served, "bad.py", b"import rclpy\nif True:\n    print('hi'\nx = 1\n", "square")
    document = response.json()
    assert (response.status_code, document["code"], document["line"]) == (422, "syntax_error", 3)
    assert document["text"] == "    print('hi'"
    assert document["column"] == 10
    assert "never closed" in document["detail"]


def test_a_crash_is_the_students_with_their_line(served: httpx.Client) -> None:
    url = graded(served, "crash.py", b"import rclpy\n\nrclpy.init()\nrclpy.crete_node('x')\n", "hello")
    (run,) = served.get(url).json()["runs"]
    assert (run["status"], run["blame"]) == ("crashed", "student")
    assert (run["error"]["type"], run["error"]["line"]) == ("AttributeError", 4)


def test_the_dashboard_needs_the_operators_token(served: httpx.Client) -> None:
    assert served.get("/api/v1/dashboard").status_code == 401
    document = served.get("/api/v1/dashboard", headers=INSTRUCTOR).json()
    assert [one["student"] for one in document["students"]] == ["20260123"]
    assert TOKEN not in json.dumps(document)


def test_a_second_server_on_the_same_port_says_so(served: httpx.Client, tmp_path: Path) -> None:
    arguments = command("serve", "--port", str(served.base_url.port), "--data", str(tmp_path))
    failed = subprocess.run(arguments, cwd=ROOT, capture_output=True, text=True, check=False)
    assert failed.returncode == 2
    assert failed.stderr.startswith("grader: cannot listen on 127.0.0.1")
    assert "Traceback" not in failed.stderr


def test_leaving_this_machine_is_refused(tmp_path: Path) -> None:
    arguments = command("serve", "--host", "0.0.0.0", "--data", str(tmp_path))
    failed = subprocess.run(arguments, cwd=ROOT, capture_output=True, text=True, check=False)
    assert failed.returncode == 2
    assert "GRADER_ALLOW_ANONYMOUS_NETWORK" in failed.stderr
