"""What typical mistakes raise on Humble, texts included."""

import pytest

PREFIX = """
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
rclpy.init()
node = Node("n")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
msg = Twist()
"""

CASES = {
    "int in a float field": ("msg.linear.x = 1", "AssertionError", "The 'x' field must be of type 'float'"),
    "text in a float field": (
        "msg.angular.z = '1'",
        "AssertionError",
        "The 'z' field must be of type 'float'",
    ),
    "number for a message": (
        "Twist(linear=1.0)",
        "AssertionError",
        "The 'linear' field must be a sub message of type 'Vector3'",
    ),
    "unknown keyword": (
        "Twist(liner=1.0)",
        "AssertionError",
        "Invalid arguments passed to constructor: liner",
    ),
    "misspelled field": ("msg.liner.x = 1.0", "AttributeError", "'Twist' object has no attribute 'liner'"),
    "publisher without qos": (
        "node.create_publisher(Twist, 'a')",
        "TypeError",
        "Node.create_publisher() missing 1 required positional argument: 'qos_profile'",
    ),
    "class for a node": ("rclpy.spin(Node)", "TypeError", "'property' object is not iterable"),
    "called instead of named": (
        "node.create_timer(0.1, publisher.publish(msg))\nrclpy.spin(node)",
        "TypeError",
        "'NoneType' object is not callable",
    ),
    "qos of a wrong type": (
        "node.create_publisher(Twist, 'a', '10')",
        "TypeError",
        "Expected QoSProfile or int, but received <class 'str'>",
    ),
    "message for its class": (
        "other = node.create_publisher(Twist(), 'a', 10)\nother.publish(msg)",
        "TypeError",
        "isinstance() arg 2 must be a type, a tuple of types, or a union",
    ),
    "negative depth": (
        "node.create_publisher(Twist, 'a', -1)",
        "ValueError",
        "history depth must be greater than or equal to zero",
    ),
    "publish of something else": (
        "publisher.publish('hi')",
        "TypeError",
        "Expected <class 'geometry_msgs.msg._twist.Twist'>, got <class 'str'>",
    ),
    "callback without an argument": (
        "node.create_subscription(Twist, '/turtle1/cmd_vel', lambda: None, 10)\n"
        "publisher.publish(msg)\nrclpy.spin(node)",
        "TypeError",
        "<lambda>() takes 0 positional arguments but 1 was given",
    ),
    "publish after shutdown": (
        "rclpy.shutdown()\npublisher.publish(msg)",
        "RCLError",
        "Failed to publish: publisher's context is invalid, at ./src/rcl/publisher.c:389",
    ),
    "publish after destruction": (
        "node.destroy_publisher(publisher)\npublisher.publish(msg)",
        "InvalidHandle",
        "cannot use Destroyable because destruction was requested",
    ),
    "double shutdown": (
        "rclpy.shutdown()\nrclpy.shutdown()",
        "RuntimeError",
        "Context must be initialized before it can be shutdown",
    ),
    "input without stdin": ("input()", "EOFError", "EOF when reading a line"),
    "printf style log": (
        "node.get_logger().info('%d', 5)",
        "TypeError",
        "RcutilsLogger.info() takes 2 positional arguments but 3 were given",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_mistake(run_script, name):
    source, kind, message = CASES[name]
    run = run_script(PREFIX + source + "\n")
    assert (run.exit["type"], run.exit["code"]) == (kind, 1)
    assert run.exit["message"] == message
    assert run.exit["line"] == 8 + len(source.splitlines()) or name == "callback without an argument"


def test_logging_a_number(run_script):
    run = run_script(PREFIX + "node.get_logger().info(5)\n")
    assert run.exit["type"] == "TypeError"
    assert run.exit["message"].startswith("rclpy_logging_rcutils_log(): incompatible function arguments.")
    assert ", 'n', 5, " in run.exit["message"]


def test_topic_and_type_in_the_order_of_ros_1(run_script):
    run = run_script(PREFIX + "node.create_publisher('/turtle1/cmd_vel', Twist, 10)\n")
    assert run.exit["type"] == "TypeError"
    assert run.exit["message"].startswith("rclpy_resolve_name(): incompatible function arguments.")
    assert run.exit["message"].endswith(">, <class 'geometry_msgs.msg._twist.Twist'>, False, False")


def test_a_subscription_takes_a_message_for_its_class(run_script):
    source = "node.create_subscription(Twist(), '/turtle1/cmd_vel', print, 10)\npublisher.publish(msg)\n"
    run = run_script(PREFIX + source + "rclpy.spin_once(node)\n")
    assert run.stdout.startswith("geometry_msgs.msg.Twist(")


def test_forgotten_spin_ends_at_once(run_script):
    run = run_script(PREFIX + "node.create_timer(0.1, print)\n")
    assert (run.exit["reason"], run.exit["t_ns"], run.published("/turtle1/cmd_vel")) == (0, 0, [])


def test_a_script_that_relies_on_instant_discovery_is_told(run_script):
    run = run_script(PREFIX + "msg.linear.x = 1.0\npublisher.publish(msg)\n")
    assert run.notes == [("discovery", "/turtle1/cmd_vel")]
    patient = run_script(PREFIX + "import time\ntime.sleep(1)\npublisher.publish(msg)\n")
    assert patient.notes == []
    waits = "import time\nwhile publisher.get_subscription_count() < 1:\n    time.sleep(0.1)\n"
    waiting = run_script(PREFIX + waits + "publisher.publish(msg)\n")
    assert waiting.notes == []
    waits = waits.replace(
        "publisher.get_subscription_count()", "node.count_subscribers(publisher.topic_name)"
    )
    assert run_script(PREFIX + waits + "publisher.publish(msg)\n").notes == []


def test_who_waits_in_a_loop_for_a_listener_that_never_comes_gets_ctrl_c(run_script):
    run = run_script(PREFIX + "while node.count_subscribers('/turtle1/cmd_vell') == 0:\n    pass\n")
    assert run.exit["after_interrupt"]
    assert [code for code, _ in run.notes] == ["interrupted"]


def test_a_publisher_on_the_wrong_topic_moves_nothing(run_script):
    source = (
        "wrong = node.create_publisher(Twist, '/cmd_vel', 10)\nfor _ in range(150):\n    wrong.publish(msg)\n"
    )
    run = run_script(PREFIX + source)
    assert [cdr for _, cdr in run.published("/cmd_vel")] == [b"", b""]
    assert run.published("/turtle1/cmd_vel") == []
