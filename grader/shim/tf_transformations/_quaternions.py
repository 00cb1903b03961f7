"""Quaternions (x, y, z, w) and Euler angles (radians)."""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, atan2, cos, hypot, pi, sin, sqrt

Angles = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Rows = Sequence[Sequence[float]]

_TINY = 8.9e-16  # four times the spacing of doubles at 1, as in transforms3d
_IDENTITY: Quaternion = (0.0, 0.0, 0.0, 1.0)


def quaternion_from_euler(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Quaternion:
    """Return the rotation of three Euler angles; by default roll, pitch and yaw about fixed axes."""
    static, order = _split(axes)
    total = _IDENTITY
    for angle, axis in zip((ai, aj, ak), order, strict=True):
        half = [0.0, 0.0, 0.0]
        half[axis] = sin(angle / 2)
        turn = (half[0], half[1], half[2], cos(angle / 2))
        total = quaternion_multiply(turn, total) if static else quaternion_multiply(total, turn)
    return total


def euler_from_quaternion(quaternion: Sequence[float], axes: str = "sxyz") -> Angles:
    """Return the Euler angles of a rotation; by default roll, pitch and yaw about fixed axes."""
    return euler_from_matrix(rotation_rows(quaternion), axes)


def euler_from_matrix(matrix: Rows, axes: str = "sxyz") -> Angles:
    """Return the Euler angles of a rotation matrix (3 x 3, or the corner of a larger one)."""
    static, order = _split(axes)
    i, j, last = order if static else order[::-1]
    repeated = i == last
    odd = j != (i + 1) % 3
    k = 3 - i - j
    m = matrix
    if repeated:
        first, second, third = _proper_angles(m, i, j, k)
    else:
        first, second, third = _mixed_angles(m, i, j, k)
    if odd:
        first, second, third = -first, -second, -third
    return (first, second, third) if static else (third, second, first)


def _proper_angles(m: Rows, i: int, j: int, k: int) -> Angles:
    sine = hypot(m[i][j], m[i][k])
    if sine > _TINY:
        return atan2(m[i][j], m[i][k]), atan2(sine, m[i][i]), atan2(m[j][i], -m[k][i])
    return atan2(-m[j][k], m[j][j]), atan2(sine, m[i][i]), 0.0


def _mixed_angles(m: Rows, i: int, j: int, k: int) -> Angles:
    cosine = hypot(m[i][i], m[j][i])
    if cosine > _TINY:
        return atan2(m[k][j], m[k][k]), atan2(-m[k][i], cosine), atan2(m[j][i], m[i][i])
    return atan2(-m[j][k], m[j][j]), atan2(-m[k][i], cosine), 0.0


def rotation_rows(quaternion: Sequence[float]) -> tuple[Angles, Angles, Angles]:
    """Return the rows of the 3 x 3 rotation matrix; of no rotation for a quaternion of length zero."""
    x, y, z, w = (float(component) for component in quaternion)
    squared = x * x + y * y + z * z + w * w
    if squared < 2.3e-16:
        return (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    s = 2.0 / squared
    return (
        (1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)),
        (s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x)),
        (s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y)),
    )


def quaternion_from_matrix(matrix: Rows) -> Quaternion:
    """Return the rotation of a matrix, with w >= 0."""
    m = matrix
    # Of the four ways to begin, the one with the largest component loses least precision.
    squares = (
        1.0 + m[0][0] - m[1][1] - m[2][2],
        1.0 - m[0][0] + m[1][1] - m[2][2],
        1.0 - m[0][0] - m[1][1] + m[2][2],
        1.0 + m[0][0] + m[1][1] + m[2][2],
    )
    best = max(range(4), key=squares.__getitem__)
    rows = (
        (squares[0], m[1][0] + m[0][1], m[0][2] + m[2][0], m[2][1] - m[1][2]),
        (m[1][0] + m[0][1], squares[1], m[2][1] + m[1][2], m[0][2] - m[2][0]),
        (m[0][2] + m[2][0], m[2][1] + m[1][2], squares[2], m[1][0] - m[0][1]),
        (m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], squares[3]),
    )
    scale = 2.0 * sqrt(squares[best])
    x, y, z, w = (float(component) / scale for component in rows[best])
    return (x, y, z, w) if w >= 0.0 else (-x, -y, -z, -w)


def quaternion_multiply(quaternion1: Sequence[float], quaternion0: Sequence[float]) -> Quaternion:
    """Return the rotation that applies `quaternion0` first."""
    ax, ay, az, aw = quaternion1
    bx, by, bz, bw = quaternion0
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def quaternion_conjugate(quaternion: Sequence[float]) -> Quaternion:
    """Return the quaternion with its vector part negated."""
    x, y, z, w = quaternion
    return -x, -y, -z, w


def quaternion_inverse(quaternion: Sequence[float]) -> Quaternion:
    """Return the inverse: its product with `quaternion` is the identity."""
    squared = sum(component * component for component in quaternion)
    x, y, z, w = (component / squared for component in quaternion_conjugate(quaternion))
    return x, y, z, w


def quaternion_about_axis(angle: float, axis: Sequence[float]) -> Quaternion:
    """Return the rotation by `angle` about `axis`, which need not have length 1."""
    length = sqrt(sum(component * component for component in axis))
    x, y, z = (component / length * sin(angle / 2) for component in axis)
    return x, y, z, cos(angle / 2)


def quaternion_slerp(
    quat0: Sequence[float], quat1: Sequence[float], fraction: float, spin: int = 0, shortestpath: bool = True
) -> Quaternion:
    """Return the rotation at `fraction` of the way from `quat0` to `quat1`, with `spin` more half turns."""
    start, end = _unit(quat0), _unit(quat1)
    if fraction in (0.0, 1.0):
        return start if fraction == 0.0 else end
    cosine = sum(a * b for a, b in zip(start, end, strict=True))
    if abs(abs(cosine) - 1.0) < _TINY:
        return start
    if shortestpath and cosine < 0.0:
        cosine = -cosine
        end = (-end[0], -end[1], -end[2], -end[3])
    angle = acos(cosine) + spin * pi
    if abs(angle) < _TINY:
        return start
    a, b = sin((1.0 - fraction) * angle) / sin(angle), sin(fraction * angle) / sin(angle)
    x, y, z, w = (a * p + b * q for p, q in zip(start, end, strict=True))
    return x, y, z, w


def _unit(quaternion: Sequence[float]) -> Quaternion:
    length = sqrt(sum(component * component for component in quaternion))
    x, y, z, w = (component / length for component in quaternion)
    return x, y, z, w


def _split(axes: str) -> tuple[bool, tuple[int, int, int]]:
    """Return whether the axes are static, and their indices in order.

    Raises KeyError: `axes` is not the name of a convention.
    """
    first, second, third = ("xyz".find(letter) for letter in axes[1:]) if len(axes) == 4 else (-1, -1, -1)
    if axes[:1] not in ("s", "r") or -1 in (first, second, third) or second in (first, third):
        raise KeyError(axes)
    return axes[0] == "s", (first, second, third)
