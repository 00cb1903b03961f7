"""The lockstep loop: what frames do to the world and what comes back."""

import math
from typing import Any

import numpy as np
import pytest

from grader.contracts.assignment import StartPose, World
from grader.contracts.errors import AssignmentError
from grader.contracts.services import ServiceCall
from grader.sim.bullet import BulletCar
from grader.sim.cdr import encode
from grader.sim.episode import Episode, EpisodeResult, EpisodeSpec
from tests.fakes import jail
from tests.fakes.jail import SECOND, FakeLink, Script

OPEN = World(walls=False)
MS = 1_000_000
LAG_S = 0.0147  # what a first-order lag of 1/60 s, stepped at 240 Hz, is behind by


def play(
    car: BulletCar, frames: Any, *, world: World = OPEN, horizon_s: float = 60.0, **fields: Any
) -> EpisodeResult:
    spec = EpisodeSpec(
        world=world, horizon_ns=round(horizon_s * SECOND), source=b"print()", file_name="a.py", **fields
    )
    return Episode(spec, car).run(FakeLink(frames))


def end_pose(result: EpisodeResult) -> tuple[float, float, float]:
    path = result.trajectory
    return (
        float(path.x_m[-1] - path.x_m[0]),
        float(path.y_m[-1] - path.y_m[0]),
        float(path.heading_rad[-1] - path.heading_rad[0]),
    )


def test_start_says_what_the_world_is(car: BulletCar) -> None:
    link = FakeLink([jail.ended(0)])
    spec = EpisodeSpec(
        world=World(cmd_vel_topic="/cmd_vel", seed=7),
        horizon_ns=SECOND,
        source="print('你好')".encode(),
        file_name="hello.py",
        args=("--fast",),
        stdin="3\n",
        calls=(ServiceCall(at_ns=0, service="/go", type="std_srvs/srv/Trigger"),),
    )
    Episode(spec, car).run(link)
    assert link.source == spec.source
    assert link.start["protocol"] == 1
    assert (link.start["file_name"], link.start["args"], link.start["stdin"]) == (
        "hello.py",
        ["--fast"],
        "3\n",
    )
    assert (link.start["horizon_ns"], link.start["seed"]) == (SECOND, 7)
    world = link.start["world"]
    assert world["subscribes"] == [["/cmd_vel", jail.TWIST]]
    assert ["/turtle1/pose", "turtlesim/msg/Pose"] in world["publishes"]
    assert ["/spawn", "turtlesim/srv/Spawn"] in world["services"]
    assert (world["nodes"], world["calls"]) == (["/turtlesim"], [["/go", "std_srvs/srv/Trigger"]])


def test_a_held_command_drives_its_distance(car: BulletCar) -> None:
    result = play(car, jail.holding([(2.0, 1.0, 0.0)]))
    x, y, turn = end_pose(result)
    assert x == pytest.approx(2.0, abs=1e-4)
    assert abs(y) < 1e-6
    assert abs(turn) < 1e-6
    assert result.violation is None
    assert result.command_count == 201
    assert (result.first_command_ns, result.last_command_ns) == (0, 2 * SECOND)
    assert result.nodes == ("/student",)
    (publisher,) = result.endpoints
    assert (publisher.kind, publisher.name, publisher.count) == ("publisher", "/turtle1/cmd_vel", 201)


def test_one_command_before_the_end_still_drives_for_a_second(car: BulletCar) -> None:
    result = play(
        car, [jail.node(), jail.driver(), jail.publish(2, 5 * MS, jail.twist(1.0)), jail.ended(6 * MS)]
    )
    assert end_pose(result)[0] == pytest.approx(1.0, abs=5e-3)
    assert result.duration_ns == 6 * MS
    assert result.trajectory.end_ns > SECOND
    assert result.trajectory.v_mps[-1] == 0.0


def test_a_killed_process_leaves_the_trajectory_up_to_then(car: BulletCar) -> None:
    result = play(car, [jail.node(), jail.driver(), jail.publish(2, SECOND, jail.twist(2.0))])
    assert result.exit is None
    assert result.violation is None
    assert end_pose(result)[0] == pytest.approx(2.0, abs=1e-2)


def test_a_command_a_second_keeps_the_car_moving(car: BulletCar) -> None:
    frames = [jail.node(), jail.driver()]
    frames += [jail.publish(2, k * SECOND + k * 2_000, jail.twist(1.0)) for k in range(5)]
    frames += [jail.publish(2, 5 * SECOND, jail.twist()), jail.ended(6 * SECOND)]
    result = play(car, frames)
    assert end_pose(result)[0] == pytest.approx(5.0, abs=1e-3)


def test_nothing_moves_beyond_the_horizon(car: BulletCar) -> None:
    frames = [jail.node(), jail.driver(), jail.publish(2, 0, jail.twist(1.0))]
    frames += [jail.publish(2, t, jail.twist(1.0)) for t in (SECOND // 2, SECOND + 1, 2 * SECOND)]
    result = play(car, [*frames, jail.ended(3 * SECOND, after_interrupt=1)], horizon_s=1.0)
    assert end_pose(result)[0] == pytest.approx(1.0 - LAG_S, abs=1e-3)
    assert result.trajectory.t_ns[-1] <= SECOND
    assert result.trajectory.end_ns == SECOND
    assert result.command_count == 2
    assert result.duration_ns == SECOND


def test_commands_after_ctrl_c_do_not_put_the_exit_into_the_past(car: BulletCar) -> None:
    # A script with its own SIGINT handler goes on for a moment; its EXIT carries the horizon.
    frames = [jail.node(), jail.driver(), jail.publish(2, 0, jail.twist(1.0))]
    frames += [jail.publish(2, SECOND + 80_000, jail.twist()), jail.ended(SECOND, after_interrupt=1)]
    result = play(car, frames, horizon_s=1.0)
    assert (result.violation, result.duration_ns, result.command_count) == (None, SECOND, 1)


def test_frames_after_exit_are_not_read(car: BulletCar) -> None:
    result = play(car, [jail.ended(SECOND, code=3), b"\xff"])
    assert result.violation is None
    assert result.exit is not None
    assert result.exit.exit_code == 3


@pytest.mark.parametrize(
    ("frames", "words"),
    [
        ([b""], "empty frame"),
        ([b"\x99"], "unknown frame kind 0x99"),
        ([jail.publish(9, 0, b"")], "id 9 is not a publisher"),
        ([jail.node(), jail.publish(1, 0, b"")], "id 1 is not a publisher"),
        ([jail.node(), jail.node()], "ENTITY.id 1 is used twice"),
        ([jail.gone(4, 0)], "GONE.id 4"),
        ([jail.driver(), jail.gone(2, 5), jail.publish(2, 6, b"")], "id 2 is not a publisher"),
        ([jail.driver(2, 10), jail.publish(2, 9, b"")], "time went back"),
        ([jail.node(1, 10), jail.advance(9)], "time went back"),
        ([jail.node(1, 10), jail.ended(9)], "time went back"),
        ([jail.note("Shout!")], "NOTE.code"),
        (
            [jail.entity(3, 4, name="/s", type="std_srvs/srv/Trigger"), jail.response(3, 1, 0, b"")],
            "never asked",
        ),
        ([jail.node(identity) for identity in range(600)], "more than 512"),
    ],
)
def test_broken_rules_end_the_belief(car: BulletCar, frames: list[bytes], words: str) -> None:
    result = play(car, [*frames, jail.ended(SECOND)])
    assert result.violation is not None
    assert words in result.violation
    assert result.exit is None


def test_a_violation_keeps_what_was_driven(car: BulletCar) -> None:
    frames = jail.holding([(1.0, 1.0, 0.0)])[:-1]
    result = play(car, [*frames, b"\x00"])
    assert result.violation == "unknown frame kind 0x00"
    assert end_pose(result)[0] == pytest.approx(1.0, abs=1e-3)


def test_the_last_command_before_a_step_wins(car: BulletCar) -> None:
    frames = [jail.node(), jail.driver()]
    frames += [jail.publish(2, t, jail.twist(5.0, 3.0)) for t in range(0, 4000, 1000)]
    frames += [jail.publish(2, 4_000, jail.twist(1.0))]
    result = play(car, [*frames, jail.publish(2, SECOND, jail.twist()), jail.ended(SECOND)])
    # All of them but the first come before step 1; the one at 0 acts for that one step.
    assert [(c.t_ns, c.v_mps) for c in result.trajectory.commands] == [(0, 5.0), (4_000, 1.0), (SECOND, 0.0)]
    assert result.command_count == 6


def test_nonsense_commands_are_stops_and_counted(car: BulletCar) -> None:
    frames = [jail.node(), jail.driver(), jail.publish(2, 0, jail.twist(1.0))]
    frames += [
        jail.publish(2, SECOND // 2, jail.twist(math.nan, 1.0)),
        jail.publish(2, SECOND, jail.twist(1.0, math.inf)),
    ]
    result = play(car, [*frames, jail.ended(2 * SECOND)])
    assert result.nonfinite_commands == 2
    assert end_pose(result)[0] == pytest.approx(0.5, abs=1e-3)
    assert abs(end_pose(result)[2]) < 1e-6


def test_what_a_car_cannot_do_is_noted(car: BulletCar) -> None:
    frames = [jail.node(), jail.driver(), jail.publish(2, 0, jail.twist(0.0, 0.0, 1.0))]
    result = play(
        car,
        [*frames, jail.publish(2, 1, jail.twist(1e9)), jail.publish(2, 2, jail.twist()), jail.ended(SECOND)],
    )
    assert {note.code for note in result.notes} == {"lateral_command", "clamped_command"}


def test_unreadable_bytes_on_the_command_topic_do_not_move(car: BulletCar) -> None:
    frames = [jail.node(), jail.driver()]
    frames += [
        jail.publish(2, 1, b""),
        jail.publish(2, 2, jail.twist(1.0)[:-1]),
        jail.publish(2, 3, b"\xff" * 52),
    ]
    result = play(car, [*frames, jail.ended(SECOND)])
    assert result.violation is None
    assert result.command_count == 0
    assert [note.code for note in result.notes] == ["unreadable_message"]


@pytest.mark.parametrize(
    ("fields", "code"),
    [({"type": "std_msgs/msg/String"}, "type_mismatch"), ({"reliability": 2}, "incompatible_qos")],
)
def test_a_publisher_that_does_not_match_moves_nothing(
    car: BulletCar, fields: dict[str, Any], code: str
) -> None:
    result = play(
        car, [jail.node(), jail.driver(**fields), jail.publish(2, 0, jail.twist(1.0)), jail.ended(SECOND)]
    )
    assert [note.code for note in result.notes] == [code]
    assert end_pose(result)[0] == 0.0


def test_the_assignment_names_the_command_topic(car: BulletCar) -> None:
    frames = [jail.node(), jail.driver(), jail.driver(3, name="/cmd_vel")]
    frames += [jail.publish(2, 0, jail.twist(9.0)), jail.publish(3, 0, jail.twist(1.0)), jail.ended(0)]
    result = play(car, frames, world=World(walls=False, cmd_vel_topic="/cmd_vel"))
    assert end_pose(result)[0] == pytest.approx(1.0, abs=5e-3)


def test_other_topics_are_counted_by_the_hundred(car: BulletCar) -> None:
    frames = [jail.node(), jail.entity(2, 2, name="/chatter", type="std_msgs/msg/String")]
    result = play(car, [*frames, *[jail.publish(2, t, b"") for t in range(3)], jail.ended(9)])
    assert result.endpoints[0].count == 201


def test_rosout_becomes_log_records(car: BulletCar) -> None:
    log = encode("rcl_interfaces/msg/Log", {"level": 20, "name": "student", "msg": "你好" * 900})
    odd = encode("rcl_interfaces/msg/Log", {"level": 7})
    frames = [jail.node(), jail.entity(2, 2, name="/rosout", type="rcl_interfaces/msg/Log")]
    frames += [jail.publish(2, 5, log), jail.publish(2, 6, odd), jail.publish(2, 7, b"bad")]
    result = play(car, [*frames, *[jail.publish(2, 8, log)] * 2005, jail.ended(9)])
    assert (len(result.logs), result.logs_dropped) == (2000, 6)
    assert (result.logs[0].t_ns, result.logs[0].level, result.logs[0].name) == (5, 20, "student")
    assert len(result.logs[0].message) == 1000
    assert result.endpoints == ()
    assert [note.code for note in result.notes] == ["unreadable_message"]


def test_notes_are_bounded_and_not_repeated(car: BulletCar) -> None:
    frames = [jail.note("discovery", "/a")] * 3 + [jail.note("discovery", str(n)) for n in range(200)]
    result = play(car, [*frames, jail.ended(0)])
    assert len(result.notes) == 100
    assert (result.notes[0].text, result.notes[1].text) == ("/a", "0")


def test_pose_comes_every_16_ms(car: BulletCar) -> None:
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
    # 2 rad/s from 170 degrees, less the lag of 1/60 s: between two steps, on the line between them.
    expected = math.remainder(math.radians(170) + 2.0 * (0.992 - LAG_S), math.tau)
    assert seen[-1][1]["theta"] == pytest.approx(expected, abs=0.01)


def test_advance_without_anything_due_reaches_its_time(car: BulletCar) -> None:
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


def test_odometry_starts_at_zero_and_stamps_wall_clock(car: BulletCar) -> None:
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

    world = World(walls=False, start=StartPose(x_m=3.0, y_m=2.0, heading_deg=90.0))
    play(car, script(), world=world, epoch_ns=100 * SECOND)
    assert seen[-1]["header"] == {"stamp": {"sec": 100, "nanosec": 500 * MS}, "frame_id": "odom"}
    assert seen[-1]["child_frame_id"] == "base_link"
    position = seen[-1]["pose"]["pose"]["position"]
    assert position["x"] == pytest.approx(0.5 - LAG_S, abs=1e-3)
    assert abs(position["y"]) < 1e-6
    assert seen[-1]["twist"]["twist"]["linear"]["x"] == pytest.approx(1.0, rel=1e-3)


def test_an_incompatible_subscription_hears_nothing(car: BulletCar) -> None:
    heard = []

    def script() -> Script:
        yield jail.entity(3, 3, name="/turtle1/pose", type="turtlesim/msg/Pose", durability=1)
        heard.append((yield jail.advance(SECOND)))
        yield jail.ended(SECOND)

    result = play(car, script())
    assert heard[0] is not None
    assert heard[0].events == []
    assert [note.code for note in result.notes] == ["incompatible_qos"]


def test_an_assignment_calls_the_scripts_service(car: BulletCar) -> None:
    calls = (
        ServiceCall(at_ns=SECOND, service="/flag", type="std_srvs/srv/SetBool", values={"data": True}),
        ServiceCall(at_ns=0, service="/missing", type="std_srvs/srv/Trigger"),
    )

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

    result = play(car, script(), calls=calls)
    assert result.violation is None
    flag, missing = result.calls
    assert (flag.sent_ns, flag.answered_ns) == (SECOND, SECOND + 5)
    assert flag.values == {"success": True, "message": "好"}
    assert (missing.sent_ns, missing.values) == (None, None)


def test_a_call_that_does_not_fit_its_type_is_the_assignments_fault(car: BulletCar) -> None:
    call = ServiceCall(at_ns=0, service="/flag", type="std_srvs/srv/SetBool", values={"colour": 1})
    with pytest.raises(AssignmentError, match=r"/flag.*colour"):
        play(car, [], calls=(call,))


def test_resting_costs_no_steps_and_few_samples(car: BulletCar) -> None:
    frames = [jail.node(), jail.driver()]
    for start in (0, 50):
        frames += [
            jail.publish(2, start * SECOND, jail.twist(1.0)),
            jail.publish(2, (start + 1) * SECOND, jail.twist()),
        ]
    result = play(car, [*frames, jail.ended(59 * SECOND)])
    assert result.sim_steps < 700
    path = result.trajectory
    gaps = np.flatnonzero(np.diff(path.t_ns) > SECOND // 60 + 1)
    assert len(gaps) == 2
    for gap in gaps:
        assert path.x_m[gap] == path.x_m[gap + 1]
        assert path.v_mps[gap] == path.v_mps[gap + 1] == 0.0
    assert path.end_ns == 59 * SECOND
