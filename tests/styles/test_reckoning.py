"""A script that reckons the poses sees and does what one does that asks the simulator for each of them."""

from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from grader.contracts.assignment import Assignment, Case, StartPose, World
from grader.contracts.grading import GradingJob
from grader.contracts.outcome import RunStatus
from grader.contracts.text import EMPTY
from grader.grading.pipeline import Pipeline
from grader.jail.cores import SharedCore
from grader.sandbox import script_sandbox
from grader.sim.turtle_world import TurtleWorld
from tests.examples import examples

_PLAYER = """
import hashlib, math, threading, time
import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.action import ActionClient
from rclpy.executors import MultiThreadedExecutor
from std_srvs.srv import Empty
from tf2_msgs.msg import TFMessage
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color, Pose
from turtlesim.srv import Kill, Spawn, TeleportAbsolute

nan = math.nan
STEPS = STEPS_HERE
KINDS = {'/turtle1/pose': Pose, '/turtle1/color_sensor': Color, '/odom': Odometry, '/tf': TFMessage}
rclpy.init()
node = rclpy.create_node('player')
seen, last, heard = hashlib.sha256(), Pose(), 0
def note(*what): seen.update(repr((node.get_clock().now().nanoseconds, what)).encode())
def hear(message):
    global last, heard
    heard += 1
    if isinstance(message, Pose): last = message
    note(message)
    if slow: time.sleep(slow)
slow, beside = 0.0, {}
node.create_subscription(Pose, '/turtle1/pose', hear, 10)
qualities = (10, rclpy.qos.qos_profile_sensor_data)
publishers = [node.create_publisher(Twist, '/turtle1/cmd_vel', qos) for qos in qualities]
def drive(v, w, which=0):
    twist = Twist(); twist.linear.x, twist.angular.z = v, w
    publishers[which].publish(twist)
def ask(service, kind, **fields):
    client = node.create_client(kind, service)
    future = client.call_async(kind.Request(**fields))
    rclpy.spin_until_future_complete(node, future, timeout_sec=1.0)
    note(future.result())
for step, *given in STEPS:
    note(step)
    if step == 'drive': drive(*given)
    elif step == 'raw': publishers[0].publish(given[0])
    elif step == 'sleep': time.sleep(given[0])
    elif step == 'spin': rclpy.spin_once(node, timeout_sec=given[0])
    elif step == 'slow': slow = given[0]
    elif step == 'fast':
        for i in range(given[0]):
            drive(given[2] * (i % 5), 1.0 - 0.1 * (i % 3))
            time.sleep(given[1])
            if i % 10 == 9: note(last)
    elif step == 'burst':
        for i in range(given[0]): drive(0.1 * i, 0.2, i % 2)
    elif step == 'busy':
        for _ in range(given[0]): note()
    elif step == 'steer':
        for _ in range(given[0]):
            rclpy.spin_once(node)
            drive(given[1], 0.3 * last.theta + given[2])
    elif step == 'ticks':
        left = given[1]
        def tick():
            global left
            left -= 1
            drive(0.3, last.theta - left)
            if not left: raise StopAsyncIteration
        timer = node.create_timer(given[0], tick)
        try: rclpy.spin(node)
        except StopAsyncIteration: node.destroy_timer(timer)
    elif step == 'polls':
        for _ in range(given[0]): rclpy.spin_once(node, timeout_sec=0)
    elif step == 'listen' and given[0] not in beside:
        beside[given[0]] = node.create_subscription(KINDS[given[0]], given[0], hear, 3)
    elif step == 'deaf' and beside: node.destroy_subscription(beside.popitem()[1])
    elif step == 'teleport': ask('/turtle1/teleport_absolute', TeleportAbsolute, x=given[0], y=given[1], theta=2.0)
    elif step == 'spawn': ask('/spawn', Spawn, x=1.0, y=2.0, theta=0.5, name=given[0])
    elif step == 'kill': ask('/kill', Kill, name=given[0])
    elif step == 'reset': ask('/reset', Empty)
    elif step == 'rotate':
        client = ActionClient(node, RotateAbsolute, '/turtle1/rotate_absolute')
        client.send_goal_async(RotateAbsolute.Goal(theta=given[0]))
    elif step == 'threads':
        executor = MultiThreadedExecutor(); executor.add_node(node)
        node.create_timer(given[0], lambda: drive(0.5, last.x - 5.5))
        end = time.monotonic() + 1.0
        while time.monotonic() < end: executor.spin_once(0.05)
        executor.shutdown(); node.executor = None
    elif step == 'beside':
        other = rclpy.create_node('other')
        other.create_subscription(Pose, '/turtle1/pose', hear, 10)
        executor = rclpy.executors.SingleThreadedExecutor(); executor.add_node(other)
        threading.Thread(target=executor.spin, daemon=True).start()
node.get_logger().info(f'{heard} {seen.hexdigest()} {last}')
if STEPS[-1][0] == 'spin': rclpy.spin(node)
"""

SPEEDS = st.sampled_from([0.0, 0.5, -1.0, 3.0, 0.1, -0.0, 2.0 / 3.0, 250.0, float("nan")])
RATES = st.sampled_from([0.0, 1.0, -0.3, 3.0, -0.0, 7.0, 300.0])
TIMES_S = st.sampled_from([0.0, 0.0003, 0.016, 0.02, 0.1, 0.9, 1.05, 5.3])
PERIODS_S = st.sampled_from([0.0005, 0.001, 0.002, 0.005, 0.01, 0.013, 0.016, 0.02, 0.1, 1.0])
TOPICS = st.sampled_from(["/turtle1/pose", "/turtle1/color_sensor", "/odom", "/tf"])
STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("drive"), SPEEDS, RATES, st.sampled_from([0, 0, 0, 1])),
        st.tuples(st.just("fast"), st.integers(1, 120), PERIODS_S, SPEEDS),
        st.tuples(st.just("burst"), st.integers(1, 16)),
        st.tuples(st.just("steer"), st.integers(1, 80), SPEEDS, RATES),
        st.tuples(st.just("sleep"), TIMES_S),
        st.tuples(st.just("spin"), TIMES_S),
        st.tuples(st.just("busy"), st.sampled_from([3, 900, 7_000])),
        st.tuples(st.just("ticks"), st.sampled_from([0.0003, 0.016, 0.05]), st.integers(1, 80)),
        st.tuples(st.just("polls"), st.integers(1, 300)),
        st.tuples(st.just("slow"), st.sampled_from([0.0, 0.01, 0.05])),
        st.tuples(st.just("listen"), TOPICS),
        st.tuples(st.just("deaf")),
        st.tuples(st.just("raw"), st.sampled_from([b"", b"\0\1\0\0" + bytes(48), b"\0\1\0\0" + bytes(47)])),
        st.tuples(st.just("teleport"), st.sampled_from([-1.0, 5.0, 11.0]), st.sampled_from([0.0, 9.0])),
        st.tuples(st.sampled_from(["spawn", "kill"]), st.sampled_from(["turtle1", "turtle2"])),
        st.tuples(st.just("reset")),
        st.tuples(st.just("rotate"), st.sampled_from([1.0, -2.5])),
        st.tuples(st.just("threads"), st.sampled_from([0.01, 0.1])),
        st.tuples(st.just("beside")),
    ),
    min_size=4,
    max_size=14,
)


@pytest.fixture(scope="module")
def pipeline() -> Iterator[Pipeline]:
    with script_sandbox("best-effort") as sandbox, Pipeline(sandbox) as pipeline:
        yield pipeline


def job(steps: list[Any], world: World) -> GradingJob:
    source = _PLAYER.replace("STEPS_HERE", repr(steps)).encode()
    return GradingJob(
        file_name="player.py",
        source=source,
        assignment=Assignment(
            id="reckoning",
            version=1,
            order=0,
            title=EMPTY,
            brief=EMPTY,
            check="node",
            items=(),
            horizon_s=30.0,
            world=world,
            cases=(Case(),),
        ),
    )


def test_the_threads_of_a_script_are_gathered_on_one_core(
    pipeline: Pipeline, monkeypatch: pytest.MonkeyPatch
) -> None:
    gathered: list[SharedCore] = []

    def gather(self: SharedCore) -> None:
        gathered.append(self)

    monkeypatch.setattr(SharedCore, "gather", gather)
    pipeline.grade(job([("sleep", 0.1)], World()))
    assert gathered == []
    pipeline.grade(job([("threads", 0.1)], World()))
    assert len(gathered) == 1


@given(steps=STEPS, walls=st.booleans(), heading_deg=st.sampled_from([0.0, 84.0, 200.0, -180.0]))
@settings(max_examples=examples(20))
@example(
    steps=[("drive", 1.0, 0.5, 0), ("sleep", 5.3), ("spin", 0.1), ("beside",), ("steer", 80, 3.0, 0.1)],
    walls=True,
    heading_deg=0.0,
)
@example(
    steps=[
        ("burst", 12),
        ("fast", 120, 0.0005, 0.5),
        ("fast", 60, 0.01, 3.0),
        ("rotate", 1.0),
        ("burst", 3),
        ("spin", 1.05),
    ],
    walls=False,
    heading_deg=84.0,
)
def test_the_script_and_the_simulator_reckon_alike(
    pipeline: Pipeline, steps: list[Any], walls: bool, heading_deg: float
) -> None:
    asked = job(steps, World(walls=walls, start=StartPose(heading_deg=heading_deg)))
    reckoned = pipeline.grade(asked)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(TurtleWorld, "let_reckon", lambda self: None)
        told = pipeline.grade(asked)
    assert reckoned.trajectories == told.trajectories
    assert reckoned.report == told.report
    (run,) = told.report.runs
    assert run.outcome.status in (RunStatus.FINISHED, RunStatus.INTERRUPTED)
