"""Check ``polygon`` where sides are not straight, or corners are cut off: the drawing decides, step by step."""

import itertools
import math
from collections.abc import Callable

import pytest

from tests.unit.checks.shipped import graded, score
from tests.unit.checks.trajectories import Leg, drive

FIGURES = [("triangle", 3), ("square", 4), ("pentagon", 5)]
Legs = list[Leg]


def ahead(length_m: float) -> Legs:
    return [(length_m, 1.0, 0.0)] if length_m > 0.0 else []


def turn(angle_deg: float) -> Legs:
    return [(abs(math.radians(angle_deg)), 0.0, math.copysign(1.0, angle_deg))] if angle_deg else []


def arc(angle_deg: float, length_m: float) -> Legs:
    return [(length_m, 1.0, math.radians(angle_deg) / length_m)]


def cut_off(sides: int, share: float) -> Legs:
    """Every corner turned in two parts, with a drive of this share of a side between them."""
    half_deg, cut_m = 180.0 / sides, 2.0 * share
    rest_m = 2.0 - cut_m / math.cos(math.radians(half_deg))
    return [*ahead(rest_m), *turn(half_deg), *ahead(cut_m), *turn(half_deg)] * sides


def cut_off_once(sides: int, share: float) -> Legs:
    half_deg = 180.0 / sides
    corner = [*turn(half_deg), *ahead(2.0 * share), *turn(half_deg)]
    whole = [*ahead(2.0), *turn(2.0 * half_deg)]
    return [*whole, *ahead(2.0), *corner, *whole * (sides - 2)]


def swung(sides: int, share: float) -> Legs:
    """Sides that swing to the left and to the right of their line; the share is that of a right angle."""
    half_deg = 45.0 * share
    side = [*arc(half_deg, 0.5), *arc(-half_deg, 0.5), *arc(-half_deg, 0.5), *arc(half_deg, 0.5)]
    return [*side, *turn(360.0 / sides)] * sides


def kinked(sides: int, share: float) -> Legs:
    """One side that leaves its line and comes back in the middle."""
    angle_deg = 90.0 * share
    side = [*ahead(0.7), *turn(angle_deg), *ahead(0.3), *turn(-2.0 * angle_deg), *ahead(0.3)]
    kink = [*side, *turn(angle_deg), *ahead(2.0 - 0.7 - 0.6 * math.cos(math.radians(angle_deg)))]
    corner = turn(360.0 / sides)
    return [*kink, *corner, *[*ahead(2.0), *corner] * (sides - 1)]


@pytest.mark.parametrize(("name", "sides"), FIGURES)
@pytest.mark.parametrize(
    ("spoilt", "fine", "most", "left"),
    [
        (cut_off, 0.13, 0.25, 25),
        (cut_off_once, 0.19, 0.5, 40),
        (swung, 0.3, 0.8, 25),
        (kinked, 0.3, 0.6, 81),
    ],
)
def test_points_fall_step_by_step(
    name: str, sides: int, spoilt: Callable[[int, float], Legs], fine: float, most: float, left: float
) -> None:
    """`fine`: up to here most of the points are kept; `left`: at most so many at the end, which is `most`."""
    shares = [most * i / 25 for i in range(26)]
    points = [score(graded(name, drive(spoilt(sides, share)))) for share in shares]
    assert points[0] == 100
    assert all(one >= 80 for one, share in zip(points, shares, strict=True) if share <= fine)
    assert points[-1] <= left
    assert min(before - after for before, after in itertools.pairwise(points)) >= -4


@pytest.mark.parametrize(("name", "sides"), [("hexagon", 6), ("octagon", 8)])
@pytest.mark.parametrize(("spoilt", "most"), [(cut_off, 0.2), (cut_off_once, 0.5), (kinked, 0.5)])
def test_points_do_not_rise_where_many_sides_are_spoilt(
    name: str, sides: int, spoilt: Callable[[int, float], Legs], most: float
) -> None:
    """Half a point is what sampling at 60 Hz makes of a vertex."""
    points = [score(graded(name, drive(spoilt(sides, most * i / 20)))) for i in range(21)]
    assert points[0] == 100
    assert min(before - after for before, after in itertools.pairwise(points)) >= -0.5


@pytest.mark.parametrize(("name", "sides"), [*FIGURES, ("hexagon", 6), ("octagon", 8)])
@pytest.mark.parametrize(("spoilt", "most"), [(cut_off, 0.3), (swung, 0.6)])
def test_points_do_not_rise_where_the_figure_is_lost(
    name: str, sides: int, spoilt: Callable[[int, float], Legs], most: float
) -> None:
    """A look that finds the figure by taking one end of each cut for its corner brought 22 points back."""
    points = [score(graded(name, drive(spoilt(sides, most * i / 30)))) for i in range(15, 31)]
    assert points[-1] <= 30
    assert min(before - after for before, after in itertools.pairwise(points)) >= -1.0


@pytest.mark.parametrize("heading_deg", [33.0, 90.0, -145.0])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_it_makes_no_difference_how_the_figure_lies(heading_deg: float, sense: float) -> None:
    for legs in (cut_off(4, 0.15), swung(4, 0.42), kinked(4, 0.2)):
        mirrored = [(duration, v, sense * w) for duration, v, w in legs]
        here = score(graded("square", drive(legs)))
        assert score(graded("square", drive(mirrored, heading_deg=heading_deg))) == pytest.approx(here, abs=3)
        assert 40 < here < 99


@pytest.mark.parametrize(("name", "sides"), FIGURES)
def test_what_is_no_such_figure_gains_nothing(name: str, sides: int) -> None:
    circle = drive(arc(360.0, 6.0))
    twice_the_corners = drive([*ahead(1.0), *turn(180.0 / sides)] * (2 * sides))
    to_and_fro = drive([*ahead(2.0), (1.5, -1.0, 0.0), *turn(360.0 / sides)] * sides)
    points = [score(graded(name, one)) for one in (circle, twice_the_corners, to_and_fro)]
    assert max(points) <= 35


def lap(sides: int, side_m: float) -> Legs:
    return [*ahead(side_m), *turn(360.0 / sides)] * sides


@pytest.mark.parametrize(("name", "sides"), FIGURES)
@pytest.mark.parametrize("sizes_m", [(0.5, 1.0, 1.5), (2.0, 1.0), (1.0, 1.2, 1.4, 1.7)])
def test_laps_from_one_corner_may_grow_or_shrink(name: str, sides: int, sizes_m: tuple[float, ...]) -> None:
    legs = [leg for side_m in sizes_m for leg in lap(sides, side_m)]
    assert score(graded(name, drive(legs))) == 100
    moved = [leg for side_m in sizes_m for leg in (*lap(sides, side_m), *ahead(0.3))]
    assert score(graded(name, drive(moved))) <= 80


def test_a_spiral_is_no_square_that_grows() -> None:
    spiral = [leg for i in range(12) for leg in (*ahead(1.04**i), *turn(90.0))]
    assert score(graded("square", drive(spiral))) < 80


def test_the_further_a_car_drives_there_and_back_at_each_corner_the_more_it_costs() -> None:
    earned = []
    for way_m in (0.05, 0.1, 0.2, 0.3, 0.4, 0.5):
        corner = [*turn(-90.0), *ahead(way_m), (way_m, -1.0, 0.0), *turn(90.0 + 120.0)]
        earned.append(score(graded("triangle", drive([*ahead(1.5), *corner] * 3))))
    assert earned == sorted(earned, reverse=True)
    assert earned[0] == 100
    assert earned[-1] < 30
