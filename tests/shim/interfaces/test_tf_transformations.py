"""tf_transformations: its documented examples, and agreement with rotations composed by hand."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tf_transformations import (
    compose_matrix,
    concatenate_matrices,
    decompose_matrix,
    euler_from_matrix,
    euler_from_quaternion,
    euler_matrix,
    inverse_matrix,
    is_same_transform,
    quaternion_about_axis,
    quaternion_conjugate,
    quaternion_from_euler,
    quaternion_from_matrix,
    quaternion_inverse,
    quaternion_matrix,
    quaternion_multiply,
    quaternion_slerp,
    random_quaternion,
    random_rotation_matrix,
    random_vector,
    reflection_from_matrix,
    reflection_matrix,
    rotation_from_matrix,
    rotation_matrix,
    scale_from_matrix,
    scale_matrix,
    shear_matrix,
    translation_from_matrix,
    translation_matrix,
    unit_vector,
    vector_norm,
)

AXES = [
    frame + "".join(letters)
    for frame in "sr"
    for letters in itertools.product("xyz", repeat=3)
    if letters[0] != letters[1] != letters[2]
]
ANGLE = st.floats(-math.pi, math.pi) | st.sampled_from([0.0, math.pi / 2, -math.pi / 2, math.pi])


def turn(axis: str, angle: float) -> np.ndarray:
    """Return the textbook matrix of a turn about one axis."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array(
        {
            "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
            "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
            "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
        }[axis]
    )


def test_there_are_24_conventions() -> None:
    assert len(AXES) == 24


@given(st.sampled_from(AXES), ANGLE, ANGLE, ANGLE)
def test_euler_angles_compose_turns_about_their_axes(axes: str, a: float, b: float, c: float) -> None:
    turns = [turn(axis, angle) for axis, angle in zip(axes[1:], (a, b, c), strict=True)]
    expected = np.linalg.multi_dot(turns[::-1] if axes[0] == "s" else turns)
    rotation = quaternion_matrix(quaternion_from_euler(a, b, c, axes))[:3, :3]
    np.testing.assert_allclose(rotation, expected, atol=1e-12)
    again = euler_matrix(*euler_from_quaternion(quaternion_from_euler(a, b, c, axes), axes), axes)[:3, :3]
    np.testing.assert_allclose(again, expected, atol=1e-7)


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_roll_pitch_yaw_come_back(roll: float, pitch: float, yaw: float) -> None:
    back = euler_from_quaternion(quaternion_from_euler(roll, pitch, yaw))
    assert back == pytest.approx((roll, pitch, yaw), abs=1e-9)


def test_documented_examples() -> None:
    assert euler_from_quaternion([0.06146124, 0, 0, 0.99810947]) == pytest.approx((0.123, 0, 0), abs=1e-6)
    assert quaternion_from_euler(1, 2, 3, "ryxz") == pytest.approx(
        (0.310622, -0.718287, 0.444435, 0.435953), abs=1e-6
    )
    assert quaternion_about_axis(0.123, (1, 0, 0)) == pytest.approx((0.06146124, 0, 0, 0.99810947), abs=1e-7)
    assert quaternion_multiply([1, -2, 3, 4], [-5, 6, 7, 8]) == (-44, -14, 48, 28)


def test_quaternion_algebra() -> None:
    q = quaternion_from_euler(0.1, 0.2, 0.3)
    longer = tuple(2 * component for component in q)
    assert quaternion_multiply(longer, quaternion_inverse(longer)) == pytest.approx((0, 0, 0, 1))
    assert quaternion_conjugate(q) == pytest.approx(quaternion_inverse(q))
    assert quaternion_from_matrix(quaternion_matrix(q)) == pytest.approx(q)
    assert quaternion_from_matrix(turn("z", math.pi)) == pytest.approx((0, 0, 1, 0), abs=1e-12)
    assert euler_from_quaternion((0, 0, 0, 0)) == (0, 0, 0)


def test_slerp() -> None:
    start, end = quaternion_from_euler(0, 0, 0), quaternion_from_euler(0, 0, 1.0)
    half = quaternion_slerp(start, end, 0.5)
    assert euler_from_quaternion(half)[2] == pytest.approx(0.5)
    assert quaternion_slerp(start, end, 0.0) == start
    assert quaternion_slerp(start, end, 1.0) == end
    other_way = tuple(-component for component in end)
    assert euler_from_quaternion(quaternion_slerp(start, other_way, 0.5))[2] == pytest.approx(0.5)


def test_matrices() -> None:
    shift = translation_matrix([1, 2, 3])
    assert translation_from_matrix(shift).tolist() == [1, 2, 3]
    both = concatenate_matrices(shift, euler_matrix(0, 0, 0.5))
    assert is_same_transform(concatenate_matrices(both, inverse_matrix(both)), np.identity(4))
    assert euler_from_matrix(both)[2] == pytest.approx(0.5)
    assert vector_norm([3.0, 4.0]) == 5.0
    assert unit_vector([3.0, 4.0]).tolist() == [0.6, 0.8]
    about = rotation_matrix(math.pi, [0, 0, 1], [1, 0, 0])
    assert (about @ [0, 0, 0, 1]).tolist() == pytest.approx([2, 0, 0, 1])


@pytest.mark.parametrize("axes", ["xyz", "sxxy", "txyz", "sxya", ""])
def test_unknown_conventions_are_refused(axes: str) -> None:
    with pytest.raises(KeyError):
        quaternion_from_euler(0, 0, 0, axes)


@given(
    st.lists(st.floats(0.5, 2.0), min_size=3, max_size=3),
    st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3),
    st.lists(st.floats(-1.5, 1.5), min_size=3, max_size=3),
    st.lists(st.floats(-9.0, 9.0), min_size=3, max_size=3),
)
def test_a_matrix_is_decomposed_into_what_it_is_composed_of(
    scale: list[float], shear: list[float], angles: list[float], translate: list[float]
) -> None:
    matrix = compose_matrix(scale, shear, angles, translate)
    found = decompose_matrix(matrix)
    assert found[4] is None
    for part, given_part in zip(found, (scale, shear, angles, translate), strict=False):
        assert np.allclose(part, given_part, atol=1e-6)
    mirrored = compose_matrix([-scale[0], *scale[1:]], shear, angles, translate)
    assert np.allclose(compose_matrix(*decompose_matrix(mirrored)), mirrored, atol=1e-6)
    assert np.allclose(compose_matrix(), np.identity(4))


POINT, AXIS = [1.0, -2.0, 3.0], [0.0, 0.6, 0.8]


@pytest.mark.parametrize("angle", [0.5, -2.5, math.pi])
def test_angle_axis_and_point_of_a_rotation_are_found_again(angle: float) -> None:
    matrix = rotation_matrix(angle, AXIS, POINT)
    assert is_same_transform(matrix, rotation_matrix(*rotation_from_matrix(matrix)))


def test_scaling_and_mirroring_are_found_again() -> None:
    for matrix in (scale_matrix(-1.5, POINT), scale_matrix(2.5, POINT, AXIS), scale_matrix(3.0)):
        assert is_same_transform(matrix, scale_matrix(*scale_from_matrix(matrix)))
    assert scale_from_matrix(scale_matrix(3.0))[2] is None
    mirror = reflection_matrix(POINT, AXIS)
    assert is_same_transform(mirror, reflection_matrix(*reflection_from_matrix(mirror)))
    assert np.allclose(mirror @ [*POINT, 1.0], [*POINT, 1.0])
    with pytest.raises(ValueError, match="eigenvalue -1"):
        reflection_from_matrix(np.identity(4))


def test_shearing_leaves_its_plane_and_is_refused_across_it() -> None:
    matrix = shear_matrix(math.pi / 4, [1.0, 0.0, 0.0], POINT, [0.0, 0.0, 2.0])
    assert np.allclose(matrix @ [*POINT, 1.0], [*POINT, 1.0])
    assert np.allclose(matrix @ [1.0, -2.0, 5.0, 1.0], [3.0, -2.0, 5.0, 1.0])
    with pytest.raises(ValueError, match="not orthogonal"):
        shear_matrix(0.1, AXIS, POINT, AXIS)


def test_random_rotations_are_rotations() -> None:
    assert np.allclose(random_quaternion([0.0, 0.25, 0.0]), [1.0, 0.0, 0.0, 0.0])
    assert math.isclose(float(np.linalg.norm(random_quaternion())), 1.0)
    assert np.allclose(np.linalg.det(random_rotation_matrix()), 1.0)
    assert random_vector(3).shape == (3,)
