"""Publishers and subscriptions: copies, queues, QoS matching, the world's topics."""

import struct
from textwrap import dedent

import pytest

PREFIX = """
import time
import rclpy
from rclpy.node import Node
from rclpy.qos import *
from std_msgs.msg import String, Float64MultiArray
from geometry_msgs.msg import Twist
rclpy.init()
node = Node("n")
def spin(times):
    for _ in range(times):
        rclpy.spin_once(node, timeout_sec=0.01)
"""


def run_lines(run_script, source, **options):
    run = run_script(PREFIX + dedent(source), **options)
    assert run.exit["reason"] == 0, run.stderr
    return run.stdout.splitlines()


def test_a_message_is_copied_when_it_is_published(run_script):
    source = """
        publisher = node.create_publisher(Float64MultiArray, "t", 10)
        node.create_subscription(Float64MultiArray, "t", lambda m: (print(m.data), m.data.append(9.0)), 10)
        node.create_subscription(Float64MultiArray, "t", lambda m: print(m.data), 10)
        message = Float64MultiArray(data=[1.0])
        publisher.publish(message)
        message.data[0] = 2.0
        spin(4)
    """
    assert run_lines(run_script, source) == ["array('d', [1.0])"] * 2


def test_the_queue_keeps_the_latest(run_script):
    source = """
        publisher = node.create_publisher(String, "t", 10)
        node.create_subscription(String, "t", lambda m: print(m.data), 2)
        for text in "abcd":
            publisher.publish(String(data=text))
        spin(8)
    """
    assert run_lines(run_script, source) == ["c", "d"]


def test_types_and_relative_names_must_agree(run_script):
    source = """
        other = Node("other", namespace="ns")
        publisher = node.create_publisher(String, "t", 10)
        node.create_subscription(Float64MultiArray, "t", lambda m: print("wrong type"), 10)
        other.create_subscription(String, "t", lambda m: print("wrong name"), 10)
        other.create_subscription(String, "/t", lambda m: print("right"), 10)
        publisher.publish(String())
        spin(2)
        rclpy.spin_once(other, timeout_sec=0.01)
        print(publisher.get_subscription_count(), publisher.topic_name)
    """
    assert run_lines(run_script, source) == ["right", "1 /t"]


def test_latched_messages_reach_late_listeners(run_script):
    source = """
        latched = QoSProfile(depth=2, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        publisher = node.create_publisher(String, "t", latched)
        for text in "abc":
            publisher.publish(String(data=text))
        node.create_subscription(String, "t", lambda m: print("latched", m.data), latched)
        node.create_subscription(String, "t", lambda m: print("volatile", m.data), 10)
        spin(6)
    """
    assert run_lines(run_script, source) == ["latched b", "latched c"]


def test_raw_subscriptions_and_serialised_messages(run_script):
    source = """
        from rclpy.serialization import serialize_message
        publisher = node.create_publisher(String, "t", 10)
        node.create_subscription(String, "t", print, 10, raw=True)
        publisher.publish(serialize_message(String(data="a")))
        spin(2)
    """
    assert run_lines(run_script, source) == [r"b'\x00\x01\x00\x00\x02\x00\x00\x00a\x00'"]


def test_incompatible_qos_delivers_nothing_and_warns_both_sides(run_script):
    run = run_script(
        PREFIX
        + dedent("""
            best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
            publisher = node.create_publisher(String, "t", best_effort)
            node.create_subscription(String, "t", print, 10)
            publisher.publish(String())
            spin(4)
            print(publisher.get_subscription_count())
        """)
    )
    assert run.stdout == "0\n"
    warnings = [line.partition("]: ")[2] for line in run.stderr.splitlines()]
    assert sorted(warnings) == [
        "New publisher discovered on topic 't', offering incompatible QoS. No messages will be received "
        "from it. Last incompatible policy: RELIABILITY",
        "New subscription discovered on topic 't', requesting incompatible QoS. No messages will be sent "
        "to it. Last incompatible policy: RELIABILITY",
    ]


def test_the_turtle_does_not_hear_best_effort_commands(run_script):
    run = run_script(
        PREFIX
        + dedent("""
            publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", qos_profile_sensor_data)
            time.sleep(1)
            publisher.publish(Twist())
            print(publisher.get_subscription_count())
        """)
    )
    assert (run.stdout, run.published("/turtle1/cmd_vel")) == ("0\n", [])
    assert run.notes == [("incompatible_qos", "/turtle1/cmd_vel")]


def test_commands_reach_the_episode_at_their_instant(run_script):
    run = run_script(
        PREFIX
        + dedent("""
            publisher = node.create_publisher(Twist, "turtle1/cmd_vel", 10)
            message = Twist()
            message.angular.z = 2.0
            node.create_timer(0.5, lambda: publisher.publish(message))
            rclpy.spin(node)
        """),
        horizon_s=1.2,
    )
    command = b"\0\1\0\0" + struct.pack("<6d", 0, 0, 0, 0, 0, 2)
    sent = [(t_ns // 1_000_000, cdr) for t_ns, cdr in run.published("/turtle1/cmd_vel")]
    assert sent == [(500, command), (1000, command)]


def test_the_worlds_messages_arrive_at_their_instant(run_script):
    run = run_script(
        PREFIX
        + dedent("""
            from turtlesim.msg import Pose
            node.create_subscription(Pose, "/turtle1/pose", lambda p: print(round(time.time() % 100, 3), p.x), 10)
            rclpy.spin(node)
        """),
        horizon_s=1,
        feed=[
            (16_000_000, "/turtle1/pose", b"\0\1\0\0" + struct.pack("<5f", 5.5, 0, 0, 0, 0)),
            (32_000_000, "/turtle1/pose", b"\0\1\0\0" + struct.pack("<5f", 6.5, 0, 0, 0, 0)),
        ],
    )
    assert run.stdout == "0.016 5.5\n0.032 6.5\n"


@pytest.mark.parametrize("heard", [True, False])
@pytest.mark.parametrize("wrong", ["Pose()", "Own()", "'pose'"])
def test_a_wrong_type_in_a_list_aborts_the_process(run_script, heard, wrong):
    """Whoever listens: rosidl_generator_py's C code asserts the type (_msg_support.c.em:190)."""
    source = """
        from geometry_msgs.msg import Pose, PoseStamped
        from nav_msgs.msg import Path
        publisher = node.create_publisher(Path, "path", 10)
        path = Path(poses=[PoseStamped()])
        publisher.publish(path)
        class Own(PoseStamped):
            pass
        path.poses.append(WRONG)
        print("filled")
        try:
            publisher.publish(path)
        finally:
            print("never")
    """
    subscription = 'node.create_subscription(Path, "path", print, 10)\n' if heard else ""
    run = run_script(
        PREFIX + "from nav_msgs.msg import Path\n" + subscription + dedent(source).replace("WRONG", wrong)
    )
    assert run.stdout == "filled\n"
    assert 'Assertion `strncmp("geometry_msgs.msg._pose_stamped.PoseStamped"' in run.stderr
    assert (run.exit["type"], run.exit["code"]) == ("Aborted", 134)
    assert run.exit["message"].startswith("field 'poses' of geometry_msgs/msg/PoseStamped: ")


@pytest.mark.parametrize("heard", [True, False])
@pytest.mark.parametrize(
    ("of", "field", "wrong"),
    [
        ("rcl_interfaces.msg.ParameterValue", "bool_array_value", "1"),
        ("rcl_interfaces.msg.ParameterValue", "byte_array_value", "1"),
        ("std_msgs.msg.ByteMultiArray", "data", "bytearray(2)"),
        ("std_msgs.msg.ByteMultiArray", "data", "'a'"),
    ],
)
def test_a_list_of_truth_values_or_bytes_holds_nothing_else(run_script, heard, of, field, wrong):
    source = f"""
        import rcl_interfaces.msg, std_msgs.msg
        publisher = node.create_publisher({of}, "list", 10)
        if {heard}:
            node.create_subscription({of}, "list", print, 10)
        message = {of}()
        message.{field}.append({wrong})
        publisher.publish(message)
        print("never")
    """
    run = run_script(PREFIX + dedent(source))
    assert (run.stdout, run.exit["type"]) == ("", "Aborted")
    assert run.exit["message"].startswith(f"field '{field}' of ")


def test_of_bytes_in_a_list_the_first_leaves(run_script):
    """_msg_support.c.em:352 takes ``PyBytes_AS_STRING(item)[0]``, which of no bytes is the NUL behind them."""
    source = """
        from std_msgs.msg import ByteMultiArray
        node.create_subscription(ByteMultiArray, "list", lambda heard: print(heard.data), 10)
        node.create_publisher(ByteMultiArray, "list", 10).publish(ByteMultiArray(data=[b"ab", b"", b"c"]))
        spin(1)
    """
    assert run_lines(run_script, source) == [r"[b'a', b'\x00', b'c']"]


def test_a_derived_message_has_a_repr_and_aborts_the_process(run_script):
    """The generated C code compares the names of class and module (_msg_support.c.em:190)."""
    source = """
        class Drive(Twist):
            pass
        print(Drive())
        node.create_publisher(Twist, "/turtle1/cmd_vel", 10).publish(Drive())
    """
    run = run_script(PREFIX + dedent(source))
    vector = "geometry_msgs.msg.Vector3(x=0.0, y=0.0, z=0.0)"
    assert run.stdout == f"Drive(linear={vector}, angular={vector})\n"
    assert (run.exit["type"], run.exit["code"]) == ("Aborted", 134)
    assert run.exit["message"].startswith("field '__class__' of geometry_msgs/msg/Twist: ")


def test_a_derived_message_in_a_message_aborts_the_process(run_script):
    source = """
        from geometry_msgs.msg import Vector3
        class Velocity(Vector3):
            pass
        command = Twist(linear=Velocity(x=1.0))
        node.create_publisher(Twist, "/turtle1/cmd_vel", 10).publish(command)
    """
    run = run_script(PREFIX + dedent(source))
    assert (run.exit["type"], run.exit["code"]) == ("Aborted", 134)
    assert run.exit["message"].startswith("field 'linear' of geometry_msgs/msg/Vector3: ")


def test_only_the_first_messages_that_nobody_hears_are_looked_at(run_script):
    """A path that grows at each tick would take time in the square of its length."""
    source = """
        from nav_msgs.msg import Path
        publisher = node.create_publisher(Path, "path", 10)
        for _ in range(10):
            publisher.publish(Path())
        path = Path()
        path.poses.append("no pose")
        publisher.publish(path)
        print("passed")
    """
    assert run_lines(run_script, source) == ["passed"]
