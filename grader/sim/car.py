"""The car as numbers: its measures, its time, and how a command becomes motion in its two profiles. Pure.

Update k stands at k * 16 ms, physics step k at k/240 s. Both are derived from their index, so no error
accumulates. A step is not a whole number of nanoseconds (12 500 000 / 3): its instant is rounded down once.

The nominal car moves by turtlesim's own law, one update every 16 ms. The rough one is a cheap classroom robot: its
drive lags, and its wheels are unequal and slip.

The law adds, multiplies, divides and rounds down, all of which IEEE 754 defines to the last bit; sine and cosine
are those of `geometry.exact`, which need no more. So the nominal car drives the same bits everywhere.
"""

import math
import random
from functools import lru_cache
from pathlib import Path
from typing import Final, TypeAlias

from grader.geometry import exact

NS_PER_S: Final = 1_000_000_000
UPDATE_NS: Final = 16_000_000  # turtlesim's timer
UPDATE_S: Final = UPDATE_NS / NS_PER_S

STEPS_PER_S: Final = 240
STEP_S: Final = 1.0 / STEPS_PER_S

_THREE_STEPS_NS: Final = 3 * NS_PER_S // STEPS_PER_S

PlanarPose: TypeAlias = tuple[float, float, float]
"""x in metres, y in metres, heading in radians, in turtlesim's frame."""

PI: Final = 3.14159265
"""turtlesim's (turtle.h). Its headings turn by twice that at a fold."""

URDF: Final = Path(__file__).with_name("car.urdf")

WHEEL_RADIUS_M: Final = 0.05
TRACK_M: Final = 0.2
RIDE_HEIGHT_M: Final = 0.03  # of the centre of mass; the axle stands at WHEEL_RADIUS_M

WIDE_TURN_RAD: Final = 0.5  # Bullet loses a body that turns by more than a quarter turn in one engine step

MAX_SPEED_MPS: Final = 100.0
MAX_YAW_RATE_RADPS: Final = 100.0
"""Bounds of a command. turtlesim has none, but 100 m/s crosses its window in 0.11 s and ends at the wall just as
1000 m/s does, and at 100 rad/s an update turns by less than half a turn, so that the heading can be followed."""

# The rough drive approaches a command with a first-order lag and bounded acceleration.
ROUGH_LAG_S: Final = 0.12
ROUGH_ACCELERATION_MPS2: Final = 3.0
ROUGH_YAW_ACCELERATION_RADPS2: Final = 12.0
_WHEEL_GAIN_SPREAD: Final = 0.015  # standard deviation of each wheel's constant relative speed error
_SLIP_SPREAD: Final = 0.03  # standard deviation of each wheel's wandering relative slip
_SLIP_TIME_S: Final = 0.25  # correlation time of the slip
_SETTLED: Final = 1e-6  # m/s and rad/s: an exponential never arrives; from here on it would move 0.1 um more


def next_update(t_ns: int) -> int:
    """Return the first update later than `t_ns`: the one that takes a command or request of that time."""
    return t_ns // UPDATE_NS + 1


def step_time_ns(step: int) -> int:
    """Return the virtual instant of step `step`, in nanoseconds."""
    return step * _THREE_STEPS_NS // 3


def last_step_at(t_ns: int) -> int:
    """Return the last step that stands at or before `t_ns`."""
    return (3 * t_ns + 2) // _THREE_STEPS_NS


def fold(angle_rad: float) -> float:
    """Fold an angle to [-PI, PI) of turtlesim's own, as it does; NaN for what is no angle.

    An angle that lies there already keeps its bits.
    """
    if -PI <= angle_rad < PI:
        return angle_rad
    if not math.isfinite(angle_rad):
        return math.nan
    return angle_rad - 2.0 * PI * math.floor((angle_rad + PI) / (2.0 * PI))


@lru_cache(maxsize=8)  # a straight has one heading
def cos_sin(angle_rad: float) -> tuple[float, float]:
    """Return cosine and sine, the same bits on every processor."""
    return exact.cos_sin(angle_rad + 0.0)  # -0.0 is the cache's 0.0


def turtlesim_update(pose: PlanarPose, v_mps: float, w_radps: float) -> PlanarPose:
    """Return the pose one update later: turtlesim turns first, then moves along the new heading."""
    x, y, heading = pose
    heading += w_radps * UPDATE_S
    if not -PI <= heading < PI:
        heading = fold(heading)
    if not v_mps:
        return x, y, heading
    c, s = cos_sin(heading)
    reach = v_mps * UPDATE_S
    return x + c * reach, y + s * reach, heading


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


def clamp_command(
    v_mps: float, w_radps: float, most_mps: float = MAX_SPEED_MPS, most_radps: float = MAX_YAW_RATE_RADPS
) -> tuple[float, float, bool]:
    """Return a command as the car takes it, and whether all of it was finite.

    A NaN or infinite component makes the whole command a stop; a finite one is cut to the bounds.
    """
    if -most_mps <= v_mps <= most_mps and -most_radps <= w_radps <= most_radps:
        return v_mps, w_radps, True
    if not (math.isfinite(v_mps) and math.isfinite(w_radps)):
        return 0.0, 0.0, False
    return min(max(v_mps, -most_mps), most_mps), min(max(w_radps, -most_radps), most_radps), True


class RoughDrive:
    """The rough car's drive, physics step by physics step: it lags, and its wheels slip, from a seed.

    Attributes:
        v_mps, w_radps: velocity the motors run at; exactly zero once a stop has settled.
        resting: stopped and told to stay so: steps would change nothing.
    """

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)  # noqa: S311 - seeded noise, not a secret
        self._left_gain, self._right_gain = (
            1.0 + self._random.gauss(0.0, _WHEEL_GAIN_SPREAD) for _ in range(2)
        )
        self._left_slip = self._right_slip = 0.0
        self._memory = math.exp(-STEP_S / _SLIP_TIME_S)
        self._kick = _SLIP_SPREAD * math.sqrt(1.0 - self._memory**2)
        self._blend = 1.0 - math.exp(-STEP_S / ROUGH_LAG_S)
        self._target = (0.0, 0.0)
        self.v_mps = self.w_radps = 0.0
        self.resting = True

    def aim(self, v_mps: float, w_radps: float) -> None:
        """Set the commanded twist, already within bounds."""
        self._target = (v_mps, w_radps)
        self.resting = (v_mps, w_radps) == (self.v_mps, self.w_radps) == (0.0, 0.0)

    def halt(self) -> None:
        """Stand still at once."""
        self.v_mps = self.w_radps = 0.0
        self.aim(0.0, 0.0)

    def step(self) -> tuple[float, float]:
        """Advance by one physics step and return the twist (v, w) the base takes during it.

        The slip is an Ornstein-Uhlenbeck process, relative to the speed.
        """
        self._approach()
        left, right = twist_to_wheels(self.v_mps, self.w_radps)
        gauss, memory, kick = self._random.gauss, self._memory, self._kick
        self._left_slip = self._left_slip * memory + gauss(0.0, kick)
        self._right_slip = self._right_slip * memory + gauss(0.0, kick)
        return wheels_to_twist(
            left * (self._left_gain - self._left_slip), right * (self._right_gain - self._right_slip)
        )

    def _approach(self) -> None:
        """Bring the motors nearer to the target; at the bound v and w are slowed alike, which keeps the arc."""
        target_v, target_w = self._target
        dv = (target_v - self.v_mps) * self._blend
        dw = (target_w - self.w_radps) * self._blend
        excess = max(
            abs(dv) / (ROUGH_ACCELERATION_MPS2 * STEP_S), abs(dw) / (ROUGH_YAW_ACCELERATION_RADPS2 * STEP_S)
        )
        if excess > 1.0:
            dv /= excess
            dw /= excess
        self.v_mps += dv
        self.w_radps += dw
        if abs(target_v - self.v_mps) < _SETTLED and abs(target_w - self.w_radps) < _SETTLED:
            self.v_mps, self.w_radps = self._target
            self.resting = self._target == (0.0, 0.0)
