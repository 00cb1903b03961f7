"""What databases hold as JSON can be read for as long as no field of it goes: records refuse unknown fields."""

import json
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any, get_args, get_type_hints

from grader.contracts.assignment import Assignment, stored_assignment
from grader.contracts.explanation import Explanation
from grader.contracts.own_assignment import Examined
from grader.contracts.record import Record, canonical, to_plain
from grader.contracts.regrade import ScoreChange, Wanted
from grader.contracts.report import GradeReport, Measurements
from grader.contracts.rules import LateRule, LateStep, Rules, SectionRule
from grader.grading.examination.reading import Reading
from tests.unit.checks.shipped import assignment

STORED = (Assignment, Examined, Explanation, GradeReport, Measurements, Reading, ScoreChange, Wanted)
RULES = (Rules, LateRule, LateStep, SectionRule)  # stored as dataclasses
GOLDEN = Path(__file__).parents[2] / "golden/stored_fields.json"


def records(hint: Any) -> Iterator[type[Any]]:
    """Yield the records that a type is made of."""
    if isinstance(hint, type) and issubclass(hint, Record):
        yield hint
    for part in get_args(hint):
        yield from records(part)


def reached() -> dict[str, list[str]]:
    """Return by name the fields of the records that stored documents are made of."""
    found: dict[str, list[str]] = {}
    left: list[type[Any]] = list(STORED)
    while left:
        record = left.pop()
        if record.__name__ not in found:
            hints = get_type_hints(record)
            names = [one.name for one in fields(record)]
            found[record.__name__] = sorted(names)
            left += [one for name in names for one in records(hints[name])]
    found |= {one.__name__: sorted(field.name for field in fields(one)) for one in RULES}
    return dict(sorted(found.items()))


def test_no_field_of_a_stored_document_goes_and_new_ones_are_noted() -> None:
    """A field that went comes back, or a migration takes it out of the documents first; new ones are noted."""
    assert reached() == json.loads(GOLDEN.read_text())


def test_an_assignment_that_was_stored_before_steps_can_be_read() -> None:
    before = {
        **to_plain(assignment("rosclaw")),
        "check": "service",
        "calls": [{"service": "/a"}],
        "agent": [],
    }
    assert stored_assignment(canonical(before)).check == "service"
