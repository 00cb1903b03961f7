"""What a script's text and its account of itself may do to its grading: nothing."""

from dataclasses import replace

import pytest

import grader.checks
from grader.contracts.outcome import RunStatus
from grader.contracts.report import GradeStatus
from grader.contracts.scoring import Scoring
from grader.contracts.text import EMPTY
from grader.grading.pipeline import _explained
from grader.grading.slot import Slot, SlotConfig
from tests.e2e.grading_slot import grade
from tests.unit.checks.shipped import assignment
from tests.unit.checks.trajectories import drive, run_of

ELSEWHERE = '"\\n" * 300 + "def g():\\n    counter += 1\\ng()\\n"'


def test_an_explanation_that_fails_costs_no_mark(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def astray(*_: object) -> Scoring:
        raise IndexError("list index out of range")

    run, task = run_of(drive([(2.0, 1.0, 0.0)]), RunStatus.FINISHED), assignment("square")
    marks = grader.checks.mark(task, [run])
    with_words = _explained(task, marks)
    monkeypatch.setattr(grader.checks, "explained", astray)
    bare = _explained(task, marks)
    assert with_words.hint != bare.hint == EMPTY
    assert with_words.mistakes
    assert [replace(item, hint=EMPTY) for item in with_words.items] == list(bare.items)
    assert 0 < sum(item.earned for item in bare.items) < 100
    assert "no explanation" in caplog.text


def test_an_error_in_code_that_the_file_does_not_have_has_no_line() -> None:
    with Slot(SlotConfig()) as slot:
        report = grade(slot, "square", f"counter = 0\nexec(compile({ELSEWHERE}, __file__, 'exec'), {{}})\n")
    error = report.runs[0].outcome.error
    assert report.status is GradeStatus.CRASHED
    assert error is not None
    assert (error.type, error.line) == ("UnboundLocalError", None)
