"""Homogeneous 4 x 4 matrices, as numpy arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from tf_transformations._quaternions import quaternion_about_axis, quaternion_from_euler, rotation_rows


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


def _numpy() -> Any:
    import numpy

    return numpy
