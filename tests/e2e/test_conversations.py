"""Exercises about what nodes say: their own scripts get what they must."""

from pathlib import Path

import pytest

from grader.catalog import Catalog, set_root
from grader.commands.validation import examine
from grader.contracts.grading import Grader
from grader.contracts.text import EMPTY

TEACHERS = Catalog(Path(__file__).parent / "exercises")
SHIPPED = Catalog(set_root("nodes"))


@pytest.mark.parametrize("name", [each.id for each in TEACHERS.all()])
def test_a_teachers_own_exercises_are_valid(grader: Grader, name: str) -> None:
    assert problems(TEACHERS, name, grader) == []


@pytest.mark.parametrize("name", [each.id for each in SHIPPED.all()])
def test_the_exercises_of_the_set_are_valid(grader: Grader, name: str) -> None:
    assert SHIPPED.get(name).max_score == 100
    assert len(SHIPPED.wrong_attempts(name)) >= 6
    assert problems(SHIPPED, name, grader) == []


def problems(catalog: Catalog, name: str, grader: Grader) -> list[tuple[str, str]]:
    findings = examine(catalog, name, grader).findings
    return [(each.script, each.problem.en) for each in findings if each.problem != EMPTY]
