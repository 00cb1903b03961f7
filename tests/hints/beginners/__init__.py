"""Scripts as beginners write them from the course's text, each with what is wrong, and what a teacher expects.

`expected.tsv` names for each the verdict (right, harmless or wrong), the lowest and the highest score that a
teacher would give, the kind of cause (`tests.hints.categories`; ``refused``: not taken; ``foreign``: no program
for rclpy, so no change of it is wanted), the lines that a hint may name, and in words what is wrong and what the
first hint should say; `reason` where the score is not what one would guess.

A script is a file in `scripts`, or an entry in `changes.yaml` if it is close to an earlier one.
"""

import csv
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from grader.catalog.attempts import changed, edits_of
from grader.contracts.assignment import SUFFIXES
from grader.contracts.errors import RefusedError
from grader.contracts.grading import Grader
from grader.contracts.outcome import RunStatus
from grader.contracts.report import GradeReport
from grader.contracts.text import EMPTY
from grader.contracts.upload import check_name, check_source
from tests.e2e.grading_slot import catalog, grade

FOLDER = Path(__file__).parent
REFUSED = "refused"
FOREIGN = "foreign"
_ERRORS = (RunStatus.CRASHED, RunStatus.SYNTAX_ERROR)


@dataclass(frozen=True)
class Beginner:
    """One row of `expected.tsv`."""

    file: str
    assignment: str
    verdict: str
    lowest: float
    highest: float
    category: str
    lines: frozenset[int]
    what_is_wrong: str
    first_hint: str

    @property
    def source(self) -> bytes:
        if self.file not in changes():
            return (FOLDER / "scripts" / self.file).read_bytes()
        change = changes()[self.file]
        base = (FOLDER / "scripts" / change["base"]).read_text(encoding="utf-8")
        return changed(base, edits_of(change["change"]), change.get("about")).encode()


@dataclass(frozen=True)
class Answer:
    """What the report says of a script: score, code of the first mistake, hint in both languages, how it ended."""

    score: float
    cause: str
    zh: str
    en: str
    crashed: bool = False

    def faults(self, expected: Beginner) -> list[str]:
        """Return in which points the answer is not what a teacher would say."""
        told = []
        if not expected.lowest <= self.score <= expected.highest:
            told.append(f"{self.score} points, not {expected.lowest:g} to {expected.highest:g}")
        if bool(self.cause) != bool(expected.category):
            told.append(f"told {self.cause or 'nothing'} first, not {expected.category or 'nothing'}")
        if bool(self.zh) != bool(self.en):
            told.append("a hint in one language only")
        return told


@cache
def changes() -> dict[str, Any]:
    """Return by name the scripts that are another one with a change."""
    entries: dict[str, Any] = yaml.safe_load((FOLDER / "changes.yaml").read_text(encoding="utf-8"))
    return entries


def beginners() -> list[Beginner]:
    """Return all rows."""
    with (FOLDER / "expected.tsv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE))
    return [
        Beginner(
            file=row["file"],
            assignment=row["assignment"],
            verdict=row["verdict"],
            lowest=float(row["lowest"]),
            highest=float(row["highest"]),
            category=row["category"],
            lines=frozenset(map(int, row["lines"].split())),
            what_is_wrong=row["what_is_wrong"],
            first_hint=row["first_hint"],
        )
        for row in rows
    ]


def answer(grader: Grader, script: Beginner) -> Answer:
    """Return what the grader says, as after an upload."""
    try:
        check_name(script.file, SUFFIXES[catalog().get(script.assignment).input])
        check_source(script.source)
    except RefusedError as refused:
        told = refused.detail or EMPTY
        return Answer(0.0, REFUSED, told.zh, told.en)
    report = grade(grader, script.assignment, script.source, script.file)
    crashed = any(run.outcome.status in _ERRORS for run in report.runs)
    return Answer(report.score, _cause(report, script), report.hint.zh, report.hint.en, crashed)


def _cause(report: GradeReport, script: Beginner) -> str:
    """Return the code of the first mistake; where none is recognised, the measure whose item gives the hint."""
    measures = {spec.id: spec.measure for spec in catalog().get(script.assignment).items}
    hinted = [
        item.id.rpartition("/")[2]
        for item in report.items
        if item.hint != EMPTY and report.hint.zh.endswith(item.hint.zh)
    ]
    return (*report.mistakes, *(measures[id_] for id_ in hinted), "")[0]
