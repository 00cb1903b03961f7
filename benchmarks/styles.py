"""What the styles in which scripts are written cost: 60 virtual seconds of each, and the solutions.

A style that asks, waits or listens often must not cost much more than the lesson's square, which only sleeps. The
script's CPU time says what the imitation of rclpy needs, the wall time also what the two processes wait for each
other. `STYLES` picks styles by a part of their name.
"""

from __future__ import annotations

import os
import statistics
from dataclasses import replace

from rich.console import Console
from rich.table import Table

from grader.catalog import Catalog
from grader.contracts.assignment import Assignment, World
from grader.contracts.grading import GradingJob, GradingResult
from grader.grading.slot import Slot, SlotConfig

ROUNDS = int(os.environ.get("BENCH_STYLE_ROUNDS", "3"))
CHOSEN = os.environ.get("STYLES", "")

_HEAD = """
import math, threading, time
import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from std_msgs.msg import Int32
from turtlesim.msg import Pose
rclpy.init()
node = rclpy.create_node('style')
publisher = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
def listen(): node.create_subscription(Pose, '/turtle1/pose', lambda pose: None, 10)
"""
_NODES = """
executor, nodes = SingleThreadedExecutor(), []
for i in range(50):
    one = rclpy.create_node(f'n{i}')
    out = one.create_publisher(Int32, f't{i % 5}', 10)
    one.create_subscription(Int32, f't{i % 5}', lambda m: None, 10)
    one.create_timer(0.1, lambda out=out: out.publish(Int32()))
    executor.add_node(one); nodes.append(one)
executor.spin()
"""
_AWAITED = """
import asyncio
done = rclpy.Future(); node.create_timer(50.0, lambda: done.set_result(1))
async def spinning():
    while rclpy.ok(): rclpy.spin_once(node, timeout_sec=0.01); await asyncio.sleep(0.001)
async def main(): asyncio.create_task(spinning()); await done
asyncio.run(main())
"""
_CLOSED_LOOP = """
state = dict(turning=False, turned=0.0, gone=0.0, last=None)
def on_pose(pose):
    last, state['last'] = state['last'], pose
    if last is None: return
    if state['turning']:
        state['turned'] += math.remainder(pose.theta - last.theta, math.tau)
        if state['turned'] >= math.pi / 2: state.update(turning=False, gone=0.0)
    else:
        state['gone'] += math.dist((pose.x, pose.y), (last.x, last.y))
        if state['gone'] >= 2.0: state.update(turning=True, turned=0.0)
    twist = Twist()
    twist.linear.x, twist.angular.z = (0.0, 1.0) if state['turning'] else (1.0, 0.0)
    publisher.publish(twist)
node.create_subscription(Pose, '/turtle1/pose', on_pose, 10)
rclpy.spin(node)
"""
STYLES = {
    "idle": "rclpy.spin(node)\n",
    "sleeps 1 ms": "while rclpy.ok(): time.sleep(0.001)\n",
    "busy on a clock": "while True: node.get_clock().now()\n",
    "polls": "while rclpy.ok(): rclpy.spin_once(node, timeout_sec=0)\n",
    "timer of 1 kHz": "node.create_timer(0.001, lambda: None); rclpy.spin(node)\n",
    "timer of 10 kHz": "node.create_timer(0.0001, lambda: None); rclpy.spin(node)\n",
    "publishes at 1 kHz": "node.create_timer(0.001, lambda: publisher.publish(Twist())); rclpy.spin(node)\n",
    "logs at 1 kHz": "node.create_timer(0.001, lambda: node.get_logger().info('hello')); rclpy.spin(node)\n",
    "listens": "listen(); rclpy.spin(node)\n",
    "listens and polls": "listen()\nwhile rclpy.ok(): rclpy.spin_once(node, timeout_sec=0)\n",
    "listens, waits 1 ms": "listen()\nwhile rclpy.ok(): rclpy.spin_once(node, timeout_sec=0.001)\n",
    "listens in threads": "listen(); node.create_timer(0.01, lambda: publisher.publish(Twist()))\n"
    "executor = MultiThreadedExecutor(); executor.add_node(node); executor.spin()\n",
    "rate beside a thread": "threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()\n"
    "rate = node.create_rate(100)\nwhile rclpy.ok(): publisher.publish(Twist()); rate.sleep()\n",
    "50 nodes": _NODES,
    "future in asyncio": _AWAITED,
    "closed loop": _CLOSED_LOOP,
}


def main() -> None:
    """Measure and print."""
    console = Console()
    catalog = Catalog()
    sandpit = replace(catalog.get("square"), horizon_s=60.0, world=World())
    jobs = {name: _job(name, _HEAD + body, sandpit) for name, body in STYLES.items()}
    for assignment in catalog.all():
        solution = catalog.folder(assignment.id) / "solution.py"
        if solution.exists():
            jobs[f"solution of {assignment.id}"] = _job(solution.name, solution.read_text(), assignment)
    table = Table(title=f"warm, one slot; median (shortest) of {ROUNDS}")
    for heading in ("style", "wall", "script's CPU", "ended", "virtual"):
        table.add_column(heading, justify="left" if heading == "style" else "right")
    with Slot(SlotConfig()) as slot:
        slot.grade(jobs["idle"])
        for name, job in jobs.items():
            if CHOSEN in name:
                table.add_row(name, *_measured([slot.grade(job) for _ in range(ROUNDS)]))
    console.print(table)


def _job(name: str, source: str, assignment: Assignment) -> GradingJob:
    return GradingJob(file_name=f"{name}.py", source=source.encode(), assignment=assignment)


def _measured(results: list[GradingResult]) -> tuple[str, str, str, str]:
    wall = [result.measurements.wall_s for result in results]
    cpu = [result.measurements.jail_cpu_s for result in results]
    outcomes = [run.outcome for run in results[0].report.runs]
    return (
        f"{statistics.median(wall):.2f} ({min(wall):.2f}) s",
        f"{statistics.median(cpu):.2f} ({min(cpu):.2f}) s",
        outcomes[0].status.value,
        f"{sum(outcome.duration_ns for outcome in outcomes) / 1e9:.0f} s",
    )


if __name__ == "__main__":
    main()
