"""The polygon check on ways to drive a figure: begun anywhere, over again, with detours, with more behind it."""

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.contracts.outcome import RunStatus
from tests.unit.checks.shipped import POLYGONS, graded, item, score
from tests.unit.checks.trajectories import Leg, drive, polygon_legs

QUARTER = math.pi / 2
TURN: Leg = (QUARTER, 0.0, 1.0)


def side(length_m: float = 2.0) -> Leg:
    return length_m, 1.0, 0.0


def begun_inside(sides: int, share: float, side_m: float = 2.0, laps: int = 1) -> list[Leg]:
    """A figure that begins after `share` of a side and ends there."""
    legs = polygon_legs(sides, side_m, laps=laps)
    first, *rest = legs
    return [((1.0 - share) * first[0], *first[1:]), *rest, (share * first[0], *first[1:])]


@given(st.sampled_from(sorted(POLYGONS)), st.floats(0.01, 0.99))
def test_a_figure_may_begin_anywhere_on_a_side(sides: int, share: float) -> None:
    assert score(graded(POLYGONS[sides], drive(begun_inside(sides, share, 1.5)))) == 100


@pytest.mark.parametrize("share", [0.05, 0.1, 0.2, 0.5, 0.79, 0.9, 0.97])
@pytest.mark.parametrize("name", ["hexagon", "octagon"])
def test_a_figure_of_many_sides_may_begin_anywhere_on_one(name: str, share: float) -> None:
    sides = 6 if name == "hexagon" else 8
    assert score(graded(name, drive(begun_inside(sides, share, 1.0)))) == 100


@pytest.mark.parametrize("sides", POLYGONS)
@pytest.mark.parametrize("laps", [2, 3])
def test_a_figure_begun_inside_a_side_may_be_driven_again(sides: int, laps: int) -> None:
    assert score(graded(POLYGONS[sides], drive(begun_inside(sides, 0.4, laps=laps)))) == 100


@pytest.mark.parametrize("horizon_s", [23.0, 27.5, 33.0])
def test_a_figure_begun_inside_a_side_may_be_driven_for_ever(horizon_s: float) -> None:
    trajectory = drive(begun_inside(4, 0.4, laps=4), horizon_s=horizon_s)
    assert score(graded("square", trajectory, RunStatus.INTERRUPTED)) == 100


@pytest.mark.parametrize("on_m", [0.25, 0.5])
def test_driving_on_along_the_first_side_is_no_figure_begun_inside_it(on_m: float) -> None:
    scoring = graded("square", drive([*polygon_legs(4), side(on_m)]))
    assert score(scoring) < 100


DETOURS: dict[str, list[Leg]] = {
    "an eight": [(2 * math.pi, 0.5, 1.0), (2 * math.pi, 0.5, -1.0)],
    "an S": [(QUARTER, 0.5, 1.0), (QUARTER, 0.5, -1.0)],
    "a step": [TURN, side(0.3), (QUARTER, 0.0, -1.0)],
    "a loop": [(2 * math.pi, 0.3, 1.0)],
}


@pytest.mark.parametrize("detour", DETOURS)
def test_detours_from_the_sides_make_no_polygon(detour: str) -> None:
    legs = [side(1.0), *DETOURS[detour], side(1.0), TURN] * 4
    scoring = graded("square", drive(legs))
    assert score(scoring) <= 50
    assert item(scoring, "straight").earned < 10


def test_the_longer_a_detour_the_more_it_costs() -> None:
    earned = []
    for radius_m in (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5):
        legs: list[Leg] = [
            side(1.0),
            (QUARTER, radius_m, 1.0),
            (QUARTER, radius_m, -1.0),
            side(1.0),
            TURN,
        ] * 4
        earned.append(score(graded("square", drive(legs))))
    assert earned == sorted(earned, reverse=True)
    assert earned[0] == 100
    assert earned[-1] < 30
    assert max(one - other for one, other in itertools.pairwise(earned)) < 25


def test_detours_are_told() -> None:
    scoring = graded("square", drive([side(1.0), *DETOURS["an S"], side(1.0), TURN] * 4))
    assert scoring.mistakes[0] == "astray"


@pytest.mark.parametrize("sides", [3, 4, 5])
@pytest.mark.parametrize("gear", [1.0, -1.0])
def test_the_further_a_car_drives_past_the_end_of_its_sides_and_back_the_more_it_costs(
    sides: int, gear: float
) -> None:
    turn: Leg = (2 * math.pi / sides, 0.0, 1.0)
    earned = []
    for beyond_m in (0.1, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3):
        legs: list[Leg] = [(2.0 + beyond_m, gear, 0.0), (beyond_m, -gear, 0.0), turn] * sides
        scoring = graded(POLYGONS[sides], drive(legs))
        earned.append(score(scoring))
        assert item(scoring, "angles").measured == pytest.approx(360.0 / sides, abs=1.0)
    assert earned == sorted(earned, reverse=True)
    assert earned[1] == 100
    assert scoring.mistakes[0] == "overshot"
    assert max(one - other for one, other in itertools.pairwise(earned)) < 25


def test_who_backs_up_for_most_of_a_side_has_driven_it_twice() -> None:
    legs = [side(2.0), (1.5, -1.0, 0.0), TURN] * 4
    assert score(graded("square", drive(legs))) < 50


@pytest.mark.parametrize("times", [1, -1, 2])
def test_whole_turns_on_the_spot_inside_a_side_change_nothing(times: int) -> None:
    spin: Leg = (2 * math.pi * abs(times), 0.0, math.copysign(1.0, times))
    for legs in (
        [side(1.0), spin, side(1.0), TURN, *[side(), TURN] * 3],
        [side(1.0), spin, side(1.0), TURN] * 4,
    ):
        assert score(graded("square", drive(legs))) == 100


@pytest.mark.parametrize("sides", POLYGONS)
@pytest.mark.parametrize("back", ["reverse gear", "after an about turn"])
def test_the_same_figure_back_is_a_repetition(sides: int, back: str) -> None:
    lap = polygon_legs(sides, last_turn=False)
    if back == "reverse gear":
        again = [(duration, -v, -w) for duration, v, w in reversed(lap)]
    else:
        again = [(math.pi, 0.0, 1.0), *[(duration, v, -w) for duration, v, w in reversed(lap)]]
    assert score(graded(POLYGONS[sides], drive([*lap, *again]))) == 100


def test_an_arc_on_the_way_to_the_figure_is_an_approach() -> None:
    scoring = graded("square", drive([(math.pi, 1.0, 1.0), *polygon_legs(4)]))
    assert scoring.mistakes == ("approach",)
    assert item(scoring, "closed").earned == 0


def test_a_circle_behind_the_figure_is_no_part_of_its_last_side() -> None:
    scoring = graded("square", drive([*polygon_legs(4), (2 * math.pi, 0.5, 1.0)]))
    assert item(scoring, "sides").earned == item(scoring, "sides").points
    assert item(scoring, "lengths").earned == item(scoring, "lengths").points
    assert 75 <= score(scoring) < 100


@pytest.mark.parametrize("rest_s", [0.5, 2.0, 5.0])
def test_a_rest_as_long_as_those_before_it_is_a_pause(rest_s: float) -> None:
    """The horizon comes in a rest of the second lap, whose sides are not all driven."""
    legs = [leg for _ in range(8) for leg in (side(1.0), TURN, (rest_s, 0.0, 0.0))]
    horizon_s = 6 * (1.0 + QUARTER + rest_s) - 0.2
    trajectory = drive(legs, horizon_s=horizon_s)
    assert score(graded("square", trajectory, RunStatus.INTERRUPTED)) == 100


def test_a_longer_rest_is_the_end() -> None:
    legs = [leg for _ in range(6) for leg in (side(1.0), TURN, (0.5, 0.0, 0.0))]
    scoring = graded("square", drive(legs, idle_s=8.0), RunStatus.INTERRUPTED)
    assert scoring.mistakes == ("drove_on",)


def test_a_step_back_from_an_arc_is_no_side_of_negative_length() -> None:
    scoring = graded("square", drive([(2.0, -3.0, 1.0), (1.0, 0.5, 0.0)]))
    assert scoring.mistakes == ("arcs",)
    assert 0 < score(scoring) < 50


def test_four_corners_of_a_star_are_four_corners_and_no_way_there_and_back() -> None:
    corners = [
        score(graded("square", drive(polygon_legs(4, corners_deg=[one] * 4))))
        for one in (143.0, 144.0, 145.0)
    ]
    assert max(corners) - min(corners) < 1.0
