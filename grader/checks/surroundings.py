"""What stood around the robot, as the checks in a room measure it."""

import math

import numpy as np

from grader.checks.measure import Measure
from grader.contracts.assignment import Room
from grader.contracts.text import Text
from grader.contracts.trajectory import Trajectory
from grader.geometry.room import clearance_m
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


def name_of(wall: str) -> Text:
    """Return what a contact calls the thing that was touched."""
    return say(f"at_wall.{wall}")
