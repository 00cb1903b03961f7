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
    assert 2.0 < edges[0] < 2.4
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
