"""Rotations and rigid transforms. Quaternions are (x, y, z, w), vectors (x, y, z), in metres."""

from __future__ import annotations

from math import acos, sin, sqrt
from typing import NamedTuple

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class Rigid(NamedTuple):
    """A rotation followed by a translation."""

    translation: Vector
    rotation: Quaternion

    def __matmul__(self, inner: Rigid) -> Rigid:
        """Return the transform that applies `inner` first."""
        return Rigid(self.apply(inner.translation), multiply(self.rotation, inner.rotation))

    def apply(self, point: Vector) -> Vector:
        """Return the transformed point."""
        return add(rotate(self.rotation, point), self.translation)

    def inverse(self) -> Rigid:
        """Return the transform that undoes this one."""
        back = conjugate(self.rotation)
        x, y, z = rotate(back, self.translation)
        return Rigid((-x, -y, -z), back)


IDENTITY = Rigid((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def add(a: Vector, b: Vector) -> Vector:
    """Return the sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """Return the rotation that applies `b` first."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def conjugate(q: Quaternion) -> Quaternion:
    """Return the inverse of a unit quaternion."""
    x, y, z, w = q
    return -x, -y, -z, w


def normalize(q: Quaternion) -> Quaternion:
    """Return the unit quaternion of the same rotation; the identity for the zero quaternion."""
    length = sqrt(sum(component * component for component in q))
    if length == 0.0:
        return 0.0, 0.0, 0.0, 1.0
    x, y, z, w = q
    return x / length, y / length, z / length, w / length


def rotate(q: Quaternion, v: Vector) -> Vector:
    """Return `v` rotated by the unit quaternion `q`."""
    x, y, z, _ = multiply(multiply(q, (*v, 0.0)), conjugate(q))
    return x, y, z


def slerp(a: Quaternion, b: Quaternion, fraction: float) -> Quaternion:
    """Return the rotation at `fraction` of the shortest way from `a` to `b`."""
    cosine = sum(p * q for p, q in zip(a, b, strict=True))
    sign = -1.0 if cosine < 0.0 else 1.0
    angle = acos(min(1.0, abs(cosine)))
    if angle < 1e-9:
        return a
    start, end = sin((1.0 - fraction) * angle) / sin(angle), sign * sin(fraction * angle) / sin(angle)
    return (
        start * a[0] + end * b[0],
        start * a[1] + end * b[1],
        start * a[2] + end * b[2],
        start * a[3] + end * b[3],
    )


def mix(a: Vector, b: Vector, fraction: float) -> Vector:
    """Return the point at `fraction` of the straight way from `a` to `b`."""
    x, y, z = (p + (q - p) * fraction for p, q in zip(a, b, strict=True))
    return x, y, z
