"""The robot's measures, which its simulation, the checks and the pictures share: a TurtleBot3 Burger's.

Figures of turtlebot3_gazebo and turtlebot3_description, branch humble. The frame is the robot's own: the origin on
the floor below the middle of the axle (``base_footprint``), x ahead, y to the left.
"""

from typing import Final

FRONT_M: Final = 0.038
BACK_M: Final = -0.102
HALF_WIDTH_M: Final = 0.089
"""Outline of what can touch a wall: a rectangle."""

WHEEL_RADIUS_M: Final = 0.033
TRACK_M: Final = 0.16
MAX_SPEED_MPS: Final = 0.22
MAX_YAW_RATE_RADPS: Final = 2.84

SCANNER_X_M: Final = -0.032
SCANNER_Z_M: Final = 0.182
RAYS: Final = 360
LEAST_RANGE_M: Final = 0.12
MOST_RANGE_M: Final = 3.5
