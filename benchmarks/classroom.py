"""A scripted class: which student hands in which bytes, in which order, and what each script is worth.

Scripts are the lesson's, the assignments' own solutions, and what beginners get wrong. What a script earns is
found out by grading it once with the core alone, without service or database. Two students never hand in the
same bytes: each file ends with a comment that names student and attempt. The share that is meant to be the
same, or no Python at all, comes on top and must not end up in the gradebook.
"""

from __future__ import annotations

import ast
import math
import random
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from itertools import cycle, islice
from pathlib import Path
from typing import Literal

from grader.catalog import Catalog
from grader.contracts.grading import GradingJob, GradingResult
from grader.grading.slot import Slot, SlotConfig

ROOT = Path(__file__).resolve().parent.parent
ASSIGNMENTS = ("hello", "straight", "backward", "spin", "square", "triangle", "pentagon")
_LESSON = {"hello": "hello_node.py", "straight": "straight_mover.py", "square": "square_mover.py"}
_BROKEN = b"def main(:\n    pass\n"
_SHARE_REPEATED = 0.03
_SHARE_BROKEN = 0.03
_SHARE_RIGHT = (0.3, 0.5, 0.8)  # of the first, second, third and later attempts

Kind = Literal["fresh", "repeated", "broken"]


@dataclass(frozen=True, slots=True)
class Script:
    """A file without its last line. `score` is what the core gives it."""

    assignment: str
    name: str
    source: bytes
    right: bool
    score: float = math.nan


@dataclass(frozen=True, slots=True)
class Upload:
    """One file that a student hands in. ``repeated``: the bytes before it again; ``broken``: no Python."""

    student: str
    attempt: int
    script: Script
    kind: Kind = "fresh"

    @property
    def content(self) -> bytes:
        """The bytes to send."""
        body = _BROKEN if self.kind == "broken" else self.script.source
        return body.rstrip() + f"\n# {self.student}, attempt {self.attempt}\n".encode()


def roster(count: int) -> list[str]:
    """Return the ids of a class."""
    return [f"2026{number:05d}" for number in range(1, count + 1)]


def graded_scripts() -> list[Script]:
    """Return every script with what it earns: graded once, without service or database."""
    return [replace(script, score=result.report.score or 0.0) for script, result in results()]


def results() -> list[tuple[Script, GradingResult]]:
    """Grade every script once."""
    with Slot(SlotConfig()) as slot:
        return [(one, slot.grade(job(one))) for one in scripts()]


def bare_rate(uploads: Sequence[Upload], count: int, processes: int) -> float:
    """Return how many of `uploads` bare loops in `processes` grading processes grade in a second."""
    jobs = [job(one.script) for one in islice(cycle(uploads), count)]
    with ExitStack() as stack:
        slots = [stack.enter_context(Slot(SlotConfig())) for _ in range(processes)]
        for slot in slots:
            slot.grade(jobs[0])
        started = time.perf_counter()
        with ThreadPoolExecutor(processes) as pool:
            list(pool.map(lambda pair: [pair[0].grade(job) for job in pair[1]], _dealt(slots, jobs)))
        return count / (time.perf_counter() - started)


def plan(scripts: Sequence[Script], students: Sequence[str], attempts: int, seed: int) -> list[Upload]:
    """Return everything the class hands in, in order: attempt by attempt, assignments and students mixed.

    It hands in for those of `ASSIGNMENTS` that have scripts.
    """
    chance = random.Random(seed)  # noqa: S311 - a class, no secret
    right, wrong = _by_assignment(scripts, right=True), _by_assignment(scripts, right=False)
    uploads: list[Upload] = []
    for attempt in range(1, attempts + 1):
        share = _SHARE_RIGHT[min(attempt, len(_SHARE_RIGHT)) - 1]
        work = [(assignment, student) for assignment in right for student in students]
        for assignment, student in chance.sample(work, len(work)):
            script = chance.choice((right if chance.random() < share else wrong)[assignment])
            uploads += _with_extras(Upload(student, attempt, script), chance)
    return uploads


def _by_assignment(scripts: Sequence[Script], *, right: bool) -> dict[str, list[Script]]:
    return {
        assignment: [one for one in scripts if one.assignment == assignment and one.right is right]
        for assignment in ASSIGNMENTS
        if any(one.assignment == assignment for one in scripts)
    }


def _with_extras(upload: Upload, chance: random.Random) -> Iterator[Upload]:
    if chance.random() < _SHARE_BROKEN:
        yield Upload(upload.student, upload.attempt, upload.script, "broken")
    yield upload
    if chance.random() < _SHARE_REPEATED:
        yield Upload(upload.student, upload.attempt, upload.script, "repeated")


def scripts() -> Iterator[Script]:
    """Yield every script, not graded yet."""
    catalog = Catalog()
    for assignment in ASSIGNMENTS:
        (name, solution), _, *wrong = catalog.scripts(assignment).items()
        yield Script(assignment, name, solution, right=True)
        if assignment in _LESSON:
            lesson = ROOT / "lesson" / _LESSON[assignment]
            yield Script(assignment, lesson.name, lesson.read_bytes(), right=True)
        for path, source in sorted(wrong):
            if _is_python(source):
                yield Script(assignment, path.removeprefix("wrong/"), source, right=False)


def _is_python(source: bytes) -> bool:
    try:
        ast.parse(source)
    except SyntaxError:
        return False
    return True


def job(script: Script) -> GradingJob:
    """Return a script as a grading process is told it."""
    return GradingJob(
        file_name=script.name, source=script.source, assignment=Catalog().get(script.assignment)
    )


def _dealt(slots: Sequence[Slot], jobs: Sequence[GradingJob]) -> list[tuple[Slot, Sequence[GradingJob]]]:
    return [(slot, jobs[number :: len(slots)]) for number, slot in enumerate(slots)]
