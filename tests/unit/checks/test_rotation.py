"""The check on turning in place."""

import itertools
import math
import random

import pytest

from grader.checks import sketch
from grader.contracts.outcome import RunStatus
from grader.contracts.rubric import ItemStatus
from tests.unit.checks.shipped import assignment, graded, item, score
from tests.unit.checks.trajectories import drive, polygon_legs, run_of

FULL_S = 2 * math.pi


@pytest.mark.parametrize("w", [1.0, -1.0, 0.5, -3.0])
@pytest.mark.parametrize("turns", [1.0, 2.5])
def test_a_full_turn_either_way(w: float, turns: float) -> None:
    assert score(graded("spin", drive([(turns * FULL_S / abs(w), 0.0, w)]))) == 100


def test_turning_for_ever() -> None:
    scoring = graded("spin", drive([(60.0, 0.0, 1.0)], horizon_s=30.0), RunStatus.INTERRUPTED)
    assert score(scoring) == 100


@pytest.mark.parametrize("turn_s", [1.0, math.pi, 5.0])
def test_too_short_a_turn(turn_s: float) -> None:
    scoring = graded("spin", drive([(turn_s, 0.0, 1.0)]))
    assert item(scoring, "turn").status is not ItemStatus.PASSED
    assert "6.283" in scoring.hint.en


def test_no_more_counts_than_was_turned() -> None:
    scoring = graded("spin", drive([(1.0, 0.0, -1.0), (4.0, 0.0, 1.0)]))
    assert "Turned 229" in item(scoring, "turn").message.en


def test_too_slow_a_turn() -> None:
    scoring = graded("spin", drive([(60.0, 0.0, 0.15)], horizon_s=30.0), RunStatus.INTERRUPTED)
    assert scoring.mistakes == ("time_was_up",)


def test_a_circle_is_no_turn_on_the_spot() -> None:
    scoring = graded("spin", drive([(FULL_S, 1.0, 1.0)]))
    assert item(scoring, "turn").measured == pytest.approx(36, abs=0.1)  # a tenth: up to 2 m away
    assert scoring.hint.zh.endswith(item(scoring, "turn").hint.zh)
    assert score(scoring) == 10


@pytest.mark.parametrize("turns", [1, 4])
def test_credit_falls_as_the_circle_widens(turns: int) -> None:
    radii = (0.0, 0.04, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.5, 3.0)
    earned = [score(graded("spin", drive([(turns * FULL_S, radius, 1.0)]))) for radius in radii]
    assert earned == sorted(earned, reverse=True)
    assert earned[1] == 100
    assert earned[-1] == 10


def test_a_figure_with_corners_is_no_turn_on_the_spot() -> None:
    scoring = graded("spin", drive(polygon_legs(4)))
    assert score(scoring) == 10


@pytest.mark.parametrize("seed", range(8))
def test_turns_made_elsewhere_do_not_add_up(seed: int) -> None:
    chance = random.Random(seed)
    walk = [(0.5, chance.uniform(0.8, 2.0), chance.uniform(-3.0, 3.0)) for _ in range(50)]
    spiral = [(1.0, 0.3 + 0.1 * k, 1.0) for k in range(20)]
    for legs in (walk, spiral, polygon_legs(8, 0.5), polygon_legs(3, 1.0, laps=3)):
        assert score(graded("spin", drive(legs))) <= 15


@pytest.mark.parametrize("before", [True, False])
def test_a_whole_turn_before_or_after_driving_keeps_its_points(before: bool) -> None:
    turn, walk = (FULL_S, 0.0, -1.0), (3.0, 1.0, 0.0)
    scoring = graded("spin", drive([turn, walk] if before else [walk, turn]))
    assert item(scoring, "turn").status is ItemStatus.PASSED
    assert score(scoring) == 70


def test_straight_on_is_no_turn() -> None:
    scoring = graded("spin", drive([(3.0, 1.0, 0.0)]))
    assert score(scoring) == 10


def test_staying_put_earns_nothing_for_staying_in_place() -> None:
    assert item(graded("spin", drive([(3.0, 0.0, 0.0)])), "place").earned == 0


def test_sketch() -> None:
    shown = sketch(assignment("spin"), run_of(drive([(1.0, 0.0, 1.0)])))
    assert shown.view == "heading"
    assert shown.wanted_turn_deg == 355
    assert shown.corners[0].angle_deg == pytest.approx(57.3, abs=0.1)
    assert shown.corners[0].ok is False
    assert shown.labels == ()


def test_the_wider_a_circle_the_less_it_is_a_turn_on_the_spot() -> None:
    radii = [i / 50 for i in range(1, 40)]
    points = [score(graded("spin", drive([(FULL_S, radius, 1.0)]))) for radius in radii]
    steps = [before - after for before, after in itertools.pairwise(points)]
    assert points[0] == 100
    assert points[-1] == 10
    assert min(steps) >= 0
    assert max(steps) < 20


def test_sketch_of_a_circle() -> None:
    shown = sketch(assignment("spin"), run_of(drive([(FULL_S, 1.0, -1.0)])))
    assert shown.corners[0].angle_deg == pytest.approx(-36, abs=0.1)
    assert shown.labels[0].text.en == "2 m aside"


def test_credit_falls_with_a_turn_rate_that_nobody_means() -> None:
    rates = (1.0, 12.0, 13.0, 16.0, 20.0, 24.0, 57.3, 360.0)
    scorings = [graded("spin", drive([(7.0, 0.0, rate)])) for rate in rates]
    earned = [score(scoring) for scoring in scorings]
    assert earned[:2] == [100, 100]
    assert earned == sorted(earned, reverse=True)
    assert len(set(earned)) == 5
    assert earned[-3:] == [80, 80, 80]
    assert {scoring.mistakes for scoring in scorings[2:]} == {("degrees_as_radians",)}


def test_the_points_for_the_rate_need_a_turn() -> None:
    assert score(graded("spin", drive([(2.0, 1.0, 0.0)]))) == 10
