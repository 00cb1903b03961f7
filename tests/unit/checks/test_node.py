"""The check on a first node."""

import pytest

from grader.checks import evaluate
from grader.contracts.outcome import LogRecord, RunOutcome, RunStatus, Stream, StudentError
from grader.contracts.scoring import Run, Scoring
from tests.unit.checks.shipped import assignment, item, score
from tests.unit.checks.trajectories import drive

INFO = LogRecord(t_ns=1000, level=20, name="hello_node", message="Hello")


def hello(**changes: object) -> Scoring:
    values: dict[str, object] = {
        "status": RunStatus.INTERRUPTED,
        "duration_ns": 5_000_000_000,
        "nodes": ("/hello_node",),
        "logs": (INFO,),
    }
    outcome = RunOutcome(**{**values, **changes})  # type: ignore[arg-type]
    return evaluate(assignment("hello"), [Run(trajectory=drive([], horizon_s=5.0), outcome=outcome)])


def test_full_marks() -> None:
    assert score(hello()) == 100


def test_an_exception_after_ctrl_c_costs_nothing() -> None:
    error = StudentError(type="RCLError", message="failed to shutdown", line=38, traceback="")
    assert score(hello(cleanup_error=error, exit_code=1)) == 100


@pytest.mark.parametrize(
    ("changes", "points", "mistake"),
    [
        ({"status": RunStatus.FINISHED, "duration_ns": 10_000}, 70, "not_spinning"),
        ({"logs": (), "stdout": Stream(text="Hello\n")}, 60, "printed"),
        ({"logs": (LogRecord(t_ns=0, level=30, name="n", message="x"),)}, 60, "log_level"),
        ({"logs": ()}, 60, "never_logged"),
        ({"nodes": (), "logs": ()}, 0, "init_without_node"),
        ({"nodes": (), "logs": (), "status": RunStatus.FINISHED}, 0, "nothing_ran"),
    ],
)
def test_mistakes(changes: dict[str, object], points: float, mistake: str) -> None:
    scoring = hello(**changes)
    assert score(scoring) == points
    assert scoring.mistakes[0] == mistake


def test_the_first_message_is_quoted_if_there_is_one() -> None:
    assert item(hello(), "log").message.zh == "收到 1 条 INFO 日志（第一条：Hello）。"
    assert item(hello(logs=()), "log").message.zh == "收到 0 条 INFO 日志。"


def test_a_crash_is_named_with_its_line() -> None:
    error = StudentError(type="TypeError", message="incompatible arguments", line=12, traceback="")
    scoring = hello(status=RunStatus.CRASHED, error=error, logs=())
    assert scoring.mistakes[0] == "crashed"
    assert "12" in scoring.hint.zh
    assert item(scoring, "alive").earned == 0
