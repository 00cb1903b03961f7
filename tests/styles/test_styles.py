"""Ordinary rclpy scripts in every style: each commands the car where an ideal turtle would go, every time.

Where the car went another way because commands came faster than turtlesim takes them, `tests/real` has which.

The expectations are written by hand, from what the script says; none is taken from a run.
"""

import hashlib
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from grader.contracts.assignment import Assignment, Case
from grader.contracts.grading import Grader, GradingJob, GradingResult
from grader.contracts.outcome import RunOutcome
from grader.contracts.text import EMPTY
from grader.contracts.trajectory import Trajectory, decode_trajectory
from tests.rows import slow_but
from tests.styles import expected_endings, expected_feedback, expected_threads, expected_timers
from tests.styles.expectation import Expectation
from tests.styles.ideal import UPDATE_S, IdealTurtle, Jump

SCRIPTS = Path(__file__).with_name("scripts")
EXPECTED: dict[str, Expectation] = {
    **expected_timers.EXPECTED,
    **expected_threads.EXPECTED,
    **expected_feedback.EXPECTED,
    **expected_endings.EXPECTED,
}

MAX_PATH_ERROR = 0.03  # of the length of the path
MIN_TOLERANCE_M = 0.01  # for turns on the spot
MAX_TOLERANCE_M = 0.05  # for long paths, whose sides would otherwise hide behind their sum
MAX_HEADING_ERROR_RAD = np.radians(3.0)
UNWELCOME = {"incompatible_qos", "type_mismatch", "unreadable_message"}  # no script here deserves these notes


def job_of(name: str) -> GradingJob:
    """Return a job that runs the script in turtlesim's window and asks for nothing."""
    expected = EXPECTED[name]
    assignment = Assignment(
        id="styles",
        version=1,
        order=0,
        title=EMPTY,
        brief=EMPTY,
        check="node",
        items=(),
        horizon_s=expected.horizon_s,
        cases=(Case(stdin=expected.stdin, args=expected.args),),
    )
    path = SCRIPTS / f"{name}.py"
    return GradingJob(file_name=path.name, source=path.read_bytes(), assignment=assignment)


@cache
def graded(grader: Grader, name: str) -> GradingResult:
    return grader.grade(job_of(name))


def test_every_script_has_its_expectation() -> None:
    assert sorted(EXPECTED) == sorted(path.stem for path in SCRIPTS.glob("*.py"))
    assert len(EXPECTED) >= 60


@pytest.mark.parametrize("name", slow_but(24, EXPECTED))
def test_the_car_goes_where_an_ideal_turtle_goes(grader: Grader, name: str) -> None:
    expected = EXPECTED[name]
    trajectory = decode_trajectory(graded(grader, name).trajectories["default"]).at_once()
    ideal = IdealTurtle(expected.plan)
    distances_m, turns_rad = _deviations(trajectory, ideal, expected)
    tolerance_m = min(max(MAX_PATH_ERROR * ideal.path_length_m, MIN_TOLERANCE_M), MAX_TOLERANCE_M)
    assert distances_m.max() <= tolerance_m
    assert abs(turns_rad).max() <= MAX_HEADING_ERROR_RAD


@pytest.mark.parametrize("name", slow_but(24, EXPECTED))
def test_the_script_ends_and_speaks_as_at_home(grader: Grader, name: str) -> None:
    expected = EXPECTED[name]
    outcome = graded(grader, name).report.runs[0].outcome
    assert outcome.status == expected.status, (outcome.detail, outcome.stderr.text)
    assert _error_types(outcome) == (expected.error, expected.cleanup)
    if expected.stdout is not None:
        assert outcome.stdout.text == expected.stdout
    if expected.exit_code is not None:
        assert outcome.exit_code == expected.exit_code
    assert _in_order(expected.says, outcome.stderr.text), outcome.stderr.text
    codes = {note.code for note in outcome.notes}
    assert set(expected.notes) <= codes
    assert not codes & UNWELCOME, outcome.notes


@pytest.mark.parametrize("name", slow_but(12, EXPECTED))
def test_every_run_is_the_same(grader: Grader, name: str) -> None:
    """Also after the process has graded all the others in between."""
    assert fingerprint(grader.grade(job_of(name))) == fingerprint(graded(grader, name))


def fingerprint(result: GradingResult) -> tuple[str, str, str]:
    """Return the digests of the command log, the trajectory and the report."""
    trajectory = decode_trajectory(result.trajectories["default"])
    commands = hashlib.sha256(repr(trajectory.commands).encode()).hexdigest()
    return commands, result.report.runs[0].trajectory_sha256, result.report.sha256()


def _deviations(
    trajectory: Trajectory, ideal: IdealTurtle, expected: Expectation
) -> tuple[np.ndarray, np.ndarray]:
    """Return how far the car is from the ideal turtle and how much it is turned, at every sample.

    The samples next to a jump are left out: it happens between two of them.
    """
    times_s = trajectory.t_ns / 1e9
    wanted = ideal.poses(times_s)
    distances_m = np.hypot(trajectory.x_m - wanted[:, 0], trajectory.y_m - wanted[:, 1])
    away = trajectory.heading_rad - wanted[:, 2]
    turns_rad = np.arctan2(np.sin(away), np.cos(away))
    steady = np.ones(len(times_s), dtype=bool)
    for jump in (part for part in expected.plan if isinstance(part, Jump)):
        steady &= abs(times_s - jump.start_s) > 2.0 * UPDATE_S
    return distances_m[steady], turns_rad[steady]


def _error_types(outcome: RunOutcome) -> tuple[str, str]:
    return (
        outcome.error.type if outcome.error else "",
        outcome.cleanup_error.type if outcome.cleanup_error else "",
    )


def _in_order(texts: tuple[str, ...], where: str) -> bool:
    """Whether every text occurs, each after the one before."""
    at = 0
    for text in texts:
        found = where.find(text, at)
        if found < 0:
            return False
        at = found + len(text)
    return True
