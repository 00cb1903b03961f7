"""Events for the script: those that wait to be sent, and what a turtle publishes by itself.

A turtle publishes pose and colour; the graded one odometry and its transform as well, if the world has them.
"""

import math
import struct
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final

from grader.sim.car import PlanarPose, cos_sin, fold
from grader.sim.cdr import HEADER, encode
from grader.sim.frames import APART, MESSAGE_EVENT, RESPONSE_EVENT, Event, Request
from grader.sim.interfaces import header, quaternion
from grader.sim.turtle import Turtle

MAX_EVENTS: Final = 256  # in one answer; the rest is due in the next one
MAX_QUEUED: Final = 2_000
BLANK: Final = (255, 255, 255)  # what turtlesim's sensor reads where nothing is drawn: see-through white

_POSE: Final = struct.Struct("<5f")
_COLOR: Final = struct.Struct("<3B")


class Outbox:
    """Events for the jail in order of time, and the subscriptions of the script.

    Attributes:
        changes: how often subscriptions came or went.
    """

    def __init__(self) -> None:
        self._queue: deque[Event] = deque()
        self._listeners: dict[str, list[int]] = {}
        self._apart: list[Event] = []
        self.changes = 0

    def __bool__(self) -> bool:
        return bool(self._queue)

    def subscribe(self, topic: str, identity: int) -> None:
        """Subscribe `identity` to `topic`."""
        self._listeners.setdefault(topic, []).append(identity)
        self.changes += 1

    def unsubscribe(self, identity: int) -> None:
        """Forget a subscription, if it is known."""
        self.changes += 1
        for topic, listeners in tuple(self._listeners.items()):
            if identity in listeners:
                listeners.remove(identity)
                if not listeners:
                    del self._listeners[topic]

    def has_listeners(self, topic: str) -> bool:
        """Return whether a message on `topic` would reach anyone."""
        return topic in self._listeners

    def has_listener_of(self, topics: Iterable[str]) -> bool:
        """Return whether a message on one of `topics` would reach anyone."""
        return not self._listeners.keys().isdisjoint(topics)

    def only_listeners(self, topic: str, others: Iterable[str]) -> tuple[int, ...]:
        """Return who hears `topic`; nobody while anybody hears one of `others`."""
        return () if self.has_listener_of(others) else tuple(self._listeners.get(topic, ()))

    def publish(self, topic: str, t_ns: int, payload: bytes) -> None:
        """Queue one message for everyone who listens."""
        for identity in self._listeners.get(topic, ()):
            self.add(Event(MESSAGE_EVENT, identity, 0, t_ns, payload))

    def reply(self, request: Request, t_ns: int, payload: bytes) -> None:
        """Queue the answer to `request`."""
        self.add(Event(RESPONSE_EVENT, request.id, request.sequence, t_ns, payload))

    def add(self, event: Event) -> None:
        """Queue `event`. Drop it if the queue is full: then the script never fetches what is due."""
        if event.id >= APART:
            if len(self._apart) < MAX_QUEUED:
                self._apart.append(event)
        elif len(self._queue) < MAX_QUEUED:
            self._queue.append(event)

    @property
    def full(self) -> bool:
        """Whether the queued events fill one answer."""
        return len(self._queue) >= MAX_EVENTS

    @property
    def first_ns(self) -> int | None:
        """Instant of the first queued event, None when nothing is queued."""
        return self._queue[0].t_ns if self._queue else None

    @property
    def last_ns(self) -> int:
        """Instant of the last queued event; one must be queued."""
        return self._queue[-1].t_ns

    def take_apart(self) -> list[Event]:
        """Return what has come for others than the script, in order of time."""
        events, self._apart = self._apart, []
        return events

    def take(self, together_ns: int = 0) -> tuple[int, list[Event]]:
        """Return an instant and the events queued up to it: the first event's, or `together_ns` if that is later.

        These are at most `MAX_EVENTS`. The instant is that of the last event if some are left for the next answer.
        """
        now_ns = max(self._queue[0].t_ns, together_ns)
        events: list[Event] = []
        while self._queue and self._queue[0].t_ns <= now_ns:
            if len(events) == MAX_EVENTS:
                return events[-1].t_ns, events
            events.append(self._queue.popleft())
        return now_ns, events


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

    def __init__(self, name: str, turtle: Turtle, outbox: Outbox, epoch_ns: int, *, odometry: bool) -> None:
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

    @property
    def pose_listeners(self) -> tuple[int, ...]:
        """Who hears the pose; empty while anybody hears another topic of the turtle."""
        pose, *others = self._feeds
        return self._outbox.only_listeners(pose, others)

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
        c, s = cos_sin(heading)
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
                "header": header(self._epoch_ns + t_ns, "odom"),
                "child_frame_id": "base_link",
                "pose": {"pose": {"position": {"x": x, "y": y}, "orientation": quaternion(heading)}},
                "twist": {"twist": {"linear": {"x": v}, "angular": {"z": w}}},
            },
        )

    def _transform(self, t_ns: int) -> bytes:
        x, y, heading = _relative(self._turtle.pose, self._origin)
        transform = {
            "header": header(self._epoch_ns + t_ns, "odom"),
            "child_frame_id": "base_link",
            "transform": {"translation": {"x": x, "y": y}, "rotation": quaternion(heading)},
        }
        return encode("tf2_msgs/msg/TFMessage", {"transforms": [transform]})


def _relative(pose: PlanarPose, origin: PlanarPose) -> PlanarPose:
    dx, dy = pose[0] - origin[0], pose[1] - origin[1]
    c, s = cos_sin(origin[2])
    return dx * c + dy * s, dy * c - dx * s, pose[2] - origin[2]
