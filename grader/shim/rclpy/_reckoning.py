"""Dead reckoning of the nominal car, so that a pose costs the script no round trip to the episode.

The poses computed here are only what the script sees. The episode gets every command with its time, moves the car
by the same law (`grader.sim.car`, `turtle`, `bullet`) and records what is scored. When anything but a command may
change the car (a service, a rotation, a turtle of the same name), or a listener is added, `Link` drops the
reckoning and asks the episode, whose next answer starts a new one.
"""

from __future__ import annotations

import math
import struct

UPDATE_NS = 16_000_000
UPDATE_S = 0.016
LIFE_NS = 1_000_000_000
"""How long a command acts, counted from the update that takes it; the first update after that stops the car."""

_DROPPED_AFTER_NS = (LIFE_NS // UPDATE_NS + 2) * UPDATE_NS - 1
"""How long after the update before the one that takes it a command is dropped: just before an update."""

MOST = 100.0
"""The car clamps the components of a command to this, in m/s and rad/s."""

NEVER_NS = 1 << 62

_HEADER = b"\x00\x01\x00\x00"
_POSE = struct.Struct("<4s5f")
_TWIST = struct.Struct("<4s6d")
_PI = math.pi
_cos, _sin, _remainder = math.cos, math.sin, math.remainder


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
        commanded: (v, w) of the latest command.
        drop_ns: when that command is dropped.
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
        self._drop_ns = drop_ns
        self._resting = resting
        self._window_m = window_m
        self._at_rest: bytes | None = None
        self._taken = b""  # the last command, and its (v, w): most scripts repeat it
        self._asked = (0.0, 0.0)

    def update(self) -> bytes:
        """Run the next update; return the pose that it publishes."""
        now_ns = self.next_ns
        self.next_ns = now_ns + UPDATE_NS
        if self._drop_ns <= now_ns:
            self._drop_ns = NEVER_NS
            self._order((0.0, 0.0))
        if self._resting:
            if self._at_rest is None:
                self._at_rest = self._published()
            return self._at_rest
        v, w = self._velocity = self._commanded
        self._heading_rad = heading = _fold(self._heading_rad + w * UPDATE_S)
        reach_m = v * UPDATE_S
        x, y = self._x_m + _cos(heading) * reach_m, self._y_m + _sin(heading) * reach_m
        most_m = self._window_m
        if most_m and not (0.0 <= x <= most_m and 0.0 <= y <= most_m):
            x, y = min(max(x, 0.0), most_m), min(max(y, 0.0), most_m)
        self._x_m, self._y_m = x, y
        self._resting = v == w == 0.0
        return _POSE.pack(_HEADER, x, y, heading, abs(v), w)

    def command(self, t_ns: int, cdr: bytes) -> None:
        """Take a message as the command from `t_ns` on; the first update after that obeys it."""
        if cdr == self._taken:
            v, w = self._asked
        elif len(cdr) != _TWIST.size or cdr[:4] != _HEADER:
            return
        else:
            v, w = self._asked = _bounded(cdr)
            self._taken = cdr
        self._order((v, w))
        self._drop_ns = t_ns // UPDATE_NS * UPDATE_NS + _DROPPED_AFTER_NS if v or w else NEVER_NS

    def _order(self, command: tuple[float, float]) -> None:
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
    """Fold an angle to [-pi, pi); one that lies there keeps its bits."""
    if -_PI <= angle_rad < _PI:
        return angle_rad
    folded = _remainder(angle_rad, math.tau)
    return -math.pi if folded >= math.pi else folded
