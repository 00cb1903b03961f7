"""Exact arithmetic: near the true value, the same bits for floats and arrays, and always the same bits."""

import cmath
import hashlib
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.geometry import exact

ANGLES = st.floats(-1e4, 1e4)
LENGTHS = st.floats(-1e3, 1e3)
ULP = 2.0**-52


@given(ANGLES)
def test_cosine_and_sine_are_near_the_true_ones_and_alike_for_arrays(angle_rad: float) -> None:
    cos, sin = exact.cos_sin(angle_rad)
    assert abs(cos - math.cos(angle_rad)) <= ULP
    assert abs(sin - math.sin(angle_rad)) <= ULP
    many = exact.cos_sin(np.array([angle_rad]))
    assert (many[0][0], many[1][0]) == (cos, sin)


@given(LENGTHS, LENGTHS)
def test_directions_are_near_the_true_ones_and_alike_for_arrays(x: float, y: float) -> None:
    x, y = x + 0.0, y + 0.0  # the origin has no direction, whatever the signs of its zeros
    angle = exact.atan2(y, x)
    assert abs(angle - math.atan2(y, x)) <= 4.0 * ULP
    assert exact.atan2(np.array([y]), np.array([x]))[0] == angle
    assert exact.hypot(x, y) == exact.hypot(np.array([x]), np.array([y]))[0]
    assert exact.hypot(x, y) == pytest.approx(math.hypot(x, y), rel=4.0 * ULP, abs=1e-150)


@pytest.mark.parametrize(
    ("y", "x"), [(0.0, 0.0), (0.0, -1.0), (-0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (1.0, 1.0)]
)
def test_directions_along_the_axes(y: float, x: float) -> None:
    assert exact.atan2(y, x) == math.atan2(y, x)


def test_what_is_no_number_stays_none() -> None:
    assert all(map(math.isnan, exact.cos_sin(math.inf)))
    assert math.isnan(exact.atan2(math.nan, 1.0))
    assert math.isnan(exact.total([math.inf, -math.inf]))
    assert np.isnan(exact.atan2(np.array([math.nan]), np.array([1.0]))).all()


def test_the_bits_are_the_same_everywhere() -> None:
    angles_rad = np.arange(-40_000, 40_000) / 97.0
    cos, sin = exact.cos_sin(angles_rad)
    bits = b"".join(
        column.tobytes() for column in (cos, sin, exact.atan2(sin, cos * 3.0), exact.hypot(cos, sin + 1.0))
    )
    assert hashlib.sha256(bits).hexdigest()[:16] == "dedf4dfa097b66c1"


def test_between_points_values_lie_on_lines() -> None:
    along, values = np.array([0.0, 1.0, 1.0, 3.0]), np.array([0.0, 2.0, 4.0, 0.0])
    at = np.array([-1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 9.0])
    assert exact.interpolated(at, along, values).tolist() == [0.0, 0.0, 1.0, 4.0, 2.0, 0.0, 0.0]
    assert exact.interpolated(at, along[:1], values[:1] + 7.0).tolist() == [7.0] * 7


def test_points_turn_and_correlate_as_complex_numbers_do() -> None:
    points = exact.paired(np.array([1.0, -2.0, 0.5]), np.array([0.0, 3.0, -4.0]))
    factor = exact.rect(2.0, 0.3)
    assert factor == pytest.approx(cmath.rect(2.0, 0.3))
    assert exact.turned(points, factor) == pytest.approx(points * factor)
    assert exact.correlation(points, points * 1j) == pytest.approx(complex(np.vdot(points, points * 1j)))
    assert exact.axis(exact.turned(np.array([-1.0 + 0j, 2.0 + 0j]), exact.rect(1.0, 0.7))) == pytest.approx(
        0.7
    )
