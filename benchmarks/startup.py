"""What importing the shim costs a fresh interpreter: prints a table, asserts nothing.

Whole processes are charged with the CPU time they used, which others on the machine change less than the wall
clock; the programs take turns so that a busy machine slows all alike. The byte code is warm (written by a first
run that does not count). Neither `site` nor the environment is read (``-I -S``), as in the process that scripts
are forked from; there all of this happens once, before a script is known.
"""

from __future__ import annotations

import os
import statistics
import sys
from pathlib import Path

from rich.console import Console
from rich.table import Table

SHIM = Path(__file__).resolve().parent.parent / "grader" / "shim"
ROUNDS = int(os.environ.get("BENCH_ROUNDS", "40"))
PROGRAMS = {
    "bare interpreter": "",
    "rclpy": "import rclpy",
    "rclpy, Node": "import rclpy, rclpy.node",
    "rclpy, Node, Twist, Pose": (
        "import rclpy, rclpy.node; from geometry_msgs.msg import Twist; from turtlesim.msg import Pose"
    ),
}


def main() -> None:
    """Measure and print."""
    seconds: dict[str, list[float]] = {name: [] for name in PROGRAMS}
    for program in PROGRAMS.values():
        _run(program)
    for _ in range(ROUNDS):
        for name, program in PROGRAMS.items():
            seconds[name].append(_run(program))
    _print(seconds)


def _run(program: str) -> float:
    source = f"import sys; sys.path.insert(0, {str(SHIM)!r}); {program}"
    command = [sys.executable, "-I", "-S", "-c", source]
    _, status, usage = os.wait4(os.posix_spawn(sys.executable, command, os.environ), 0)
    if status:
        raise SystemExit(f"{source} failed")
    return usage.ru_utime + usage.ru_stime


def _print(seconds: dict[str, list[float]]) -> None:
    table = Table(title=f"CPU time of importing the shim, {ROUNDS} processes each")
    for heading in ("", "median", "least", "median above bare", "least above bare"):
        table.add_column(heading, justify="right")
    bare = seconds["bare interpreter"]
    for name, values in seconds.items():
        median, least = statistics.median(values), min(values)
        figures = (median, least, median - statistics.median(bare), least - min(bare))
        table.add_row(name, *(f"{figure * 1e3:.1f} ms" for figure in figures))
    Console().print(table)


if __name__ == "__main__":
    main()
