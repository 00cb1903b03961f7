"""Where the first figure ends, and what follows it."""

import math

import pytest

from grader.geometry.figure import PolygonFigure, measure_polygon
from grader.geometry.path import driven_path
from grader.geometry.segmentation import segment
from tests.unit.checks.ideal_turtle import Leg, drive, polygon_legs


def figure_of(legs: list[Leg], *, cut_short: bool = False, **how: float) -> PolygonFigure:
    trajectory = drive(legs, **how)  # type: ignore[arg-type]
    path = driven_path(trajectory.x_m, trajectory.y_m, trajectory.heading_rad)
    figure = measure_polygon(path, segment(path), cut_short=cut_short)
    assert figure is not None
    return figure


def corners(figure: PolygonFigure) -> list[int]:
    return [round(math.degrees(corner)) for corner in figure.corners_rad]


def test_without_a_straight_run_there_is_no_figure() -> None:
    trajectory = drive([(5.0, 0.0, 1.0)])
    path = driven_path(trajectory.x_m, trajectory.y_m, trajectory.heading_rad)
    assert measure_polygon(path, segment(path), cut_short=False) is None


def test_an_open_figure_is_measured_to_its_end() -> None:
    figure = figure_of(polygon_legs(4, 1.0, laps=0.5, last_turn=False))
    assert figure.sides_m == pytest.approx((1.0, 1.0), abs=0.02)
    assert corners(figure) == [90]
    assert figure.gap_m == pytest.approx(math.sqrt(2.0), abs=0.03)


def test_whole_laps_are_one_figure_repeated() -> None:
    figure = figure_of(polygon_legs(3, 1.0, laps=2))
    assert len(figure.sides_m) == 3
    assert figure.repeated
    assert not figure.overrun


def test_one_side_too_many_at_rest_belongs_to_the_figure() -> None:
    figure = figure_of(polygon_legs(4, 1.0, laps=1.25))
    assert len(figure.sides_m) == 5
    assert figure.gap_m == pytest.approx(1.0, abs=0.05)


def test_one_side_more_when_cut_short_is_a_repetition_under_way() -> None:
    figure = figure_of(polygon_legs(4, 1.0, laps=1.25), cut_short=True)
    assert len(figure.sides_m) == 4
    assert figure.repeated
    assert figure.gap_m < 0.05


def test_a_longer_run_after_the_figure_is_no_repetition() -> None:
    legs = [*polygon_legs(4, 1.0), (3.0, 1.0, 0.0)]
    figure = figure_of(legs, cut_short=True, idle_s=0.0)
    assert len(figure.sides_m) == 4
    assert figure.overrun
    assert not figure.repeated


def test_a_closing_turn_cut_short_is_not_judged() -> None:
    whole = polygon_legs(4, 1.0, pause_s=0.0)
    cut_s = sum(duration for duration, _, _ in whole) - 0.8
    figure = figure_of(whole, cut_short=True, horizon_s=cut_s)
    assert corners(figure) == [90, 90, 90]


def test_spins_at_a_corner_do_not_end_the_figure() -> None:
    figure = figure_of(polygon_legs(4, 1.0, corners_deg=[450.0] * 4, w_radps=3.0))
    assert len(figure.sides_m) == 4
    assert corners(figure) == [450] * 4


def test_the_curved_share_is_what_arcs_have_of_the_distance() -> None:
    figure = figure_of([(2.0, 1.0, 0.0), (math.pi / 2, 1.0, 1.0)] * 4)
    assert figure.curved_share == pytest.approx(math.pi / 2 / (2.0 + math.pi / 2), abs=0.05)
    assert figure_of(polygon_legs(4)).curved_share < 0.005


def test_right_turns_have_negative_corners() -> None:
    assert corners(figure_of(polygon_legs(3, w_radps=-1.0))) == [-120] * 3


def test_perimeter() -> None:
    assert figure_of(polygon_legs(5, 1.2)).perimeter_m == pytest.approx(6.0, abs=0.05)


@pytest.mark.parametrize(
    ("closing_deg", "seen"),
    [(90, [90]), (450, [90]), (810, [90]), (360, []), (-720, []), (400, [40]), (180, [180]), (270, [270])],
)
def test_a_pirouette_after_the_figure_is_no_corner(closing_deg: int, seen: list[int]) -> None:
    turn = (math.radians(abs(closing_deg)), 0.0, math.copysign(1.0, closing_deg))
    figure = figure_of([*polygon_legs(4, 1.0, last_turn=False), turn])
    assert corners(figure) == [90, 90, 90, *seen]


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize(("spun_deg", "seen"), [(360, [90]), (720, [90]), (180, [-90]), (355, [95])])
def test_a_pirouette_the_other_way_round_is_none_either(spun_deg: int, seen: list[int], sense: int) -> None:
    legs = polygon_legs(4, 1.0, w_radps=float(sense))
    figure = figure_of([*legs, (math.radians(spun_deg), 0.0, -float(sense))])
    assert corners(figure) == [sense * corner for corner in (90, 90, 90, *seen)]


def test_a_circle_after_the_figure_is_not_overlooked() -> None:
    figure = figure_of([*polygon_legs(4, 1.0, last_turn=False), (2.0 * math.pi, 0.5, 1.0)])
    assert corners(figure) == [90, 90, 90, 360]
