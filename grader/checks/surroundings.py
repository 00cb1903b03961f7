"""What stood around the robot, as the checks in a room measure it."""

import itertools
import math

import numpy as np

from grader.checks.measure import Measure
from grader.contracts.assignment import Room, Solid
from grader.contracts.figure import Point, SketchSolid
from grader.contracts.text import Text
from grader.contracts.trajectory import Trajectory
from grader.geometry import exact
from grader.geometry.room import clearance_m, outline
from grader.messages import say

_MOST_POSES = 2_000  # a robot drives 1 cm between two of them in two minutes


def clearance(room: Room, trajectory: Trajectory) -> Measure:
    """Return how near the robot's outline came to anything; ramps are there to be driven on."""
    stride = max(1, math.ceil(len(trajectory) / _MOST_POSES))
    x, y, heading = (column[::stride] for column in (trajectory.x_m, trajectory.y_m, trajectory.heading_rad))
    apart = [
        float(np.min(clearance_m(solid, x, y, heading))) for solid in room.solids if solid.kind != "ramp"
    ]
    touched = any(contact.wall != "ramp" for contact in trajectory.contacts)
    return Measure(0.0 if touched else min(apart))


def solids_of(room: Room) -> tuple[SketchSolid, ...]:
    """Return what a picture shows of a room: lines on the floor, then what stands on it."""
    lines = [
        SketchSolid(kind="line", outline_m=_band(begin, end, stripe.width_m))
        for stripe in room.stripes
        for begin, end in itertools.pairwise(stripe.points_m)
    ]
    return (*lines, *(SketchSolid(kind=solid.kind, outline_m=_outline(solid)) for solid in room.solids))


def _outline(solid: Solid) -> tuple[Point, ...]:
    return tuple((float(x), float(y)) for x, y in outline(solid))


def _band(begin: Point, end: Point, width_m: float) -> tuple[Point, ...]:
    """Return the outline of a line of some width."""
    long = exact.apart(begin, end) or 1.0
    x, y = ((end[i] - begin[i]) / long * width_m / 2.0 for i in (0, 1))
    (x0, y0), (x1, y1) = begin, end
    return ((x0 - y, y0 + x), (x1 - y, y1 + x), (x1 + y, y1 - x), (x0 + y, y0 - x))


def name_of(wall: str) -> Text:
    """Return what a contact calls the thing that was touched."""
    return say(f"at_wall.{wall}")
