"""Many gradings in a row, one in five of them hostile: prints what the grading process holds on to.

Each line is a block of gradings: the median time of an ordinary grading, and then, with nothing running, the
process's memory, descriptors, processes below it and zombies among them. Nothing may grow from the first block
to the last. Exit code 1 if an ordinary script's report ever differed, or a hostile one failed the grader.

Usage: ``python -m lab.soak [GRADINGS]`` (default 2000).
"""

from __future__ import annotations

import os
import statistics
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console
from rich.table import Table

from grader.catalog import Catalog
from grader.contracts.assignment import MIB, Limits
from grader.contracts.errors import GraderError
from grader.contracts.grading import GradingJob
from grader.grading.pipeline import Pipeline
from grader.sandbox import Sandbox

ROOT = Path(__file__).resolve().parent.parent
ATTACKS = ROOT / "tests" / "hostile"
HOSTILE_EVERY = 5
BLOCKS = 10
LIMITS = Limits(cpu_s=0.4, grace_cpu_s=0.1, memory_bytes=192 * MIB, output_bytes=256 * 1024)


@dataclass(frozen=True)
class Held:
    """What the process holds on to while nothing runs."""

    memory_mib: float
    descriptors: int
    processes: int
    zombies: int


def main(gradings: int) -> int:
    """Grade, print the table, return the exit code."""
    table = Table(title=f"{gradings} gradings, one in {HOSTILE_EVERY} hostile")
    for heading in (
        "gradings",
        "median ms",
        "MiB",
        "descriptors",
        "processes",
        "zombies",
        "different",
        "faults",
    ):
        table.add_column(heading, justify="right")
    with Sandbox() as sandbox, Pipeline(sandbox) as pipeline:
        soak = _Soak(pipeline)
        for block in range(BLOCKS):
            times_ms = [soak.step() for _ in range(gradings // BLOCKS)]
            held = _held()
            table.add_row(
                str((block + 1) * (gradings // BLOCKS)),
                f"{statistics.median([each for each in times_ms if each is not None]):.1f}",
                f"{held.memory_mib:.1f}",
                *map(str, (held.descriptors, held.processes, held.zombies, soak.different, soak.faults)),
            )
    Console().print(table)
    return 1 if soak.different or soak.faults else 0


class _Soak:
    """Grades one script after the other and remembers what went wrong."""

    def __init__(self, pipeline: Pipeline) -> None:
        self._pipeline = pipeline
        self._hostile = _for_ever(_hostile_jobs())
        self._ordinary = _for_ever(_ordinary_jobs())
        self._reports: dict[bytes, bytes] = {}
        self._count = 0
        self.different = 0
        self.faults = 0

    def step(self) -> float | None:
        """Grade the next script; return the time in ms if it is an ordinary one."""
        self._count += 1
        if self._count % HOSTILE_EVERY == 0:
            self._grade(next(self._hostile))
            return None
        job = next(self._ordinary)
        started = time.perf_counter()
        report = self._grade(job)
        took_ms = (time.perf_counter() - started) * 1e3
        self.different += report != self._reports.setdefault(job.source, report)
        return took_ms

    def _grade(self, job: GradingJob) -> bytes:
        try:
            return self._pipeline.grade(job).report.canonical_bytes()
        except GraderError as error:
            print(f"{job.file_name}: {type(error).__name__}: {error}", file=sys.stderr)
            self.faults += 1
            return b""


def _for_ever(jobs: list[GradingJob]) -> Iterator[GradingJob]:
    while True:
        yield from jobs


def _ordinary_jobs() -> list[GradingJob]:
    catalog = Catalog()
    names = ("hello", "straight", "spin")
    return [
        GradingJob(
            file_name="solution.py",
            source=(catalog.folder(name) / "solution.py").read_bytes(),
            assignment=catalog.get(name),
        )
        for name in names
    ]


def _hostile_jobs() -> list[GradingJob]:
    """Every attack that does not end by sleeping, which takes seconds by its nature."""
    assignment = replace(Catalog().get("straight"), limits=LIMITS)
    scripts = sorted([*(ATTACKS / "scripts").iterdir(), *(ATTACKS / "episode" / "scripts").iterdir()])
    return [
        GradingJob(file_name=path.name, source=source, assignment=assignment)
        for path in scripts
        if path.is_file() and b"Expected: stalled" not in (source := path.read_bytes())
    ]


def _held() -> Held:
    status = Path("/proc/self/status").read_text(encoding="ascii")
    resident_kib = next(int(line.split()[1]) for line in status.splitlines() if line.startswith("VmRSS"))
    below = list(_below(os.getpid()))
    return Held(
        memory_mib=resident_kib / 1024,
        descriptors=len(os.listdir("/proc/self/fd")),
        processes=len(below),
        zombies=sum(_state(pid) == "Z" for pid in below),
    )


def _below(pid: int) -> Iterator[int]:
    for child in Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii").split():
        yield int(child)
        yield from _below(int(child))


def _state(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except OSError:
        return ""


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 2_000))
