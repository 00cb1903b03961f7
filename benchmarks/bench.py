"""What one grading costs against a bare PyBullet loop over the same car: prints tables, asserts nothing.

The lesson's square is graded cold (`grader check` as a whole process; its validated assignment is remembered
from an earlier run, or nothing is) and warm (inside a running grading process). The floor is the same car
driven for the same number of steps without anything around it, in a fresh process and in a warm one. A second
table compares the start of a confined process with that of a bare fork of the same warm process.

All runs are interleaved, so that a busy machine slows all of them. The median says what to expect on this
machine as it is now, the shortest run what the program itself needs. Byte code is kept, as it is on a user's
machine, even where the environment forbids it: compiling is no part of a grading.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path

from rich.console import Console
from rich.table import Table

from benchmarks.floor import BareLoop
from grader.catalog import Catalog
from grader.contracts.assignment import Limits
from grader.contracts.grading import GradingJob
from grader.grading.slot import Slot, SlotConfig
from grader.sandbox import PRELOADED, Layer, Mode, Sandbox

ROOT = Path(__file__).resolve().parent.parent
SQUARE = ROOT / "lesson" / "square_mover.py"
ROUNDS = int(os.environ.get("BENCH_ROUNDS", "15"))
STARTS = int(os.environ.get("BENCH_STARTS", "100"))

Times = dict[str, list[float]]


def main() -> None:
    """Measure and print."""
    console = Console()
    console.print(f"load of the last minute: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    job = GradingJob(file_name=SQUARE.name, source=SQUARE.read_bytes(), assignment=Catalog().get("square"))
    with Slot(SlotConfig()) as slot:
        first = slot.grade(job)
        steps = first.measurements.sim_steps
        virtual_s = first.report.runs[0].outcome.duration_ns / 1e9
        bare = BareLoop()
        times = _interleaved(ROUNDS, {"warm": lambda: slot.grade(job), "floor": lambda: bare.run(steps)})
        warm = [("warm", times["warm"], times["floor"])]
    cold = _cold(steps)
    console.print(_grading_table(steps, virtual_s, [*cold, *warm]))
    console.print(_sandbox_table(_starts()))


def _cold(steps: int) -> list[tuple[str, list[float], list[float]]]:
    def check(cache: str) -> None:
        _python("-m", "grader", "check", str(SQUARE), "-a", "square", "--lang", "en", XDG_CACHE_HOME=cache)

    def check_with_nothing_remembered() -> None:
        with tempfile.TemporaryDirectory() as empty:
            check(empty)

    with tempfile.TemporaryDirectory() as cache:
        check(cache)
        times = _interleaved(
            ROUNDS,
            {
                "cold": lambda: check(cache),
                "cold, nothing remembered": check_with_nothing_remembered,
                "floor": lambda: _python("-m", "benchmarks.floor", str(steps)),
            },
        )
    return [(name, times[name], times["floor"]) for name in times if name != "floor"]


def _python(*arguments: str, **environment: str) -> None:
    inherited = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    subprocess.run(
        [sys.executable, *arguments],
        cwd=ROOT,
        check=True,
        stdout=subprocess.DEVNULL,
        env={**inherited, **environment},
    )


def _starts() -> Times:
    """Time starting, confining, ending and reaping a process that does nothing, in seconds."""
    with ExitStack() as stack:

        def sandbox(*without: Layer) -> Callable[[], None]:
            opened = stack.enter_context(
                Sandbox(Mode.BEST_EFFORT, without=frozenset(without), preload=PRELOADED)
            )

            def start() -> None:
                with opened.open(Limits()):
                    pass

            start()
            return start

        return _interleaved(
            STARTS,
            {
                "bare fork": sandbox(*frozenset(Layer) - {Layer.PROCESS}),
                "confined": sandbox(Layer.NAMESPACES),
                "confined, with namespaces": sandbox(),
            },
        )


def _interleaved(rounds: int, actions: Mapping[str, Callable[[], object]]) -> Times:
    times: Times = {name: [] for name in actions}
    for _ in range(rounds):
        for name, action in actions.items():
            start = time.perf_counter()
            action()
            times[name].append(time.perf_counter() - start)
    return times


def _grading_table(steps: int, virtual_s: float, rows: list[tuple[str, list[float], list[float]]]) -> Table:
    table = Table(
        title=f"lesson's square: {virtual_s:.1f} virtual s, {steps} physics steps; median (shortest) of {ROUNDS}"
    )
    for heading in ("", "grading", "bare loop (floor)", "ratio", "virtual s per wall s"):
        table.add_column(heading, justify="right")
    for name, grading, floor in rows:
        ratio, shortest = (of(grading) / of(floor) for of in (statistics.median, min))
        table.add_row(
            name,
            _milliseconds(grading),
            _milliseconds(floor),
            f"{ratio:.2f} ({shortest:.2f})",
            f"{virtual_s / statistics.median(grading):.0f} ({virtual_s / min(grading):.0f})",
        )
    return table


def _sandbox_table(times: Times) -> Table:
    table = Table(title=f"start, confine, end and reap one process; median (shortest) of {STARTS}")
    for heading in ("", "time", "over the bare fork"):
        table.add_column(heading, justify="right")
    bare = times["bare fork"]
    for name, each in times.items():
        over = [(of(each) - of(bare)) * 1e3 for of in (statistics.median, min)]
        table.add_row(name, _milliseconds(each), f"{over[0]:.1f} ({over[1]:.1f}) ms")
    return table


def _milliseconds(times: list[float]) -> str:
    return f"{statistics.median(times) * 1e3:.1f} ({min(times) * 1e3:.1f}) ms"


if __name__ == "__main__":
    main()
