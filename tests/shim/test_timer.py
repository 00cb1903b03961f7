"""Timers: phase, cancelling, periods; exact virtual times."""

from textwrap import dedent

PREFIX = """
import time
import rclpy
from rclpy.node import Node
rclpy.init()
node = Node("n")
def now_ms():
    return round(time.time() * 1000) - 1_700_000_000_000
"""


def run_lines(run_script, source, **options):
    run = run_script(PREFIX + dedent(source), **options)
    assert run.exit["type"] == "", run.stderr
    return run.stdout.split()


def test_first_call_after_one_period_and_no_drift(run_script):
    source = """
        node.create_timer(0.25, lambda: print(now_ms()))
        rclpy.spin(node)
    """
    assert run_lines(run_script, source, horizon_s=1.3) == ["250", "500", "750", "1000", "1250"]


def test_a_late_timer_skips_to_its_next_multiple(run_script):
    source = """
        def tick():
            print(now_ms())
            time.sleep(0.25)
        node.create_timer(0.1, tick)
        rclpy.spin(node)
    """
    assert run_lines(run_script, source, horizon_s=1.2) == ["100", "350", "600", "850", "1100"]


def test_a_new_period_counts_from_the_call_already_planned(run_script):
    source = """
        def tick():
            print(now_ms())
            timer.timer_period_ns = 300_000_000
        timer = node.create_timer(0.1, tick)
        rclpy.spin(node)
    """
    assert run_lines(run_script, source, horizon_s=0.9) == ["100", "200", "500", "800"]


def test_cancel_and_reset(run_script):
    source = """
        timer = node.create_timer(0.1, lambda: print(now_ms()))
        rclpy.spin_once(node)
        timer.cancel()
        print(timer.is_canceled(), timer.time_until_next_call())
        rclpy.spin_once(node, timeout_sec=1.0)
        print(now_ms())
        timer.reset()
        rclpy.spin_once(node)
    """
    assert run_lines(run_script, source) == ["100", "True", "None", "1100", "1200"]


def test_invalid_periods(run_script):
    source = """
        for period in (-1, "x", None, 1e12, 9.2e9):
            try:
                node.create_timer(period, print)
            except Exception as error:
                print(type(error).__name__)
    """
    assert run_lines(run_script, source) == ["RCLError", "ValueError", "TypeError", "TypeError"]


def test_a_period_of_more_than_64_bits_is_no_argument(run_script):
    for distro, last in (("humble", "arg2: int)"), ("jazzy", "arg2: int, arg3: bool)")):
        run = run_script(PREFIX + "node.create_timer(1e12, print)", distro=distro)
        assert "__init__(): incompatible constructor arguments" in run.stderr
        assert last in run.stderr


def test_period_zero_lets_time_pass(run_script):
    source = """
        calls = []
        node.create_timer(0, lambda: calls.append(1))
        try:
            rclpy.spin(node)
        except KeyboardInterrupt:
            print(len(calls) > 100)
    """
    assert run_lines(run_script, source, horizon_s=0.01) == ["True"]


def test_timers_subscriptions_and_so_on_are_served_in_upstreams_order(run_script):
    source = """
        from std_msgs.msg import String
        from std_srvs.srv import Empty
        publisher = node.create_publisher(String, "t", 10)
        def tick(name):
            print(name)
        node.create_service(Empty, "s", lambda q, a: (print("service"), a)[1])
        node.create_subscription(String, "t", lambda m: print("message"), 10)
        guard = node.create_guard_condition(lambda: print("guard"))
        node.create_timer(1.0, lambda: print("first"))
        node.create_timer(1.0, lambda: print("second"))
        client = node.create_client(Empty, "s")
        time.sleep(1.5)
        client.call_async(Empty.Request())
        guard.trigger()
        publisher.publish(String())
        for _ in range(5):
            rclpy.spin_once(node, timeout_sec=0.1)
    """
    assert run_lines(run_script, source) == ["first", "second", "message", "guard", "service"]


def test_timers_without_end_take_virtual_time(run_script):
    """Otherwise a callback that makes a timer each time would double them each period, at hardly any time."""
    source = """
        made = 1
        def tick():
            global made
            made += 1
            node.create_timer(0.1, tick)
        node.create_timer(0.1, tick)
        try:
            rclpy.spin(node)
        except KeyboardInterrupt:
            print(made)
    """
    (made,) = run_lines(run_script, source, horizon_s=2.0)
    assert 10_000 < int(made) < 2**16
    (few,) = run_lines(run_script, source, horizon_s=1.25)
    assert int(few) == 2**12
