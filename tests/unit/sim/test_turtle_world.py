"""turtlesim's services and its action, as the script meets them."""

import math
from collections.abc import Generator
from typing import Any

import numpy as np
import pytest

from grader.contracts.assignment import StartPose, World
from grader.sim.bullet import AREA_M, BulletCar
from grader.sim.cdr import encode
from grader.sim.episode import Episode, EpisodeResult, EpisodeSpec
from tests.fakes import jail
from tests.fakes.jail import SECOND, Answer, FakeLink, Script

MS = 1_000_000
TICK = 16 * MS
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
        self.heard += [(t, identity, payload) for what, identity, _, t, payload in answer.events if what == 1]


def run(
    car: BulletCar, student: Student, story: Script, *, walls: bool = True, heading_deg: float = 0.0
) -> EpisodeResult:
    def script() -> Script:
        yield jail.node()
        yield from story
        yield jail.ended(student.now)

    world = World(walls=walls, start=StartPose(heading_deg=heading_deg))
    spec = EpisodeSpec(world=world, horizon_ns=60 * SECOND, source=b"", file_name="a.py")
    result = Episode(spec, car).run(FakeLink(script()))
    assert result.violation is None
    assert result.exit is not None
    return result


def test_a_teleport_is_served_at_the_next_tick_and_is_a_jump(car: BulletCar) -> None:
    student = Student()

    def story() -> Script:
        yield from student.wait(20 * MS)
        assert (yield from student.call("/turtle1/teleport_absolute", x=1.0, y=2.0, theta=math.pi / 2)) == {}
        assert student.now == 2 * TICK
        yield from student.drive(1.0)
        yield from student.wait(SECOND)

    path = run(car, student, story()).trajectory
    (jump,) = path.jumps
    assert (path.x_m[jump], path.y_m[jump]) == (1.0, 2.0)
    assert path.t_ns[jump] - path.t_ns[jump - 1] == 1
    assert path.t_ns[jump] >= 2 * TICK
    assert (path.x_m[jump - 1], path.y_m[jump - 1]) == (5.544445, 5.544445)
    assert (np.diff(path.t_ns) > 0).all()
    assert path.x_m[-1] == pytest.approx(1.0, abs=1e-3)
    assert path.y_m[-1] == pytest.approx(3.0, abs=0.02)


def test_a_teleport_keeps_the_velocity(car: BulletCar) -> None:
    student = Student()

    def story() -> Script:
        yield from student.drive(1.0)
        yield from student.wait(SECOND // 2)
        yield from student.call("/turtle1/teleport_absolute", x=1.0, y=1.0, theta=0.0)
        yield from student.wait(2 * SECOND)

    path = run(car, student, story()).trajectory
    (jump,) = path.jumps
    assert path.v_mps[jump] == pytest.approx(1.0, abs=1e-3)
    assert path.x_m[-1] == pytest.approx(1.0 + 0.5, abs=0.03)


def test_teleport_relative_turns_first_and_stays_in_the_window(car: BulletCar) -> None:
    student = Student()

    def story() -> Script:
        yield from student.call("/turtle1/teleport_relative", linear=2.0, angular=math.pi / 2)
        yield from student.call("/turtle1/teleport_relative", linear=100.0, angular=0.0)
        yield from student.call("/turtle1/teleport_relative", linear=math.nan, angular=0.0)

    path = run(car, student, story()).trajectory
    first, second = path.jumps
    assert (path.x_m[first], path.y_m[first]) == pytest.approx((5.544445, 7.544445), abs=1e-6)
    assert path.heading_rad[first] == pytest.approx(math.pi / 2, abs=1e-6)
    assert path.y_m[second] == AREA_M


def test_reset_puts_the_turtle_back_at_rest(car: BulletCar) -> None:
    student = Student()

    def story() -> Script:
        yield from student.drive(1.0, 1.0)
        yield from student.wait(SECOND // 2)
        yield from student.call("/reset")
        yield from student.wait(SECOND)

    path = run(car, student, story(), heading_deg=45.0).trajectory
    assert len(path.jumps) == 1
    assert (path.x_m[-1], path.y_m[-1]) == (5.544445, 5.544445)
    assert path.heading_rad[-1] == pytest.approx(math.pi / 4, abs=1e-9)
    assert path.v_mps[-1] == 0.0


def test_spawn_names_turtles_and_refuses_what_exists(car: BulletCar) -> None:
    student = Student()

    def story() -> Script:
        assert (yield from student.call("/spawn", x=1.0, y=1.0)) == {"name": "turtle2"}
        assert (yield from student.call("/spawn", x=1.0, y=1.0, name="bob")) == {"name": "bob"}
        assert (yield from student.call("/spawn", x=1.0, y=1.0, name="bob")) == {"name": ""}
        assert (yield from student.call("/spawn", x=1.0, y=1.0, name="turtle1")) == {"name": ""}
        assert (yield from student.call("/kill", name="bob")) == {}
        assert (yield from student.call("/kill", name="nobody")) == {}
        assert (yield from student.call("/spawn", x=2.0, y=2.0, name="bob")) == {"name": "bob"}
        assert (yield from student.call("/clear")) == {}

    assert run(car, student, story()).trajectory.jumps == ()


def test_a_killed_turtle_obeys_and_says_nothing(car: BulletCar) -> None:
    student = Student()

    def story() -> Script:
        yield from student.subscribe("/turtle1/pose", "turtlesim/msg/Pose")
        yield from student.drive(1.0)
        yield from student.wait(SECOND // 2)
        yield from student.call("/kill", name="turtle1")
        killed = student.now
        yield from student.drive(1.0)
        yield from student.wait(SECOND)
        assert student.messages("/turtle1/pose", "turtlesim/msg/Pose")[-1][0] <= killed
        yield from student.call("/spawn", x=3.0, y=3.0, theta=1.0, name="turtle1")
        yield from student.drive(0.0, 1.0)
        yield from student.wait(2 * SECOND)

    result = run(car, student, story())
    path = result.trajectory
    (jump,) = path.jumps
    assert path.x_m[jump - 1] == pytest.approx(5.544445 + 0.5, abs=0.03)
    assert path.heading_rad[-1] == pytest.approx(2.0, abs=0.03)
    assert result.command_count == 3


def test_the_colour_sensor_sees_background_and_then_the_line(car: BulletCar) -> None:
    student = Student()

    def story() -> Script:
        yield from student.subscribe("/turtle1/color_sensor", "turtlesim/msg/Color")
        yield from student.call("/turtle1/set_pen", r=255, g=1, b=2, width=3, off=0)
        yield from student.drive(1.0)
        yield from student.wait(SECOND)

    run(car, student, story())
    colors = [color for _, color in student.messages("/turtle1/color_sensor", "turtlesim/msg/Color")]
    assert colors[0] == {"r": 69, "g": 86, "b": 255}
    assert colors[-1] == {"r": 255, "g": 1, "b": 2}


def test_odometry_does_not_see_a_teleport(car: BulletCar) -> None:
    student = Student()

    def story() -> Script:
        yield from student.subscribe("/odom", "nav_msgs/msg/Odometry")
        yield from student.drive(1.0)
        yield from student.wait(SECOND // 2)
        yield from student.call("/turtle1/teleport_absolute", x=1.0, y=9.0, theta=-1.0)
        yield from student.wait(2 * SECOND)

    run(car, student, story(), heading_deg=30.0)
    positions = [
        odom["pose"]["pose"]["position"] for _, odom in student.messages("/odom", "nav_msgs/msg/Odometry")
    ]
    assert positions[-1]["x"] == pytest.approx(1.0, abs=0.01)
    assert max(abs(position["y"]) for position in positions) < 1e-6
    assert max(np.diff([position["x"] for position in positions])) < 0.03


def test_too_many_requests_are_noted_not_kept(car: BulletCar) -> None:
    student = Student()

    def story() -> Script:
        for _ in range(1_100):
            yield from student.ask("/clear")
        answers = 0
        while answers < 1_000:
            answer = yield jail.advance(SECOND)
            assert answer is not None
            student.now = answer.now_ns
            answers += len(answer.events)

    assert [note.code for note in run(car, student, story()).notes] == ["too_many_requests"]


def test_a_request_is_served_although_the_script_does_not_wait(car: BulletCar) -> None:
    student = Student()

    def story() -> Script:
        yield from student.ask("/turtle1/teleport_absolute", x=1.0, y=1.0, theta=0.0)

    assert run(car, student, story()).trajectory.x_m[-1] == 1.0


def test_a_malformed_request_is_a_violation(car: BulletCar) -> None:
    frames = [jail.node(), jail.entity(5, 5, name="/spawn", type="turtlesim/srv/Spawn")]
    frames += [jail.request(5, 1, 0, b"\0\1\0\0junk"), jail.advance(SECOND)]
    spec = EpisodeSpec(world=World(), horizon_ns=SECOND, source=b"", file_name="a.py")
    result = Episode(spec, car).run(FakeLink(frames))
    assert result.violation is not None
    assert "Spawn_Request" in result.violation


def goal(
    student: Student, theta: float, uuid: bytes = UUID
) -> Generator[bytes, Answer | None, dict[str, Any]]:
    return (
        yield from student.call(f"{ACTION}/send_goal", goal_id={"uuid": list(uuid)}, goal={"theta": theta})
    )


def result_of(student: Student, uuid: bytes = UUID) -> Generator[bytes, Answer | None, dict[str, Any]]:
    return (yield from student.call(f"{ACTION}/get_result", goal_id={"uuid": list(uuid)}))


def test_rotate_absolute_turns_and_reports(car: BulletCar) -> None:
    student = Student()
    ends: list[dict[str, Any]] = []

    def story() -> Script:
        yield from student.subscribe(f"{ACTION}/feedback", f"{ROTATE}_FeedbackMessage")
        yield from student.subscribe(f"{ACTION}/status", "action_msgs/msg/GoalStatusArray")
        accepted = yield from goal(student, -1.5)
        assert accepted["accepted"]
        ends.append((yield from result_of(student)))
        ends.append((yield from result_of(student)))
        ends.append((yield from result_of(student, bytes(16))))

    path = run(car, student, story()).trajectory
    assert path.heading_rad[-1] == pytest.approx(-1.5, abs=0.02)
    assert ends[0]["status"] == ends[1]["status"] == 4
    assert ends[0]["result"]["delta"] == pytest.approx(1.5, abs=0.03)
    assert ends[2]["status"] == 0
    assert np.abs(path.w_radps).max() == pytest.approx(1.0, rel=1e-3)
    feedback = student.messages(f"{ACTION}/feedback", f"{ROTATE}_FeedbackMessage")
    assert feedback[0][1]["feedback"]["remaining"] == pytest.approx(-1.5)
    assert {t % TICK for t, _ in feedback} == {0}
    statuses = student.messages(f"{ACTION}/status", "action_msgs/msg/GoalStatusArray")
    assert [message["status_list"][0]["status"] for _, message in statuses][:1] == [2]
    assert statuses[-1][1]["status_list"][0]["status"] == 4


def test_a_velocity_command_aborts_the_rotation(car: BulletCar) -> None:
    student = Student()
    ends: list[dict[str, Any]] = []

    def story() -> Script:
        yield from goal(student, 3.0)
        yield from student.wait(SECOND)
        yield from student.drive(0.5)
        ends.append((yield from result_of(student)))
        yield from student.wait(3 * SECOND)

    path = run(car, student, story()).trajectory
    assert ends[0]["status"] == 6
    assert path.heading_rad[-1] == pytest.approx(1.0, abs=0.05)
    assert np.hypot(path.x_m[-1] - path.x_m[0], path.y_m[-1] - path.y_m[0]) == pytest.approx(0.5, abs=0.02)


def test_a_new_goal_aborts_the_old_one(car: BulletCar) -> None:
    student = Student()
    ends: list[dict[str, Any]] = []
    other = bytes([7] * 16)

    def story() -> Script:
        yield from goal(student, 3.0)
        yield from student.wait(SECOND)
        yield from goal(student, 0.0, other)
        assert not (yield from goal(student, 0.0, other))["accepted"]
        ends.append((yield from result_of(student)))
        ends.append((yield from result_of(student, other)))

    path = run(car, student, story()).trajectory
    assert [end["status"] for end in ends] == [6, 4]
    assert path.heading_rad[-1] == pytest.approx(0.0, abs=0.02)


def test_a_goal_is_cancelled(car: BulletCar) -> None:
    student = Student()
    replies: list[dict[str, Any]] = []

    def cancel(uuid: bytes) -> Script:
        info = {"goal_id": {"uuid": list(uuid)}}
        replies.append((yield from student.call(f"{ACTION}/cancel_goal", goal_info=info)))

    def story() -> Script:
        yield from cancel(bytes(16))
        yield from goal(student, 3.0)
        yield from student.wait(SECOND)
        yield from cancel(bytes([9] * 16))
        yield from cancel(bytes(16))
        replies.append((yield from result_of(student)))
        yield from cancel(UUID)

    path = run(car, student, story()).trajectory
    rejected, unknown, cancelled, end, late = replies
    assert (rejected["return_code"], unknown["return_code"], late["return_code"]) == (1, 2, 3)
    assert cancelled["return_code"] == 0
    assert cancelled["goals_canceling"][0]["goal_id"]["uuid"] == UUID
    assert end["status"] == 5
    assert path.heading_rad[-1] == pytest.approx(1.0, abs=0.05)


def test_a_rotation_goes_on_when_the_script_has_ended(car: BulletCar) -> None:
    student = Student()

    def story() -> Script:
        yield from goal(student, 2.0)

    result = run(car, student, story())
    assert result.trajectory.heading_rad[-1] == pytest.approx(2.0, abs=0.02)
    assert result.trajectory.end_ns < 3 * SECOND


def test_a_teleport_beyond_all_measure_ends_far_away(car: BulletCar) -> None:
    student = Student()

    def story() -> Script:
        yield from student.subscribe("/turtle1/pose", "turtlesim/msg/Pose")
        for _ in range(2):
            yield from student.call("/turtle1/teleport_relative", linear=3e38, angular=0.0)
        yield from student.call("/turtle1/teleport_absolute", x=math.inf, y=0.0, theta=0.0)
        yield from student.call("/turtle1/teleport_relative", linear=0.0, angular=math.inf)
        yield from student.wait(SECOND // 2)

    path = run(car, student, story(), walls=False).trajectory
    assert len(path.jumps) == 2
    assert path.x_m[-1] == 1e6
    assert student.messages("/turtle1/pose", "turtlesim/msg/Pose")[-1][1]["x"] == 1e6


@pytest.mark.parametrize("theta", [math.nan, math.inf])
def test_a_goal_that_is_no_angle_turns_until_it_is_cancelled(car: BulletCar, theta: float) -> None:
    student = Student()
    replies: list[dict[str, Any]] = []

    def story() -> Script:
        yield from goal(student, theta)
        yield from student.wait(2 * SECOND)
        yield from student.call(f"{ACTION}/cancel_goal", goal_info={"goal_id": {"uuid": list(UUID)}})
        replies.append((yield from result_of(student)))

    path = run(car, student, story()).trajectory
    assert replies[0]["status"] == 5
    assert path.heading_rad[-1] == pytest.approx(2.0, abs=0.05)
