"""turtlesim as the script meets it: its graph, its services, its updates every 16 ms."""

import json
import math
import re
from collections import deque
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from grader.contracts.assignment import WINDOW_M, Distro, World
from grader.contracts.conversation import TurtleSample
from grader.contracts.trajectory import Trajectory
from grader.sim import parameters
from grader.sim.car import UPDATE_NS, PlanarPose, cos_sin, next_update
from grader.sim.cdr import Values, decode, encode
from grader.sim.feeds import Feeds, Pen
from grader.sim.frames import GRAPH_EVENT, CarState, Entity, Event, Request
from grader.sim.parameters import Parameters
from grader.sim.rotate_action import RotateAction
from grader.sim.simulated_world import SimulatedWorld
from grader.sim.turtle import Turtle, spawned

NODE_NAME: Final = "/turtlesim"
TWIST: Final = "geometry_msgs/msg/Twist"
MAX_PENDING: Final = 1_000
MAX_TURTLES: Final = 100
FAR_M: Final = 1e6  # as far as a teleport goes in a world without walls

_NOWHERE: Final = (math.nan, math.nan, math.nan)

GRADED: Final = "turtle1"

# In the order in which they are made, and served.
_WINDOW_SERVICES: Final = {
    **{f"{NODE_NAME}/{name}": kind for name, kind in parameters.SERVICES.items()},
    "/clear": "std_srvs/srv/Empty",
    "/reset": "std_srvs/srv/Empty",
    "/spawn": "turtlesim/srv/Spawn",
    "/kill": "turtlesim/srv/Kill",
}
_TURTLE_SERVICES: Final = {
    "set_pen": "turtlesim/srv/SetPen",
    "teleport_relative": "turtlesim/srv/TeleportRelative",
    "teleport_absolute": "turtlesim/srv/TeleportAbsolute",
}
_TOPIC_NAME: Final = re.compile(r"[A-Za-z_]\w*", re.ASCII)

Graph: TypeAlias = dict[str, list[list[str]]]
"""Names and types of what the world publishes, subscribes to and offers, from the world's point of view."""


@dataclass(slots=True)
class Presence:
    """A turtle in the window and what it has on the ROS graph."""

    name: str
    turtle: Turtle
    feeds: Feeds
    action: RotateAction
    command_topic: str

    @property
    def services(self) -> dict[str, str]:
        """Types by name."""
        own = {f"/{self.name}/{service}": kind for service, kind in _TURTLE_SERVICES.items()}
        return own | self.action.services

    @property
    def topics(self) -> dict[str, str]:
        """Types of what it publishes, by topic."""
        return self.feeds.topics | self.action.topics

    def graph(self) -> Graph:
        """Return what it adds to the graph."""
        return {
            "publishes": [list(item) for item in self.topics.items()],
            "subscribes": [[self.command_topic, TWIST]],
            "services": [list(item) for item in self.services.items()],
        }


class TurtleWorld(SimulatedWorld):
    """Everything that is not the script: the turtles and turtlesim's interface. One turtle, a car, is graded.

    All happens in turtlesim's updates, every 16 ms. An update takes one command of each turtle, then serves one
    request of each service and of each action, then moves the turtles and publishes. A turtle that the script
    spawns has topics, services and an action of its own; the script learns when they come and go.

    Attributes:
        turtle: the graded one.
    """

    def __init__(self, turtle: Turtle, world: World, epoch_ns: int, distro: Distro = "humble") -> None:
        super().__init__(turtle.commands, world.cmd_vel_topic)
        self.turtle = turtle
        self._walls = world.walls
        self._epoch_ns = epoch_ns
        self._feeds = Feeds(GRADED, turtle, self.outbox, epoch_ns, odometry=world.odometry)
        self._action = RotateAction(GRADED, turtle, self.outbox, epoch_ns)
        graded = Presence(GRADED, turtle, self._feeds, self._action, world.cmd_vel_topic)
        self._present = {GRADED: graded}
        self._others: dict[str, Turtle] = {}
        self._nameless: set[str] = set()
        # The last number given to a turtle spawned without a name; turtlesim gives none twice.
        self._numbered = 1
        self._parameters = Parameters(distro)
        self._pending: dict[str, deque[Request]] = {}
        self._now_ns = 0
        self._reckoned = False  # whether the script reckons the poses by itself
        self._heard = False  # whether anybody listens; asked several times an update
        self._heard_at = -1  # the outbox's number of changes at that answer
        self._handlers: dict[str, Callable[[Values, int], Values]] = {
            "/clear": self._clear,
            "/reset": self._reset,
            "/spawn": self._spawn,
            "/kill": self._kill,
        }
        self._turtle_handlers: dict[str, Callable[[Presence, Values], None]] = {
            "set_pen": self._set_pen,
            "teleport_absolute": self._teleport_absolute,
            "teleport_relative": self._teleport_relative,
        }
        self._topics: dict[str, str] = {}
        self._commands: dict[str, Presence] = {}
        self._turns: list[tuple[str, ...]] = []
        self._index()

    def graph(self) -> dict[str, list[Any]]:
        """Return START's ``world``: what exists besides the script, from the world's point of view."""
        graph = self._present[GRADED].graph()
        window = [list(item) for item in _WINDOW_SERVICES.items()]
        return {**graph, "services": window + graph["services"], "nodes": [NODE_NAME]}

    @property
    def topics(self) -> dict[str, str]:
        """Types by topic of what the world publishes and of what it takes commands on, at present."""
        return self._topics | dict.fromkeys(self._commands, TWIST)

    @property
    def command_topics(self) -> Collection[str]:
        """On which commands are taken at present."""
        return self._commands.keys()

    def type_of(self, topic: str) -> str | None:
        """Return the type the world publishes or subscribes to on `topic`, None when it does neither."""
        return TWIST if topic in self._commands else self._topics.get(topic)

    @property
    def steps_run(self) -> int:
        """Physics steps computed."""
        return self.turtle.steps_run

    def appear(self) -> None:
        """Build the physical world. To be called first, once; InfrastructureError."""
        self.turtle.appear()

    def as_commanded(self, recorded: Trajectory) -> Trajectory | None:
        """Return the motion if each command had been obeyed at once; None where none waited."""
        return self.turtle.at_once(recorded)

    def finish(self, end_ns: int) -> None:
        """Drive up to `end_ns`, when the episode ended, and record the last sample."""
        self.turtle.finish(end_ns)

    def qos_note(self, entity: Entity) -> str | None:
        """Return the note on a subscription whose QoS the world's publisher on its topic does not offer."""
        fits = not entity.transient_local or entity.name.endswith("/_action/status")
        return None if fits else "incompatible_qos"

    def listen(self, topic: str, identity: int, t_ns: int, *, late: bool = False) -> None:
        """Connect subscription `identity` to `topic`, which the world publishes, from `t_ns` on."""
        self.advance(t_ns)
        self.outbox.subscribe(topic, identity)

    def command(
        self, topic: str, times_ns: Sequence[int], linear_x: float, linear_y: float, angular_z: float
    ) -> None:
        """Take a message on a command topic, which was published at each of these times in order."""
        commanded = self._commands[topic]
        if commanded.name == GRADED and self.next_due() is None:  # commands make nothing due by themselves
            self.turtle.receive(times_ns, linear_x, linear_y, angular_z)
            return
        for t_ns in times_ns:
            if self.next_due() is not None:
                self.advance(t_ns)
            commanded.turtle.receive((t_ns,), linear_x, linear_y, angular_z)

    def say(self, topic: str, t_ns: int, payload: bytes) -> None:
        """Publish a message of a conversation; one on a command topic moves its turtle."""
        if topic in self._commands:
            twist = decode(TWIST, payload)
            self.command(topic, (t_ns,), twist["linear"]["x"], twist["linear"]["y"], twist["angular"]["z"])
        super().say(topic, t_ns, payload)

    def turtles(self, t_ns: int) -> dict[str, TurtleSample]:
        """Return where each turtle is at `t_ns`, and its pen."""
        self.advance(t_ns)
        self._move(t_ns)
        return {
            name: TurtleSample(t_ns, *each.turtle.pose, pen=each.feeds.pen.color, pen_off=each.feeds.pen.off)
            for name, each in self._present.items()
            if each.turtle.alive
        }

    def request(self, service: str, request: Request) -> bool:
        """Queue a request to one of `services` for the next update; false when too many wait."""
        self.advance(request.t_ns)
        if sum(map(len, self._pending.values())) >= MAX_PENDING:
            return False
        self._pending.setdefault(service, deque()).append(request)
        return True

    def forget_commands(self) -> None:
        """Drop the commands that wait for any turtle."""
        for turtle in self._present.values():
            turtle.turtle.forget()

    def forget_requests(self) -> None:
        """Drop every waiting request: a script that broke the protocol is served no more."""
        self._pending.clear()

    def next_due(self) -> int | None:
        """Return the next instant at which something may become due for the script, None when never."""
        if self._heard_at != self.outbox.changes:
            self._heard_at = self.outbox.changes
            self._heard = any(turtle.feeds.heard for turtle in self._present.values())
        if (self._heard and not self._reckoned) or self._busy:
            return next_update(self._now_ns) * UPDATE_NS
        return None

    def let_reckon(self) -> CarState | None:
        """Return what the script needs to compute the poses itself; None unless only its commands decide them.

        From then on no pose is published, until `take_back`.
        """
        if not self.turtle.reckonable or self.outbox or self._busy or self._others:
            return None
        listeners = self._feeds.pose_listeners
        if not listeners:
            return None
        self._reckoned = True
        self.turtle.advance(self._now_ns)
        return self.turtle.state(listeners)

    def take_back(self, t_ns: int) -> None:
        """Publish the poses again that come after `t_ns`."""
        if self._reckoned:
            self.advance(t_ns)
            self._reckoned = False

    def advance(self, t_ns: int) -> None:
        """Run until `t_ns`, through every update that serves or tells somebody."""
        while (due_ns := self.next_due()) is not None and due_ns <= t_ns:
            self._move(due_ns - 1)
            self._serve(due_ns)
            self._move(due_ns)
            self._now_ns = due_ns
            for turtle in self._present.values():
                turtle.feeds.emit(due_ns)
        if t_ns > self._now_ns:
            self._move(t_ns)
            self._now_ns = t_ns

    def _move(self, t_ns: int) -> None:
        self.turtle.advance(t_ns)
        for other in self._others.values():
            other.advance(t_ns)

    def settle(self, from_ns: int, until_ns: int) -> int:
        """Run the world on without the script until the turtle rests; return when that is."""
        now_ns = min(from_ns, until_ns)
        self.advance(now_ns)
        while now_ns < until_ns and (self._busy or not self.turtle.resting):
            now_ns = min(next_update(now_ns) * UPDATE_NS, until_ns)
            self.advance(now_ns)
        return now_ns

    @property
    def _busy(self) -> bool:
        """Whether the next update has something to serve."""
        if self._pending:
            return True
        for turtle in self._present.values():  # noqa: SIM110 - asked for each command: a generator costs more
            if turtle.action.busy:
                return True
        return False

    def _serve(self, t_ns: int) -> None:
        """Do what the update of `t_ns` does before it moves the turtles, in the order of rclcpp's executor."""
        for turtle in self._present.values():
            if turtle.turtle.take(t_ns):
                turtle.action.interrupt()
        if self._pending:
            for served in self._turns:
                self._serve_one(served, t_ns)
        for turtle in self._present.values():
            turtle.action.tick(t_ns)

    def _serve_one(self, services: Collection[str], t_ns: int) -> None:
        """Answer the oldest request of the first of `services` that has one."""
        for service in services:
            if requests := self._pending.get(service):
                request = requests.popleft()
                if not requests:
                    del self._pending[service]
                self._answer(service, request, t_ns)
                return

    def _answer(self, service: str, request: Request, t_ns: int) -> None:
        """Serve one request; nobody answers for a turtle that has gone meanwhile."""
        kind = self.services.get(service)
        if kind is None:
            return
        if kind.startswith("rcl_interfaces/"):
            asked = decode(f"{kind}_Request", request.payload)
            answer = self._parameters.answer(service.rpartition("/")[2], asked)
        elif handler := self._handlers.get(service):
            answer = handler(decode(f"{kind}_Request", request.payload), t_ns)
        else:
            _, name, rest = service.split("/", 2)
            addressed = self._present[name]
            if rest not in self._turtle_handlers:
                addressed.action.handle(service, request, t_ns)
                return
            self._turtle_handlers[rest](addressed, decode(f"{kind}_Request", request.payload))
            answer = {}
        self.outbox.reply(request, t_ns, encode(f"{kind}_Response", answer))

    def _index(self) -> None:
        """Collect the services and topics of all turtles that are present."""
        self._heard_at = -1
        self.services = dict(_WINDOW_SERVICES)
        self._topics, self._commands = {}, {}
        for turtle in self._present.values():
            self.services |= turtle.services
            self._topics |= turtle.topics
            self._commands[turtle.command_topic] = turtle
        present = self._present.values()
        self._pending = {name: those for name, those in self._pending.items() if name in self.services}
        own = [f"/{turtle.name}/{service}" for turtle in present for service in _TURTLE_SERVICES]
        # Of what an action is asked, one thing is done in an update; a service is asked one thing.
        self._turns = [
            *((service,) for service in (*_WINDOW_SERVICES, *own)),
            *(tuple(turtle.action.services) for turtle in present),
        ]

    def _appear(self, name: str, pose: PlanarPose, t_ns: int) -> None:
        """Put a new turtle into the window, and on the graph if its name can stand there."""
        if not _TOPIC_NAME.fullmatch(name):
            self._nameless.add(name)
            return
        turtle = spawned(pose, t_ns - 1, walls=self._walls)
        feeds = Feeds(name, turtle, self.outbox, self._epoch_ns, odometry=False)
        action = RotateAction(name, turtle, self.outbox, self._epoch_ns)
        self._others[name] = turtle
        self._present[name] = Presence(name, turtle, feeds, action, f"/{name}/cmd_vel")
        self.carried.add(f"/{name}/cmd_vel")
        self._index()
        self._announce(self._present[name], t_ns, gone=False)

    def _vanish(self, name: str, t_ns: int) -> None:
        """Take a spawned turtle away, if it is there."""
        self._nameless.discard(name)
        if name in self._others:
            gone = self._present.pop(name)
            del self._others[name]
            self._index()
            self._announce(gone, t_ns, gone=True)

    def _announce(self, changed: Presence, t_ns: int, *, gone: bool) -> None:
        """Send the script a change of the graph, before the answer to the request that caused it."""
        payload = json.dumps({**changed.graph(), "gone": gone}, separators=(",", ":")).encode()
        self.outbox.add(Event(GRAPH_EVENT, 0, 0, t_ns, payload))
        self.on_change(frozenset((changed.command_topic, *changed.topics)))

    # Services, as TurtleFrame and Turtle of turtlesim 1.4 serve them.

    def _clear(self, _values: Values, _t_ns: int) -> Values:
        for turtle in self._present.values():
            turtle.feeds.pen.cleared_at = turtle.turtle.pose
        return {}

    def _reset(self, _values: Values, t_ns: int) -> Values:
        for name in (*self._others, *self._nameless):
            self._vanish(name, t_ns)
        self._action.interrupt()
        for service in self._present[GRADED].services:  # made anew, as all of the turtle is
            self._pending.pop(service, None)
        self._jump(self._present[GRADED], self.turtle.start, revive=True)
        self._feeds.pen = Pen(cleared_at=self.turtle.start)
        self._numbered = 1
        return {}

    def _spawn(self, values: Values, t_ns: int) -> Values:
        names = {*self._others, *self._nameless} | ({GRADED} if self.turtle.alive else set())
        name = values["name"] or self._next_name(names)
        pose = (values["x"], values["y"], values["theta"])
        if name in names or len(names) >= MAX_TURTLES or not all(map(math.isfinite, pose)):
            return {"name": ""}
        if name == GRADED:
            self._jump(self._present[GRADED], pose, revive=True)
            self._feeds.pen = Pen(cleared_at=self.turtle.pose)
        else:
            self._appear(name, pose, t_ns)
        return {"name": name}

    def _next_name(self, names: Collection[str]) -> str:
        while True:
            self._numbered += 1
            if (name := f"turtle{self._numbered}") not in names:
                return name

    def _kill(self, values: Values, t_ns: int) -> Values:
        if values["name"] == GRADED and self.turtle.alive:
            self._action.interrupt()
            self.turtle.kill()
        self._vanish(values["name"], t_ns)
        return {}

    def _set_pen(self, of: Presence, values: Values) -> None:
        of.feeds.pen.color = (values["r"], values["g"], values["b"])
        of.feeds.pen.off = bool(values["off"])

    def _teleport_absolute(self, of: Presence, values: Values) -> None:
        x, y, heading = values["x"], values["y"], values["theta"]
        if self._walls:  # turtlesim counts y downwards, and makes a negative one 0: NaN, too
            y = min(y, WINDOW_M) if y == y else WINDOW_M  # noqa: PLR0124
        self._jump(of, (x, y, heading))

    def _teleport_relative(self, of: Presence, values: Values) -> None:
        x, y, heading = of.turtle.pose
        heading += values["angular"]
        c, s = cos_sin(heading)
        reach = values["linear"]
        self._jump(of, (x + reach * c, y + reach * s, heading))

    def _jump(self, of: Presence, pose: PlanarPose, *, revive: bool = False) -> None:
        """Put a turtle into `pose`, unless the turtle is dead.

        A place that is infinite is that far; a heading that is no number leaves no place.
        """
        if not (of.turtle.alive or revive):
            return
        before = of.turtle.pose
        x, y, heading = pose
        after = (_bounded(x), _bounded(y), heading) if math.isfinite(heading) else _NOWHERE
        if revive:
            self.turtle.revive(after)
        else:
            of.turtle.teleport(after)
        if all(map(math.isfinite, (*before, *after))):
            of.feeds.moved(before, of.turtle.pose)


def _bounded(place_m: float) -> float:
    """Return a component of a place as far as a teleport goes; NaN stays."""
    return min(max(place_m, -FAR_M), FAR_M)
