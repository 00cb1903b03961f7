"""turtlesim as the script meets it: its graph, its services, its updates every 16 ms."""

import math
from collections import deque
from collections.abc import Callable
from typing import Any, Final

from grader.contracts.assignment import World
from grader.sim import rotate_action
from grader.sim.car import PlanarPose, fold
from grader.sim.cdr import Values, decode, encode
from grader.sim.feeds import Feeds, Pen
from grader.sim.frames import Request
from grader.sim.outbox import Outbox
from grader.sim.rotate_action import RotateAction
from grader.sim.timeline import UPDATE_NS, next_update
from grader.sim.turtle import Turtle

NODE_NAME: Final = "/turtlesim"
TWIST: Final = "geometry_msgs/msg/Twist"
MAX_PENDING: Final = 1_000
MAX_TURTLES: Final = 100
FAR_M: Final = 1e6  # as far as a teleport goes in a world without walls

_LOCAL_SERVICES: Final = {
    "/clear": "std_srvs/srv/Empty",
    "/reset": "std_srvs/srv/Empty",
    "/spawn": "turtlesim/srv/Spawn",
    "/kill": "turtlesim/srv/Kill",
    "/turtle1/set_pen": "turtlesim/srv/SetPen",
    "/turtle1/teleport_absolute": "turtlesim/srv/TeleportAbsolute",
    "/turtle1/teleport_relative": "turtlesim/srv/TeleportRelative",
}


class TurtleWorld:
    """Everything that is not the script: one turtle that is a car, and turtlesim's interface to it.

    All happens in turtlesim's updates, every 16 ms: each serves the requests that came since the one before,
    moves the turtle and publishes. Turtles that a script spawns have a name and a place in the window but no
    topics of their own: the graph is fixed when the episode starts.

    Attributes:
        services: types by name.
    """

    def __init__(self, turtle: Turtle, world: World, epoch_ns: int) -> None:
        self.turtle = turtle
        self.outbox = Outbox()
        self.services = _LOCAL_SERVICES | rotate_action.SERVICES
        self._feeds = Feeds(turtle, self.outbox, epoch_ns)
        self._action = RotateAction(turtle, self.outbox, epoch_ns)
        self._publishes = self._feeds.topics | rotate_action.TOPICS
        self._command_topic = world.cmd_vel_topic
        self._others: set[str] = set()
        self._pending: deque[tuple[str, Request]] = deque()
        self._now_ns = 0
        self._handlers: dict[str, Callable[[Values], Values]] = {
            "/clear": self._clear,
            "/reset": self._reset,
            "/spawn": self._spawn,
            "/kill": self._kill,
            "/turtle1/set_pen": self._set_pen,
            "/turtle1/teleport_absolute": self._teleport_absolute,
            "/turtle1/teleport_relative": self._teleport_relative,
        }

    def graph(self) -> dict[str, list[Any]]:
        """Return START's ``world``: what exists besides the script, from the world's point of view."""
        return {
            "publishes": [list(item) for item in self._publishes.items()],
            "subscribes": [[self._command_topic, TWIST]],
            "services": [list(item) for item in self.services.items()],
            "nodes": [NODE_NAME],
        }

    def type_of(self, topic: str) -> str | None:
        """Return the type the world publishes or subscribes to on `topic`, None when it does neither."""
        return TWIST if topic == self._command_topic else self._publishes.get(topic)

    def keeps_last(self, topic: str) -> bool:
        """Return whether the world's publisher on `topic` is TRANSIENT_LOCAL."""
        return topic == f"{rotate_action.PREFIX}/status"

    def listen(self, topic: str, identity: int, t_ns: int) -> None:
        """Connect subscription `identity` to `topic`, which the world publishes, from `t_ns` on."""
        self.advance(t_ns)
        self.outbox.subscribe(topic, identity)

    def command(self, t_ns: int, linear_x: float, linear_y: float, angular_z: float) -> None:
        """Take a message on the command topic."""
        if self.next_due() is not None:
            self.advance(t_ns)
            self._action.interrupt()
        self.turtle.receive(t_ns, linear_x, linear_y, angular_z)

    def request(self, service: str, request: Request) -> bool:
        """Queue a request to one of `services` for the next update; false when too many wait."""
        self.advance(request.t_ns)
        if len(self._pending) >= MAX_PENDING:
            return False
        self._pending.append((service, request))
        return True

    def forget_requests(self) -> None:
        """Leave every waiting request unserved: their sender is not believed any more."""
        self._pending.clear()

    def next_due(self) -> int | None:
        """Return the next instant at which something may become due for the script, None when never."""
        return next_update(self._now_ns) * UPDATE_NS if self._busy or self._feeds.heard else None

    def advance(self, t_ns: int) -> None:
        """Run until `t_ns`, through every update that serves or tells somebody."""
        while (due_ns := self.next_due()) is not None and due_ns <= t_ns:
            self.turtle.advance(due_ns - 1)
            self._serve(due_ns)
            self.turtle.advance(due_ns)
            self._now_ns = due_ns
            self._feeds.emit(due_ns)
        self.turtle.advance(t_ns)
        self._now_ns = max(self._now_ns, t_ns)

    def settle(self, from_ns: int, until_ns: int) -> int:
        """Let the world go on without the script until the turtle rests; return when that is."""
        now_ns = min(from_ns, until_ns)
        self.advance(now_ns)
        while now_ns < until_ns and (self._busy or not self.turtle.resting):
            now_ns = min(next_update(now_ns) * UPDATE_NS, until_ns)
            self.advance(now_ns)
        return now_ns

    @property
    def _busy(self) -> bool:
        """Whether the next update has something to serve."""
        return bool(self._pending) or self._action.busy

    def _serve(self, t_ns: int) -> None:
        """Do what the update of `t_ns` does before it moves the turtle."""
        while self._pending:
            service, request = self._pending.popleft()
            handler = self._handlers.get(service)
            if handler is None:
                self._action.handle(service, request, t_ns)
                continue
            kind = self.services[service]
            answer = handler(decode(f"{kind}_Request", request.payload))
            self.outbox.reply(request, t_ns, encode(f"{kind}_Response", answer))
        self._action.tick(t_ns)

    # Services, as TurtleFrame and Turtle of turtlesim 1.4 serve them.

    def _clear(self, _: Values) -> Values:
        self._feeds.pen.cleared_at = self.turtle.pose
        return {}

    def _reset(self, _: Values) -> Values:
        self._others.clear()
        self._action.interrupt()
        self._jump(self.turtle.start, revive=True)
        self._feeds.pen = Pen(cleared_at=self.turtle.start)
        return {}

    def _spawn(self, values: Values) -> Values:
        names = self._others | ({"turtle1"} if self.turtle.alive else set())
        name = values["name"] or next(
            n for n in map("turtle{}".format, range(1, MAX_TURTLES + 2)) if n not in names
        )
        pose = (values["x"], values["y"], values["theta"])
        if name in names or len(names) >= MAX_TURTLES or not all(map(math.isfinite, pose)):
            return {"name": ""}
        if name == "turtle1":
            self._jump(pose, revive=True)
        else:
            self._others.add(name)
        return {"name": name}

    def _kill(self, values: Values) -> Values:
        if values["name"] == "turtle1" and self.turtle.alive:
            self._action.interrupt()
            self.turtle.kill()
        self._others.discard(values["name"])
        return {}

    def _set_pen(self, values: Values) -> Values:
        self._feeds.pen.color = (values["r"], values["g"], values["b"])
        self._feeds.pen.off = bool(values["off"])
        return {}

    def _teleport_absolute(self, values: Values) -> Values:
        self._jump((values["x"], values["y"], values["theta"]))
        return {}

    def _teleport_relative(self, values: Values) -> Values:
        x, y, heading = self.turtle.pose
        reach, turn = values["linear"], values["angular"]
        if not (math.isfinite(reach) and math.isfinite(turn)):
            return {}
        heading += turn
        self._jump((x + reach * math.cos(heading), y + reach * math.sin(heading), heading))
        return {}

    def _jump(self, pose: PlanarPose, *, revive: bool = False) -> None:
        """Put the turtle into `pose`; a place that is no number, or a dead turtle, is left alone."""
        if not all(map(math.isfinite, pose)) or not (self.turtle.alive or revive):
            return
        before = self.turtle.pose
        x, y = (min(max(position, -FAR_M), FAR_M) for position in pose[:2])
        after = (x, y, fold(pose[2]))
        if revive:
            self.turtle.revive(after)
        else:
            self.turtle.teleport(after)
        self._feeds.moved(before, after)
