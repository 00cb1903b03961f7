"""Dead reckoning of the nominal car, so that a pose costs the script no round trip to the episode.

The poses computed here are only what the script sees. The episode gets every command with its time, moves the car
by the same law (`grader.sim.car`, `turtle`, `bullet`) and records what is scored. When anything but a command may
change the car (a service, a rotation, a turtle of the same name), or a listener is added, `Link` drops the
reckoning and asks the episode, whose next answer starts a new one.
"""

from __future__ import annotations

import math
import struct
from collections import deque

UPDATE_NS = 16_000_000
UPDATE_S = 0.016
LIFE_NS = 1_000_000_000
"""How long a command acts, counted from the update that takes it; the first update after that stops the car."""

_DROPPED_AFTER_NS = (LIFE_NS // UPDATE_NS + 1) * UPDATE_NS - 1
"""How long after the update that takes it a command is dropped: just before an update."""

MOST_WAITING = 7
"""Each update takes one command, oldest first; an eighth that waits pushes the oldest out."""

MOST = 100.0
"""The car clamps the components of a command to this, in m/s and rad/s."""

NEVER_NS = 1 << 62

_HEADER = b"\x00\x01\x00\x00"
_POSE = struct.Struct("<4s5f")
_TWIST = struct.Struct("<4s6d")
_PI = 3.14159265
_QUARTERS_PER_RAD = 0.6366197723675814
_QUARTER_RAD = (1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21)
_SIN = tuple((-1) ** k / math.factorial(2 * k + 1) for k in range(8, 0, -1))
_COS = tuple((-1) ** k / math.factorial(2 * k) for k in range(9, 0, -1))


class Reckoning:
    """The car between two answers of the episode.

    Attributes:
        subscriptions: ids of the subscriptions that get each pose.
        publishers: ids of the publishers whose messages command the car.
        next_ns: instant of the next update.

    Args:
        now_ns: instant of the last update; the arguments that follow describe the car after it.
        pose: x, y and heading.
        velocity: (v, w) during that update.
        commanded: (v, w) of the command that was taken last.
        waiting: (v, w) of the commands that wait to be taken.
        drop_ns: when the one that was taken is dropped.
        resting: whether the car stands still until the next command.
        window_m: width and height of the window, whose walls stop the car; 0: no walls.
    """

    def __init__(
        self,
        subscriptions: tuple[int, ...],
        publishers: tuple[int, ...],
        now_ns: int,
        pose: tuple[float, float, float],
        velocity: tuple[float, float],
        commanded: tuple[float, float],
        waiting: tuple[tuple[float, float], ...],
        drop_ns: int,
        resting: bool,
        window_m: float,
    ) -> None:
        self.subscriptions = subscriptions
        self.publishers = publishers
        self.next_ns = now_ns + UPDATE_NS
        self._x_m, self._y_m, self._heading_rad = pose
        self._velocity = velocity
        self._commanded = commanded
        self._waiting = deque(waiting, MOST_WAITING)
        self._drop_ns = drop_ns
        self._resting = resting
        self._window_m = window_m
        self._at_rest: bytes | None = None
        self._came = b""  # the last command, and its (v, w): most scripts repeat it
        self._asked = (0.0, 0.0)
        self._cos_sin: tuple[float, float] | None = None  # of the heading

    def update(self) -> bytes:
        """Run the next update; return the pose that it publishes."""
        now_ns = self.next_ns
        self.next_ns = now_ns + UPDATE_NS
        if self._waiting:
            self._take(self._waiting.popleft(), now_ns)
        elif self._drop_ns <= now_ns:
            self._take((0.0, 0.0), now_ns)
        if self._resting:
            if self._at_rest is None:
                self._at_rest = self._published()
            return self._at_rest
        v, w = self._velocity = self._commanded
        heading = _fold(self._heading_rad + w * UPDATE_S)
        x, y = self._x_m, self._y_m
        if heading != self._heading_rad:
            self._heading_rad = heading
            self._cos_sin = None
        if v:
            if self._cos_sin is None:
                self._cos_sin = _cos_sin(heading)
            c, s = self._cos_sin
            reach_m = v * UPDATE_S
            x, y = x + c * reach_m, y + s * reach_m
        most_m = self._window_m
        if most_m and not (0.0 <= x <= most_m and 0.0 <= y <= most_m):
            x, y = min(max(x, 0.0), most_m), min(max(y, 0.0), most_m)
        self._x_m, self._y_m = x, y
        self._resting = v == w == 0.0
        return _POSE.pack(_HEADER, x, y, heading, abs(v), w)

    def command(self, cdr: bytes) -> None:
        """Let a message arrive as a command. Updates up to its time must have been run."""
        if cdr != self._came:
            if len(cdr) != _TWIST.size or cdr[:4] != _HEADER:
                return
            self._asked = _bounded(cdr)
            self._came = cdr
        self._waiting.append(self._asked)

    def _take(self, command: tuple[float, float], now_ns: int) -> None:
        self._drop_ns = now_ns + _DROPPED_AFTER_NS if command != (0.0, 0.0) else NEVER_NS
        if command != self._commanded:
            self._commanded = command
            self._resting = False
            self._at_rest = None

    def _published(self) -> bytes:
        v, w = self._velocity
        return _POSE.pack(_HEADER, self._x_m, self._y_m, _fold(self._heading_rad), abs(v), w)


def _bounded(cdr: bytes) -> tuple[float, float]:
    """Return (v, w) of a Twist as the car takes it."""
    _, v, _, _, _, _, w = _TWIST.unpack(cdr)
    if -MOST <= v <= MOST and -MOST <= w <= MOST:
        return v, w
    if math.isfinite(v) and math.isfinite(w):
        return min(max(v, -MOST), MOST), min(max(w, -MOST), MOST)
    return 0.0, 0.0


def _fold(angle_rad: float) -> float:
    """Fold an angle as `grader.sim.car.fold` does; here it is always finite."""
    if -_PI <= angle_rad < _PI:
        return angle_rad
    return angle_rad - 2.0 * _PI * math.floor((angle_rad + _PI) / (2.0 * _PI))


def _cos_sin(angle_rad: float) -> tuple[float, float]:
    """Return the bits of `grader.geometry.exact.cos_sin`, where they are explained; an angle is finite here."""
    angle_rad += 0.0
    quarters = round(angle_rad * _QUARTERS_PER_RAD)
    first, second, third = _QUARTER_RAD
    x = ((angle_rad - quarters * first) - quarters * second) - quarters * third
    square = x * x
    c = 1.0 + square * _polynomial(_COS, square)
    s = x + x * square * _polynomial(_SIN, square)
    return ((c, s), (-s, c), (-c, -s), (s, -c))[quarters % 4]


def _polynomial(factors: tuple[float, ...], x: float) -> float:
    value = 0.0
    for factor in factors:
        value = value * x + factor
    return value
