"""What a scanner in a level plane measures in a room, in closed form: rays against the sides of solids.

PyBullet's rayTestBatch takes 0.5 ms for 360 rays, a fifth of which are the way into it and back, while the
physics between two scans takes 0.8 ms. This takes a tenth of it.
"""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from grader.contracts.assignment import Room
from grader.contracts.robot import RAYS, SCANNER_Z_M
from grader.geometry.room import corners

Ranges = NDArray[np.float32]
Side = tuple[float, float, float, float, float]
Pose = tuple[float, float, float, float]

LAST_ANGLE_RAD: Final = 6.28
STEP_RAD: Final = LAST_ANGLE_RAD / (RAYS - 1)
ANGLES_RAD: Final = tuple(i * STEP_RAD for i in range(RAYS))
_AHEAD: Final = np.array([math.cos(angle) for angle in ANGLES_RAD], dtype=np.float32)
_ONE: Final = np.float32(1.0)
_BEYOND: Final = np.full(RAYS, math.inf, dtype=np.float32)
_LEFT: Final = np.array([math.sin(angle) for angle in ANGLES_RAD], dtype=np.float32)


class RoomScanner:
    """The solids of one room that reach as high as the scanner's plane.

    Attributes:
        exact: nothing in the room has another outline in the plane than on the floor.
    """

    def __init__(self, room: Room) -> None:
        high = [solid for solid in room.solids if solid.height_m > SCANNER_Z_M]
        self.exact = all(solid.kind != "ramp" for solid in high)
        sides = [side for solid in high if solid.kind != "cylinder" for side in _sides(corners(solid))]
        self._sides = sides
        self._round = [
            (solid.x_m, solid.y_m, (solid.length_m / 2.0) ** 2) for solid in high if solid.kind == "cylinder"
        ]

    def ranges_m(self, x_m: float, y_m: float, heading_rad: float, most_m: float) -> Ranges:
        """Return how far each ray goes from a scanner in this pose; infinite where that is more than `most_m`."""
        c, s = math.cos(heading_rad), math.sin(heading_rad)
        best = np.full(RAYS, 1.0 / most_m, dtype=np.float32)  # the inverse range
        pose = (x_m, y_m, c, s)
        if len(sides := _seen_sides(self._sides, pose, most_m)):
            np.maximum(best, _of_sides(sides), out=best)
        if len(cylinders := _seen_cylinders(self._round, pose)):
            np.maximum(best, _of_cylinders(cylinders), out=best)
        return np.divide(_ONE, best, out=_BEYOND.copy(), where=best > np.float32(1.0 / most_m))


def _seen_sides(sides: list[Side], pose: Pose, most_m: float) -> NDArray[np.float32]:
    """Return six numbers of each side that faces the scanner: by x and by y, of the three forms of `_of_sides`.

    In Python's own numbers: for some ten sides twice as fast as by numpy, and the same bits.
    """
    x, y, c, s = pose
    visible = []
    for nx, ny, offset, begin, end in sides:
        away = nx * x + ny * y - offset
        if 0.0 < away <= most_m:
            here = nx * y - ny * x
            ahead, left = nx * c + ny * s, ny * c - nx * s
            to_x, to_y = -ahead / away, -left / away
            begin, end = begin - here, end - here  # noqa: PLW2901 - seen from the scanner
            by_begin = (-left - begin * to_x, ahead - begin * to_y)
            by_end = (left + end * to_x, end * to_y - ahead)
            visible.append((to_x, by_begin[0], by_end[0], to_y, by_begin[1], by_end[1]))
    return np.array(visible, dtype=np.float32)


def _of_sides(sides: NDArray[np.float32]) -> Ranges:
    """Return the largest inverse range to a side, 0 for rays that meet none.

    The inverse range to a side's line is linear in the ray's direction, and so is on which side of either end
    the ray passes.
    """
    count = len(sides)
    columns = sides.T.reshape(2, 3 * count)
    forms = np.multiply.outer(columns[0], _AHEAD)
    forms += np.multiply.outer(columns[1], _LEFT)
    inside = np.minimum(forms[count : 2 * count], forms[2 * count :]) >= 0.0
    forms[:count] *= inside
    return np.asarray(np.maximum.reduce(forms[:count], axis=0))


def _seen_cylinders(cylinders: list[tuple[float, float, float]], pose: Pose) -> NDArray[np.float32]:
    """Return of each cylinder where its axis is, in lengths of a tangent to it, and the inverse of that length."""
    x, y, c, s = pose
    visible = []
    for x_m, y_m, radius_squared in cylinders:
        dx, dy = x_m - x, y_m - y
        square = dx * dx + dy * dy - radius_squared
        if square > 0.0:
            per_tangent = 1.0 / math.sqrt(square)
            visible.append(((dx * c + dy * s) * per_tangent, (dy * c - dx * s) * per_tangent, per_tangent))
    return np.array(visible, dtype=np.float32)


def _of_cylinders(cylinders: NDArray[np.float32]) -> Ranges:
    """Return the largest inverse range to a cylinder, 0 for rays that meet none.

    A ray that passes the axis' foot at a distance of u tangents' lengths has the inverse range u + sqrt(u^2 - 1),
    over that length; u is linear in the ray's direction, and more than 1 where the ray hits.
    """
    along = np.multiply.outer(cylinders[:, 0], _AHEAD)
    along += np.multiply.outer(cylinders[:, 1], _LEFT)
    hit = along > _ONE
    distances = along * along
    distances -= _ONE
    np.sqrt(distances, out=distances, where=hit)
    distances += along
    distances *= hit
    distances *= cylinders[:, 2:]
    return np.asarray(np.maximum.reduce(distances, axis=0))


def _sides(around: NDArray[np.float64]) -> list[Side]:
    """Return the sides of an outline: outward normal, its distance from the origin, begin and end along it."""
    sides = []
    for (x0, y0), (x1, y1) in zip(around.tolist(), np.roll(around, -1, axis=0).tolist(), strict=True):
        long = math.hypot(x1 - x0, y1 - y0)
        nx, ny = (y1 - y0) / long, (x0 - x1) / long
        sides.append((nx, ny, nx * x0 + ny * y0, nx * y0 - ny * x0, nx * y1 - ny * x1))
    return sides
