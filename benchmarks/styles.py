"""What the styles in which scripts are written cost, and whether each gets the same report every time.

60 virtual seconds of each style, scripts that meet the limit of steps while they drive, and the solutions. A style
that asks, waits or listens often must not cost much more than the lesson's square, which only sleeps. The script's
CPU time says what the imitation of rclpy needs, the wall time also what the two processes wait for each other.

    python -m benchmarks.styles                               what each costs
    python -m benchmarks.styles --rounds 20 --slots 2         and whether 20 reports are the same to the byte
    python -m benchmarks.styles --rounds 10 --only limit      of what the limit of steps ends, or nearly
    python -m benchmarks.styles --rounds 10 --only limit --beside 4 --save loaded.json
    taskset -c 0 python -m benchmarks.styles --rounds 10 --only limit --compare loaded.json

Exits with 1 when two reports of a script differ, from each other or from those of `--compare`.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from queue import SimpleQueue

from rich.console import Console
from rich.table import Table

from grader.catalog import Catalog
from grader.contracts.assignment import Assignment, World
from grader.contracts.grading import GradingJob, GradingResult
from grader.grading.slot import Slot, SlotConfig

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

_DRIVES = """
calls = 0
def drive():
    twist = Twist(); twist.linear.x, twist.angular.z = 0.5, 0.4
    publisher.publish(twist)
def tick():
    global calls
    calls += 1
    if calls % 25 == 0: drive()
"""
AT_THE_LIMIT = {
    "timer of 12.1 kHz": "node.create_timer(1 / 12_100, tick); rclpy.spin(node)\n",
    "timer of 12.3 kHz": "node.create_timer(1 / 12_300, tick); rclpy.spin(node)\n",
    "looks at a clock": "while True:\n    for _ in range(104): time.time()\n    drive(); time.sleep(0.004)\n",
    "polls a listener": "listen()\nwhile True:\n    for _ in range(260): rclpy.spin_once(node, timeout_sec=0)\n"
    "    drive(); time.sleep(0.01)\n",
    "threads of 2.6 kHz": "node.create_timer(1 / 2_600, tick)\n"
    "executor = MultiThreadedExecutor(); executor.add_node(node); executor.spin()\n",
    "rate beside a thread": "threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()\n"
    "rate = node.create_rate(2_600)\nwhile rclpy.ok(): drive(); rate.sleep()\n",
    "a rate for each motion": "for i in range(400):\n    node.create_rate(150)\n"
    "    end = node.get_clock().now().nanoseconds + 5e8\n"
    "    while node.get_clock().now().nanoseconds < end: drive(); rclpy.spin_once(node)\n",
    "loop after a drive": "for i in range(20): drive(); time.sleep(0.1)\nn = 0\nwhile True: n += 1\n",
}
"""Scripts that come to some 1,500,000 steps within 60 s: where they are ended decides how far the car got."""


@dataclass(frozen=True, slots=True)
class Graded:
    """The rounds of one script."""

    results: list[GradingResult]

    @property
    def reports(self) -> list[str]:
        """Digests of the different reports, in order of appearance."""
        return list(dict.fromkeys(result.report.sha256() for result in self.results))

    def row(self) -> tuple[str, ...]:
        """Return the cells of the table."""
        wall = [result.measurements.wall_s for result in self.results]
        cpu = [result.measurements.jail_cpu_s for result in self.results]
        outcomes = [run.outcome for run in self.results[0].report.runs]
        return (
            f"{statistics.median(wall):.2f} ({min(wall):.2f}) s",
            f"{statistics.median(cpu):.2f} ({min(cpu):.2f}) s",
            outcomes[0].status.value,
            f"{sum(outcome.duration_ns for outcome in outcomes) / 1e9:.1f} s",
            self.reports[0][:12] if len(self.reports) == 1 else f"{len(self.reports)} different",
        )


def main() -> None:
    """Measure, compare and print."""
    options = _options()
    jobs = {name: job for name, job in _jobs(options.files).items() if options.only in name}
    if not jobs:
        sys.exit(f"no style has {options.only!r} in its name")
    table = Table(title=f"warm, {options.slots} at once; median (shortest) of {options.rounds}")
    for heading in ("style", "wall", "script's CPU", "ended", "virtual", "report"):
        table.add_column(heading, justify="left" if heading == "style" else "right")
    reports = {}
    with _busy(options.beside):
        for name, graded in _graded(jobs, options.rounds, options.slots).items():
            reports[name] = graded.reports
            table.add_row(name, *graded.row())
    Console(width=None if sys.stdout.isatty() else 130).print(table)
    if options.save:
        options.save.write_text(json.dumps(reports, indent=1))
    _judge(reports, json.loads(options.compare.read_text()) if options.compare else {})


def _graded(jobs: Mapping[str, GradingJob], rounds: int, slots: int) -> dict[str, Graded]:
    """Grade each job so many times, in so many grading processes."""
    idle: SimpleQueue[Slot] = SimpleQueue()

    def grade(name: str) -> GradingResult:
        slot = idle.get()
        try:
            return slot.grade(jobs[name])
        finally:
            idle.put(slot)

    with ExitStack() as stack:
        for _ in range(slots):
            slot = stack.enter_context(Slot(SlotConfig()))
            slot.grade(next(iter(jobs.values())))
            idle.put(slot)
        pool = stack.enter_context(ThreadPoolExecutor(slots))
        under_way = {name: [pool.submit(grade, name) for _ in range(rounds)] for name in jobs}
        return {name: Graded([one.result() for one in each]) for name, each in under_way.items()}


def _judge(reports: Mapping[str, list[str]], others: Mapping[str, list[str]]) -> None:
    """End with 1 where reports differ."""
    differ = [name for name, found in reports.items() if len({*found, *others.get(name, ())}) > 1]
    if differ:
        sys.exit(f"reports differ: {', '.join(differ)}")


def _jobs(files: list[Path]) -> dict[str, GradingJob]:
    """Return what to grade by its name: the files, as the assignment square, or all that is known here."""
    catalog = Catalog()
    square = catalog.get("square")
    if files:
        return {path.name: _job(path.stem, path.read_text(), square) for path in files}
    sandpit = replace(square, horizon_s=60.0, world=World())
    jobs = {name: _job(name, _HEAD + body, sandpit) for name, body in STYLES.items()}
    for name, body in AT_THE_LIMIT.items():
        jobs[f"limit: {name}"] = _job("limit", _HEAD + _DRIVES + body, sandpit)
    for assignment in catalog.all():
        solution = catalog.folder(assignment.id) / "solution.py"
        if solution.exists():
            jobs[f"solution of {assignment.id}"] = _job("solution", solution.read_text(), assignment)
    return jobs


def _job(name: str, source: str, assignment: Assignment) -> GradingJob:
    return GradingJob(file_name=f"{name}.py", source=source.encode(), assignment=assignment)


@contextmanager
def _busy(count: int) -> Iterator[None]:
    """Keep `count` processes busy meanwhile."""
    processes = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def _options() -> argparse.Namespace:
    assert __doc__ is not None
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.styles",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "files", nargs="*", type=Path, help="scripts to grade as squares instead of the styles"
    )
    parser.add_argument("--only", default="", metavar="PART", help="those with PART in their name")
    parser.add_argument("--rounds", type=int, default=3, help="times that each is graded")
    parser.add_argument("--slots", type=int, default=1, metavar="N", help="gradings at once; more are slower")
    parser.add_argument("--beside", type=int, default=0, metavar="N", help="keep N processes busy meanwhile")
    parser.add_argument("--save", type=Path, metavar="FILE", help="write the reports' digests")
    parser.add_argument("--compare", type=Path, metavar="FILE", help="compare with the digests of --save")
    return parser.parse_args()


if __name__ == "__main__":
    main()
