"""Laying one path on another: recovered similarities, matches in order, distances, circles."""

import cmath
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.geometry.matching import Points, circle_through, fitted, frechet, matched, resampled

SHAPE: Points = np.array([0, 1, 2, 2 + 1j, 2 + 2j, 1 + 1j, 0.5 + 0.2j])
ANGLES = st.floats(-math.pi, math.pi)
COORDINATES = st.floats(-10.0, 10.0)


@given(ANGLES, st.floats(0.1, 10.0), COORDINATES, COORDINATES, st.booleans())
def test_a_similarity_is_recovered(angle: float, scale: float, x: float, y: float, mirrored: bool) -> None:
    source = np.conj(SHAPE) if mirrored else SHAPE
    target = cmath.rect(scale, angle) * source + complex(x, y)
    placed = fitted(SHAPE, target, scaled=True, mirrored=mirrored)
    assert np.allclose(placed.of(SHAPE), target, atol=1e-9)
    assert placed.scale == pytest.approx(scale)
    rigid = fitted(SHAPE, target, scaled=False, mirrored=mirrored)
    assert rigid.scale == pytest.approx(1.0)
    assert cmath.phase(rigid.factor * cmath.rect(1.0, -angle)) == pytest.approx(0.0, abs=1e-9)


@given(st.integers(0, 2**32 - 1), ANGLES, st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_no_other_similarity_fits_better(seed: int, turn: float, x: float, y: float) -> None:
    noise = np.random.default_rng(seed).standard_normal((2, len(SHAPE)))
    target = 1.5 * SHAPE + noise[0] + 1j * noise[1]
    best = fitted(SHAPE, target, scaled=False)
    left = np.sum(np.abs(best.of(SHAPE) - target) ** 2)
    other = cmath.rect(1.0, turn) * best.factor * SHAPE + best.offset + complex(x, y)
    assert left <= np.sum(np.abs(other - target) ** 2) + 1e-9


def test_points_that_are_one_point_fit_somehow() -> None:
    one = np.zeros(4, dtype=complex)
    for scaled in (True, False):
        assert np.allclose(fitted(one, SHAPE[:4], scaled=scaled).of(one), np.mean(SHAPE[:4]))


def test_a_match_is_in_order_and_whole() -> None:
    pairs = matched(SHAPE, SHAPE[[0, 0, 1, 2, 2, 3, 4, 5, 6]])
    assert pairs[0].tolist() == [0, 0]
    assert pairs[-1].tolist() == [6, 8]
    assert bool((np.diff(pairs, axis=0) >= 0).all())
    assert bool((np.diff(pairs, axis=0) <= 1).all())
    assert np.allclose(SHAPE[pairs[:, 0]], SHAPE[[0, 0, 1, 2, 2, 3, 4, 5, 6]][pairs[:, 1]])


def test_the_frechet_distance_minds_the_order() -> None:
    line = np.linspace(0, 1, 11) + 0j
    assert frechet(line, line + 0.25j) == pytest.approx(0.25)
    assert frechet(line, line[::-1]) == pytest.approx(1.0)
    there_and_back = np.concatenate((line, line[::-1], line))
    assert frechet(line, there_and_back) == pytest.approx(0.5)


def test_resampling_keeps_the_ends() -> None:
    path = resampled(np.array([0, 1, 1 + 1j]), np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.5, 1.5, 2.0]))
    assert path.tolist() == [0, 0.5, 1 + 0.5j, 1 + 1j]


@given(COORDINATES, COORDINATES, st.floats(0.1, 10.0), st.floats(0.5, 6.0), st.booleans())
def test_a_circle_is_recovered_from_an_arc(x: float, y: float, radius: float, arc: float, left: bool) -> None:
    angles = np.linspace(0.0, arc if left else -arc, 40)
    circle = circle_through(complex(x, y) + radius * np.exp(1j * angles))
    assert circle is not None
    assert circle.centre == pytest.approx(complex(x, y), abs=1e-4 * radius)
    assert circle.radius_m == pytest.approx(radius, rel=1e-4)
    assert circle.swept_rad == pytest.approx(arc if left else -arc, rel=1e-4)


def test_a_line_is_no_circle() -> None:
    assert circle_through(np.array([0, 1 + 0j, 2, 3])) is None
    assert circle_through(np.array([0, 1 + 0j])) is None
