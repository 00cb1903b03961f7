"""The driven way of a robot, point by point, and how much of it ran along a wall."""

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grader.checks.drive import Drive
from grader.contracts.assignment import Assignment, Room
from grader.contracts.trajectory import Floats
from grader.geometry import exact
from grader.geometry.room import from_point_m

POINT_M: Final = 0.01
"""Distance between the points of the way that are examined."""

SIDES: Final = {"left": 1.0, "right": -1.0}
_ASIDE_M = 0.005  # how far beside the way the distance is measured as well, to know where the nearest wall is
# The wall may lie up to 135° from the wanted side: 90° is straight ahead, more is a corner in front of the robot.
_WIDEST_COS = exact.cos(math.radians(135.0))


class WayPoints(NamedTuple):
    """Points of the driven way, `POINT_M` apart; the first one alone if nothing was driven."""

    x_m: Floats
    y_m: Floats
    heading_rad: Floats


def points_of(drive: Drive) -> WayPoints:
    """Return points of the driven way."""
    path = drive.path
    rising = np.concatenate(([True], np.diff(path.along_m) > 0.0))
    at = np.arange(0.0, max(float(path.along_m[-1]), POINT_M / 2.0), POINT_M)
    columns = (path.x_m, path.y_m, path.heading_rad)
    return WayPoints(*(exact.interpolated(at, path.along_m[rising], column[rising]) for column in columns))


@dataclass(frozen=True, slots=True, kw_only=True)
class WallFollowing:
    """How a robot drove along walls, from where it was first as near as it should be.

    Attributes:
        low_m, high_m: between which the nearest wall should be.
        kept_share: of the way, forwards and with the wall on the wanted side.
        way_m: how far that led along the walls; what leads back, as half of a circle does, is taken off.
    """

    low_m: float
    high_m: float
    kept_share: float = 0.0
    way_m: float = 0.0


def wall_following(assignment: Assignment, room: Room, drive: Drive) -> WallFollowing | None:
    """Return how a robot drove along the walls, None where the assignment gives no distance from them."""
    options = assignment.options
    if not {"band_low_m", "band_high_m"} <= options.keys():
        return None
    low_m, high_m = float(options["band_low_m"]), float(options["band_high_m"])
    way = points_of(drive)
    near = _nearest_m(room, way.x_m, way.y_m)
    within = (near >= low_m) & (near <= high_m)
    if not within.any():
        return WallFollowing(low_m=low_m, high_m=high_m)
    side = SIDES.get(str(options.get("wall_side")))
    beside = np.ones(len(near), dtype=bool) if side is None else _on_side(room, way, side)
    first = int(np.argmax(within))
    kept, direction = (within & beside)[first:], _direction(way)[first:]
    return WallFollowing(
        low_m=low_m,
        high_m=high_m,
        kept_share=float(np.mean(kept & (direction > 0.0))),
        way_m=_net_m(_progress_m(room, way)[first:], kept, side),
    )


def _nearest_m(room: Room, x_m: Floats, y_m: Floats) -> Floats:
    """Return how far points are from the nearest solid that stands above the floor."""
    walls = [from_point_m(solid, x_m, y_m) for solid in room.solids if solid.kind != "ramp"]
    return np.asarray(np.min(np.array(walls), axis=0))


def _progress_m(room: Room, way: WayPoints) -> Floats:
    """Return how far each point of the way leads along the nearest wall, with it on the right."""
    aside = _ASIDE_M
    away_x = _nearest_m(room, way.x_m + aside, way.y_m) - _nearest_m(room, way.x_m - aside, way.y_m)
    away_y = _nearest_m(room, way.x_m, way.y_m + aside) - _nearest_m(room, way.x_m, way.y_m - aside)
    if len(way.x_m) < 2:
        return np.zeros(len(way.x_m))
    step_x, step_y = np.gradient(way.x_m), np.gradient(way.y_m)
    return np.asarray((away_y * step_x - away_x * step_y) / (2.0 * aside))


def _net_m(progress_m: Floats, kept: NDArray[np.bool_], side: float | None) -> float:
    """Return the sum of the progress that was kept, but no more than all of it comes to.

    Otherwise the way back, further off or with the wall on the other side, would be free. Without a wanted side
    the direction that leads further counts.
    """
    sign = -side if side is not None else math.copysign(1.0, exact.total(progress_m[kept]))
    return max(0.0, min(sign * exact.total(progress_m[kept]), sign * exact.total(progress_m)))


def _on_side(room: Room, way: WayPoints, side: float) -> NDArray[np.bool_]:
    """Whether the nearest wall is not clearly on the wrong side, at each point; `side`: 1 is left, -1 right."""
    cos, sin = exact.cos_sin(way.heading_rad)
    dx, dy = -_ASIDE_M * sin, _ASIDE_M * cos  # to the left
    nearer = _nearest_m(room, way.x_m - dx, way.y_m - dy) - _nearest_m(room, way.x_m + dx, way.y_m + dy)
    return np.asarray(side * nearer / (2.0 * _ASIDE_M) > _WIDEST_COS)


def _direction(way: WayPoints) -> Floats:
    """Return 1 where the robot drove forwards, -1 where it drove backwards."""
    if len(way.x_m) < 2:
        return np.ones(len(way.x_m))
    cos, sin = exact.cos_sin(way.heading_rad)
    ahead = cos * np.gradient(way.x_m) + sin * np.gradient(way.y_m)
    return np.where(ahead < 0.0, -1.0, 1.0)
