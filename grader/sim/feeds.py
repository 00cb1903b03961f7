"""What a turtle publishes by itself: pose and colour; the graded one odometry and its transform as well."""

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

from grader.sim.car import PlanarPose, fold
from grader.sim.cdr import HEADER, encode
from grader.sim.outbox import Outbox
from grader.sim.timeline import NS_PER_S
from grader.sim.turtle import AnyTurtle

BLANK: Final = (255, 255, 255)  # what turtlesim's sensor reads where nothing is drawn: see-through white

_POSE: Final = struct.Struct("<5f")
_COLOR: Final = struct.Struct("<3B")


@dataclass(slots=True)
class Pen:
    """A turtle's pen, as far as the colour sensor can tell."""

    color: tuple[int, int, int] = (179, 184, 255)
    off: bool = False
    cleared_at: PlanarPose | None = None


class Feeds:
    """What comes with each update. A message is built only when somebody listens.

    Odometry starts at zero where the car starts, as a robot's does, and follows the wheels: a teleport is
    not motion, so it does not show in it.
    """

    def __init__(
        self, name: str, turtle: AnyTurtle, outbox: Outbox, epoch_ns: int, *, odometry: bool
    ) -> None:
        self.pen = Pen(cleared_at=turtle.start)
        self._turtle = turtle
        self._outbox = outbox
        self._epoch_ns = epoch_ns
        self._origin = turtle.start
        self._feeds: dict[str, tuple[str, Callable[[int], bytes]]] = {
            f"/{name}/pose": ("turtlesim/msg/Pose", self._pose),
            f"/{name}/color_sensor": ("turtlesim/msg/Color", self._color),
        }
        if odometry:
            self._feeds["/odom"] = ("nav_msgs/msg/Odometry", self._odometry)
            self._feeds["/tf"] = ("tf2_msgs/msg/TFMessage", self._transform)

    @property
    def topics(self) -> dict[str, str]:
        """Types by topic."""
        return {topic: feed[0] for topic, feed in self._feeds.items()}

    @property
    def heard(self) -> bool:
        """Whether anybody listens."""
        return self._outbox.has_listener_of(self._feeds)

    def emit(self, t_ns: int) -> None:
        """Queue what the update of `t_ns` publishes."""
        if self._turtle.alive:
            for topic, (_, build) in self._feeds.items():
                if self._outbox.has_listeners(topic):
                    self._outbox.publish(topic, t_ns, build(t_ns))

    def moved(self, before: PlanarPose, after: PlanarPose) -> None:
        """Learn of a teleport: shift the origin of the odometry so that it stays where it was."""
        x, y, turn = _relative(before, self._origin)
        heading = after[2] - turn
        c, s = math.cos(heading), math.sin(heading)
        self._origin = (after[0] - (x * c - y * s), after[1] - (x * s + y * c), heading)

    def _pose(self, _t_ns: int) -> bytes:
        x, y, heading = self._turtle.pose
        v, w = self._turtle.velocity
        return HEADER + _POSE.pack(x, y, fold(heading), abs(v), w)

    def _color(self, _t_ns: int) -> bytes:
        # The sensor reads the pixel under the turtle: its own line once it has left the place of the last
        # /clear. Crossing older lines of other colours is not imitated.
        x, y, _ = self._turtle.pose
        cleared = self.pen.cleared_at
        drawn = not self.pen.off and cleared is not None and math.dist((x, y), cleared[:2]) > 0.02
        if drawn:
            self.pen.cleared_at = (math.inf, math.inf, 0.0)
        return HEADER + _COLOR.pack(*(self.pen.color if drawn else BLANK))

    def _odometry(self, t_ns: int) -> bytes:
        x, y, heading = _relative(self._turtle.pose, self._origin)
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
        x, y, heading = _relative(self._turtle.pose, self._origin)
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
