"""How far the robot's outline is from solids, against cases that need no program."""

import math

import numpy as np
import pytest

from grader.contracts.robot import BACK_M, FRONT_M, HALF_WIDTH_M
from grader.geometry.room import ahead_m, clearance_m, from_point_m
from tests.unit.sim.rooms import solid

BOX = solid("box", 1.0, 0.0, 0.4, 0.2)
POST = solid("cylinder", 0.0, 1.0, 0.2, 0.2)
WALL = solid("wall", 0.0, 0.0, 2.0, 0.02)


def apart(thing: object, x: float, y: float, heading_deg: float = 0.0) -> float:
    pose = (np.array([each]) for each in (x, y, math.radians(heading_deg)))
    return float(clearance_m(thing, *pose)[0])  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("thing", "pose", "wanted"),
    [
        (BOX, (0.0, 0.0, 0.0), 0.8 - FRONT_M),
        (BOX, (0.0, 0.0, 180.0), 0.8 + BACK_M),
        (BOX, (1.0, 1.0, 0.0), 0.9 - HALF_WIDTH_M),
        (POST, (0.0, 0.0, 90.0), 0.9 - FRONT_M),
        (POST, (1.0, 1.0, 90.0), 0.9 - HALF_WIDTH_M),
        (BOX, (0.78, 0.0, 0.0), 0.0),
        (POST, (0.0, 1.0, 0.0), 0.0),
        (WALL, (0.03, 0.0, 90.0), 0.0),  # runs through the outline: no corner of either is in the other
        (WALL, (0.0, 0.4, 0.0), 0.39 - HALF_WIDTH_M),
    ],
)
def test_clearance(thing: object, pose: tuple[float, float, float], wanted: float) -> None:
    assert apart(thing, *pose) == pytest.approx(wanted, abs=1e-12)


def test_a_turned_box_is_nearest_at_its_corner() -> None:
    turned = solid("box", 1.0, 0.0, 0.2, 0.2, 45.0)
    assert apart(turned, 0.0, 0.0) == pytest.approx(1.0 - 0.1 * math.sqrt(2.0) - FRONT_M)
    assert float(from_point_m(turned, np.array([0.0]), np.array([0.0]))[0]) == pytest.approx(
        1.0 - 0.1 * math.sqrt(2.0)
    )


def test_what_lies_straight_ahead() -> None:
    assert ahead_m([BOX, POST], 0.0, 0.0, 0.0) == pytest.approx(0.8)
    assert ahead_m([BOX, POST], 0.0, 0.0, math.pi / 2.0) == pytest.approx(0.9)
    assert ahead_m([BOX, POST], 0.0, 0.0, math.pi) == math.inf
    assert ahead_m([POST], 0.05, 0.0, math.pi / 2.0) == pytest.approx(1.0 - math.sqrt(0.01 - 0.0025))
