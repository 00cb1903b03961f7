"""`grader submit` against a real server whose worker is a thread of the test."""

import json
import re
import threading
from collections.abc import Iterator
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import pytest
from fastapi import FastAPI

from grader.commands import cli
from grader.contracts.assignment import Case
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.rules import LateRule, Rules
from grader.contracts.text import Text
from grader.operation.settings import Settings
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes import server
from tests.fakes.clock import START, FakeClock
from tests.fakes.grading import grade_next


def work(services: Services, stop: threading.Event) -> None:
    while not stop.wait(0.02):
        if grade_next(services.queue, services.assignments):
            services.doorbell.ring()


@pytest.fixture
def services(sqlite_url: str) -> Iterator[Services]:
    with server.services(Settings(database_url=sqlite_url), FakeClock()) as made:
        yield made


@pytest.fixture
def submit(
    services: Services,
    running: tuple[FastAPI, str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
):
    monkeypatch.delenv("GRADER_TOKEN", raising=False)
    stop = threading.Event()
    worker = threading.Thread(target=work, args=(services, stop))
    worker.start()
    app, address = running
    app.state.services = services

    def run(source: str, *arguments: str, name: str = "square_mover.py") -> tuple[int, str, str]:
        path = tmp_path / name
        path.write_text(source)
        status = cli.run(["submit", str(path), "--server", address, *arguments])
        return (status, *capsys.readouterr())

    yield run
    stop.set()
    worker.join()


def test_full_marks_and_where_the_replay_is(submit, services: Services) -> None:
    status, output, told = submit("good good", "--student", "s1", "--lang", "en")
    assert status == 0
    submission = services.dashboard.state().progress[0].latest_submission
    assert re.search(rf"See it at http://\S+/submissions/{submission}\n", told)
    assert "Exercise square" in output
    assert "10" in output


def test_less_than_that_shows_the_next_step(submit, services: Services) -> None:
    status, output, _ = submit("good", "--student", "s1", "--lang", "en")
    assert status == 1
    assert "try again" in output
    assert services.dashboard.state().progress[0].attempts == 1


def test_the_same_file_again_is_told(submit, services: Services) -> None:
    assert "已经提交过" not in submit("good good", "--student", "s1")[2]
    status, _, told = submit("good good", "--student", "s1")
    assert (status, "已经提交过" in told) == (0, True)
    assert services.dashboard.state().progress[0].attempts == 1


def test_what_lateness_leaves_is_told_and_how_many_attempts_are_left(
    submit, services: Services, monkeypatch: pytest.MonkeyPatch
) -> None:
    services.courses.create("ros", "ROS", "UTC", "test")
    services.courses.import_roster("ros", [RosterEntry(id="li", name="李", role=Role.STUDENT)], "test")
    _, token = services.tokens.issue("ros", "li", timedelta(days=1), "test")
    monkeypatch.setenv("GRADER_TOKEN", token)
    late = Rules(due=START - timedelta(hours=1), late=LateRule(kind="linear", per_day=0.25))
    services.rules.set("square", late, Signature(START, "ros", "test"))
    told = submit("good good")[2]
    assert "计 7.5 分" in told
    assert "还可提交" not in told
    services.rules.set("square", replace(late, attempts=3), Signature(START, "ros", "test"))
    assert "还可提交 1 次。" in submit("good")[2]


def test_as_json_it_is_the_stored_report(submit, services: Services) -> None:
    _, output, _ = submit("good", "--student", "s1", "--json")
    submission = services.dashboard.state().progress[0].latest_submission
    assert output.strip().encode() == services.submissions.report(submission).content
    assert json.loads(output)["assignment"] == "square"


def test_a_refusal_says_what_to_do(submit) -> None:
    status, _, errors = submit("x = 1\ndef broken(\n", "--student", "s1", "--lang", "en")
    assert status == 2
    assert "Line 2" in errors
    assert "def broken(" in errors
    assert "Traceback" not in errors


def test_in_a_course_the_token_says_who(
    submit, services: Services, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    services.courses.create("ros", "ROS", "UTC", "test")
    services.courses.import_roster("ros", [RosterEntry(id="li", name="李", role=Role.STUDENT)], "test")
    _, token = services.tokens.issue("ros", "li", timedelta(days=1), "test")
    status, _, errors = submit("good")
    assert (status, errors.count("需要有效的令牌")) == (2, 1)
    assert "--token-file" in errors
    monkeypatch.setenv("GRADER_TOKEN", token)
    assert submit("good")[0] == 1
    assert services.dashboard.state("ros").progress[0].student == "li"
    path = tmp_path / "token"
    monkeypatch.delenv("GRADER_TOKEN")
    for encoding in (
        "utf-8",
        "utf-8-sig",
        "utf-16",
    ):  # the last as PowerShell's `echo TOKEN > FILE` writes it
        path.write_text(token + "\n", encoding=encoding)
        assert submit("good", "--token-file", str(path))[0] == 1
    path.write_bytes("令牌".encode("gbk"))
    assert "这不是令牌" in submit("good", "--token-file", str(path))[2]


def test_a_token_is_not_sent_in_the_clear(submit, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GRADER_TOKEN", "grader_abc")
    status, _, errors = submit("good", "--server", "http://grader.example.org")
    assert status == 2
    assert "https" in errors


def test_a_server_that_is_not_there(submit, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("grader.commands.submit._PAUSE_S", 0.0)
    status, _, errors = submit("good", "--server", "http://127.0.0.1:9", "--student", "s1")
    assert status == 2
    assert "没有回应" in errors


@pytest.mark.parametrize("address", ["127.0.0.1:8080", "http://", "http://[::"])
def test_what_is_no_address_is_told(submit, address: str) -> None:
    status, _, errors = submit("good", "--server", address)
    assert status == 2
    assert "不是服务器地址" in errors


def test_an_unknown_assignment_is_answered_with_those_there_are(submit) -> None:
    status, _, errors = submit("good", "--student", "s1", "-a", "sqare")
    assert status == 2
    assert "allowed: straight, square" in errors


def test_items_of_several_cases_stand_below_their_titles(submit, services: Services) -> None:
    square = services.assignments.get("square")
    near = replace(square.items[0], id="near/sides")
    cases = (Case(id="near", title=Text(zh="近", en="Near start")), Case(id="far"))
    services.assignments.assignments = (replace(square, cases=cases, items=(near,)),)  # type: ignore[attr-defined]
    _, output, _ = submit("good", "--student", "s1", "--lang", "en")
    assert "Near start" in output


def test_a_name_that_tells_nothing(submit) -> None:
    status, _, errors = submit("good", "--student", "s1", name="x.py")
    assert status == 2
    assert "-a square" in errors


def test_who_stops_waiting_is_told_where_the_result_will_be(submit, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("grader.commands.submit._await", interrupt)
    status, _, told = submit("good good", "--student", "s1")
    assert status == cli.EXIT_INTERRUPTED
    assert re.search(r"评分会继续。在网页上看结果：http://\S+/submissions/\w+", told)
