"""Exercises about what nodes say: their own scripts get what they must."""

from pathlib import Path

import pytest

from grader.catalog import Catalog
from grader.commands.validation import fitting, own_scripts
from grader.contracts.grading import Grader
from grader.contracts.text import EMPTY
from grader.grading.examination import examine

EXERCISES = Catalog(Path(__file__).parent / "exercises")


@pytest.mark.parametrize("name", [each.id for each in EXERCISES.all()])
def test_own_scripts_get_what_they_must(grader: Grader, name: str) -> None:
    findings = examine(own_scripts(EXERCISES, fitting(EXERCISES, name)), grader).findings
    assert [(each.script, each.problem) for each in findings if each.problem != EMPTY] == []
