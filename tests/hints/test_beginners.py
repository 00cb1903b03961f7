"""A sample of the beginners' scripts gets the scores that a teacher expects, and a hint where one is due.

``python -m tests.hints`` grades all, and counts how many of the hints are right.
"""

import re

import pytest

from grader.checks.kinds import KINDS as KINDS_OF_CHECKS
from grader.contracts.grading import Grader
from grader.messages import template
from tests.hints.beginners import FOLDER, Beginner, answer, beginners, changes
from tests.hints.categories import KINDS

ODD = [script for script in beginners() if script.verdict == "harmless" and script.category == ""][::3]
ALIKE = [script for script in beginners() if re.search(r"_looks_like_\w*[a-z]\.py", script.file)]
"""Scripts with a line that looks like another cause than theirs."""
WRONG = [script for script in beginners() if script.verdict == "wrong"][::9]


def test_each_script_has_one_row() -> None:
    rows = beginners()
    files = [path.name for path in (FOLDER / "scripts").iterdir()]
    assert sorted(row.file for row in rows) == sorted([*files, *changes()])
    assert sum(row.verdict == "wrong" for row in rows) >= 350
    assert all(row.category == "" and row.lowest >= 60 for row in rows if row.verdict == "right")


@pytest.mark.parametrize(
    "script",
    {script.file: script for script in (*ODD, *ALIKE, *WRONG)}.values(),
    ids=lambda script: script.file,
)
def test_the_answer_is_what_a_teacher_expects(grader: Grader, script: Beginner) -> None:
    assert answer(grader, script).faults(script) == []


def test_the_kinds_of_causes_name_codes_that_exist() -> None:
    measures = {name for check in KINDS_OF_CHECKS.values() for name in check.measures}
    for code in frozenset().union(*KINDS.values()):
        assert code in measures or any(template("en", f"{kind}.{code}") for kind in ("mistake", "cause")), (
            code
        )
