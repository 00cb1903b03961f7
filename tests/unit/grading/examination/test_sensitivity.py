"""The solution's motion driven again, and made worse."""

import math
from dataclasses import replace

import numpy as np
import pytest

from grader.contracts.assignment import Assignment
from grader.contracts.scoring import Run
from grader.grading.examination.sensitivity import lax, replayable, replayed, sensitivities
from tests.unit.checks.shipped import assignment
from tests.unit.checks.trajectories import drive, polygon_legs, run_of

SQUARE = assignment("square")


def square_run() -> Run:
    return run_of(drive(polygon_legs(4, pause_s=0.3)))


def widened(task: Assignment, measure: str, **band: float) -> Assignment:
    items = tuple(replace(item, **band) if item.measure == measure else item for item in task.items)
    return replace(task, items=items)


def test_replaying_the_same_commands_gives_the_same_motion() -> None:
    recorded = square_run().trajectory
    again = replayed(SQUARE.world, recorded, recorded.commands)
    for name in ("x_m", "y_m", "heading_rad"):
        then = np.interp(recorded.t_ns, again.t_ns, getattr(again, name))
        assert np.allclose(then, getattr(recorded, name), atol=0.02), name


def test_a_command_is_held_for_63_updates() -> None:
    recorded = drive([(0.05, 1.0, 0.0)])
    alone = replayed(SQUARE.world, recorded, recorded.commands[:1])
    assert alone.x_m[-1] - alone.x_m[0] == pytest.approx(63 * 0.016)
    assert replayed(SQUARE.world, recorded, []) is recorded


def test_credit_falls_from_the_tolerances_on() -> None:
    found = {
        (each.perturbation.name.en, each.item, each.starts > 0): each
        for each in sensitivities(SQUARE, square_run())
    }
    corner = found["angle of the first turn", "angles", True]
    assert 3.0 / 90.0 <= corner.starts <= 4.5 / 90.0
    assert corner.zero is not None
    assert 0.22 <= corner.zero <= 0.26  # of four corners one is off
    assert found["length of the first straight", "lengths", False].starts == pytest.approx(-0.065, abs=0.011)
    assert not [each for each in found.values() if each.perturbation.name.en == "time of every rest"]


def test_arcs_are_spoilt_one_by_one() -> None:
    two_circles = assignment("two_circles")
    run = run_of(drive([(2.0 * math.pi * radius, 1.0, 1.0 / radius) for radius in (0.8, 1.6)]))
    assert replayable(two_circles, run)
    found = {
        (each.perturbation.name.en, each.item, each.starts > 0): each
        for each in sensitivities(two_circles, run)
    }
    for error in ("radius of every arc", "radius of the first arc"):
        assert 0.04 <= found[error, "radius", True].starts <= 0.08
    assert found["angle of every arc", "whole", False].starts <= -0.04
    assert lax(two_circles, run) == []
    task = widened(two_circles, "covered_pct", low=1.0)
    for measure in ("radius_error_pct", "off_pct", "gap_pct", "round_pct"):
        task = widened(task, measure, high=300.0)
    assert any("radius of the first arc" in problem.en for problem in lax(task, run))


def test_the_shipped_square_is_not_lax() -> None:
    assert replayable(SQUARE, square_run())
    assert lax(SQUARE, square_run()) == []


@pytest.mark.parametrize(
    ("measures", "band", "name"),
    [
        (("side_spread_pct", "gap_pct"), {"high": 90.0}, "length of the first straight"),
        (("corner_deg", "gap_pct"), {"low": 10.0, "high": 170.0}, "angle of the first turn"),
    ],
)
def test_a_lax_tolerance_is_caught(measures: tuple[str, ...], band: dict[str, float], name: str) -> None:
    task = SQUARE
    for measure in measures:
        edges = {"high": 90.0} if measure == "gap_pct" else band
        task = widened(task, measure, **edges)
    if "corner_deg" in measures:
        task = widened(task, "side_spread_pct", high=90.0)
    assert any(name in problem.en for problem in lax(task, square_run()))


def test_a_motion_that_needs_its_script_is_left_alone() -> None:
    rough = replace(SQUARE, world=replace(SQUARE.world, profile="rough"))
    assert not replayable(rough, square_run())
    assert not replayable(SQUARE, run_of(drive([])))


def test_a_limit_with_a_reason_may_be_wide() -> None:
    task = widened(widened(SQUARE, "side_spread_pct", high=90.0), "gap_pct", high=90.0)
    assert any("length of the first straight" in problem.en for problem in lax(task, square_run()))
    allowed = tuple(
        replace(item, limit="any quadrangle with right corners will do")
        if item.measure == "side_spread_pct"
        else item
        for item in task.items
    )
    assert not any(
        "length of the first straight" in problem.en
        for problem in lax(replace(task, items=allowed), square_run())
    )


def only(task: Assignment, *measures: str, **change: str) -> Assignment:
    """Return the assignment with the items of these measures alone, worth everything."""
    items = [
        replace(item, needs=(), scaled_by=(), **change) for item in task.items if item.measure in measures
    ]
    return replace(task, items=tuple(items))


def test_what_no_measure_sees_is_told_and_may_be_left_free_by_any_limit() -> None:
    """Whoever asks for the turning alone can narrow no band that would see how far the turtle drives."""
    task = only(SQUARE, "corner_deg")
    run = run_of(drive([(1.0, 1.0, 0.0), (1.0, 0.0, math.pi / 2)] * 4))
    assert replayable(task, run)
    (unseen,) = [one.en for one in lax(task, run) if "length of the first straight" in one.en]
    assert unseen.endswith(
        "no measure sees it: add an item that does, or say with limit, at any item, why it may be so"
    )
    assert lax(only(SQUARE, "corner_deg", limit="only the turns are asked for"), run) == []


def test_a_limit_leaves_nothing_free_that_another_item_sees() -> None:
    """The reason at one item is none for the wide band of another."""
    task = widened(widened(SQUARE, "side_spread_pct", high=90.0), "gap_pct", high=90.0)
    elsewhere = tuple(
        replace(item, limit="corners may differ") if item.measure == "corner_deg" else item
        for item in task.items
    )
    told = [one.en for one in lax(replace(task, items=elsewhere), square_run())]
    (seen,) = [one for one in told if "length of the first straight" in one]
    assert "narrow the band of one of " in seen
    assert "lengths" in seen
    assert "angles" not in seen
