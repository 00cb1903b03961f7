"""What a plot shows of a polygon."""

import math

import pytest

from grader.checks import sketch
from tests.unit.checks.shipped import assignment
from tests.unit.checks.trajectories import Leg, drive, polygon_legs, run_of


def test_the_plot_shows_sides_corners_and_the_fitted_figure() -> None:
    run = run_of(drive(polygon_legs(4, lengths_m=[2, 2, 2.4, 2]), heading_deg=30))
    shown = sketch(assignment("square"), run)
    assert [side.ok for side in shown.sides] == [True, True, False, True]
    assert [round(corner.angle_deg) for corner in shown.corners] == [90] * 4
    assert all(corner.ok for corner in shown.corners)
    assert len(shown.ideal_m) == 4
    edges = [math.dist(shown.ideal_m[i], shown.ideal_m[i - 1]) for i in range(4)]
    assert max(edges) - min(edges) < 1e-9
    assert edges[0] == pytest.approx(2.0, abs=0.01)  # as the sides that are compared with the median
    assert shown.ideal_m[0] == shown.sides[0].start_m  # where the car set out, and ahead of it
    ahead = [
        math.atan2(b[1] - a[1], b[0] - a[0])
        for a, b in [shown.ideal_m[:2], (shown.sides[0].start_m, shown.sides[0].end_m)]
    ]
    assert ahead[0] == pytest.approx(ahead[1])
    assert shown.gap is not None
    assert shown.gap.length_m == pytest.approx(0.4, abs=0.02)


def test_the_plot_of_an_approach_begins_with_the_figure() -> None:
    run = run_of(drive([(1.0, 1.0, 0.0), (math.radians(45), 0.0, -1.0), *polygon_legs(4)]))
    shown = sketch(assignment("square"), run)
    assert shown.begin_ns == pytest.approx(1e9, rel=0.5)
    assert len(shown.sides) == 4
    assert shown.gap is not None
    assert shown.gap.start_m == pytest.approx((5.54, 5.54), abs=0.02)


def test_the_fitted_figure_lies_on_a_right_one() -> None:
    run = run_of(drive(polygon_legs(3, w_radps=-1.0), heading_deg=84))
    shown = sketch(assignment("triangle"), run)
    for wanted, side in zip(shown.ideal_m, shown.sides, strict=True):
        assert math.dist(wanted, side.start_m) < 0.02


def test_the_fitted_figure_of_one_begun_in_the_middle_of_a_side() -> None:
    turn: Leg = (math.pi / 2, 0.0, 1.0)
    legs = [(1.0, 1.0, 0.0), turn, *[(2.0, 1.0, 0.0), turn] * 3, (1.0, 1.0, 0.0)]
    shown = sketch(assignment("square"), run_of(drive(legs)))
    assert len(shown.sides) == 5
    assert math.dist(shown.ideal_m[0], shown.ideal_m[1]) == pytest.approx(2.0, abs=0.02)
    assert math.dist(shown.ideal_m[0], shown.sides[0].end_m) < 0.02


def test_the_first_error_shows_first() -> None:
    """A first corner of 80 degrees leaves the first side on the wanted figure, and nothing after it."""
    legs = [*polygon_legs(4)]
    legs[2] = (math.radians(80), 0.0, 1.0)
    shown = sketch(assignment("square"), run_of(drive(legs)))
    apart = [math.dist(wanted, side.start_m) for wanted, side in zip(shown.ideal_m, shown.sides, strict=True)]
    assert apart[0] == 0.0
    assert apart[1] < 0.03
    assert apart[2] > 0.3
