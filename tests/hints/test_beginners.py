"""Of the beginners' scripts those whose cause no other test names, and some that work though they look wrong.

``python -m tests.hints`` grades all.
"""

import re

import pytest

from grader.contracts.grading import Grader
from tests.hints.beginners import FOLDER, Beginner, answer, beginners, changes
from tests.hints.named import ROOT, named_by_checks, words
from tests.hints.scripts import SCRIPTS

NAMED = named_by_checks() | words(*(ROOT / "assignments").glob("*/assignment.yaml"))
KNOWN = NAMED | {script.cause for script in SCRIPTS} | {""}
FIRST_OF_CAUSE = {script.cause: script for script in reversed(beginners()) if script.cause not in KNOWN}
ODD = [script for script in beginners() if script.verdict == "harmless" and script.cause == ""][::3]
ALIKE = [script for script in beginners() if re.search(r"_looks_like_\w*[a-z]\.py", script.file)]
"""Of the scripts with a line that looks like another cause than theirs, the first of each such cause."""
SLOW = [pytest.param(one, marks=pytest.mark.slow) for one in beginners() if one.cause == "never_finished"]
"""Three runs until the time is up take four seconds; the tests of checks name the cause as well."""


def test_each_script_has_one_row() -> None:
    rows = beginners()
    files = [path.name for path in (FOLDER / "scripts").iterdir()]
    assert sorted(row.file for row in rows) == sorted([*files, *changes()])
    assert sum(row.verdict == "wrong" for row in rows) >= 350
    assert all(row.cause == "" and row.lowest >= 60 for row in rows if row.verdict == "right")


@pytest.mark.parametrize(
    "script",
    [*{script.file: script for script in (*FIRST_OF_CAUSE.values(), *ODD, *ALIKE)}.values(), *SLOW],
    ids=lambda script: script.file,
)
def test_the_answer_is_what_a_teacher_expects(grader: Grader, script: Beginner) -> None:
    assert answer(grader, script).faults(script) == []
