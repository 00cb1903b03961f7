"""The car as numbers: its measures, its two profiles, and how a velocity command becomes motion. Pure.

The drive is a velocity servo on the base: the commanded twist is approached with a first-order lag and a
bounded acceleration. The lag is linear over the whole range that student scripts use, which keeps three
properties of turtlesim's instant response:

- what is lost while speeding up is gained while stopping, so a command v held for T drives v*T;
- v and w lag alike, so an arc keeps its curvature v/w from the first instant on;
- at the acceleration bound both are slowed by one factor, which keeps the curvature there too.
"""

import math
import random
from pathlib import Path
from typing import Final, TypeAlias

from grader.contracts.assignment import Profile
from grader.contracts.record import Record
from grader.sim.timeline import STEP_S

PlanarPose: TypeAlias = tuple[float, float, float]
"""x in metres, y in metres, heading in radians, in turtlesim's frame."""

URDF: Final = Path(__file__).with_name("car.urdf")

WHEEL_RADIUS_M: Final = 0.05
TRACK_M: Final = 0.2
RIDE_HEIGHT_M: Final = 0.03  # of the centre of mass; the axle stands at WHEEL_RADIUS_M

MAX_SPEED_MPS: Final = 100.0
MAX_YAW_RATE_RADPS: Final = 100.0
"""Bounds of a command. turtlesim has none, but 100 m/s crosses its window in 0.11 s and ends at the wall
just as 1000 m/s does, and at 100 rad/s a turn still spans 15 steps, so that the heading can be followed."""

_SETTLED: Final = 1e-6  # m/s and rad/s: an exponential never arrives; from here on it would move 17 nm more


class CarParameters(Record):
    """How a car answers commands.

    Attributes:
        time_constant_s: lag of v and w.
        max_acceleration_mps2, max_yaw_acceleration_radps2: bounds of their change.
        wheel_gain_spread: standard deviation of each wheel's constant relative speed error.
        slip_spread: standard deviation of each wheel's wandering relative slip.
        slip_time_s: correlation time of the slip.
    """

    time_constant_s: float
    max_acceleration_mps2: float
    max_yaw_acceleration_radps2: float
    wheel_gain_spread: float = 0.0
    slip_spread: float = 0.0
    slip_time_s: float = 0.25


PROFILES: Final[dict[Profile, CarParameters]] = {
    # Within 2 % of any ordinary command after 4 time constants (0.07 s). The bounds act beyond a jump of
    # 6.7 m/s or 13 rad/s only: everything a script ordinarily commands stays in the linear range.
    "nominal": CarParameters(
        time_constant_s=1.0 / 60.0,
        max_acceleration_mps2=400.0,
        max_yaw_acceleration_radps2=800.0,
    ),
    # A cheap classroom robot: sluggish, unequal wheels that slip. Needs feedback control.
    "rough": CarParameters(
        time_constant_s=0.12,
        max_acceleration_mps2=3.0,
        max_yaw_acceleration_radps2=12.0,
        wheel_gain_spread=0.015,
        slip_spread=0.03,
    ),
}


def twist_to_wheels(v_mps: float, w_radps: float) -> tuple[float, float]:
    """Return the angular speeds (left, right) in rad/s that roll a base of this track at twist (v, w)."""
    half = 0.5 * TRACK_M * w_radps
    return (v_mps - half) / WHEEL_RADIUS_M, (v_mps + half) / WHEEL_RADIUS_M


def wheels_to_twist(left_radps: float, right_radps: float) -> tuple[float, float]:
    """Return the twist (v, w) of a base whose wheels roll at these speeds; inverse of `twist_to_wheels`."""
    return (
        0.5 * WHEEL_RADIUS_M * (left_radps + right_radps),
        WHEEL_RADIUS_M * (right_radps - left_radps) / TRACK_M,
    )


def clamp_command(v_mps: float, w_radps: float) -> tuple[float, float, bool]:
    """Return a command as the car takes it, and whether all of it was finite.

    A NaN or infinite component makes the whole command a stop; a finite one is cut to the bounds above.
    """
    if -MAX_SPEED_MPS <= v_mps <= MAX_SPEED_MPS and -MAX_YAW_RATE_RADPS <= w_radps <= MAX_YAW_RATE_RADPS:
        return v_mps, w_radps, True
    if not (math.isfinite(v_mps) and math.isfinite(w_radps)):
        return 0.0, 0.0, False
    v_mps = min(max(v_mps, -MAX_SPEED_MPS), MAX_SPEED_MPS)
    w_radps = min(max(w_radps, -MAX_YAW_RATE_RADPS), MAX_YAW_RATE_RADPS)
    return v_mps, w_radps, True


class Servo:
    """The drive's velocity, step by step.

    Attributes:
        v_mps, w_radps: velocity the wheels turn at; exactly zero once a stop has settled.
        steady: `step` would return the present velocity until another one is aimed at.
        resting: stopped and told to stay so: steps would change nothing.
    """

    def __init__(self, parameters: CarParameters) -> None:
        self._blend = 1.0 - math.exp(-STEP_S / parameters.time_constant_s)
        self._max_dv = parameters.max_acceleration_mps2 * STEP_S
        self._max_dw = parameters.max_yaw_acceleration_radps2 * STEP_S
        self._target = (0.0, 0.0)
        self.v_mps = self.w_radps = 0.0
        self.steady = self.resting = True

    def aim(self, v_mps: float, w_radps: float) -> None:
        """Set the commanded twist, already within bounds."""
        self._target = (v_mps, w_radps)
        self.steady = self.resting = (v_mps, w_radps) == (self.v_mps, self.w_radps) == (0.0, 0.0)

    def halt(self) -> None:
        """Stand still at once."""
        self.v_mps = self.w_radps = 0.0
        self.aim(0.0, 0.0)

    def step(self) -> tuple[float, float]:
        """Advance by one physics step and return the twist (v, w) the base takes during it."""
        target_v, target_w = self._target
        dv = (target_v - self.v_mps) * self._blend
        dw = (target_w - self.w_radps) * self._blend
        excess = max(abs(dv) / self._max_dv, abs(dw) / self._max_dw)
        if excess > 1.0:
            dv /= excess
            dw /= excess
        self.v_mps += dv
        self.w_radps += dw
        if abs(target_v - self.v_mps) < _SETTLED and abs(target_w - self.w_radps) < _SETTLED:
            self.v_mps, self.w_radps = self._target
            self.steady = True
            self.resting = self._target == (0.0, 0.0)
        return self.v_mps, self.w_radps


class RoughServo(Servo):
    """A servo whose wheels have unequal gains and a wandering slip, from a seed."""

    def __init__(self, parameters: CarParameters, seed: int) -> None:
        super().__init__(parameters)
        self._random = random.Random(seed)  # noqa: S311 - seeded noise, not a secret
        self._gains = [1.0 + self._random.gauss(0.0, parameters.wheel_gain_spread) for _ in range(2)]
        self._slips = [0.0, 0.0]
        self._memory = math.exp(-STEP_S / parameters.slip_time_s)
        self._kick = parameters.slip_spread * math.sqrt(1.0 - self._memory**2)

    def step(self) -> tuple[float, float]:
        """Advance by one physics step; the slip is an Ornstein-Uhlenbeck process, relative to the speed."""
        wheels = twist_to_wheels(*super().step())
        self.steady = self.resting
        turned = []
        for side, speed in enumerate(wheels):
            self._slips[side] = self._slips[side] * self._memory + self._random.gauss(0.0, self._kick)
            turned.append(speed * (self._gains[side] - self._slips[side]))
        return wheels_to_twist(turned[0], turned[1])


def make_servo(profile: Profile, seed: int) -> Servo:
    """Return the drive of `profile`; `seed` matters only where the profile is noisy."""
    parameters = PROFILES[profile]
    if parameters.wheel_gain_spread or parameters.slip_spread:
        return RoughServo(parameters, seed)
    return Servo(parameters)
