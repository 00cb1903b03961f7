"""`elapsed >= T` in a periodic tick holds after T, not one period later, however the ticks are made."""

from collections.abc import Callable
from typing import Any

import pytest

RunScript = Callable[..., Any]

HEAD = """\
import threading, time
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

class Phases(Node):
    def __init__(self):
        super().__init__('phases')
        self.pub = self.create_publisher(String, 'spoken', 10)
        self.ticks = 0
        self.begin = self.now()
    def now(self):
        return {clock}
    def tick(self):
        self.ticks += 1
        self.pub.publish(String())
        if self.now() - self.begin >= {phase_s}:
            print(self.ticks)
            self.pub.publish(String())
            self.ticks, self.begin = 0, self.now()

rclpy.init()
node = Phases()
"""

LOOPS = {
    "timer": "node.create_timer({period_s}, node.tick)\nrclpy.spin(node)\n",
    "threads": "node.create_timer({period_s}, node.tick)\nexecutor = MultiThreadedExecutor()\n"
    "executor.add_node(node)\nexecutor.spin()\n",
    "rate": "threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()\n"
    "rate = node.create_rate(1 / {period_s})\nwhile rclpy.ok():\n    rate.sleep()\n    node.tick()\n",
    "spin_once": "rate = node.create_rate(1 / {period_s})\nwhile rclpy.ok():\n    rclpy.spin_once(node)\n"
    "    node.tick()\n",
}

CLOCKS = {
    "ros": "self.get_clock().now().nanoseconds / 1e9",
    "time": "time.time()",
    "monotonic": "time.monotonic()",
}


@pytest.mark.parametrize("loop", LOOPS.values(), ids=LOOPS)
@pytest.mark.parametrize("clock", CLOCKS.values(), ids=CLOCKS)
def test_a_phase_takes_a_whole_number_of_periods(run_script: RunScript, loop: str, clock: str) -> None:
    source = HEAD + loop
    run = run_script(source.format(clock=clock, phase_s=2.0, period_s=0.1), horizon_s=20.5)
    assert run.stdout.split() == ["20"] * 10


def test_a_fast_tick_is_at_most_one_period_long(run_script: RunScript) -> None:
    source = HEAD + LOOPS["timer"]
    run = run_script(source.format(clock=CLOCKS["ros"], phase_s=1.0, period_s=0.01), horizon_s=30.0)
    assert set(run.stdout.split()) <= {"100", "101"}
    assert run.stdout.split().count("100") > 20


def test_ticks_stay_in_phase(run_script: RunScript) -> None:
    run = run_script(
        "import time\nimport rclpy\nrclpy.init()\nnode = rclpy.create_node('n')\nn = 0\n"
        "def tick():\n    global n\n    n += 1\n    for _ in range(300):\n        time.time()\n"
        "    late = time.time() - 1_700_000_000 - n * 0.05\n    assert 0 <= late < 0.0104, (n, late)\n"
        "    print(n)\nnode.create_timer(0.05, tick)\nrclpy.spin(node)\n",
        horizon_s=20.01,
    )
    assert run.exit["type"] == "", run.stderr
    assert run.stdout.split()[-1] == "400"
