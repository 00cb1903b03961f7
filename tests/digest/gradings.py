"""The corpus of reports: every script that the tests grade, and drives near the edges of bands."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import PurePath

from grader.catalog import SETS, Catalog, set_root
from grader.contracts.assignment import Limits
from grader.contracts.grading import GradingJob
from tests.corpus.attempts import corpus, near_edges
from tests.corpus.scoring import task_of
from tests.corpus.scripts import script
from tests.hints.beginners import beginners
from tests.hints.scripts import SCRIPTS
from tests.styles.test_styles import EXPECTED, job_of

_LIMITS = Limits(steps=150_000, output_bytes=256 * 1024)
"""Of the scripts for hints: as their tests have it, what has no end ends sooner."""


@dataclass(frozen=True)
class Grading:
    """One script with what it is graded as; the id says where it is from."""

    id: str
    job: GradingJob


def gradings() -> list[Grading]:
    """Return the whole corpus, always the same, in one order."""
    found = [*_of_assignments(), *_of_beginners(), *_of_hints(), *_of_styles(), *_generated()]
    assert len({grading.id for grading in found}) == len(found)
    return found


def replays(found: Iterable[Grading]) -> set[str]:
    """Return the ids of those whose PyBullet world is replayed: Bullet's last bits depend on the C library."""
    return {grading.id for grading in found if grading.job.assignment.world.kind == "pybullet"}


def touching(found: Iterable[Grading]) -> set[str]:
    """Return the ids of those whose bodies may touch another: Bullet finds contacts with the C library's sines."""
    return {grading.id for grading in found if grading.job.assignment.world.kind != "turtle"}


def _of_assignments() -> Iterator[Grading]:
    for catalog in (Catalog(), *(Catalog(set_root(name)) for name in SETS)):
        for assignment in catalog.all():
            for name, source in catalog.scripts(assignment.id).items():
                job = GradingJob(file_name=PurePath(name).name, source=source, assignment=assignment)
                own = name if name.startswith("wrong/") else PurePath(name).stem
                yield Grading(f"{assignment.id}/{own}", job)


def _of_beginners() -> Iterator[Grading]:
    for one in beginners():
        yield _short(f"beginners/{one.file}", one.assignment, one.file, one.source)


def _of_hints() -> Iterator[Grading]:
    for one in SCRIPTS:
        yield _short(f"hints/{_slug(one.name)}", one.assignment, "script.py", one.source.encode())


def _short(name: str, assignment: str, file_name: str, source: bytes) -> Grading:
    task = replace(_CATALOG.get(assignment), limits=_LIMITS)
    return Grading(name, GradingJob(file_name=file_name, source=source, assignment=task))


def _of_styles() -> Iterator[Grading]:
    for name in EXPECTED:
        yield Grading(f"styles/{name}", job_of(name))


def _generated() -> Iterator[Grading]:
    for family, attempts in (("corpus", corpus()), ("edges", near_edges())):
        for number, attempt in enumerate(attempts):
            job = GradingJob(
                file_name="script.py", source=script(attempt).encode(), assignment=task_of(attempt)
            )
            yield Grading(f"{family}/{number:03}_{_slug(str(attempt))}", job)


def _slug(text: str) -> str:
    return re.sub(r"[^\w.+%-]+", "_", text)


_CATALOG = Catalog()
