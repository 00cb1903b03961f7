"""The robot as numbers: when it does what, and how a command becomes wheel speeds. Pure.

Everything happens at beats, four physics steps of 1/240 s apart (60 Hz). A beat's instant is derived from its
number. The drive is Gazebo's (gazebo_ros_diff_drive as turtlebot3_gazebo sets it up): thirty times a second the
wheels' speeds come nearer to the last command, by 1 m/s^2 at most, and a command holds until the next one.
"""

import math
import random
from pathlib import Path
from typing import Final

from grader.contracts.robot import MAX_SPEED_MPS, MAX_YAW_RATE_RADPS, TRACK_M, WHEEL_RADIUS_M
from grader.sim.car import STEPS_PER_S, clamp_command, last_step_at, step_time_ns

ROBOT_MODEL: Final = 1  # raised whenever the same commands may give another trajectory
ROBOT_URDF: Final = Path(__file__).with_name("robot.urdf")

STEPS_PER_BEAT: Final = 4
BEAT_S: Final = STEPS_PER_BEAT / STEPS_PER_S
DRIVE_BEATS: Final = 2
DRIVE_S: Final = DRIVE_BEATS * BEAT_S
WHEEL_ACCELERATION_MPS2: Final = 1.0

SCAN_BEATS: Final = 12
SCAN_NOISE_M: Final = 0.01
ROUGH_SCAN_NOISE_M: Final = 0.02
_ROUGH_WHEELS: Final = 0.015  # standard deviation of each wheel's radius, relative


def beat_time_ns(beat: int) -> int:
    """Return the virtual instant of a beat, in nanoseconds."""
    return step_time_ns(beat * STEPS_PER_BEAT)


def last_beat_at(t_ns: int) -> int:
    """Return the last beat that stands at or before `t_ns`."""
    return last_step_at(t_ns) // STEPS_PER_BEAT


def clamp_twist(v_mps: float, w_radps: float) -> tuple[float, float, bool]:
    """Return a command as the robot's motors take it, which is as the car does, within the Burger's bounds."""
    return clamp_command(v_mps, w_radps, MAX_SPEED_MPS, MAX_YAW_RATE_RADPS)


class WheelDrive:
    """Speeds of the tyres, left and right, on their way to the last command.

    Attributes:
        speeds_mps: what the motors are set to.
        radii: of the wheels, relative to their nominal radius; those of a rough robot are drawn by seed.
    """

    def __init__(self, seed: int | None) -> None:
        self.speeds_mps = self._wanted = (0.0, 0.0)
        self.radii = (1.0, 1.0)
        if seed is not None:
            source = random.Random(f"wheels {seed}")  # noqa: S311 - the same robot each time, not a secret
            self.radii = (1.0 + source.gauss(0.0, _ROUGH_WHEELS), 1.0 + source.gauss(0.0, _ROUGH_WHEELS))

    def aim(self, v_mps: float, w_radps: float) -> None:
        """Set the commanded twist, already within bounds."""
        half = 0.5 * TRACK_M * w_radps
        self._wanted = (v_mps - half, v_mps + half)

    @property
    def settled(self) -> bool:
        """Whether the speeds are those commanded."""
        return self.speeds_mps == self._wanted

    def tick(self) -> tuple[float, float]:
        """Come nearer to the command, a thirtieth of a second later; return the wheels' rates in rad/s."""
        most = WHEEL_ACCELERATION_MPS2 * DRIVE_S
        left, right = (
            now + min(max(target - now, -most), most)
            for now, target in zip(self.speeds_mps, self._wanted, strict=True)
        )
        self.speeds_mps = (left, right)
        return left / WHEEL_RADIUS_M, right / WHEEL_RADIUS_M


class Odometry:
    """The pose that adds up from how far the wheels have turned, from the start pose on.

    So the frame of the odometry is that of the room, as in Gazebo; the robot itself counts from zero.
    """

    def __init__(self, start: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        self.x_m, self.y_m, self.heading_rad = start
        self.v_mps = self.w_radps = 0.0
        self.wheels_radps: tuple[float, ...] = (0.0, 0.0)
        self._wheels = (0.0, 0.0)

    def update(self, left_rad: float, right_rad: float, seconds: float) -> None:
        """Take the wheels' angles, `seconds` after the last ones: an arc of the circle in between."""
        left_m = (left_rad - self._wheels[0]) * WHEEL_RADIUS_M
        right_m = (right_rad - self._wheels[1]) * WHEEL_RADIUS_M
        self.wheels_radps = tuple(
            (now - before) / seconds for now, before in zip((left_rad, right_rad), self._wheels, strict=True)
        )
        self._wheels = (left_rad, right_rad)
        ahead_m, turned_rad = 0.5 * (left_m + right_m), (right_m - left_m) / TRACK_M
        middle_rad = self.heading_rad + 0.5 * turned_rad
        self.x_m += ahead_m * math.cos(middle_rad)
        self.y_m += ahead_m * math.sin(middle_rad)
        self.heading_rad += turned_rad
        self.v_mps, self.w_radps = ahead_m / seconds, turned_rad / seconds
