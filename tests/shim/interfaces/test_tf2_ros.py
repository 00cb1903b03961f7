"""Broadcasting and listening to frames inside a script."""

from collections.abc import Callable
from typing import Any

import pytest

from grader.sim.cdr import encode

Run = Callable[..., Any]

PREAMBLE = """
import math
import rclpy
from geometry_msgs.msg import PointStamped, TransformStamped
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import (
    Buffer, StaticTransformBroadcaster, TransformBroadcaster, TransformException, TransformListener,
)

def pose(node, parent, child, x, y=0.0, yaw=0.0):
    t = TransformStamped()
    t.header.stamp = node.get_clock().now().to_msg()
    t.header.frame_id = parent
    t.child_frame_id = child
    t.transform.translation.x = x
    t.transform.translation.y = y
    t.transform.rotation.z = math.sin(yaw / 2)
    t.transform.rotation.w = math.cos(yaw / 2)
    return t

rclpy.init()
node = Node('frames')
"""


def test_a_listener_hears_what_a_broadcaster_sends(run_script: Run) -> None:
    run = run_script(
        PREAMBLE
        + """
buffer = Buffer()
listener = TransformListener(buffer, node)
moving, fixed = TransformBroadcaster(node), StaticTransformBroadcaster(node)
fixed.sendTransform(pose(node, 'turtle1', 'carrot', 1.0))
node.create_timer(0.1, lambda: moving.sendTransform([pose(node, 'world', 'turtle1', 2.0, 3.0, math.pi / 2)]))
for _ in range(20):
    rclpy.spin_once(node, timeout_sec=0.1)
t = buffer.lookup_transform('world', 'carrot', Time())
print(round(t.transform.translation.x, 6), round(t.transform.translation.y, 6))
print(buffer.can_transform('world', 'nowhere', Time()))
try:
    buffer.lookup_transform('world', 'nowhere', Time())
except TransformException as error:
    print(type(error).__name__, error)
rclpy.shutdown()
"""
    )
    assert run.stdout.splitlines() == [
        "2.0 4.0",
        "False",
        'LookupException "nowhere" passed to lookupTransform argument source_frame does not exist. ',
    ], run.stderr


def test_a_late_listener_still_hears_fixed_frames(run_script: Run) -> None:
    run = run_script(
        PREAMBLE
        + """
StaticTransformBroadcaster(node).sendTransform(pose(node, 'world', 'map', 5.0))
rclpy.spin_once(node, timeout_sec=0.5)
buffer = Buffer()
listener = TransformListener(buffer, node)
rclpy.spin_once(node, timeout_sec=0.5)
print(buffer.lookup_transform('world', 'map', Time()).transform.translation.x)
"""
    )
    assert run.stdout == "5.0\n", run.stderr


def test_waiting_for_a_frame_takes_its_virtual_time(run_script: Run) -> None:
    run = run_script(
        PREAMBLE
        + """
buffer = Buffer()
before = node.get_clock().now()
print(buffer.can_transform('world', 'turtle1', Time(), timeout=Duration(seconds=1.0)))
waited = (node.get_clock().now() - before).nanoseconds / 1e9
print(1.0 <= waited < 1.03)
"""
    )
    assert run.stdout == "False\nTrue\n", run.stderr


def test_a_thread_of_its_own_lets_a_callback_wait(run_script: Run) -> None:
    run = run_script(
        PREAMBLE
        + """
buffer = Buffer()
listener = TransformListener(buffer, node, spin_thread=True)
sender = Node('sender')
broadcaster = TransformBroadcaster(sender)
broadcaster.sendTransform(pose(sender, 'world', 'turtle1', 7.0))
t = buffer.lookup_transform('world', 'turtle1', Time(), timeout=Duration(seconds=2.0))
print(t.transform.translation.x)
rclpy.shutdown()
"""
    )
    assert run.stdout == "7.0\n", run.stderr


def test_futures_are_done_when_the_frame_appears(run_script: Run) -> None:
    run = run_script(
        PREAMBLE
        + """
buffer = Buffer()
future = buffer.wait_for_transform_async('world', 'turtle1', Time())
print(future.done())
buffer.set_transform(pose(node, 'world', 'turtle2', 1.0), 'me')
print(future.done())
buffer.set_transform(pose(node, 'world', 'turtle1', 1.0), 'me')
print(future.done())
print(buffer.wait_for_transform_async('world', 'turtle1', Time()).done())
"""
    )
    assert run.stdout == "False\nFalse\nTrue\nTrue\n", run.stderr


def test_points_are_transformed_once_their_type_is_registered(run_script: Run) -> None:
    run = run_script(
        PREAMBLE
        + """
buffer = Buffer()
buffer.set_transform(pose(node, 'world', 'turtle1', 1.0, 2.0, math.pi / 2), 'me')
point = PointStamped()
point.header.frame_id = 'turtle1'
point.point.x = 1.0
try:
    buffer.transform(point, 'world')
except Exception as error:
    print(type(error).__name__, error.errstr)
import tf2_geometry_msgs
moved = buffer.transform(point, 'world')
print(moved.header.frame_id, round(moved.point.x, 6), round(moved.point.y, 6))
"""
    )
    assert run.stdout.splitlines() == [
        "TypeException Type <class 'geometry_msgs.msg._point_stamped.PointStamped'> "
        "is not loaded or supported",
        "world 1.0 3.0",
    ], run.stderr


def test_frames_of_the_world_are_heard(run_script: Run) -> None:
    pose = {"translation": {"x": 1.5}}
    stamped = {"header": {"frame_id": "world"}, "child_frame_id": "turtle1", "transform": pose}
    cdr = encode("tf2_msgs/msg/TFMessage", {"transforms": [stamped]})
    world = {
        "publishes": [["/tf", "tf2_msgs/msg/TFMessage"]],
        "subscribes": [],
        "services": [],
        "nodes": ["/turtlesim"],
    }
    run = run_script(
        PREAMBLE
        + """
buffer = Buffer()
listener = TransformListener(buffer, node)
rclpy.spin_once(node, timeout_sec=2.0)
print(buffer.lookup_transform('world', 'turtle1', Time()).transform.translation.x)
""",
        world=world,
        feed=[(1_000_000_000, "/tf", cdr)],
    )
    assert run.stdout == "1.5\n", run.stderr


@pytest.mark.parametrize(
    "name", ["tf2_ros.buffer", "tf2_ros.transform_listener", "tf2_ros.transform_broadcaster"]
)
def test_submodules_are_importable_by_their_names(run_script: Run, name: str) -> None:
    assert run_script(f"import {name}\nprint({name}.__name__)\n").stdout == f"{name}\n"


def test_the_package_passes_on_what_tutorials_take_from_it() -> None:
    import tf2_ros
    from geometry_msgs.msg import TransformStamped
    from rclpy.time import Time

    assert tf2_ros.TransformStamped is TransformStamped
    assert tf2_ros.Time is Time
    with pytest.raises(AttributeError, match="has no attribute 'Twist'"):
        tf2_ros.Twist  # noqa: B018


def test_modules_pass_on_the_messages_that_they_import(run_script: Run) -> None:
    source = """
from tf2_ros.transform_broadcaster import Node, TransformBroadcaster, TransformStamped
from tf2_geometry_msgs import PointStamped, PoseStamped, TransformStamped as theirs
import geometry_msgs.msg as messages
print(TransformStamped is theirs is messages.TransformStamped, PointStamped is messages.PointStamped)
del TransformStamped, Node
from tf2_ros import *
print(TransformStamped is theirs, Node.__name__, Time.__name__, Buffer.__name__)
"""
    assert run_script(source).stdout.splitlines() == ["True True", "True Node Time Buffer"]


@pytest.mark.parametrize(("distro", "sent"), [("humble", "base 1.0\narm 2.0\nbase 3.0\n"),
                                              ("jazzy", "base 1.0\nbase 1.0 arm 2.0\nbase 1.0 arm 2.0\n")])  # fmt: skip
def test_a_broadcaster_of_fixed_frames_on_jazzy_sends_the_first_of_each_frame_again(
    run_script: Run, distro: str, sent: str
) -> None:
    run = run_script(
        PREAMBLE
        + """
broadcaster = StaticTransformBroadcaster(node)
broadcaster.pub_tf.publish = lambda message: print(
    *(f'{t.child_frame_id} {t.transform.translation.x}' for t in message.transforms))
broadcaster.sendTransform(pose(node, 'map', 'base', 1.0))
broadcaster.sendTransform([pose(node, 'map', 'arm', 2.0)])
broadcaster.sendTransform(pose(node, 'map', 'base', 3.0))
""",
        distro=distro,
    )
    assert run.stdout == sent, run.stderr


@pytest.mark.parametrize(("distro", "kind"), [("humble", "bool"), ("jazzy", "TransformStamped")])
def test_what_a_future_of_a_transform_comes_to(run_script: Run, distro: str, kind: str) -> None:
    run = run_script(
        PREAMBLE
        + """
buffer = Buffer()
question = ('world', 'turtle1', Time())
full = ('world', Time(), 'turtle1', Time(), 'world')
early = [buffer.wait_for_transform_async(*question), buffer.wait_for_transform_full_async(*full)]
buffer.set_transform(pose(node, 'world', 'turtle1', 1.0), 'me')
late = [buffer.wait_for_transform_async(*question), buffer.wait_for_transform_full_async(*full)]
print({type(future.result()).__name__ for future in early + late})
""",
        distro=distro,
    )
    assert run.stdout == f"{{'{kind}'}}\n", run.stderr


@pytest.mark.parametrize(
    ("distro", "timeout", "said"),
    [
        ("humble", "1.0", "TypeError: (\"Can't compare duration with object of type: \", <class 'float'>)"),
        ("humble", "None", "TypeError: (\"Can't compare duration with object of type: \", <class 'NoneType'>)"),
        ("jazzy", "1.0", "TypeError: unsupported operand type(s) for +: 'Time' and 'float'"),
    ],
)
def test_a_timeout_that_is_no_duration_is_refused_as_upstream_does(
    run_script: Run, distro: str, timeout: str, said: str
) -> None:
    run = run_script(f"{PREAMBLE}Buffer().lookup_transform('a', 'b', Time(), {timeout})\n", distro=distro)
    assert said in run.stderr


def test_the_action_of_the_tutorial_of_jazzy_is_there(run_script: Run) -> None:
    script = "from custom_action_interfaces.action import Fibonacci\nprint(Fibonacci.Goal(order=3).order)\n"
    assert run_script(script, distro="jazzy").stdout == "3\n"
    assert "No module named 'custom_action_interfaces'" in run_script(script).stderr
