"""Turtles that a script spawns: on the graph from the update that spawns them, moving by turtlesim's law."""

import json
import math

import pytest

from grader.sim.cdr import encode
from grader.sim.driving import Car
from tests.fakes import jail, turtlesim
from tests.fakes.jail import SECOND, Script
from tests.unit.sim.playing import play
from tests.unit.sim.student import ACTION, TYPES, Student, run

MS = 1_000_000
GRAPH = 4
POSE = "turtlesim/msg/Pose"


def changes(student: Student) -> list[dict[str, object]]:
    return [json.loads(payload) for _, payload in student.graph]


def test_the_script_is_told_of_the_graph_before_the_answer(car: Car) -> None:
    order: list[int] = []

    def script() -> Script:
        yield jail.node()
        yield jail.entity(5, 5, name="/spawn", type="turtlesim/srv/Spawn")
        yield jail.request(5, 1, 0, encode("turtlesim/srv/Spawn_Request", {"x": 1.0, "y": 2.0}))
        answer = yield jail.advance(SECOND)
        assert answer is not None
        assert answer.now_ns == 16 * MS
        order.extend(event[0] for event in answer.events)
        told = json.loads(answer.events[0][4])
        assert not told["gone"]
        assert told["subscribes"] == [["/turtle2/cmd_vel", jail.TWIST]]
        assert ["/turtle2/pose", POSE] in told["publishes"]
        assert ["/turtle2/teleport_relative", "turtlesim/srv/TeleportRelative"] in told["services"]
        assert [f"{ACTION.replace('turtle1', 'turtle2')}/send_goal", TYPES[f"{ACTION}/send_goal"]] in told[
            "services"
        ]
        assert not any(name in ("/odom", "/tf") for name, _ in told["publishes"])
        yield jail.ended(SECOND)

    assert play(car, script()).violation is None
    assert order == [GRAPH, 2]


def test_a_spawned_turtle_moves_as_turtlesims_do_and_is_not_scored(car: Car) -> None:
    student = Student()
    commands = [(100 * MS, 1.0, 0.5), (1_200 * MS, -2.0, 0.0), (3_500 * MS, 3.0, 2.0)]

    def story() -> Script:
        yield jail.driver(2, name="/bob/cmd_vel")  # there before the turtle
        yield from student.subscribe("/bob/pose", POSE)
        assert (yield from student.call("/spawn", x=2.0, y=3.0, theta=1.0, name="bob")) == {"name": "bob"}
        for t_ns, v, w in commands:
            yield from student.wait(t_ns)
            yield jail.publish(2, student.now, jail.twist(v, w))
        yield from student.wait(6 * SECOND)

    result = run(car, student, story())
    exact = turtlesim.poses(commands, 6 * SECOND, (2.0, 3.0, 1.0))
    heard = student.messages("/bob/pose", POSE)
    assert [t_ns for t_ns, _ in heard] == [pose.t_ns for pose in exact]
    for (_, got), pose in zip(heard, exact, strict=True):
        assert (got["x"], got["y"]) == pytest.approx((pose.x, pose.y), abs=1e-3)
        assert abs(math.remainder(got["theta"] - pose.theta, math.tau)) < math.radians(0.02)
    assert len(set(result.trajectory.x_m)) == 1
    assert (result.command_count, result.trajectory.commands) == (0, ())
    (count,) = [each.count for each in result.endpoints if each.name == "/bob/cmd_vel"]
    assert count == len(commands)


def test_a_spawned_turtle_has_services_and_the_action(car: Car) -> None:
    student = Student()
    TYPES["/bob/teleport_absolute"] = TYPES["/turtle1/teleport_absolute"]
    TYPES["/bob/set_pen"] = TYPES["/turtle1/set_pen"]
    for name in ("send_goal", "get_result"):
        TYPES[f"/bob/rotate_absolute/_action/{name}"] = TYPES[f"{ACTION}/{name}"]

    def story() -> Script:
        yield from student.call("/spawn", x=2.0, y=3.0, theta=0.0, name="bob")
        yield from student.subscribe("/bob/pose", POSE)
        yield from student.subscribe("/bob/color_sensor", "turtlesim/msg/Color")
        assert (yield from student.call("/bob/set_pen", r=9, g=8, b=7, width=3, off=0)) == {}
        assert (yield from student.call("/bob/teleport_absolute", x=5.0, y=6.0, theta=0.0)) == {}
        uuid = {"goal_id": {"uuid": list(range(16))}}
        yield from student.call("/bob/rotate_absolute/_action/send_goal", **uuid, goal={"theta": 1.0})
        end = yield from student.call("/bob/rotate_absolute/_action/get_result", **uuid)
        assert end["status"] == 4

    assert run(car, student, story()).trajectory.jumps == ()
    last = student.messages("/bob/pose", POSE)[-1][1]
    assert (last["x"], last["y"]) == (5.0, 6.0)
    assert last["theta"] == pytest.approx(1.0, abs=0.02)
    color = student.messages("/bob/color_sensor", "turtlesim/msg/Color")[-1][1]
    assert color == {"r": 9, "g": 8, "b": 7}


@pytest.mark.parametrize("how", ["/kill", "/reset"])
def test_a_turtle_that_is_gone_says_and_obeys_nothing(car: Car, how: str) -> None:
    student = Student()

    def story() -> Script:
        yield from student.call("/spawn", x=2.0, y=3.0, theta=0.0, name="bob")
        yield from student.subscribe("/bob/pose", POSE)
        yield from student.wait(SECOND)
        yield from student.call(how, **({"name": "bob"} if how == "/kill" else {}))
        gone = student.now
        yield jail.driver(2, student.now, name="/bob/cmd_vel")
        yield jail.publish(2, student.now, jail.twist(1.0))
        yield from student.wait(2 * SECOND)
        assert student.messages("/bob/pose", POSE)[-1][0] < gone

    run(car, student, story())
    assert [change["gone"] for change in changes(student)] == [False, True]


def test_a_name_that_can_be_no_topic_is_a_name_only(car: Car) -> None:
    student = Student()

    def story() -> Script:
        assert (yield from student.call("/spawn", x=1.0, y=1.0, name="my turtle")) == {"name": "my turtle"}
        assert (yield from student.call("/spawn", x=1.0, y=1.0, name="my turtle")) == {"name": ""}

    run(car, student, story())
    assert student.graph == []


def test_a_turtle_that_is_spawned_outside_of_the_window_stands_at_its_wall(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.call("/spawn", x=20.0, y=-3.0, theta=0.0, name="bob")
        yield from student.subscribe("/bob/pose", POSE)
        yield from student.wait(SECOND)

    run(car, student, story())
    first = student.messages("/bob/pose", POSE)[0][1]
    assert (first["x"], first["y"]) == (pytest.approx(11.088889), 0.0)
