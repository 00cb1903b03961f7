"""A script in the turtle world, written as a story of frames, and how to run it."""

from collections.abc import Generator
from typing import Any

from grader.contracts.assignment import StartPose, World
from grader.sim.cdr import encode
from grader.sim.driving import Car
from grader.sim.episode import Episode, EpisodeResult, EpisodeSpec
from tests.fakes import jail
from tests.fakes.jail import SECOND, Answer, FakeLink, Script

UUID = bytes(range(16))
ACTION = "/turtle1/rotate_absolute/_action"
ROTATE = "turtlesim/action/RotateAbsolute"
TYPES = {
    "/clear": "std_srvs/srv/Empty",
    "/reset": "std_srvs/srv/Empty",
    "/spawn": "turtlesim/srv/Spawn",
    "/kill": "turtlesim/srv/Kill",
    "/turtle1/set_pen": "turtlesim/srv/SetPen",
    "/turtle1/teleport_absolute": "turtlesim/srv/TeleportAbsolute",
    "/turtle1/teleport_relative": "turtlesim/srv/TeleportRelative",
    f"{ACTION}/send_goal": f"{ROTATE}_SendGoal",
    f"{ACTION}/cancel_goal": "action_msgs/srv/CancelGoal",
    f"{ACTION}/get_result": f"{ROTATE}_GetResult",
}


class Student:
    """A script under test: keeps its clock and its ids; its methods are generators of frames."""

    def __init__(self) -> None:
        self.now = 0
        self.ids: dict[str, int] = {}
        self.heard: list[tuple[int, int, bytes]] = []
        self.graph: list[tuple[int, bytes]] = []
        self.sequence = 0

    def _new(self, key: str) -> int:
        return self.ids.setdefault(key, len(self.ids) + 10)

    def drive(self, v: float, w: float = 0.0) -> Script:
        if "driver" not in self.ids:
            yield jail.driver(self._new("driver"), self.now)
        yield jail.publish(self.ids["driver"], self.now, jail.twist(v, w))

    def subscribe(self, topic: str, type: str) -> Script:
        yield jail.entity(self._new(topic), 3, self.now, name=topic, type=type)

    def wait(self, until: int) -> Script:
        while self.now < until:
            answer = yield jail.advance(until)
            self._hear(answer)

    def ask(self, service: str, **values: Any) -> Generator[bytes, Answer | None, int]:
        kind = TYPES[service]
        if service not in self.ids:
            yield jail.entity(self._new(service), 5, self.now, name=service, type=kind)
        self.sequence += 1
        payload = encode(f"{kind}_Request", values)
        yield jail.request(self.ids[service], self.sequence, self.now, payload)
        return self.sequence

    def call(self, service: str, **values: Any) -> Generator[bytes, Answer | None, dict[str, Any]]:
        sequence = yield from self.ask(service, **values)
        while True:
            answer = yield jail.advance(60 * SECOND)
            self._hear(answer)
            assert answer is not None
            for what, identity, number, _, payload in answer.events:
                if (what, identity, number) == (2, self.ids[service], sequence):
                    return jail.decode(f"{TYPES[service]}_Response", payload)
            assert self.now < 60 * SECOND, f"{service} was never answered"

    def messages(self, topic: str, type: str) -> list[tuple[int, dict[str, Any]]]:
        return [
            (t, jail.decode(type, data)) for t, identity, data in self.heard if identity == self.ids[topic]
        ]

    def _hear(self, answer: Answer | None) -> None:
        assert answer is not None
        assert answer.now_ns >= self.now
        self.now = answer.now_ns
        self.graph += [(t, payload) for what, _, _, t, payload in answer.events if what == 4]
        self.heard += [(t, identity, payload) for what, identity, _, t, payload in answer.events if what == 1]


def run(
    car: Car, student: Student, story: Script, *, walls: bool = True, heading_deg: float = 0.0
) -> EpisodeResult:
    def script() -> Script:
        yield jail.node()
        yield from story
        yield jail.ended(student.now)

    world = World(walls=walls, start=StartPose(heading_deg=heading_deg), odometry=True)
    spec = EpisodeSpec(world=world, horizon_ns=60 * SECOND, source=b"", file_name="a.py")
    result = Episode(spec, car).run(FakeLink(script()))
    assert result.violation is None
    assert result.exit is not None
    return result
