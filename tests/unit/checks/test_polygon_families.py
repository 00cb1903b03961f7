"""Families of figures that are spoilt more and more: no cliffs, and credit never falls when one gets better.

A step is half a degree, or half a per cent of a side. It costs at most 8 points, but where a count changes.
"""

import itertools
import math
from collections.abc import Callable
from typing import NamedTuple

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.examples import examples
from tests.rows import slow_but
from tests.unit.checks.shipped import graded, score
from tests.unit.checks.trajectories import Leg, drive, polygon_legs

FIGURES = {"triangle": 3, "square": 4, "pentagon": 5, "hexagon": 6, "octagon": 8}
SIDE_M = 2.0
STEP_DEG, STEP = 0.5, 0.005
MOST_COST, SAMPLING = 8.0, 1.0
"""Up to a point is what a vertex moves by between two samples at 60 Hz."""
Legs = list[Leg]


def ahead(length_m: float) -> Legs:
    return [(abs(length_m), math.copysign(1.0, length_m), 0.0)] if length_m else []


def turn(angle_deg: float) -> Legs:
    return [(abs(math.radians(angle_deg)), 0.0, math.copysign(1.0, angle_deg))] if angle_deg else []


def arc(angle_deg: float, length_m: float) -> Legs:
    return [(length_m, 1.0, math.radians(angle_deg) / length_m)]


def corners(sides: int, *errors_deg: float, laps: int = 1) -> Legs:
    """A figure each of whose laps has corners that are off by this, and then right ones."""
    right = [360.0 / sides] * sides
    off = [corner + error for corner, error in itertools.zip_longest(right, errors_deg, fillvalue=0.0)]
    return polygon_legs(sides, SIDE_M / laps, corners_deg=off * laps, laps=laps)


def lengths(sides: int, **shares: float) -> Legs:
    """A figure whose side of each name (``s1``, ``s2``, …) is longer by a share."""
    return polygon_legs(sides, lengths_m=[SIDE_M * (1.0 + shares.get(f"s{i}", 0.0)) for i in range(sides)])


def begun_within(sides: int, last: float, share: float = 1.0) -> Legs:
    """Begun within a side, whose last part comes at the end; a share of that is driven."""
    first, *rest = corners(sides)
    return [((1.0 - last) * first[0], *first[1:]), *rest, *ahead(SIDE_M * last * share)]


def cut_off(sides: int, share: float) -> Legs:
    """Every corner turned in two parts, with a drive of this share of a side between them."""
    half_deg, cut_m = 180.0 / sides, SIDE_M * share
    rest_m = SIDE_M - cut_m / math.cos(math.radians(half_deg))
    return [*ahead(rest_m), *turn(half_deg), *ahead(cut_m), *turn(half_deg)] * sides


def cut_off_once(sides: int, share: float) -> Legs:
    half_deg = 180.0 / sides
    whole = [*ahead(SIDE_M), *turn(2.0 * half_deg)]
    corner = [*turn(half_deg), *ahead(SIDE_M * share), *turn(half_deg)]
    return [*whole, *ahead(SIDE_M), *corner, *whole * (sides - 2)]


def swung(sides: int, angle_deg: float) -> Legs:
    """Sides that leave their line by this and come back to it."""
    side = [leg for one in (1.0, -1.0, -1.0, 1.0) for leg in arc(one * angle_deg, SIDE_M / 4.0)]
    return [*side, *turn(360.0 / sides)] * sides if angle_deg else corners(sides)


def kinked(sides: int, angle_deg: float) -> Legs:
    """One side that leaves its line and comes back in the middle."""
    back_m = 2.0 * 0.3 * math.cos(math.radians(angle_deg))
    away = [*turn(angle_deg), *ahead(0.3), *turn(-2.0 * angle_deg), *ahead(0.3), *turn(angle_deg)]
    side = [*ahead(0.7), *away, *ahead(SIDE_M - 0.7 - back_m)]
    return [*side, *turn(360.0 / sides), *[*ahead(SIDE_M), *turn(360.0 / sides)] * (sides - 1)]


def bent(sides: int, angle_deg: float, count: int | None = None) -> Legs:
    """Sides that are arcs of this angle, all of them or the second one alone."""
    legs: Legs = []
    for i in range(sides):
        own_deg = angle_deg if count is None or i == 1 else 0.0
        corner_deg = 360.0 / sides - (own_deg if count is None else angle_deg / 2.0 * (i < 2))
        legs += [*arc(own_deg, SIDE_M), *turn(corner_deg)]
    return legs


def rounded(sides: int, share: float) -> Legs:
    """Corners that are arcs, which take this share of each side."""
    radius_m = share * SIDE_M / 2.0 / math.tan(math.pi / sides)
    return [*ahead(SIDE_M * (1.0 - share)), (math.tau / sides, radius_m, 1.0)] * sides


def detours(sides: int, share: float) -> Legs:
    """An S-bend in each side."""
    bend = [(math.pi / 2.0, share * SIDE_M, 1.0), (math.pi / 2.0, share * SIDE_M, -1.0)]
    return [*ahead(SIDE_M / 2.0), *bend, *ahead(SIDE_M / 2.0), *turn(360.0 / sides)] * sides


def past_the_ends(sides: int, share: float) -> Legs:
    """Past the end of each side, and back."""
    return [*ahead(SIDE_M * (1.0 + share)), *ahead(-SIDE_M * share), *turn(360.0 / sides)] * sides


class Family(NamedTuple):
    """How a figure of so many sides is spoilt, up to where, and in which steps.

    Attributes:
        left: most points at the end. of_corner: where it ends at the latest, as a share of a corner.
    """

    spoilt: Callable[[int, float], Legs]
    most: float
    step: float
    left: float
    of_corner: float = math.inf

    def end(self, figure: str) -> float:
        return min(self.most, self.of_corner * 360.0 / FIGURES[figure])


FAMILIES = {
    "a corner too wide": Family(lambda n, x: corners(n, 0.0, x), 25.0, STEP_DEG, 60),
    "a corner too narrow": Family(lambda n, x: corners(n, 0.0, -x), 24.0, STEP_DEG, 60),
    "all corners too wide": Family(lambda n, x: corners(n, *[x] * n), 15.0, STEP_DEG, 45),
    "all corners too narrow": Family(lambda n, x: corners(n, *[-x] * n), 15.0, STEP_DEG, 60),
    "laps further and further round": Family(
        lambda n, x: corners(n, *[0.0] * (n - 1), x, laps=3), 40.0, STEP_DEG, 80
    ),
    "a longer side": Family(lambda n, x: lengths(n, s1=x), 0.5, STEP, 82),
    "a shorter side": Family(lambda n, x: lengths(n, s1=-x), 0.5, STEP, 82),
    "a last side left out": Family(lambda n, x: lengths(n, **{f"s{n - 1}": -x}), 0.7, STEP, 90),
    "a way on": Family(lambda n, x: [*corners(n), *ahead(x * SIDE_M)], 0.8, STEP, 90),
    "an approach": Family(lambda n, x: [*ahead(x * SIDE_M), *turn(-50.0), *corners(n)], 1.0, STEP, 90),
    "an approach backwards": Family(lambda n, x: [*ahead(-x * SIDE_M), *corners(n)], 0.6, STEP, 99),
    "a way back at the end": Family(lambda n, x: [*corners(n)[:-2], *ahead(-x * SIDE_M)], 0.6, STEP, 94),
    "corners cut off": Family(cut_off, 0.36, STEP, 25),
    "a corner cut off": Family(cut_off_once, 0.5, STEP, 85),
    "sides that swing": Family(swung, 20.0, STEP_DEG, 90, 0.3),
    "a kinked side": Family(kinked, 45.0, STEP_DEG, 96),
    "bent sides": Family(bent, 54.0, STEP_DEG, 70, 0.65),
    "a bent side": Family(lambda n, x: bent(n, x, 1), 30.0, STEP_DEG, 95),
    "rounded corners": Family(rounded, 0.75, STEP, 65),
    "a worse second lap": Family(lambda n, x: [*corners(n), *corners(n, *[-x] * n)], 40.0, STEP_DEG, 81),
    "begun within and not finished": Family(lambda n, x: begun_within(n, 0.4, 1.0 - x), 0.8, STEP, 100),
    "detours": Family(detours, 0.25, STEP, 45),
    "past the ends": Family(past_the_ends, 0.6, STEP, 90),
}
ROWS = [(name, figure) for name in FAMILIES for figure in FIGURES]


def points(family: Family, figure: str, spoilt: float) -> float:
    return score(graded(figure, drive(family.spoilt(FIGURES[figure], spoilt))))


@pytest.mark.parametrize("row", slow_but(len(FAMILIES), ROWS))
def test_the_more_a_figure_is_spoilt_the_less_it_earns(row: tuple[str, str]) -> None:
    family, figure = FAMILIES[row[0]], row[1]
    earned = [points(family, figure, family.end(figure) * i / 12) for i in range(13)]
    assert earned[0] == 100.0
    assert earned[-1] <= family.left
    assert max(after - before for before, after in itertools.pairwise(earned)) <= SAMPLING


@settings(max_examples=examples(400))
@given(st.sampled_from(ROWS), st.floats(0.0, 1.0))
def test_a_step_costs_at_most_eight_points_and_gains_nothing(row: tuple[str, str], share: float) -> None:
    family, figure = FAMILIES[row[0]], row[1]
    spoilt = share * (family.end(figure) - family.step)
    cost = points(family, figure, spoilt) - points(family, figure, spoilt + family.step)
    assert -SAMPLING <= cost <= MOST_COST


@pytest.mark.parametrize("heading_deg", [33.0, 90.0, -145.0])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_it_makes_no_difference_how_the_figure_lies(heading_deg: float, sense: float) -> None:
    for legs in (cut_off(4, 0.15), swung(4, 18.9), kinked(4, 18.0)):
        mirrored = [(duration, v, sense * w) for duration, v, w in legs]
        here = score(graded("square", drive(legs)))
        assert score(graded("square", drive(mirrored, heading_deg=heading_deg))) == pytest.approx(here, abs=3)
        assert 40 < here < 99


@pytest.mark.parametrize(("name", "sides"), FIGURES.items())
def test_what_is_no_such_figure_gains_nothing(name: str, sides: int) -> None:
    circle = drive(arc(360.0, 6.0))
    twice_the_corners = drive([*ahead(1.0), *turn(180.0 / sides)] * (2 * sides))
    to_and_fro = drive([*ahead(2.0), (1.5, -1.0, 0.0), *turn(360.0 / sides)] * sides)
    points = [score(graded(name, one)) for one in (circle, twice_the_corners, to_and_fro)]
    assert max(points) <= 35


def lap(sides: int, side_m: float) -> Legs:
    return [*ahead(side_m), *turn(360.0 / sides)] * sides


@pytest.mark.parametrize(("name", "sides"), FIGURES.items())
@pytest.mark.parametrize("sizes_m", [(0.5, 1.0, 1.5), (2.0, 1.0), (1.0, 1.2, 1.4, 1.7)])
def test_laps_from_one_corner_may_grow_or_shrink(name: str, sides: int, sizes_m: tuple[float, ...]) -> None:
    legs = [leg for side_m in sizes_m for leg in lap(sides, side_m)]
    assert score(graded(name, drive(legs))) == 100
    moved = [leg for side_m in sizes_m for leg in (*lap(sides, side_m), *ahead(0.3))]
    assert score(graded(name, drive(moved))) <= 80


def test_a_spiral_is_no_square_that_grows() -> None:
    spiral = [leg for i in range(12) for leg in (*ahead(1.04**i), *turn(90.0))]
    assert score(graded("square", drive(spiral))) < 80
