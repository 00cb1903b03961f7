"""Solids of a room as plane figures: their outlines, and how far the robot is from them."""

import math
from collections.abc import Iterable
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from grader.contracts.assignment import Solid
from grader.contracts.robot import BACK_M, FRONT_M, HALF_WIDTH_M
from grader.geometry import exact

Points = NDArray[np.float64]
"""(n, 2) in metres."""
_Each = TypeVar("_Each", float, Points)

_CIRCLE_POINTS: Final = 24
_OUTLINE: Final = np.array(
    [(FRONT_M, HALF_WIDTH_M), (BACK_M, HALF_WIDTH_M), (BACK_M, -HALF_WIDTH_M), (FRONT_M, -HALF_WIDTH_M)]
)


def corners(solid: Solid) -> Points:
    """Return the corners of a solid that has any, counter-clockwise."""
    half_x, half_y = solid.length_m / 2.0, solid.width_m / 2.0
    own = np.array([(half_x, half_y), (-half_x, half_y), (-half_x, -half_y), (half_x, -half_y)])
    return placed(own, solid.x_m, solid.y_m, math.radians(solid.heading_deg))


def outline(solid: Solid) -> Points:
    """Return the corners of a solid, or points of its circle."""
    if solid.kind != "cylinder":
        return corners(solid)
    turns = np.arange(_CIRCLE_POINTS) * (math.tau / _CIRCLE_POINTS)
    around = 0.5 * solid.length_m * np.column_stack(exact.cos_sin(turns))
    return np.asarray(around + np.array((solid.x_m, solid.y_m)))


def placed(points: Points, x_m: float, y_m: float, heading_rad: float) -> Points:
    """Return points of an own frame where it is placed at a pose."""
    c, s = exact.cos_sin(heading_rad)
    x = x_m + points[:, 0] * c - points[:, 1] * s
    return np.column_stack((x, y_m + points[:, 0] * s + points[:, 1] * c))


def clearance_m(solid: Solid, x_m: Points, y_m: Points, heading_rad: Points) -> Points:
    """Return how far the robot's outline is from a solid, for each of (n,) poses; 0 where they touch."""
    c, s = exact.cos_sin(heading_rad)

    def seen(at: Points) -> tuple[Points, Points]:
        """Return points of the room in the frame of each pose: (n, k) ahead and to the left."""
        return _along(at[:, 0] - x_m[:, None], at[:, 1] - y_m[:, None], c[:, None], s[:, None])

    if solid.kind == "cylinder":
        ahead, left = seen(np.array([(solid.x_m, solid.y_m)]))
        return np.asarray(np.maximum(_from_outline(ahead, left)[:, 0] - solid.length_m / 2.0, 0.0))
    ahead, left = seen(corners(solid))
    near = np.min(_from_outline(ahead, left), axis=1)
    at_x = x_m[:, None] + _OUTLINE[:, 0] * c[:, None] - _OUTLINE[:, 1] * s[:, None]
    at_y = y_m[:, None] + _OUTLINE[:, 0] * s[:, None] + _OUTLINE[:, 1] * c[:, None]
    apart = np.minimum(near, np.min(from_point_m(solid, at_x, at_y), axis=1))
    return np.asarray(np.where(_cross(ahead, left), 0.0, apart))


def ahead_m(solids: Iterable[Solid], x_m: float, y_m: float, heading_rad: float) -> float:
    """Return how far it is along the heading from a point to the first solid; infinite where there is none."""
    c, s = exact.cos_sin(heading_rad)
    return min((_first_m(solid, (x_m, y_m), (c, s)) for solid in solids), default=math.inf)


def _first_m(solid: Solid, origin: tuple[float, float], along: tuple[float, float]) -> float:
    dx, dy = origin[0] - solid.x_m, origin[1] - solid.y_m
    if solid.kind == "cylinder":
        middle = -(dx * along[0] + dy * along[1])
        rest = solid.length_m * solid.length_m / 4.0 - (dx * dx + dy * dy - middle * middle)
        reach = middle - math.sqrt(rest) if rest >= 0.0 else -1.0
        return reach if reach >= 0.0 else math.inf
    axes = exact.cos_sin(math.radians(solid.heading_deg))
    enter, leave = 0.0, math.inf
    halves = solid.length_m / 2.0, solid.width_m / 2.0
    for at, step, half in zip(_along(dx, dy, *axes), _along(*along, *axes), halves, strict=True):
        if step == 0.0:
            if abs(at) > half:
                return math.inf
            continue
        near, far = sorted(((-half - at) / step, (half - at) / step))
        enter, leave = max(enter, near), min(leave, far)
    return enter if enter <= leave else math.inf


def from_point_m(solid: Solid, x_m: Points, y_m: Points) -> Points:
    """Return how far (n,) points are outside of a solid."""
    dx, dy = x_m - solid.x_m, y_m - solid.y_m
    if solid.kind == "cylinder":
        return np.asarray(np.maximum(exact.hypot(dx, dy) - solid.length_m / 2.0, 0.0))
    x, y = _along(dx, dy, *exact.cos_sin(math.radians(solid.heading_deg)))
    return _beyond(x, y, solid.length_m / 2.0, solid.width_m / 2.0)


def _along(dx: _Each, dy: _Each, c: Any, s: Any) -> tuple[_Each, _Each]:
    """Return a vector in a frame whose heading has this cosine and sine: ahead and to the left."""
    return dx * c + dy * s, dy * c - dx * s


def _beyond(x: Points, y: Points, half_length_m: float, half_width_m: float) -> Points:
    """Return how far points are outside of a rectangle around the origin."""
    across = np.maximum(np.abs(y) - half_width_m, 0.0)
    return np.asarray(exact.hypot(np.maximum(np.abs(x) - half_length_m, 0.0), across))


def _from_outline(ahead: Points, left: Points) -> Points:
    """Return how far points in the robot's frame are outside of its outline."""
    return _beyond(ahead - 0.5 * (FRONT_M + BACK_M), left, 0.5 * (FRONT_M - BACK_M), HALF_WIDTH_M)


def _cross(ahead: Points, left: Points) -> NDArray[np.bool_]:
    """Return whether an edge of the solid runs through the outline although no corner of either lies in the other.

    An edge is clipped at the four sides of the outline (Liang and Barsky 1984); what is left of it is inside.
    """
    dx, dy = np.roll(ahead, -1, axis=1) - ahead, np.roll(left, -1, axis=1) - left
    enter, leave = np.zeros_like(dx), np.ones_like(dx)
    inside = np.ones(dx.shape, dtype=bool)
    for step, room in (
        (-dx, ahead - BACK_M),
        (dx, FRONT_M - ahead),
        (-dy, left + HALF_WIDTH_M),
        (dy, HALF_WIDTH_M - left),
    ):
        with np.errstate(divide="ignore", invalid="ignore"):
            at = room / step
        enter = np.where(step < 0.0, np.maximum(enter, at), enter)
        leave = np.where(step > 0.0, np.minimum(leave, at), leave)
        inside &= (step != 0.0) | (room >= 0.0)
    return np.asarray(np.any(inside & (enter <= leave), axis=1))
