"""Each script of a beginner that lacks marks gets a hint; a right one gets none."""

import pytest

from grader.contracts.assignment import Limits
from grader.contracts.grading import Grader
from grader.contracts.text import EMPTY
from tests.e2e.grading_slot import grade
from tests.hints.scripts import SCRIPTS, Script

# less than usual: what has no end ends sooner, and no other script meets them
LIMITS = Limits(steps=150_000, output_bytes=256 * 1024)


def test_there_are_enough_scripts_of_either_sort() -> None:
    assert len({script.name for script in SCRIPTS}) == len(SCRIPTS) >= 70
    assert sum(not script.cause for script in SCRIPTS) >= 12


ROWS = [
    pytest.param(one, id=one.name.replace(" ", "-"), marks=[pytest.mark.slow] * bool(place % 4 and one.cause))
    for place, one in enumerate(SCRIPTS)
]


@pytest.mark.parametrize("script", ROWS)
def test_who_lacks_marks_is_told_why(grader: Grader, script: Script) -> None:
    report = grade(grader, script.assignment, script.source, limits=LIMITS)
    if script.cause:
        assert report.hint.zh
        assert report.hint.en
    else:
        assert report.mistakes == ()
        assert report.hint == EMPTY
        assert report.score == report.max_score


def test_a_script_in_gbk_that_declares_it_is_graded_as_python_runs_it(grader: Grader) -> None:
    right = next(script for script in SCRIPTS if script.name == "square as taught").source
    plain = "".join(character for character in right if character.encode("gbk", "ignore"))
    source = ("# -*- coding: gbk -*-\n" + plain).encode("gbk")
    assert grade(grader, "square", source).score == 100
