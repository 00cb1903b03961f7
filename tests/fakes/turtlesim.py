"""turtlesim 1.4's motion, exactly, written from its behaviour apart from the simulator, so that they can disagree.

Its timer comes every 16 ms. Each time it takes the oldest of the at most seven commands that it kept, stops a
turtle whose last command it took more than 1.0 s ago, turns by w * 16 ms, then moves by v * 16 ms along the new
heading, then clamps to the window.
"""

import math
from collections import deque
from collections.abc import Iterable
from typing import NamedTuple

PERIOD_NS = 16_000_000
HOLD_NS = 1_000_000_000
KEPT = 7
WINDOW_M = 11.088889122009277
PI = 3.14159265  # turtlesim's own


class Pose(NamedTuple):
    """A message on /turtle1/pose and when it is published."""

    t_ns: int
    x: float
    y: float
    theta: float
    v: float
    w: float


class Turtlesim:
    """One turtle. `command` must be called in order of time, before `update` reaches its instant."""

    def __init__(self, x: float, y: float, theta: float, *, walls: bool = True, kept: int = KEPT) -> None:
        self._x, self._y, self._theta = x, y, theta
        self._walls = walls
        self._most = kept
        self._coming: deque[tuple[int, float, float]] = deque()
        self._kept: list[tuple[float, float]] = []
        self._v = self._w = 0.0
        self._taken_ns = -HOLD_NS
        self._now_ns = 0

    def command(self, t_ns: int, v: float, w: float) -> None:
        """Let a Twist arrive."""
        self._coming.append((t_ns, v, w))

    def update(self) -> Pose:
        """Run the next tick of the timer. A command of the very instant of a tick comes too late for it."""
        self._now_ns += PERIOD_NS
        while self._coming and self._coming[0][0] < self._now_ns:
            self._kept = [*self._kept, self._coming.popleft()[1:]][-self._most :]
        if self._kept:
            (self._v, self._w), *self._kept = self._kept
            self._taken_ns = self._now_ns
        if self._now_ns - self._taken_ns > HOLD_NS:
            self._v = self._w = 0.0
        dt = PERIOD_NS / 1e9
        theta = self._theta + self._w * dt
        self._theta = theta - 2.0 * PI * math.floor((theta + PI) / (2.0 * PI))
        self._x += math.cos(self._theta) * self._v * dt
        self._y += math.sin(self._theta) * self._v * dt
        if self._walls:
            self._x = min(max(self._x, 0.0), WINDOW_M)
            self._y = min(max(self._y, 0.0), WINDOW_M)
        return Pose(self._now_ns, self._x, self._y, self._theta, abs(self._v), self._w)


def poses(
    commands: Iterable[tuple[int, float, float]],
    until_ns: int,
    start: tuple[float, float, float],
    *,
    walls: bool = True,
    kept: int = KEPT,
) -> list[Pose]:
    """Return what turtlesim publishes up to `until_ns` under commands (t, v, w) in order of time."""
    turtle = Turtlesim(*start, walls=walls, kept=kept)
    for command in commands:
        turtle.command(*command)
    return [turtle.update() for _ in range(until_ns // PERIOD_NS)]
