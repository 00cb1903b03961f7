"""The polygon check on ways to drive a figure: begun anywhere, over again, with detours, with more behind it."""

import cmath
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


@pytest.mark.parametrize("turned_deg", [20.0, 33.0, 45.0, 145.0])
@pytest.mark.parametrize("bend_deg", [28.0, 34.0, 38.0])
def test_who_turns_first_has_as_much_for_bent_sides(turned_deg: float, bend_deg: float) -> None:
    bent = [(2.0, 1.0, math.radians(bend_deg) / 2.0), (math.radians(90.0 - bend_deg), 0.0, 1.0)] * 4
    turned = [(math.radians(turned_deg), 0.0, 1.0), *bent]
    assert score(graded("square", drive(turned))) == pytest.approx(
        score(graded("square", drive(bent))), abs=2
    )


def homing(sides: int, side_m: float, off_deg: float, near_m: float) -> list[Leg]:
    """Drive from corner to corner by the pose; a heading is corrected once it is further off the goal's direction.

    So each side bends the more, the nearer its end.
    """
    at = goal = 0j
    heading_rad, legs = 0.0, []
    for i in range(sides):
        goal += cmath.rect(side_m, math.tau * i / sides)
        while abs(goal - at) > near_m:
            error_rad = math.remainder(cmath.phase(goal - at) - heading_rad, math.tau)
            turn_rad = math.copysign(max(abs(error_rad) - math.radians(off_deg), 0.0), error_rad)
            heading_rad += turn_rad
            length_m = 0.05 * abs(goal - at)
            at += cmath.rect(length_m, heading_rad)
            legs += [(abs(turn_rad), 0.0, math.copysign(1.0, turn_rad)), side(length_m)]
    return legs


@pytest.mark.parametrize("near_m", [0.02, 0.05, 0.1])
@pytest.mark.parametrize(
    ("name", "sides", "side_m"), [("octagon", 8, 1.0), ("hexagon", 6, 1.2), ("square", 4, 2.0)]
)
def test_who_steers_to_corners_loses_little_by_a_heading_a_few_degrees_off(
    name: str, sides: int, side_m: float, near_m: float
) -> None:
    earned = [score(graded(name, drive(homing(sides, side_m, off, near_m)))) for off in (1, 3, 5, 7, 8.5)]
    assert earned == sorted(earned, reverse=True)
    assert earned[1] > 98
    assert earned[-1] > 75


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


def test_a_step_back_from_an_arc_is_no_side_of_negative_length() -> None:
    scoring = graded("square", drive([(2.0, -3.0, 1.0), (1.0, 0.5, 0.0)]))
    assert 0 < score(scoring) < 50


def test_four_corners_of_a_star_are_four_corners_and_no_way_there_and_back() -> None:
    corners = [
        score(graded("square", drive(polygon_legs(4, corners_deg=[one] * 4))))
        for one in (143.0, 144.0, 145.0)
    ]
    assert max(corners) - min(corners) < 1.0


@pytest.mark.parametrize(
    ("name", "sides", "corners_deg"),
    [
        ("octagon", 8, (42.5, 48.4, 49.0)),
        ("hexagon", 6, (57.0, 63.0, 65.6)),
        ("square", 4, (88.0, 93.0, 103.0)),
    ],
)
@pytest.mark.parametrize("laps", [2, 3])
def test_corners_that_are_off_cost_no_more_in_several_laps(
    name: str, sides: int, corners_deg: tuple[float, ...], laps: int
) -> None:
    """After several laps the direction has come round a side too early, or too late."""
    for corner_deg in corners_deg:
        once = polygon_legs(sides, 1.0, corners_deg=[corner_deg] * sides)
        again = graded(name, drive(once * laps))
        for_ever = graded(name, drive(once * 4, horizon_s=4.4 * sides), RunStatus.INTERRUPTED)
        assert score(again) == score(graded(name, drive(once))), corner_deg
        if corner_deg < 103.0:  # four sides of 103° may as well be a triangle driven on and on
            assert score(for_ever) == score(again), corner_deg


@pytest.mark.parametrize("corner_deg", [48.4, 49.3, 50.3])
def test_as_many_sides_as_are_wanted_are_no_approach_to_another_figure(corner_deg: float) -> None:
    """Eight sides with corners of 49 degrees: the last seven nearly close a heptagon."""
    legs = polygon_legs(
        8, 1.0, corners_deg=[corner_deg - 0.4, corner_deg, corner_deg + 1.1, *[corner_deg] * 5]
    )
    scoring = graded("octagon", drive(legs))
    assert item(scoring, "sides").earned == 15
    assert score(scoring) > 84


def test_the_laps_of_another_figure_are_another_figure() -> None:
    assert score(graded("octagon", drive(polygon_legs(7, 1.0) * 2))) == score(
        graded("octagon", drive(polygon_legs(7, 1.0)))
    )


@pytest.mark.parametrize("laps", [1.25, 1.5, 2.25, 2.5])
def test_a_part_of_a_lap_that_the_script_ended_is_driven_after_the_figure(laps: float) -> None:
    scoring = graded("square", drive(polygon_legs(4, 1.0, laps=laps)))
    assert 75 < score(scoring) <= 80


def test_a_third_side_counts_as_far_as_it_was_driven() -> None:
    earned = []
    for share in (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0):
        lengths = [2.0, 2.0, 2.0 * share] if share else [2.0, 2.0]
        legs = polygon_legs(4, lengths_m=lengths, laps=len(lengths) / 4, last_turn=False)
        earned.append(score(graded("square", drive(legs))))
    assert earned == sorted(earned)
    assert earned[0] == 47.5  # half of the figure
    assert earned[-1] == 67.65
    said = item(
        graded("square", drive(polygon_legs(4, lengths_m=[2.0, 2.0, 0.8], laps=0.75))), "sides"
    ).message
    assert said.en.startswith("Straight sides driven: 2.5 (lengths: 2 m, 2 m, 0.8 m). The last one counts")
    assert max(other - one for one, other in itertools.pairwise(earned)) < 22


@pytest.mark.parametrize("middle_m", [1.0, 2.0])
def test_an_approach_may_lead_to_the_middle_of_a_side(middle_m: float) -> None:
    """From the middle of the field to a side, round a square about the middle, back to that side."""
    half, whole = side(middle_m), side(2 * middle_m)
    legs = [half, TURN, half, TURN, whole, TURN, whole, TURN, whole, TURN, half]
    scoring = graded("square", drive(legs))
    assert item(scoring, "lengths").earned == 20
    assert score(scoring) == pytest.approx(88.6, abs=1)


def test_of_two_figures_the_one_that_closes_is_taken() -> None:
    for first_m in (1.6, 1.75, 2.25, 2.4):
        scoring = graded("square", drive([side(first_m), TURN, *polygon_legs(4)]))
        assert score(scoring) == pytest.approx(85, abs=0.5), first_m


def oblong(first_m: float, second_m: float, corner_deg: float = 90.0) -> list[Leg]:
    return polygon_legs(4, lengths_m=[first_m, second_m] * 2, corners_deg=[corner_deg] * 4)


def test_the_longer_a_rectangle_the_less_of_a_square_it_is() -> None:
    earned = [score(graded("square", drive(oblong(2.0, 2.0 + 0.05 * i)))) for i in range(24)]
    assert earned == sorted(earned, reverse=True)
    assert earned[-1] == 45
    assert max(one - other for one, other in itertools.pairwise(earned)) < 6


def test_the_nearer_a_rectangle_to_a_square_the_less_it_is_the_wanted_one() -> None:
    earned = [score(graded("rectangle", drive(oblong(3.0, 2.0 + 0.05 * i)))) for i in range(21)]
    assert earned == sorted(earned, reverse=True)
    assert earned[-1] == 45
    assert max(one - other for one, other in itertools.pairwise(earned)) < 8


@pytest.mark.parametrize(("name", "lengths"), [("square", (2.0, 3.0)), ("rectangle", (2.5, 2.5))])
def test_another_figure_does_not_earn_much_more_for_corners_that_are_off(
    name: str, lengths: tuple[float, float]
) -> None:
    earned = [score(graded(name, drive(oblong(*lengths, 90.0 + 0.5 * i)))) for i in range(12)]
    assert max(earned) < 60
    assert max(abs(one - other) for one, other in itertools.pairwise(earned)) < 4


@pytest.mark.parametrize("sides", POLYGONS)
def test_a_side_that_is_left_out_between_its_turns_is_one_side_missing(sides: int) -> None:
    """Two turns follow the last side that was driven, as if there were one between them."""
    turn: Leg = (math.tau / sides, 0.0, 1.0)
    scoring = graded(POLYGONS[sides], drive([*polygon_legs(sides, laps=(sides - 1) / sides), turn]))
    assert item(scoring, "angles").earned == pytest.approx(25 * (sides - 1) / sides, abs=0.01)
    assert item(scoring, "rest").earned == 0
