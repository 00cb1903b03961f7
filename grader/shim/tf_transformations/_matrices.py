"""Homogeneous 4 x 4 matrices, as numpy arrays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from tf_transformations._quaternions import (
    euler_from_matrix,
    quaternion_about_axis,
    quaternion_from_euler,
    rotation_rows,
)

_NEARLY = 1e-5  # as exact as a number found by computing has to be


def identity_matrix() -> Any:
    """Return the matrix of no motion."""
    return _numpy().identity(4)


def translation_matrix(direction: Sequence[float]) -> Any:
    """Return the matrix that shifts by `direction`."""
    matrix = identity_matrix()
    matrix[:3, 3] = direction[:3]
    return matrix


def translation_from_matrix(matrix: Any) -> Any:
    """Return the shift of a matrix."""
    return _numpy().array(matrix)[:3, 3].copy()


def quaternion_matrix(quaternion: Sequence[float]) -> Any:
    """Return the matrix of a rotation."""
    matrix = identity_matrix()
    matrix[:3, :3] = rotation_rows(quaternion)
    return matrix


def euler_matrix(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Any:
    """Return the matrix of three Euler angles."""
    return quaternion_matrix(quaternion_from_euler(ai, aj, ak, axes))


def rotation_matrix(angle: float, direction: Sequence[float], point: Sequence[float] | None = None) -> Any:
    """Return the matrix that turns by `angle` about an axis through `point` (the origin when left out)."""
    matrix = quaternion_matrix(quaternion_about_axis(angle, direction[:3]))
    if point is not None:
        centre = _numpy().array(point[:3], dtype=float)
        matrix[:3, 3] = centre - matrix[:3, :3] @ centre
    return matrix


def rotation_from_matrix(matrix: Any) -> Any:
    """Return angle, axis and a point of the axis of a matrix that turns.

    Raises ValueError: it does something else.
    """
    numpy = _numpy()
    whole = numpy.array(matrix, dtype=float)
    turn = whole[:3, :3]
    axis = _fixed_vector(turn.T, 1.0)[:3]
    by_sine = numpy.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    angle = math.atan2(float(by_sine @ axis) / 2, float(numpy.trace(turn) - 1.0) / 2)
    point = _fixed_vector(whole, 1.0)
    return angle, axis, point / point[3]


def scale_matrix(factor: float, origin: Any = None, direction: Any = None) -> Any:
    """Return the matrix that scales by `factor` about `origin`, along `direction` only if that is given."""
    numpy = _numpy()
    matrix = identity_matrix()
    if direction is None:
        matrix[:3, :3] *= factor
    else:
        along = unit_vector(direction[:3])
        matrix[:3, :3] -= (1.0 - factor) * numpy.outer(along, along)
    return _about(matrix, origin)


def scale_from_matrix(matrix: Any) -> Any:
    """Return factor, origin and direction of a matrix that scales; without a direction it is None.

    Raises ValueError: it does something else.
    """
    numpy = _numpy()
    whole = numpy.array(matrix, dtype=float)
    factor = float(numpy.trace(whole[:3, :3])) - 2.0
    direction = None
    if any(abs(value - factor) < _NEARLY for value in numpy.linalg.eigvals(whole[:3, :3])):
        direction = _fixed_vector(whole[:3, :3], factor)
    else:
        factor = (factor + 2.0) / 3.0
    origin = _fixed_vector(whole, 1.0)
    return factor, origin / origin[3], direction


def reflection_matrix(point: Any, normal: Any) -> Any:
    """Return the matrix that mirrors at the plane through `point`, to which `normal` is perpendicular."""
    return scale_matrix(-1.0, point, normal)


def reflection_from_matrix(matrix: Any) -> Any:
    """Return a point of the plane, and what is perpendicular to it, of a matrix that mirrors.

    Raises ValueError: it does something else.
    """
    whole = _numpy().array(matrix, dtype=float)
    normal = _fixed_vector(whole[:3, :3], -1.0)
    point = _fixed_vector(whole, 1.0)
    return point / point[3], normal


def shear_matrix(angle: float, direction: Any, point: Any, normal: Any) -> Any:
    """Return the matrix that shears by `angle` along `direction` at a plane through `point`.

    Raises ValueError: the direction is not in the plane, as `normal` is not perpendicular to it.
    """
    numpy = _numpy()
    along, across = unit_vector(direction[:3]), unit_vector(normal[:3])
    if abs(float(along @ across)) > _NEARLY:
        raise ValueError("direction and normal vectors are not orthogonal")
    matrix = identity_matrix()
    matrix[:3, :3] += math.tan(angle) * numpy.outer(along, across)
    return _about(matrix, point)


def compose_matrix(
    scale: Any = None, shear: Any = None, angles: Any = None, translate: Any = None, perspective: Any = None
) -> Any:
    """Return the matrix that shears, then scales, turns by Euler angles and shifts; `perspective` is ignored."""
    numpy = _numpy()
    matrix = identity_matrix() if angles is None else euler_matrix(*angles)
    sheared = numpy.identity(3)
    sheared[numpy.triu_indices(3, 1)] = (0.0, 0.0, 0.0) if shear is None else shear
    matrix[:3, :3] = matrix[:3, :3] @ numpy.diag((1.0, 1.0, 1.0) if scale is None else scale) @ sheared
    matrix[:3, 3] = (0.0, 0.0, 0.0) if translate is None else translate
    return matrix


def decompose_matrix(matrix: Any) -> Any:
    """Return what `compose_matrix` is given for a matrix; of the perspective None, as tf_transformations does.

    Raises LinAlgError: it scales something to nothing.
    """
    numpy = _numpy()
    whole = numpy.array(matrix, dtype=float)
    inner = whole[:3, :3]
    scaled = numpy.linalg.cholesky(inner.T @ inner).T
    scale = numpy.diag(scaled).copy()
    shear = (scaled / scale[:, None])[numpy.triu_indices(3, 1)]
    if numpy.linalg.det(inner) < 0.0:
        scale[0], scaled[0] = -scale[0], -scaled[0]
    turn = inner @ numpy.linalg.inv(scaled)
    return scale, shear, euler_from_matrix(turn), whole[:3, 3], None


def random_quaternion(rand: Any = None) -> Any:
    """Return the quaternion of a random rotation, of which all are as likely; `rand` gives its three numbers."""
    numpy = _numpy()
    first, second, third = numpy.random.rand(3) if rand is None else rand
    near, far = math.sqrt(1.0 - first), math.sqrt(first)
    one, other = 2.0 * math.pi * second, 2.0 * math.pi * third
    return numpy.array(
        (math.sin(one) * near, math.cos(one) * near, math.sin(other) * far, math.cos(other) * far)
    )


def random_rotation_matrix(rand: Any = None) -> Any:
    """Return the matrix of what `random_quaternion` returns."""
    return quaternion_matrix(random_quaternion(rand))


def random_vector(size: Any) -> Any:
    """Return random numbers from 0 to 1."""
    return _numpy().random.random(size)


def concatenate_matrices(*matrices: Any) -> Any:
    """Return the product of matrices: the last is applied first."""
    product = identity_matrix()
    for matrix in matrices:
        product = product @ matrix
    return product


def inverse_matrix(matrix: Any) -> Any:
    """Return the inverse of a square matrix."""
    return _numpy().linalg.inv(matrix)


def is_same_transform(matrix0: Any, matrix1: Any) -> bool:
    """Return whether two matrices mean the same motion."""
    numpy = _numpy()
    first, second = numpy.array(matrix0, dtype=float), numpy.array(matrix1, dtype=float)
    return bool(numpy.allclose(first / first[3, 3], second / second[3, 3]))


def vector_norm(data: Any, axis: int | None = None, out: Any = None) -> Any:
    """Return the Euclidean length of an array along `axis`."""
    norm = _numpy().linalg.norm(data, axis=axis)
    if out is None:
        return norm
    out[...] = norm
    return None


def unit_vector(data: Any, axis: int | None = None, out: Any = None) -> Any:
    """Return an array scaled to length 1 along `axis`."""
    numpy = _numpy()
    array = numpy.array(data, dtype=float)
    scaled = array / numpy.linalg.norm(array, axis=axis, keepdims=axis is not None)
    if out is None:
        return scaled
    out[...] = scaled
    return None


def _about(matrix: Any, point: Any) -> Any:
    """Return a matrix that leaves `point` in its place."""
    if point is not None:
        centre = _numpy().array(point[:3], dtype=float)
        matrix[:3, 3] = centre - matrix[:3, :3] @ centre
    return matrix


def _fixed_vector(matrix: Any, factor: float) -> Any:
    """Return the last vector of length 1 that a matrix only scales by `factor`.

    Raises ValueError: there is none.
    """
    numpy = _numpy()
    values, vectors = numpy.linalg.eig(matrix)
    indices = numpy.where(abs(values - factor) < _NEARLY)[0]
    if not len(indices):
        raise ValueError(f"no eigenvector corresponding to eigenvalue {factor:g}")
    return numpy.real(vectors[:, indices[-1]])


def _numpy() -> Any:
    import numpy

    return numpy
