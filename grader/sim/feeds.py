"""What turtle1 publishes by itself: pose, colour, odometry and its transform."""

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

from grader.sim.car import PlanarPose
from grader.sim.cdr import HEADER, encode
from grader.sim.outbox import Outbox
from grader.sim.timeline import NS_PER_S
from grader.sim.turtle import Turtle

TICK_NS: Final = 16_000_000  # turtlesim's timer
ODOMETRY_NS: Final = 20_000_000

BACKGROUND: Final = (69, 86, 255)

_POSE: Final = struct.Struct("<5f")
_COLOR: Final = struct.Struct("<3B")


@dataclass(slots=True)
class Pen:
    """turtle1's pen, as far as the colour sensor can tell."""

    color: tuple[int, int, int] = (179, 184, 255)
    off: bool = False
    cleared_at: PlanarPose | None = None


def fold(angle_rad: float) -> float:
    """Fold an angle to [-pi, pi), as turtlesim does; an infinite one is no angle."""
    if math.isinf(angle_rad):
        return math.nan
    folded = math.remainder(angle_rad, math.tau)
    return -math.pi if folded >= math.pi else folded


class Feeds:
    """The periodic topics. A message is built only when somebody listens and its instant is reached.

    Odometry starts at zero where the car starts, as a robot's does, and follows the wheels: a teleport is
    not motion, so it does not show in it.
    """

    def __init__(self, turtle: Turtle, outbox: Outbox, epoch_ns: int) -> None:
        self.pen = Pen(cleared_at=turtle.start)
        self._turtle = turtle
        self._outbox = outbox
        self._epoch_ns = epoch_ns
        self._origin = turtle.start
        self._feeds: dict[str, tuple[str, int, Callable[[int], bytes]]] = {
            "/turtle1/pose": ("turtlesim/msg/Pose", TICK_NS, self._pose),
            "/turtle1/color_sensor": ("turtlesim/msg/Color", TICK_NS, self._color),
            "/odom": ("nav_msgs/msg/Odometry", ODOMETRY_NS, self._odometry),
            "/tf": ("tf2_msgs/msg/TFMessage", ODOMETRY_NS, self._transform),
        }
        self._next_ns: dict[str, int] = {}

    @property
    def topics(self) -> dict[str, str]:
        """Types by topic."""
        return {topic: feed[0] for topic, feed in self._feeds.items()}

    def listen(self, topic: str, t_ns: int) -> None:
        """Somebody listens to `topic` from `t_ns` on: its next message is due at its next instant."""
        if topic in self._feeds and topic not in self._next_ns:
            period_ns = self._feeds[topic][1]
            self._next_ns[topic] = (t_ns // period_ns + 1) * period_ns

    def next_ns(self) -> int | None:
        """Return when the next message is due, or None when nobody listens."""
        for topic in [topic for topic in self._next_ns if not self._outbox.has_listeners(topic)]:
            del self._next_ns[topic]
        return min(self._next_ns.values(), default=None)

    def emit(self, t_ns: int) -> None:
        """Queue every message due at `t_ns`, to which the turtle has been advanced."""
        for topic, due_ns in self._next_ns.items():
            if due_ns <= t_ns:
                _, period_ns, build = self._feeds[topic]
                self._next_ns[topic] = due_ns + period_ns
                if self._turtle.alive:
                    self._outbox.publish(topic, due_ns, build(due_ns))

    def moved(self, before: PlanarPose, after: PlanarPose) -> None:
        """Learn of a teleport: shift the origin of the odometry so that it stays where it was."""
        x, y, turn = _relative(before, self._origin)
        heading = after[2] - turn
        c, s = math.cos(heading), math.sin(heading)
        self._origin = (after[0] - (x * c - y * s), after[1] - (x * s + y * c), heading)

    def _pose(self, t_ns: int) -> bytes:
        x, y, heading = self._turtle.pose_at(t_ns)
        v, w = self._turtle.velocity
        return HEADER + _POSE.pack(x, y, fold(heading), abs(v), w)

    def _color(self, t_ns: int) -> bytes:
        # The sensor reads the pixel under the turtle: its own line once it has left the place of the last
        # /clear. Crossing older lines of other colours is not imitated.
        x, y, _ = self._turtle.pose_at(t_ns)
        cleared = self.pen.cleared_at
        drawn = not self.pen.off and cleared is not None and math.dist((x, y), cleared[:2]) > 0.02
        if drawn:
            self.pen.cleared_at = (math.inf, math.inf, 0.0)
        return HEADER + _COLOR.pack(*(self.pen.color if drawn else BACKGROUND))

    def _odometry(self, t_ns: int) -> bytes:
        x, y, heading = _relative(self._turtle.pose_at(t_ns), self._origin)
        v, w = self._turtle.velocity
        return encode(
            "nav_msgs/msg/Odometry",
            {
                "header": self._header(t_ns, "odom"),
                "child_frame_id": "base_link",
                "pose": {"pose": {"position": {"x": x, "y": y}, "orientation": _quaternion(heading)}},
                "twist": {"twist": {"linear": {"x": v}, "angular": {"z": w}}},
            },
        )

    def _transform(self, t_ns: int) -> bytes:
        x, y, heading = _relative(self._turtle.pose_at(t_ns), self._origin)
        transform = {
            "header": self._header(t_ns, "odom"),
            "child_frame_id": "base_link",
            "transform": {"translation": {"x": x, "y": y}, "rotation": _quaternion(heading)},
        }
        return encode("tf2_msgs/msg/TFMessage", {"transforms": [transform]})

    def _header(self, t_ns: int, frame: str) -> dict[str, Any]:
        return {"stamp": stamp(self._epoch_ns + t_ns), "frame_id": frame}


def stamp(t_ns: int) -> dict[str, int]:
    """Return `t_ns` as builtin_interfaces/msg/Time."""
    return {"sec": t_ns // NS_PER_S, "nanosec": t_ns % NS_PER_S}


def _relative(pose: PlanarPose, origin: PlanarPose) -> PlanarPose:
    dx, dy = pose[0] - origin[0], pose[1] - origin[1]
    c, s = math.cos(origin[2]), math.sin(origin[2])
    return dx * c + dy * s, dy * c - dx * s, pose[2] - origin[2]


def _quaternion(heading_rad: float) -> dict[str, float]:
    half = fold(heading_rad) / 2.0
    return {"z": math.sin(half), "w": math.cos(half)}
