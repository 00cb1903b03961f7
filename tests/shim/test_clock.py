"""Clocks, times and durations."""

from textwrap import dedent

PREFIX = """
import time
import rclpy
from rclpy.node import Node
from rclpy.clock import *
from rclpy.time import Time
from rclpy.duration import Duration
def attempt(call):
    try:
        print(call())
    except Exception as error:
        print(type(error).__name__, error)
"""


def run_lines(run_script, source, **options):
    run = run_script(PREFIX + dedent(source), **options)
    assert run.exit["reason"] == 0, run.stderr
    return run.stdout.splitlines()


def test_arithmetic(run_script):
    source = """
        early, late = Time(seconds=1, nanoseconds=5), Time(seconds=2.5)
        print(early.seconds_nanoseconds(), late - early, (early - late).nanoseconds, late - Duration(seconds=1))
        print(early < late, early == Time(seconds=1, nanoseconds=5), Duration(seconds=1) < Duration(seconds=2))
        attempt(lambda: Time(seconds=-1))
        attempt(lambda: Time(1))
        attempt(lambda: early - Duration(seconds=2))
        attempt(lambda: early < Time(clock_type=ClockType.ROS_TIME))
        attempt(lambda: early == 3)
        attempt(lambda: Duration(seconds=1) + Duration(seconds=1))
        attempt(lambda: hash(early))
        half = Duration(seconds=-0.5).to_msg()
        print(late.to_msg(), Time.from_msg(late.to_msg()).nanoseconds, Duration.from_msg(half))
    """
    assert run_lines(run_script, source) == [
        "(1, 5) 1499999995 nanoseconds -1499999995 Time(nanoseconds=1500000000, clock_type=SYSTEM_TIME)",
        "True True True",
        "ValueError Seconds value must not be negative",
        "TypeError Time.__init__() takes 1 positional argument but 2 were given",
        "ValueError Subtraction leads to negative time.",
        "TypeError Can't compare times with different clock types",
        """TypeError ("Can't compare time with object of type: ", <class 'int'>)""",
        "TypeError unsupported operand type(s) for +: 'Duration' and 'Duration'",
        "TypeError unhashable type: 'Time'",
        "builtin_interfaces.msg.Time(sec=2, nanosec=500000000) 2500000000 -500000000 nanoseconds",
    ]


def test_clocks_agree_with_the_time_module(run_script):
    source = """
        for kind in (ClockType.ROS_TIME, ClockType.SYSTEM_TIME):
            clock = Clock(clock_type=kind)
            print(clock, abs(clock.now().nanoseconds - time.time_ns()) <= 2000)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        print(abs(steady.now().nanoseconds - time.monotonic_ns()) <= 2000)
        attempt(lambda: Clock(clock_type=1))
    """
    assert run_lines(run_script, source) == [
        "Clock(clock_type=ROS_TIME) True",
        "Clock(clock_type=SYSTEM_TIME) True",
        "True",
        "TypeError Clock type must be a ClockType enum",
    ]


def test_sleeping(run_script):
    source = """
        clock = Clock()
        attempt(lambda: clock.sleep_for(Duration(seconds=1)))
        rclpy.init()
        start = time.time()
        print(clock.sleep_for(Duration(seconds=1.5)), round(time.time() - start, 3))
        print(clock.sleep_until(clock.now() + Duration(seconds=1)), round(time.time() - start, 3))
        attempt(lambda: clock.sleep_until(Time(clock_type=ClockType.STEADY_TIME)))
    """
    assert run_lines(run_script, source) == [
        "NotInitializedException rclpy.init() has not been called",
        "True 1.5",
        "True 2.5",
        "ValueError until's clock type does not match this clock's type",
    ]


def test_use_sim_time_follows_the_clock_topic(run_script):
    source = """
        from rosgraph_msgs.msg import Clock as ClockMsg
        rclpy.init()
        node = Node("n", parameter_overrides=[rclpy.Parameter("use_sim_time", value=True)])
        publisher = node.create_publisher(ClockMsg, "/clock", 10)
        node.create_timer(1.0, lambda: print("tick", node.get_clock().now().nanoseconds))
        print(node.get_clock().now().nanoseconds)
        for second in (1, 2, 3):
            message = ClockMsg()
            message.clock.sec = second
            publisher.publish(message)
            for _ in range(3):
                rclpy.spin_once(node, timeout_sec=0.1)
    """
    out = run_lines(run_script, source)
    assert out == ["0", "tick 1000000000", "tick 2000000000", "tick 3000000000"]


def test_jump_callbacks(run_script):
    source = """
        clock = ROSClock()
        threshold = JumpThreshold(min_forward=Duration(seconds=1), min_backward=None, on_clock_change=True)
        jumps = []
        handle = clock.create_jump_callback(
            threshold, pre_callback=lambda: jumps.append("before"),
            post_callback=lambda j: jumps.append((j.clock_change.name, j.delta.nanoseconds)))
        clock._set_ros_time_is_active(True)
        clock.set_ros_time_override(Time(seconds=0.5))
        clock.set_ros_time_override(Time(seconds=2))
        print(jumps)
        attempt(lambda: JumpThreshold(min_forward=None, min_backward=Duration(seconds=1)))
    """
    assert run_lines(run_script, source) == [
        "['before', ('ROS_TIME_ACTIVATED', 0), 'before', ('ROS_TIME_NO_CHANGE', 1500000000)]",
        "ValueError min_backward must be a negative non-zero duration",
    ]
