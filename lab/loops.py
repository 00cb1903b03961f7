"""CPU time a script's process needs for a long run: prints a table, asserts nothing.

Each script publishes at 100 Hz for 1,000 virtual seconds through the whole stack (sandbox, channel, car). CPU
time is what the kernel charges the confined process with, start and imports of the script included.
"""

from __future__ import annotations

import os

from rich.console import Console
from rich.table import Table

from grader.contracts.assignment import Assignment
from grader.contracts.grading import GradingJob
from grader.contracts.text import EMPTY
from grader.grading.slot import Slot, SlotConfig

VIRTUAL_S = float(os.environ.get("BENCH_VIRTUAL_S", "1000"))

_HEAD = """
import time
import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
rclpy.init()
node = rclpy.create_node("bench")
pub = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
msg = Twist()
msg.linear.x = 0.5
msg.angular.z = 0.5
"""
SCRIPTS = {
    "publish and sleep": """
while True:
    pub.publish(msg)
    time.sleep(0.01)
""",
    "timer and spin": """
node.create_timer(0.01, lambda: pub.publish(msg))
rclpy.spin(node)
""",
    "timer, spin and pose": """
node.create_subscription(Pose, "/turtle1/pose", lambda pose: None, 10)
node.create_timer(0.01, lambda: pub.publish(msg))
rclpy.spin(node)
""",
}


def main() -> None:
    """Measure and print."""
    assignment = Assignment(
        id="bench", version=1, order=0, title=EMPTY, brief=EMPTY, check="node", items=(), horizon_s=VIRTUAL_S
    )
    table = Table(title=f"{VIRTUAL_S:.0f} virtual s at 100 Hz")
    for heading in ("", "commands", "script's CPU", "wall"):
        table.add_column(heading, justify="right")
    with Slot(SlotConfig()) as slot:
        for name, body in SCRIPTS.items():
            source = (_HEAD + body).encode()
            graded = slot.grade(GradingJob(file_name="bench.py", source=source, assignment=assignment))
            outcome, measured = graded.report.runs[0].outcome, graded.measurements
            cpu, wall = f"{measured.jail_cpu_s:.2f} s", f"{measured.wall_s:.1f} s"
            table.add_row(name, f"{outcome.command_count}", cpu, wall)
    Console().print(table)


if __name__ == "__main__":
    main()
