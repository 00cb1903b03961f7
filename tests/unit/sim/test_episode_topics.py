"""What an episode hears and says on topics and services."""

import math
import struct
from dataclasses import replace
from typing import Any

import pytest

from grader.contracts.assignment import EPOCH_NS, StartPose, World
from grader.contracts.conversation import Step
from grader.contracts.errors import AssignmentError
from grader.sim.cdr import encode
from grader.sim.driving import Car
from grader.sim.episode import Episode, EpisodeSpec
from tests.fakes import jail
from tests.fakes.jail import SECOND, FakeLink, Script
from tests.unit.sim.playing import OPEN, end_pose, play

WITH_ODOMETRY = replace(OPEN, odometry=True)

MS = 1_000_000


@pytest.mark.parametrize(
    ("fields", "code"),
    [({"type": "std_msgs/msg/String"}, "type_mismatch"), ({"reliability": 2}, "incompatible_qos")],
)
def test_a_publisher_that_does_not_match_moves_nothing(car: Car, fields: dict[str, Any], code: str) -> None:
    result = play(
        car, [jail.node(), jail.driver(**fields), jail.publish(2, 0, jail.twist(1.0)), jail.ended(SECOND)]
    )
    assert [note.code for note in result.notes] == [code]
    assert end_pose(result)[0] == 0.0


def test_the_assignment_names_the_command_topic(car: Car) -> None:
    frames = [jail.node(), jail.driver(), jail.driver(3, name="/cmd_vel")]
    frames += [jail.publish(2, 0, jail.twist(9.0)), jail.publish(3, 0, jail.twist(1.0)), jail.ended(0)]
    result = play(car, frames, world=World(walls=False, cmd_vel_topic="/cmd_vel"))
    assert end_pose(result)[0] == pytest.approx(63 * 0.016)


def test_other_topics_are_counted_by_the_hundred(car: Car) -> None:
    frames = [jail.node(), jail.entity(2, 2, name="/chatter", type="std_msgs/msg/String")]
    result = play(car, [*frames, *[jail.publish(2, t, b"") for t in range(3)], jail.ended(9)])
    assert result.endpoints[0].count == 201


def test_long_log_records_are_kept_up_to_half_a_million_characters(car: Car) -> None:
    log = encode("rcl_interfaces/msg/Log", {"level": 20, "name": "n" * 2000, "msg": "m" * 2000})
    frames = [jail.node(), jail.entity(2, 2, name="/rosout", type="rcl_interfaces/msg/Log")]
    result = play(car, [*frames, *[jail.publish(2, 8, log)] * 260, jail.ended(9)])
    assert (len(result.logs), result.logs_dropped) == (250, 10)


def test_rosout_becomes_log_records(car: Car) -> None:
    log = encode("rcl_interfaces/msg/Log", {"level": 20, "name": "student", "msg": "你好" * 900})
    odd = encode("rcl_interfaces/msg/Log", {"level": 7})
    frames = [jail.node(), jail.entity(2, 2, name="/rosout", type="rcl_interfaces/msg/Log")]
    frames += [jail.publish(2, 5, log), jail.publish(2, 6, odd), jail.publish(2, 7, b"bad")]
    short = encode("rcl_interfaces/msg/Log", {"level": 20, "msg": "hi"})
    result = play(car, [*frames, *[jail.publish(2, 8, short)] * 2005, jail.ended(9)])
    assert (len(result.logs), result.logs_dropped) == (2000, 6)
    assert (result.logs[0].t_ns, result.logs[0].level, result.logs[0].name) == (5, 20, "student")
    assert len(result.logs[0].message) == 1000
    assert result.endpoints == ()
    assert [note.code for note in result.notes] == ["unreadable_message"]


def test_notes_are_bounded_and_not_repeated(car: Car) -> None:
    frames = [jail.note("discovery", "/a")] * 3 + [jail.note("discovery", str(n)) for n in range(200)]
    result = play(car, [*frames, jail.ended(0)])
    assert len(result.notes) == 100
    assert (result.notes[0].text, result.notes[1].text) == ("/a", "0")


def test_pose_comes_every_16_ms(car: Car) -> None:
    seen: list[tuple[int, dict[str, Any]]] = []

    def script() -> Script:
        yield jail.driver()
        yield jail.entity(3, 3, name="/turtle1/pose", type="turtlesim/msg/Pose")
        yield jail.publish(2, 0, jail.twist(-1.0, 2.0))
        now = 0
        while now < SECOND:
            answer = yield jail.advance(SECOND)
            assert answer is not None
            now = answer.now_ns
            seen.extend((now, pose) for pose in answer.messages(3, "turtlesim/msg/Pose"))
        yield jail.publish(2, SECOND, jail.twist())
        yield jail.ended(SECOND)

    play(car, script(), world=World(walls=False, start=StartPose(heading_deg=170.0)))
    assert [t for t, _ in seen] == [16 * MS * k for k in range(1, 63)]
    assert all(-math.pi <= pose["theta"] < math.pi for _, pose in seen)
    assert seen[-1][1]["linear_velocity"] == pytest.approx(1.0, rel=1e-3)
    assert seen[-1][1]["angular_velocity"] == pytest.approx(2.0, rel=1e-3)
    expected = math.remainder(math.radians(170) + 2.0 * 0.992, math.tau)
    assert seen[-1][1]["theta"] == pytest.approx(expected, abs=1e-6)


def test_advance_without_anything_due_reaches_its_time(car: Car) -> None:
    times = []

    def script() -> Script:
        for t in (5, SECOND, 3 * SECOND):
            answer = yield jail.advance(t)
            assert answer is not None
            times.append((answer.now_ns, answer.events))
        yield jail.ended(3 * SECOND)

    result = play(car, script(), horizon_s=2.0)
    assert times == [(5, []), (SECOND, []), (3 * SECOND, [])]
    assert result.sim_steps == 0


def test_the_answer_says_until_when_nothing_is_due(car: Car) -> None:
    answers = []

    def script() -> Script:
        yield jail.entity(3, 3, name="/turtle1/pose", type="turtlesim/msg/Pose")
        for t_ns, together_ns in ((5 * MS, 0), (SECOND, 0), (SECOND, 100 * MS), (SECOND, SECOND)):
            answer = yield jail.advance(t_ns, together_ns)
            assert answer is not None
            answers.append((answer.now_ns // MS, answer.quiet_ns // MS, len(answer.events)))
        yield jail.gone(3, SECOND)
        answer = yield jail.advance(SECOND)
        assert answer is not None
        assert answer.quiet_ns == 1 << 62
        yield jail.ended(SECOND)

    play(car, script())
    assert answers == [(5, 16, 0), (16, 32, 1), (100, 112, 5), (1_000, 1_008, 56)]


def test_what_does_not_fit_into_an_answer_comes_with_the_next(car: Car) -> None:
    answers = []

    def script() -> Script:
        yield jail.entity(3, 3, name="/odom", type="nav_msgs/msg/Odometry")
        while not answers or answers[-1][0] < 10 * SECOND:
            answer = yield jail.advance(10 * SECOND, 10 * SECOND)
            assert answer is not None
            answers.append((answer.now_ns, answer.quiet_ns, answer.events[-1][3]))
        yield jail.ended(10 * SECOND)

    play(car, script(), world=WITH_ODOMETRY)
    assert answers == [
        (4_096 * MS, 4_112 * MS, 4_096 * MS),
        (8_192 * MS, 8_208 * MS, 8_192 * MS),
        (10_000 * MS, 10_000 * MS + 16 * MS, 10_000 * MS),
    ]


def test_a_script_that_only_hears_the_pose_is_told_the_car(car: Car) -> None:
    told = []

    def script() -> Script:
        yield jail.driver()
        yield jail.entity(3, 3, name="/turtle1/pose", type="turtlesim/msg/Pose")
        for topic in ((), ((4, "/odom", "nav_msgs/msg/Odometry"),)):
            for identity, name, kind in topic:
                yield jail.entity(identity, 3, 16 * MS, name=name, type=kind)
            answer = yield jail.advance(20 * MS)
            assert answer is not None
            told.append(answer.car[:8])
        yield jail.ended(20 * MS)

    play(car, script(), world=WITH_ODOMETRY)
    assert told == [struct.pack("<HHHH", 1, 3, 1, 2), b""]


def test_it_tells_while_script_and_world_wait_for_each_other(car: Car) -> None:
    told: list[bool | str] = []

    def script() -> Script:
        yield jail.driver()
        yield jail.publish(2, SECOND // 2, jail.twist(1.0))
        yield jail.entity(3, 3, SECOND // 2, name="/odom", type="nav_msgs/msg/Odometry")
        for _ in range(3):
            told.append("asks")
            yield jail.advance(SECOND)
        yield jail.gone(3, SECOND)
        told.append("runs ahead")
        yield jail.publish(2, 2 * SECOND, jail.twist(1.0))
        told.append("asks")
        yield jail.advance(3 * SECOND)
        yield jail.ended(3 * SECOND)

    spec = EpisodeSpec(world=WITH_ODOMETRY, horizon_ns=5 * SECOND, source=b"", file_name="a.py")
    Episode(spec, car).run(FakeLink(script()), take_turns=told.append)
    assert told == [False, "asks", True, "asks", "asks", False, "runs ahead", "asks", True]


def test_odometry_starts_at_zero_and_stamps_wall_clock(car: Car) -> None:
    seen: list[dict[str, Any]] = []

    def script() -> Script:
        yield jail.driver()
        yield jail.entity(3, 3, name="/odom", type="nav_msgs/msg/Odometry")
        yield jail.entity(4, 3, name="/tf", type="tf2_msgs/msg/TFMessage")
        yield jail.publish(2, 0, jail.twist(1.0))
        for _ in range(25):
            answer = yield jail.advance(SECOND)
            assert answer is not None
            (odom,) = answer.messages(3, "nav_msgs/msg/Odometry")
            (tf,) = answer.messages(4, "tf2_msgs/msg/TFMessage")
            (transform,) = tf["transforms"]
            assert transform["header"] == odom["header"]
            assert transform["transform"]["translation"]["x"] == odom["pose"]["pose"]["position"]["x"]
            seen.append(odom)
        yield jail.ended(SECOND // 2)

    world = World(walls=False, start=StartPose(x_m=3.0, y_m=2.0, heading_deg=90.0), odometry=True)
    play(car, script(), world=world)
    sec, nanosec = divmod(EPOCH_NS + 400 * MS, SECOND)
    assert seen[-1]["header"] == {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": "odom"}
    assert seen[-1]["child_frame_id"] == "base_link"
    position = seen[-1]["pose"]["pose"]["position"]
    assert position["x"] == pytest.approx(0.4)
    assert abs(position["y"]) < 1e-15
    assert seen[-1]["twist"]["twist"]["linear"]["x"] == pytest.approx(1.0, rel=1e-3)


def test_an_incompatible_subscription_hears_nothing(car: Car) -> None:
    heard = []

    def script() -> Script:
        yield jail.entity(3, 3, name="/turtle1/pose", type="turtlesim/msg/Pose", durability=1)
        heard.append((yield jail.advance(SECOND)))
        yield jail.ended(SECOND)

    result = play(car, script())
    assert heard[0] is not None
    assert heard[0].events == []
    assert [note.code for note in result.notes] == ["incompatible_qos"]


def test_an_assignment_calls_the_scripts_service(car: Car) -> None:
    flagged = Step(
        id="flag",
        kind="call",
        at_ns=SECOND,
        target="/flag",
        type="std_srvs/srv/SetBool",
        values={"data": True},
    )
    missed = Step(id="missing", kind="call", target="/missing", type="std_srvs/srv/Trigger")

    def script() -> Script:
        yield jail.entity(3, 4, 1, name="/flag", type="std_srvs/srv/SetBool")
        answer = yield jail.advance(5 * SECOND)
        assert answer is not None
        assert answer.now_ns == SECOND
        ((what, identity, sequence, t_ns, payload),) = answer.events
        assert (what, identity, t_ns, payload) == (
            3,
            3,
            SECOND,
            encode("std_srvs/srv/SetBool_Request", {"data": True}),
        )
        done = encode("std_srvs/srv/SetBool_Response", {"success": True, "message": "好"})
        yield jail.response(3, sequence, SECOND + 5, done)
        yield jail.ended(2 * SECOND)

    result = play(car, script(), said=(flagged, missed))
    assert result.violation is None
    assert result.conversation is not None
    flag, missing = result.conversation.exchanges
    assert (flag.sent_ns, flag.answered_ns) == (SECOND, SECOND + 5)
    assert flag.answer == {"success": True, "message": "好"}
    assert (missing.sent_ns, missing.answer) == (None, None)


def test_a_call_that_does_not_fit_its_type_is_the_assignments_fault(car: Car) -> None:
    call = Step(id="flag", kind="call", target="/flag", type="std_srvs/srv/SetBool", values={"colour": 1})
    with pytest.raises(AssignmentError, match=r"flag.*colour"):
        play(car, [], said=(call,))
