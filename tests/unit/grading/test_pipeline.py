"""What a script's text and its account of itself may do to its grading: nothing."""

from dataclasses import replace

import pytest

import grader.checks
from grader.contracts.outcome import RunStatus, StudentError
from grader.contracts.report import GradeStatus
from grader.contracts.scoring import Run, Scoring
from grader.grading.pipeline import _evaluated
from grader.grading.slot import Slot, SlotConfig
from tests.e2e.grading_slot import grade
from tests.unit.checks.shipped import assignment
from tests.unit.checks.trajectories import drive, polygon_legs, run_of

ELSEWHERE = '"\\n" * 300 + "def g():\\n    counter += 1\\ng()\\n"'


def test_a_look_for_hints_that_fails_costs_no_grading(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    evaluate = grader.checks.evaluate

    def astray(task: object, runs: list[Run]) -> Scoring:
        if any("lead astray" in run.source for run in runs):
            raise IndexError("list index out of range")
        return evaluate(task, runs)  # type: ignore[arg-type]

    monkeypatch.setattr(grader.checks, "evaluate", astray)
    error = StudentError(type="NameError", message="name 'x' is not defined", line=3, traceback="")
    run = run_of(drive(polygon_legs(4)), RunStatus.CRASHED, error=error)
    scoring = _evaluated(assignment("square"), [replace(run, source="lead astray")])
    assert sum(item.earned for item in scoring.items) == 100
    assert "scored without hints" in caplog.text


def test_an_error_in_code_that_the_file_does_not_have_has_no_line() -> None:
    with Slot(SlotConfig()) as slot:
        report = grade(slot, "square", f"counter = 0\nexec(compile({ELSEWHERE}, __file__, 'exec'), {{}})\n")
    error = report.runs[0].outcome.error
    assert report.status is GradeStatus.CRASHED
    assert error is not None
    assert (error.type, error.line) == ("UnboundLocalError", None)
