"""Credit for figures: a part earns its part, and coming nearer to the wanted figure never costs anything."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from grader.contracts.outcome import RunStatus
from grader.contracts.trajectory import Trajectory
from tests.unit.checks.shipped import graded, item, score
from tests.unit.checks.trajectories import Leg, drive, once_each, polygon_legs

FIGURES = {"triangle": 3, "square": 4, "pentagon": 5, "hexagon": 6, "octagon": 8}
SIDE_M = 1.2


def sides_driven(sides: int, count: int) -> list[Leg]:
    return polygon_legs(sides, SIDE_M, laps=count / sides)


def with_corners(sides: int, corners_deg: Sequence[float]) -> list[Leg]:
    return polygon_legs(sides, SIDE_M, corners_deg=corners_deg)


@pytest.mark.parametrize(("name", "sides"), FIGURES.items())
def test_a_part_of_the_sides_earns_about_that_part(name: str, sides: int) -> None:
    earned = [score(graded(name, drive(sides_driven(sides, count)))) for count in range(1, sides + 1)]
    assert earned == sorted(earned)
    assert (earned[0], earned[-1]) == (5, 100)
    for count, points in enumerate(earned[1:-1], start=2):
        if 2 * count > sides:
            assert abs(points - 90.0 * count / sides) < 8  # of what is not for moving and resting


@pytest.mark.parametrize(("name", "sides"), FIGURES.items())
def test_the_same_slip_costs_the_same_in_each_figure(name: str, sides: int) -> None:
    right_deg = 360.0 / sides
    for wrong_deg in (90.0, 120.0, 2.0 * right_deg if sides > 4 else 60.0, right_deg / 2.0):
        if wrong_deg != right_deg:
            assert score(graded(name, drive(with_corners(sides, [wrong_deg] * sides)))) == 40, wrong_deg


@pytest.mark.parametrize(("name", "sides"), FIGURES.items())
def test_one_side_too_many_costs_no_more_than_two(name: str, sides: int) -> None:
    one, two, most = (
        score(graded(name, drive(sides_driven(sides, count))))
        for count in (sides + 1, sides + 2, 2 * sides - 1)
    )
    assert one >= two >= most >= 80


def test_one_straight_is_no_part_of_a_figure() -> None:
    scoring = graded("octagon", drive([(3.0, 1.0, 0.0)]))
    assert score(scoring) == 5
    assert item(scoring, "sides").earned == 0


def test_a_drive_past_the_figure_until_ctrl_c_is_not_back_at_the_start() -> None:
    there = drive([*polygon_legs(4, 1.0), (40.0, 0.1, 0.0)], horizon_s=50.0)
    scoring = graded("square", there, RunStatus.INTERRUPTED)
    assert (item(scoring, "closed").earned, item(scoring, "rest").earned) == (0, 0)
    assert score(scoring) == 80


@pytest.mark.parametrize("waits_s", [(1.0,), (2.0,), (1.0, 1.0, 2.0)])
def test_the_phase_at_which_ctrl_c_ends_a_figure_of_single_messages_does_not_matter(
    waits_s: tuple[float, ...],
) -> None:
    """Each motion is one message, which turtlesim obeys for a second: that second is no rest."""
    legs = [leg for wait_s in waits_s for leg in ((2.0, 0.0, math.pi / 2.0), (wait_s, 2.0, 0.0))]
    lap_s = sum(leg[0] for leg in legs)
    for phase in range(12):
        ready_s = 1.0 + phase * lap_s / 12.0
        whole = once_each([(ready_s, 0.0, 0.0), *legs * round(80.0 / lap_s)])
        for horizon_s in (60.0, 62.0, 64.0):
            assert score(graded("square", _until(whole, horizon_s), RunStatus.INTERRUPTED)) == 100


def _until(whole: Trajectory, horizon_s: float) -> Trajectory:
    end_ns = round(horizon_s * 1e9)
    count = int(np.searchsorted(whole.t_ns, end_ns, side="right"))
    columns = {
        name: getattr(whole, name)[:count]
        for name in ("t_ns", "x_m", "y_m", "heading_rad", "v_mps", "w_radps")
    }
    commands = tuple(each for each in whole.commands if each.t_ns < end_ns)
    return Trajectory(**columns, commands=commands, end_ns=end_ns)
