"""What one grading costs against a bare PyBullet loop over the same car: prints a table, asserts nothing.

The lesson's square is graded cold (`grader check` as a whole process) and warm (inside a running grading
process). The floor is the same car driven for the same number of steps without anything around it, in a fresh
process and in a warm one. Figures are medians; the runs of a pair are interleaved so that a busy machine slows
both.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from rich.console import Console
from rich.table import Table

from benchmarks.floor import BareLoop
from grader.catalog import Catalog
from grader.contracts.grading import GradingJob
from grader.slot import Slot, SlotConfig

ROOT = Path(__file__).resolve().parent.parent
SQUARE = ROOT / "lesson" / "square_mover.py"
ROUNDS = int(os.environ.get("BENCH_ROUNDS", "9"))


def main() -> None:
    """Measure and print."""
    job = GradingJob(file_name=SQUARE.name, source=SQUARE.read_bytes(), assignment=Catalog().get("square"))
    with Slot(SlotConfig()) as slot:
        first = slot.grade(job)
        steps = first.measurements.sim_steps
        virtual_s = first.report.runs[0].outcome.duration_ns / 1e9
        bare = BareLoop()
        warm, warm_floor = _interleaved(lambda: slot.grade(job), lambda: bare.run(steps))
    cold, cold_floor = _interleaved(_check, lambda: _python("-m", "benchmarks.floor", str(steps)))
    _print(steps, virtual_s, (cold, cold_floor), (warm, warm_floor))


def _check() -> None:
    _python("-m", "grader", "check", str(SQUARE), "--assignment", "square", "--lang", "en")


def _python(*arguments: str) -> None:
    subprocess.run([sys.executable, *arguments], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)


def _interleaved(first: Callable[[], object], second: Callable[[], object]) -> tuple[float, float]:
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(ROUNDS):
        for action, into in zip((first, second), times, strict=True):
            start = time.perf_counter()
            action()
            into.append(time.perf_counter() - start)
    return statistics.median(times[0]), statistics.median(times[1])


def _print(steps: int, virtual_s: float, cold: tuple[float, float], warm: tuple[float, float]) -> None:
    table = Table(
        title=f"lesson's square: {virtual_s:.1f} virtual s, {steps} physics steps, median of {ROUNDS}"
    )
    for heading in ("", "grading", "bare loop (floor)", "ratio", "virtual s per wall s"):
        table.add_column(heading, justify="right")
    for name, (grading, floor) in (("cold", cold), ("warm", warm)):
        table.add_row(
            name,
            f"{grading * 1e3:.0f} ms",
            f"{floor * 1e3:.0f} ms",
            f"{grading / floor:.2f}",
            f"{virtual_s / grading:.0f}",
        )
    Console().print(table)


if __name__ == "__main__":
    main()
