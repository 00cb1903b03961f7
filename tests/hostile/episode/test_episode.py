"""Attacks on the grade itself, through the whole grading process: shim, wire, episode, checks."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from grader.contracts.assignment import Limits
from grader.contracts.grading import GradingJob
from grader.contracts.report import GradeReport
from grader.grading.budget import REPORT_TEXT_BYTES
from grader.grading.slot import Slot
from grader.jail import landlock
from tests.e2e.grading_slot import catalog

pytestmark = pytest.mark.skipif(landlock.abi_version() == 0, reason="this kernel has no Landlock")

SCRIPTS = sorted((Path(__file__).parent / "scripts").glob("*.py"))
ABUSE = sorted((Path(__file__).parents[1] / "abuse").glob("*.py"))
LONGEST_REPORT = REPORT_TEXT_BYTES + 16 * 1024
BRIEF = Limits(cpu_s=0.4, grace_cpu_s=0.2, wall_s=0.8)
LIMITS = Limits(cpu_s=0.6, grace_cpu_s=0.2, wall_s=60.0)
AMPLE = Limits(cpu_s=10.0, grace_cpu_s=0.2, wall_s=60.0)
"""For scripts that must end otherwise than by this limit: on a busy machine they take several times as long."""
WORTHLESS = 0.25
"""Of the points: driving straight ahead, which some attacks do on the way, may earn as much."""


def grade(slot: Slot, source: bytes, name: str, limits: Limits = LIMITS) -> GradeReport:
    assignment = replace(catalog().get("square"), limits=limits)
    return slot.grade(GradingJob(file_name=name, source=source, assignment=assignment)).report


@pytest.fixture(scope="module")
def good(slot: Slot) -> bytes:
    report = grade_solution(slot)
    assert report.score == report.max_score
    return report.canonical_bytes()


def grade_solution(slot: Slot) -> GradeReport:
    """Grade a script that also drives, and takes half as long as a square."""
    source = (catalog().folder("straight") / "solution.py").read_bytes()
    job = GradingJob(file_name="good.py", source=source, assignment=catalog().get("straight"))
    return slot.grade(job).report


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_attack_earns_nothing_and_disturbs_nobody(slot: Slot, good: bytes, script: Path) -> None:
    source = script.read_bytes()
    match = re.search(r"^Expected: (.+)$", source.decode(errors="replace"), re.MULTILINE)
    assert match
    expected = match[1].split(" or ")
    limits = LIMITS if {"any", "cpu_limit"} & set(expected) else AMPLE
    report = grade(slot, source, script.name, limits)
    status = report.runs[0].outcome.status
    assert expected == ["any"] or status in expected, report.runs[0].outcome
    assert report.score is not None
    assert report.score <= WORTHLESS * report.max_score
    assert grade_solution(slot).canonical_bytes() == good


@pytest.mark.parametrize("script", ABUSE, ids=lambda path: path.stem)
def test_abuse_ends_as_the_scripts_own_and_leaves_nothing(slot: Slot, good: bytes, script: Path) -> None:
    """What costs others something: time that only the wall clock sees, threads, memory, disks, long reports."""
    source = script.read_bytes()
    match = re.search(r"^Expected: (.+)$", source.decode(), re.MULTILINE)
    assert match
    report = grade(slot, source, script.name, BRIEF)  # no fault of the host: that would be raised
    outcome = report.runs[0].outcome
    assert outcome.status in match[1].split(" or "), outcome
    assert "BREACH" not in outcome.stdout.text
    assert len(report.canonical_bytes()) <= LONGEST_REPORT
    assert grade_solution(slot).canonical_bytes() == good
