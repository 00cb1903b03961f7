"""A car of one's own as a ROS graph: turtlesim with odometry, a camera and an emergency stop, for a bridge."""

from collections.abc import Mapping, Sequence
from typing import Final

from grader.contracts.assignment import World
from grader.sim.car import PlanarPose
from grader.sim.cdr import decode, encode
from grader.sim.driving import Car
from grader.sim.frames import MESSAGE_EVENT, RESPONSE_EVENT, Event, Request
from grader.sim.interfaces import Types, header, with_interfaces
from grader.sim.recorder import Unrecorded
from grader.sim.rosbridge.camera import TopView
from grader.sim.rosbridge.graph import twist_of
from grader.sim.turtle import Turtle
from grader.sim.turtle_world import NODE_NAME, TurtleWorld

CAMERA: Final = "/camera/image_raw/compressed"
ESTOP: Final = "/emergency_stop"
_IMAGE: Final = "sensor_msgs/msg/CompressedImage"
_SET_BOOL: Final = "std_srvs/srv/SetBool"
_TOPICS: Final = {
    "/rosout": "rcl_interfaces/msg/Log",
    "/parameter_events": "rcl_interfaces/msg/ParameterEvent",
    CAMERA: _IMAGE,
}
_CAMERA_NS: Final = 500_000_000
_FOREVER: Final = 1 << 61
_STOP: Final = (0.0, 0.0, 0.0)


class _Viewed(Unrecorded):
    """Keeps of a drive what the camera sees of it."""

    def __init__(self, view: TopView) -> None:
        super().__init__()
        self._view = view

    def sample(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        self._view.driven(pose)

    def jump(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        self._view.driven(pose)


class LiveWorld:
    """The graph of one car that is driven by clients of a bridge.

    Attributes:
        types: all that ROS has. epoch_ns: wall clock at the instant 0.
        stopped: whether the emergency stop holds the car; commands have no effect then.
    """

    def __init__(self, car: Car, epoch_ns: int) -> None:
        world = World(odometry=True)
        self.types: Types = with_interfaces(())
        self.epoch_ns = epoch_ns
        self.stopped = False
        self._view = TopView()
        self._turtle = Turtle(car, _Viewed(self._view), world, _FOREVER)
        self._world = TurtleWorld(self._turtle, world, epoch_ns)
        self._world.on_change = lambda topics: self._world.carried.clear()  # kept for reports only
        self._turtle.appear()
        self._camera: list[int] = []  # who hears it
        self._camera_due_ns = 0
        self._answers: list[Event] = []

    @property
    def topics(self) -> Mapping[str, str]:
        """Types by topic."""
        return {**self._world.topics, **_TOPICS}

    @property
    def services(self) -> Mapping[str, str]:
        """Types by service."""
        return {**self._world.services, ESTOP: _SET_BOOL}

    @property
    def nodes(self) -> Sequence[str]:
        """The car's node."""
        return (NODE_NAME,)

    def publish(self, topic: str, t_ns: int, payload: bytes) -> None:
        """Publish to the car and to whoever hears the topic."""
        if topic in self._world.command_topics:
            x, y, turn = _STOP if self.stopped else twist_of(payload)
            self._world.command(topic, (t_ns,), x, y, turn)
        self._world.outbox.publish(topic, t_ns, payload)

    def listen(self, topic: str, identity: int, t_ns: int) -> None:
        """Subscribe `identity` to a topic from `t_ns` on."""
        if topic == CAMERA:
            self._camera.append(identity)
            self._camera_due_ns = t_ns
        else:
            self._world.listen(topic, identity, t_ns)

    def unlisten(self, identity: int) -> None:
        """End the subscription."""
        if identity in self._camera:
            self._camera.remove(identity)
        else:
            self._world.outbox.unsubscribe(identity)

    def request(self, service: str, request: Request) -> bool:
        """Send a request to the car."""
        if service != ESTOP:
            return self._world.request(service, request)
        engage = decode(f"{_SET_BOOL}_Request", request.payload)["data"]
        self.stop(request.t_ns, engage=engage)
        answer = {"success": True, "message": "the car is held" if engage else "the car obeys again"}
        payload = encode(f"{_SET_BOOL}_Response", answer)
        self._answers.append(Event(RESPONSE_EVENT, request.id, request.sequence, request.t_ns, payload))
        return True

    def stop(self, t_ns: int, *, engage: bool) -> None:
        """Stop every turtle in the next update and hold it (`engage`), or let commands through again."""
        self.stopped = engage
        if engage:
            self._world.forget_commands()
            for topic in tuple(self._world.command_topics):
                self._world.command(topic, (t_ns,), *_STOP)

    def next_due(self) -> int | None:
        """Return the next instant at which something may become due, None when never."""
        camera_ns = self._camera_due_ns if self._camera else None
        due = [due_ns for due_ns in (self._world.next_due(), camera_ns) if due_ns is not None]
        return min(due, default=None)

    def advance(self, t_ns: int) -> list[Event]:
        """Run until `t_ns` and return what has come, in order of time."""
        self._world.advance(t_ns)
        events = self._answers + self._world.outbox.take_apart()
        self._answers = []
        while self._world.outbox:  # what turtles come and go, which the bridge asks for itself
            self._world.outbox.take(t_ns)
        if self._camera and self._camera_due_ns <= t_ns:
            events += self._pictures(t_ns)
            self._camera_due_ns = t_ns + _CAMERA_NS
        return events

    def _pictures(self, t_ns: int) -> list[Event]:
        head = {"header": header(self.epoch_ns + t_ns, "camera"), "format": "png"}
        payload = encode(_IMAGE, {**head, "data": self._view.png(self._turtle.pose)}, self.types)
        return [Event(MESSAGE_EVENT, subscription, 0, t_ns, payload) for subscription in self._camera]
