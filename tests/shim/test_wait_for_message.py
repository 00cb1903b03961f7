"""wait_for_message and guard conditions."""

from textwrap import dedent

PREFIX = """
import threading, time
import rclpy
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("n")
"""


def test_a_message_or_a_timeout(run_script):
    run = run_script(
        PREFIX
        + dedent("""
            publisher = node.create_publisher(String, "t", 10)
            def later():
                time.sleep(1.5)
                publisher.publish(String(data="hello"))
            threading.Thread(target=later).start()
            print(wait_for_message(String, node, "t", time_to_wait=1))
            print(wait_for_message(String, node, "t"))
            print(round(time.time() % 10, 1), len(list(node.subscriptions)))
        """)
    )
    assert run.stdout.splitlines() == [
        "(False, None)",
        "(True, std_msgs.msg.String(data='hello'))",
        "1.5 0",
    ]


def test_nothing_can_come(run_script):
    run = run_script(PREFIX + "wait_for_message(String, node, 't')\n")
    assert run.exit["reason"] == 2
    assert "wait_for_message() waits for a message on '/t'" in run.exit["text"]


def test_guard_conditions_wake_the_spin(run_script):
    run = run_script(
        PREFIX
        + dedent("""
            guard = node.create_guard_condition(lambda: (print(round(time.time() % 10, 1)), rclpy.shutdown()))
            threading.Timer(2.5, guard.trigger).start()
            rclpy.spin(node)
            print(node.destroy_guard_condition(guard), node.destroy_guard_condition(guard))
            try:
                guard.trigger()
            except RuntimeError as error:
                print(type(error).__name__)
        """)
    )
    assert run.stdout.split() == ["2.5", "True", "False", "InvalidHandle"]


def test_a_minute_of_poses_can_be_waited_for_one_by_one(run_script):
    run = run_script(
        PREFIX
        + dedent("""
            for _ in range(3750):
                wait_for_message(String, node, "t", time_to_wait=0.001)
            print(len(list(node.subscriptions)))
        """)
    )
    assert run.stdout.split() == ["0"]
