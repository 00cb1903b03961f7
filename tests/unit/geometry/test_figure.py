"""Which part of a drive is read as the figure, and what follows it."""

import math

import pytest

from grader.checks.drive import Drive
from grader.checks.kinds.polygon import read
from grader.geometry.figure import PolygonFigure, readings
from grader.geometry.path import driven_path, segment
from tests.unit.checks.shipped import assignment
from tests.unit.checks.trajectories import Leg, drive, polygon_legs, run_of

ASSIGNMENTS = {3: "triangle", 4: "square", 5: "pentagon", 8: "octagon"}


def figure_of(legs: list[Leg], *, sides: int = 4, cut_short: bool = False, **how: float) -> PolygonFigure:
    """Return the way to read a drive that earns most."""
    trajectory = drive(legs, **how)  # type: ignore[arg-type]
    path = driven_path(trajectory.x_m, trajectory.y_m, trajectory.heading_rad)
    driven = Drive(path, trajectory.t_ns, moving_at_end=cut_short, cut_short=cut_short)
    figure = read(assignment(ASSIGNMENTS[sides]), run_of(trajectory), driven)[0].figure
    assert figure is not None
    return figure


def corners(figure: PolygonFigure) -> list[int]:
    return [round(math.degrees(corner)) for corner in figure.corners_rad]


def last_turn(figure: PolygonFigure) -> int:
    return round(math.degrees(figure.last_turn_rad))


def test_without_a_straight_run_there_is_no_figure() -> None:
    trajectory = drive([(5.0, 0.0, 1.0)])
    path = driven_path(trajectory.x_m, trajectory.y_m, trajectory.heading_rad)
    assert list(readings(path, segment(path), sides=4, cut_short=False)) == []


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
    assert corners(figure) == [450] * 3
    assert last_turn(figure) == 90


def test_the_curved_share_is_what_arcs_have_of_the_distance() -> None:
    figure = figure_of([(2.0, 1.0, 0.0), (math.pi / 2, 1.0, 1.0)] * 4)
    assert figure.curved_share == pytest.approx(math.pi / 2 / (2.0 + math.pi / 2), abs=0.05)
    assert figure_of(polygon_legs(4)).curved_share < 0.005


def test_right_turns_have_negative_corners() -> None:
    figure = figure_of(polygon_legs(3, w_radps=-1.0))
    assert corners(figure) == [-120] * 2
    assert last_turn(figure) == -120


def test_perimeter() -> None:
    assert figure_of(polygon_legs(5, 1.2)).perimeter_m == pytest.approx(6.0, abs=0.05)


@pytest.mark.parametrize(
    ("turned_deg", "seen"),
    [(90, 90), (450, 90), (810, 90), (360, 0), (-720, 0), (400, 40), (175, 175), (270, -90)],
)
def test_the_last_turn_is_no_corner_and_known_but_for_whole_turns(turned_deg: int, seen: int) -> None:
    turn = (math.radians(abs(turned_deg)), 0.0, math.copysign(1.0, turned_deg))
    figure = figure_of([*polygon_legs(4, 1.0, last_turn=False), turn])
    assert corners(figure) == [90, 90, 90]
    assert last_turn(figure) == seen
    assert not figure.overrun


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize(("spun_deg", "seen"), [(360, 90), (720, 90), (175, -85), (355, 95)])
def test_a_pirouette_the_other_way_round(spun_deg: int, seen: int, sense: int) -> None:
    legs = polygon_legs(4, 1.0, w_radps=float(sense))
    figure = figure_of([*legs, (math.radians(spun_deg), 0.0, -float(sense))])
    assert last_turn(figure) == sense * seen


def test_a_circle_after_the_figure_is_not_overlooked() -> None:
    figure = figure_of([*polygon_legs(4, 1.0, last_turn=False), (2.0 * math.pi, 0.5, 1.0)])
    assert last_turn(figure) == 360


def test_the_last_turn_of_a_figure_that_lacks_it_is_a_corner() -> None:
    figure = figure_of(polygon_legs(4, 1.0, laps=0.75))
    assert corners(figure) == [90, 90, 90]
    assert last_turn(figure) == 0


TURN: Leg = (math.pi / 2, 0.0, 1.0)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("turned_deg", [90, -90, 135, -45, 175])
def test_an_approach_is_no_side(turned_deg: int, sense: int) -> None:
    turn = (math.radians(abs(turned_deg)), 0.0, math.copysign(1.0, turned_deg))
    figure = figure_of([(0.5, 1.0, 0.0), turn, *polygon_legs(4, 1.0, w_radps=float(sense))])
    assert figure.sides_m == pytest.approx([1.0] * 4, abs=0.02)
    assert corners(figure) == [sense * 90] * 3
    assert figure.approach_m == pytest.approx(0.5, abs=0.02)
    assert figure.gap_m == pytest.approx(0.5, abs=0.02)


def test_an_approach_from_the_middle_of_the_figure() -> None:
    figure = figure_of([*[(0.6, 1.0, 0.0), TURN] * 2, *polygon_legs(4, 1.2)])
    assert figure.sides_m == pytest.approx([1.2] * 4, abs=0.02)
    assert figure.approach_m == pytest.approx(1.2, abs=0.04)
    assert figure.gap_m == pytest.approx(0.6 * math.sqrt(2.0), abs=0.02)


def test_a_first_side_too_long_is_no_approach() -> None:
    figure = figure_of(polygon_legs(4, lengths_m=[2.5, 2.0, 2.0, 2.0]))
    assert figure.approach_m == 0.0
    assert figure.sides_m[0] == pytest.approx(2.5, abs=0.02)


def test_a_triangle_that_closes_by_chance_is_not_the_figure() -> None:
    figure = figure_of([(2.12, 1.0, 0.0), (math.radians(135), 0.0, 1.0), *polygon_legs(4, 1.5)])
    assert len(figure.sides_m) == 4


@pytest.mark.parametrize(("sides", "repeated"), [(6, False), (7, False), (8, True), (9, False), (12, True)])
def test_a_lap_given_up_is_no_repetition(sides: int, repeated: bool) -> None:
    figure = figure_of(polygon_legs(4, 1.0, laps=sides / 4))
    assert len(figure.sides_m) == 4
    assert (figure.repeated > 0.0) is repeated
    assert figure.overrun is not repeated


def test_where_the_car_came_to_rest_after_the_figure_is_the_gap() -> None:
    figure = figure_of([*polygon_legs(4, 1.0), (0.5, 1.0, 0.0)])
    assert figure.overrun
    assert figure.gap_m == pytest.approx(0.5, abs=0.02)
    assert figure.end < figure.rest


@pytest.mark.parametrize("turned_deg", [-90, 270])
def test_sides_driven_forward_and_backing_up_in_turn(turned_deg: int) -> None:
    turn = (math.radians(abs(turned_deg)), 0.0, math.copysign(1.0, turned_deg))
    figure = figure_of([leg for v in (1.0, -1.0) * 2 for leg in ((1.0, v, 0.0), turn)])
    assert corners(figure) == [90, 90, 90]
    assert last_turn(figure) == 90
    assert figure.gap_m < 0.03


def test_as_many_sides_as_are_wanted_are_one_figure_though_it_comes_round_before() -> None:
    legs = polygon_legs(8, 1.0, corners_deg=[60.0] * 8)
    assert len(figure_of(legs, sides=8).sides_m) == 8
    assert len(figure_of(legs, sides=4).sides_m) == 6


def test_right_laps_after_one_with_a_corner_off_are_the_figure() -> None:
    lap = polygon_legs(4, corners_deg=[115.0, 90.0, 90.0, 90.0])
    figure = figure_of([*lap, *polygon_legs(4, laps=2)])
    assert figure.approach_m == pytest.approx(2.0, abs=0.02)
    assert corners(figure)[:3] == [90, 90, 90]


@pytest.mark.parametrize(("then", "repeated"), [(4, True), (-4, True), (6, False)])
def test_another_figure_with_sides_as_long_is_no_repetition(then: int, repeated: bool) -> None:
    after = polygon_legs(abs(then), 1.0, w_radps=math.copysign(1.0, then))
    figure = figure_of([*polygon_legs(4, 1.0), *after])
    assert (figure.repeated > 0.0) is repeated
    assert figure.overrun is not repeated


def test_a_way_there_and_back_home_is_no_side_begun_in_its_middle() -> None:
    there: list[Leg] = [(1.0, 1.0, 0.0), (math.radians(45), 0.0, 1.0)]
    home: list[Leg] = [(math.radians(135), 0.0, 1.0), (1.0, 1.0, 0.0)]
    figure = figure_of([*there, *polygon_legs(4), *home])
    assert figure.sides_m == pytest.approx([2.0] * 4, abs=0.02)
    assert figure.approach_m == pytest.approx(1.0, abs=0.02)
    assert figure.overrun
