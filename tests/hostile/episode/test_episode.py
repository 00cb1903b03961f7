"""Attacks on the grade itself, through the whole grading process: shim, wire, episode, checks."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from grader.catalog import Catalog
from grader.contracts.assignment import Limits
from grader.contracts.grading import GradingJob
from grader.contracts.report import GradeReport
from grader.grading.slot import Slot, SlotConfig
from grader.jail import landlock

pytestmark = pytest.mark.skipif(landlock.abi_version() == 0, reason="this kernel has no Landlock")

SCRIPTS = sorted((Path(__file__).parent / "scripts").glob("*.py"))
LIMITS = Limits(cpu_s=1.0, grace_cpu_s=0.2, wall_s=60.0)
WORTHLESS = 0.25
"""Of the points: driving straight ahead, which some attacks do on the way, may earn as much."""


@pytest.fixture(scope="module")
def slot() -> Iterator[Slot]:
    with Slot(SlotConfig()) as made:
        yield made


def grade(slot: Slot, source: bytes, name: str) -> GradeReport:
    assignment = replace(Catalog().get("square"), limits=LIMITS)
    return slot.grade(GradingJob(file_name=name, source=source, assignment=assignment)).report


@pytest.fixture(scope="module")
def good(slot: Slot) -> bytes:
    report = grade(slot, solution(), "good.py")
    assert report.score == report.max_score
    return report.canonical_bytes()


def solution() -> bytes:
    return (Catalog().folder("square") / "solution.py").read_bytes()


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_attack_earns_nothing_and_disturbs_nobody(slot: Slot, good: bytes, script: Path) -> None:
    source = script.read_bytes()
    match = re.search(r"^Expected: (.+)$", source.decode(errors="replace"), re.MULTILINE)
    assert match
    expected = match[1].split(" or ")
    report = grade(slot, source, script.name)
    status = report.runs[0].outcome.status
    assert expected == ["any"] or status in expected, report.runs[0].outcome
    assert report.score is not None
    assert report.score <= WORTHLESS * report.max_score
    assert grade(slot, solution(), "good.py").canonical_bytes() == good
