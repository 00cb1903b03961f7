"""Solids of a room as plane figures: their outlines, and how far the robot is from them."""

import math
from collections.abc import Iterable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from grader.contracts.assignment import Solid
from grader.contracts.robot import BACK_M, FRONT_M, HALF_WIDTH_M
from grader.geometry import exact

Points = NDArray[np.float64]
"""(n, 2) in metres."""

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
        dx, dy = at[:, 0] - x_m[:, None], at[:, 1] - y_m[:, None]
        return dx * c[:, None] + dy * s[:, None], dy * c[:, None] - dx * s[:, None]

    if solid.kind == "cylinder":
        ahead, left = seen(np.array([(solid.x_m, solid.y_m)]))
        return np.asarray(np.maximum(_from_outline(ahead, left)[:, 0] - solid.length_m / 2.0, 0.0))
    ahead, left = seen(corners(solid))
    near = np.min(_from_outline(ahead, left), axis=1)
    turn = math.radians(solid.heading_deg)
    own_x, own_y = x_m[:, None], y_m[:, None]
    at_x = own_x + _OUTLINE[:, 0] * c[:, None] - _OUTLINE[:, 1] * s[:, None] - solid.x_m
    at_y = own_y + _OUTLINE[:, 0] * s[:, None] + _OUTLINE[:, 1] * c[:, None] - solid.y_m
    along, across = exact.cos_sin(turn)
    in_x, in_y = at_x * along + at_y * across, at_y * along - at_x * across
    beyond = exact.hypot(
        np.maximum(np.abs(in_x) - solid.length_m / 2.0, 0.0),
        np.maximum(np.abs(in_y) - solid.width_m / 2.0, 0.0),
    )
    apart = np.minimum(near, np.min(beyond, axis=1))
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
    turn = math.radians(solid.heading_deg)
    c, s = exact.cos_sin(turn)
    enter, leave = 0.0, math.inf
    for at, step, half in (
        (dx * c + dy * s, along[0] * c + along[1] * s, solid.length_m / 2.0),
        (dy * c - dx * s, along[1] * c - along[0] * s, solid.width_m / 2.0),
    ):
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
    turn = math.radians(solid.heading_deg)
    c, s = exact.cos_sin(turn)
    x, y = dx * c + dy * s, dy * c - dx * s
    return np.asarray(
        exact.hypot(
            np.maximum(np.abs(x) - solid.length_m / 2.0, 0.0),
            np.maximum(np.abs(y) - solid.width_m / 2.0, 0.0),
        )
    )


def _from_outline(ahead: Points, left: Points) -> Points:
    """Return how far points in the robot's frame are outside of its outline."""
    middle = 0.5 * (FRONT_M + BACK_M)
    half = 0.5 * (FRONT_M - BACK_M)
    return np.asarray(
        exact.hypot(
            np.maximum(np.abs(ahead - middle) - half, 0.0), np.maximum(np.abs(left) - HALF_WIDTH_M, 0.0)
        )
    )


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
