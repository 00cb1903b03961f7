"""The driven path: distance, direction of travel, teleports."""

import itertools
import math

import numpy as np
import pytest

from grader.geometry.path import driven_path


def straight(*stops_m: float) -> np.ndarray:
    """Positions 1 cm apart along a line from stop to stop."""
    parts = [np.arange(a, b, math.copysign(0.01, b - a)) for a, b in itertools.pairwise(stops_m)]
    return np.concatenate([*parts, [stops_m[-1]]])


def test_distance_and_direction_ahead() -> None:
    x = straight(0.0, 2.0)
    path = driven_path(x, np.zeros_like(x), np.zeros_like(x))
    assert path.along_m[-1] == pytest.approx(2.0)
    assert np.all(path.travel_rad == 0.0)
    assert path.extent_m == pytest.approx(2.0)


def test_backing_up_travels_the_other_way() -> None:
    x = straight(0.0, -2.0)
    path = driven_path(x, np.zeros_like(x), np.zeros_like(x))
    assert path.along_m[-1] == pytest.approx(2.0)
    assert path.signed_m[-1] == pytest.approx(-2.0)
    assert np.all(path.travel_rad == math.pi)


def test_there_and_back_adds_up_and_turns_round() -> None:
    x = straight(0.0, 2.0, 0.5)
    path = driven_path(x, np.zeros_like(x), np.zeros_like(x))
    assert path.along_m[-1] == pytest.approx(3.5)
    assert path.travel_rad[0] == 0.0
    assert path.travel_rad[-1] == math.pi


def test_a_small_correction_is_no_way_back() -> None:
    x = straight(0.0, 2.1, 2.0)
    path = driven_path(x, np.zeros_like(x), np.zeros_like(x))
    assert path.along_m[-1] == pytest.approx(2.0)
    assert np.all(path.travel_rad == 0.0)


def test_noise_at_rest_does_not_add_up() -> None:
    rng = np.random.default_rng(7)
    x, y = 0.002 * rng.standard_normal((2, 600))
    path = driven_path(x, y, np.zeros(600))
    assert abs(path.along_m[-1]) < 0.02


def test_a_teleport_is_taken_out_with_its_turn() -> None:
    """Ahead 1 m, put down elsewhere facing up, ahead another metre: 2 m straight."""
    leg = np.linspace(0.0, 1.0, 50)
    x = np.concatenate([leg, np.full(50, 5.0)])
    y = np.concatenate([np.zeros(50), 3.0 + leg])
    heading = np.concatenate([np.zeros(50), np.full(50, math.pi / 2)])
    path = driven_path(x, y, heading, jumps=[50])
    assert path.along_m[-1] == pytest.approx(2.0)
    assert (path.x_m[-1], path.y_m[-1]) == (pytest.approx(2.0), pytest.approx(0.0))
    assert np.allclose(path.heading_rad, 0.0)
    assert heading[-1] == math.pi / 2, "the caller's arrays stay as they are"


def test_a_single_sample() -> None:
    path = driven_path(np.zeros(1), np.zeros(1), np.zeros(1))
    assert len(path) == 1
    assert path.along_m.tolist() == [0.0]
