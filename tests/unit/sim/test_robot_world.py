"""The robot as a script meets it: topics, QoS, stamps, what holds after the script's end."""

import math
import struct
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from grader.contracts.assignment import StartPose, Stripe, World
from grader.sim import robot_messages as messages
from grader.sim.cdr import decode, encode
from grader.sim.driving import Car
from grader.sim.episode import Episode, EpisodeResult, EpisodeSpec
from grader.sim.interfaces import header, quaternion, with_interfaces
from grader.sim.robot_body import RobotBody
from grader.sim.robot_world import SIM_START_NS
from tests.fakes import jail
from tests.fakes.jail import SECOND, FakeLink
from tests.unit.sim.rooms import room
from tests.unit.sim.student import Student

TYPES = with_interfaces(())
SCAN, ODOM = "sensor_msgs/msg/LaserScan", "nav_msgs/msg/Odometry"
ROOM = room(-1.0, -1.0, 2.0, 1.0)
WORLD = World(kind="robot", room=ROOM, cmd_vel_topic="/cmd_vel", start=StartPose(x_m=0.0, y_m=0.0), seed=7)


@pytest.fixture(scope="module")
def body() -> Any:
    body = RobotBody()
    yield body
    body.close()


def play(
    car: Car, body: RobotBody, frames: Any, world: World = WORLD, horizon_s: float = 20.0
) -> EpisodeResult:
    spec = EpisodeSpec(world=world, horizon_ns=round(horizon_s * SECOND), source=b"print()", file_name="a.py")
    return Episode(spec, car, lambda: body).run(FakeLink(frames))


def listen(student: Student, topic: str, kind: str, *, reliable: bool = False, kept: bool = False) -> Any:
    ident = student.ids.setdefault(topic, len(student.ids) + 10)
    yield jail.entity(
        ident, 3, student.now, name=topic, type=kind, reliability=2 - reliable, durability=2 - kept
    )


def heard(student: Student, topic: str, kind: str) -> list[tuple[int, dict[str, Any]]]:
    ident = student.ids[topic]
    return [(t_ns, decode(kind, data, TYPES)) for t_ns, who, data in student.heard if who == ident]


def test_scans_come_five_times_a_second_with_a_burgers_fields(car: Car, body: RobotBody) -> None:
    student = Student()

    def story() -> Any:
        yield from listen(student, "/scan", SCAN)
        yield from student.wait(2 * SECOND)
        yield jail.ended(student.now)

    play(car, body, story())
    scans = heard(student, "/scan", SCAN)
    assert [t_ns for t_ns, _ in scans] == [k * SECOND // 5 for k in range(1, 11)]
    _, scan = scans[0]
    stamp = scan["header"]["stamp"]
    assert stamp["sec"] * SECOND + stamp["nanosec"] == SIM_START_NS + SECOND // 5
    assert scan["header"]["frame_id"] == "base_scan"
    assert (len(scan["ranges"]), len(scan["intensities"])) == (360, 360)
    assert (scan["range_min"], scan["range_max"]) == (pytest.approx(0.12), 3.5)
    assert scan["angle_max"] == pytest.approx(6.28)
    assert scan["ranges"][0] == pytest.approx(2.032, abs=0.05)
    assert scan["ranges"][180] == pytest.approx(0.968, abs=0.05)
    ahead = [each["ranges"][0] for _, each in scans]
    assert len(set(ahead)) == 10  # noise
    assert sum(ahead) / 10 == pytest.approx(2.032, abs=0.015)


def test_what_is_too_far_or_too_near_is_infinite(car: Car, body: RobotBody) -> None:
    student = Student()
    world = World(kind="robot", room=room(-0.2, -4.0, 8.0, 4.0), start=StartPose(x_m=0.0, y_m=0.0))

    def story() -> Any:
        yield from listen(student, "/scan", SCAN)
        yield from student.wait(SECOND // 4)
        yield jail.ended(student.now)

    play(car, body, story(), world)
    ((_, scan),) = heard(student, "/scan", SCAN)
    assert scan["ranges"][0] == math.inf
    assert scan["ranges"][180] == pytest.approx(0.168, abs=0.05)
    near = World(kind="robot", room=room(-0.105, -4.0, 8.0, 4.0), start=StartPose(x_m=0.0, y_m=0.0))
    student = Student()
    play(car, body, story(), near)
    ((_, scan),) = heard(student, "/scan", SCAN)
    assert scan["ranges"][180] == -math.inf


def test_a_reliable_subscription_gets_no_scan_but_odometry(car: Car, body: RobotBody) -> None:
    student = Student()

    def story() -> Any:
        yield from listen(student, "/scan", SCAN, reliable=True)
        yield from listen(student, "/odom", ODOM, reliable=True)
        yield from student.wait(SECOND)
        yield jail.ended(student.now)

    result = play(car, body, story())
    assert heard(student, "/scan", SCAN) == []
    assert len(heard(student, "/odom", ODOM)) == 30
    assert [(note.code, note.text) for note in result.notes] == [("sensor_qos", "/scan")]


def test_what_is_fixed_to_the_robot_comes_to_late_listeners(car: Car, body: RobotBody) -> None:
    student = Student()

    def story() -> Any:
        yield from student.wait(SECOND)
        yield from listen(student, "/tf_static", "tf2_msgs/msg/TFMessage", reliable=True, kept=True)
        yield from student.wait(2 * SECOND)
        yield jail.ended(student.now)

    play(car, body, story())
    ((_, told),) = heard(student, "/tf_static", "tf2_msgs/msg/TFMessage")
    pairs = {(each["header"]["frame_id"], each["child_frame_id"]) for each in told["transforms"]}
    assert {("base_footprint", "base_link"), ("base_link", "base_scan")} <= pairs


def test_a_command_holds_until_the_next_one_even_after_the_scripts_end(car: Car, body: RobotBody) -> None:
    student = Student()

    def story() -> Any:
        yield jail.entity(10, 2, 0, name="/cmd_vel", type="geometry_msgs/msg/Twist")
        yield jail.publish(10, 200_000_000, jail.twist(0.2, 0.0))
        yield jail.ended(500_000_000)

    result = play(car, body, story(), horizon_s=15.0)
    assert result.trajectory.end_ns == 15 * SECOND
    assert result.trajectory.x_m[-1] == pytest.approx(2.0 - 0.038, abs=0.003)
    (contact,) = result.trajectory.contacts
    assert contact.wall == "right"
    assert student.heard == []
    assert result.command_count == 1


def test_topics_have_the_assignments_names(car: Car, body: RobotBody) -> None:
    student = Student()
    world = World(
        kind="robot", room=ROOM, cmd_vel_topic="/robot/cmd_vel", topics={"/scan": "/robot/laser"},
        start=StartPose(x_m=0.0, y_m=0.0),
    )  # fmt: skip

    def story() -> Any:
        yield from listen(student, "/robot/laser", SCAN)
        yield from listen(student, "/scan", SCAN)
        yield from student.wait(SECOND)
        yield jail.ended(student.now)

    play(car, body, story(), world)
    assert len(heard(student, "/robot/laser", SCAN)) == 5
    assert heard(student, "/scan", SCAN) == []


def test_messages_are_as_the_general_writer_makes_them() -> None:
    t_ns = 12_345_678_901
    told = header(t_ns, "odom")
    diagonal = [0.0] * 36
    diagonal[::7] = (1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3)
    odometry = {
        "header": told,
        "child_frame_id": "base_footprint",
        "pose": {
            "pose": {"position": {"x": 1.0, "y": 2.0}, "orientation": quaternion(0.5)},
            "covariance": diagonal,
        },
        "twist": {"twist": {"linear": {"x": 0.1}, "angular": {"z": 0.2}}, "covariance": diagonal},
    }
    assert messages.odometry(t_ns, (1.0, 2.0, 0.5), 0.1, 0.2) == encode(ODOM, odometry)
    ranges = [0.5 + i / 360.0 for i in range(360)]
    packed = struct.pack("<360f", *ranges)
    scan = decode(SCAN, messages.laser_scan(t_ns, packed), TYPES)
    assert encode(SCAN, scan, TYPES) == messages.laser_scan(t_ns, packed)
    joints = messages.joint_states(t_ns, (1.0, 2.0), (3.0, 4.0))
    read = decode("sensor_msgs/msg/JointState", joints, TYPES)
    assert read["name"] == list(messages.WHEEL_JOINTS)
    assert (read["position"], read["velocity"], read["effort"]) == ([1.0, 2.0], [3.0, 4.0], [])
    assert encode("sensor_msgs/msg/JointState", read, TYPES) == joints
    assert decode("rosgraph_msgs/msg/Clock", messages.clock(t_ns))["clock"]["nanosec"] == 345_678_901
    for kind, payload in (
        ("sensor_msgs/msg/Imu", messages.imu(t_ns, 0.5, (0.0, 0.0, 0.2), (0.1, 0.0, 0.0))),
        ("sensor_msgs/msg/Image", messages.image(t_ns, 4, 2, bytes(range(24)))),
        ("sensor_msgs/msg/CompressedImage", messages.compressed_image(t_ns, b"abc")),
    ):
        values = decode(kind, payload, TYPES)
        assert encode(kind, values, TYPES) == payload
    assert decode("sensor_msgs/msg/Image", messages.image(t_ns, 4, 2, bytes(24)), TYPES)["step"] == 12


def test_the_imu_feels_a_turn_and_gravity(car: Car, body: RobotBody) -> None:
    student = Student()
    kind = "sensor_msgs/msg/Imu"

    def story() -> Any:
        yield jail.entity(90, 2, 0, name="/cmd_vel", type="geometry_msgs/msg/Twist")
        yield jail.publish(90, 0, jail.twist(0.0, 1.0))
        yield from listen(student, "/imu", kind)
        yield from student.wait(2 * SECOND)
        yield jail.ended(student.now)

    play(car, body, story(), horizon_s=2.0)
    told = [values for _, values in heard(student, "/imu", kind)]
    assert len(told) == 120
    assert told[-1]["angular_velocity"]["z"] == pytest.approx(1.0, abs=0.01)
    assert told[-1]["linear_acceleration"]["z"] == pytest.approx(9.8, abs=0.1)
    turned = sum(each["angular_velocity"]["z"] for each in told) / 60.0
    q = told[-1]["orientation"]
    assert 2.0 * math.atan2(q["z"], q["w"]) == pytest.approx(turned, abs=0.01)


def test_the_imu_feels_no_push_when_a_script_begins_to_listen_on_the_way(car: Car, body: RobotBody) -> None:
    student = Student()
    kind = "sensor_msgs/msg/Imu"

    def story() -> Any:
        yield jail.entity(90, 2, 0, name="/cmd_vel", type="geometry_msgs/msg/Twist")
        yield jail.publish(90, 0, jail.twist(0.2, 0.0))
        yield from student.wait(SECOND)
        yield from listen(student, "/imu", kind)
        yield from student.wait(2 * SECOND)
        yield jail.ended(student.now)

    play(car, body, story(), horizon_s=2.0)
    pushes = [values["linear_acceleration"]["x"] for _, values in heard(student, "/imu", kind)]
    assert len(pushes) == 60
    assert max(map(abs, pushes)) < 0.5


def test_what_a_sensor_shows_does_not_depend_on_who_listens_to_another(car: Car, body: RobotBody) -> None:
    kinds = {"/scan": SCAN, "/imu": "sensor_msgs/msg/Imu"}

    def told(*topics: str) -> dict[str, Any]:
        student = Student()

        def story() -> Any:
            for topic in topics:
                yield from listen(student, topic, kinds[topic])
            yield from student.wait(2 * SECOND)
            yield jail.ended(student.now)

        play(car, body, story(), horizon_s=2.0)
        return {topic: heard(student, topic, kinds[topic]) for topic in topics}

    both = told("/scan", "/imu")
    assert len(both["/scan"]) == 10
    assert both == told("/scan") | told("/imu")


def test_a_camera_sees_a_line_on_its_side_only_while_somebody_looks(car: Car, body: RobotBody) -> None:
    student = Student()
    kind = "sensor_msgs/msg/Image"
    striped = replace(ROOM, stripes=(Stripe(points_m=((0.1, 0.1), (1.0, 0.1))),))
    world = replace(WORLD, room=striped)

    def story() -> Any:
        yield from listen(student, "/camera/image_raw", kind, reliable=True)
        yield from student.wait(SECOND // 5)
        yield jail.gone(student.ids["/camera/image_raw"], student.now)
        yield from student.wait(SECOND)
        yield jail.ended(student.now)

    play(car, body, story(), world)
    ident = student.ids["/camera/image_raw"]
    pictures = [data for _, who, data in student.heard if who == ident]
    assert len(pictures) == 2
    assert pictures[0][12:] == pictures[1][12:]  # all but the stamp: nothing moved
    pixels = np.frombuffer(pictures[0][-3 * 80 * 60 :], dtype=np.uint8).reshape(60, 80, 3)
    dark = np.nonzero(pixels[40:].max(axis=2) < 90)[1]
    assert len(dark) > 10
    assert dark.mean() < 36  # to the left
