"""Rates."""

from textwrap import dedent

PREFIX = """
import threading, time
import rclpy
rclpy.init()
node = rclpy.create_node("n")
"""


def test_rate_with_a_spinning_thread(run_script):
    run = run_script(
        PREFIX
        + dedent("""
            threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
            rate = node.create_rate(4)
            for _ in range(3):
                rate.sleep()
                print(round(time.time() * 1000) % 10_000)
        """)
    )
    assert run.stdout.split() == ["250", "500", "750"]
    assert run.exit["reason"] == 0


def test_a_lone_sleep_is_a_deadlock(run_script):
    run = run_script(PREFIX + "time.sleep(2)\nnode.create_rate(2).sleep()\n")
    assert run.exit["reason"] == 2
    assert run.exit["t_ns"] // 1_000_000 == 2_000
    assert "rate.sleep() waits for a timer of its node" in run.exit["text"]
    assert "main thread, line 7" in run.exit["text"]


def test_frequencies_and_destruction(run_script):
    run = run_script(
        PREFIX
        + dedent("""
            for frequency in (0, -1.0, None):
                try:
                    node.create_rate(frequency)
                except Exception as error:
                    print(type(error).__name__, error)
            rate = node.create_rate(1)
            print(node.destroy_rate(rate))
            try:
                rate.sleep()
            except RuntimeError as error:
                print(error)
            rate = node.create_rate(1)
            rclpy.shutdown()
            try:
                rate.sleep()
            except Exception as error:
                print(type(error).__name__, error)
        """)
    )
    assert run.stdout.splitlines() == [
        "ValueError frequency must be > 0",
        "ValueError frequency must be > 0",
        "TypeError '<=' not supported between instances of 'NoneType' and 'int'",
        "True",
        "Rate cannot sleep because it has been destroyed",
        "ROSInterruptException rclpy.shutdown() has been called",
    ]
