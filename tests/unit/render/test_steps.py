"""What students are told of lost points, by how much the teacher lets be told."""

from dataclasses import replace

import pytest

from grader.contracts.assignment import Hints
from grader.contracts.explanation import ChangedText, Explanation, ProvenChange, StatedCause
from grader.contracts.grading import GradingJob
from grader.contracts.report import GradeReport
from grader.contracts.rubric import ItemStatus
from grader.contracts.text import EMPTY, Text
from grader.render.steps import own_hints, steps, told
from tests.fakes.grading import assignment, grade

OWN = Text(zh="想想外角", en="think of the outer angle")
CHANGE = ProvenChange(
    code="scaled",
    text=Text(zh="第 2 行：把 1 改成 2（试过：5 → 10）", en="line 2: write 2 for 1 (tried: 5 -> 10)"),
    lines=(ChangedText(number=2, before="    turn(1)", after="    turn(2)"),),
    before=5.0,
    after=10.0,
    gains=("closed",),
)
ADDED = replace(CHANGE, lines=(ChangedText(number=44, before=None, after="stop()"),))
FOUND = Explanation(changes=(CHANGE,), tried=3)


@pytest.fixture
def report() -> GradeReport:
    graded = grade(GradingJob(file_name="square.py", source=b"good", assignment=assignment())).report
    items = tuple(
        replace(item, status=ItemStatus.FAILED, earned=0.0, message=Text(zh="差 1 m", en="1 m off"))
        if item.id == "closed"
        else item
        for item in graded.items
    )
    guess = Text(zh="猜的", en="a guess")
    items = tuple(replace(item, hint=guess if item.id == "closed" else EMPTY) for item in items)
    return replace(graded, items=items, hint=guess, mistakes=("too_short",))


def test_one_step_after_the_other(report: GradeReport) -> None:
    (step,) = steps(report, FOUND, Hints.CHANGE)
    assert step.fact.en == "Back at the start: 1 m off"
    assert step.line.en == "Look at line 2: turn(1)"
    assert (step.change, step.lines) == (CHANGE.text, CHANGE.lines)
    (line,) = steps(report, FOUND, Hints.LINE)
    assert line == replace(step, change=EMPTY, lines=())
    (fact,) = steps(report, FOUND, Hints.FACT)
    assert fact == replace(line, line=EMPTY)


def test_a_step_begins_with_what_still_lacks_points(report: GradeReport) -> None:
    """Not with an item whose points a teacher gave."""
    passed = next(item for item in report.items if item.status is ItemStatus.PASSED)
    report = replace(report, items=(replace(passed, id="given"), *report.items))
    found = Explanation(changes=(replace(CHANGE, gains=("given", "closed")),))
    assert steps(report, found, Hints.FACT)[0].fact.en == "Back at the start: 1 m off"


def test_what_is_added_has_the_line_before_it(report: GradeReport) -> None:
    (step,) = steps(report, Explanation(changes=(ADDED,)), Hints.LINE)
    assert step.line.en == "Look after line 44."


def test_changes_keep_the_order_in_which_they_are_to_be_made(report: GradeReport) -> None:
    both = steps(report, Explanation(changes=(ADDED, CHANGE)), Hints.CHANGE)
    assert [step.lines for step in both] == [ADDED.lines, CHANGE.lines]


def test_what_was_tried_takes_the_place_of_what_was_guessed(report: GradeReport) -> None:
    shown = told(report, FOUND, Hints.CHANGE, {})
    assert shown.hint == CHANGE.text
    assert [item.hint for item in shown.items if item.id == "closed"] == [EMPTY]
    assert shown.mistakes == ("change.scaled",)
    assert told(report, Explanation(), Hints.CHANGE, {}) == report
    same = replace(shown, hint=report.hint, mistakes=report.mistakes, items=report.items)
    assert same == report  # nothing else changes


@pytest.mark.parametrize("level", [Hints.FACT, Hints.LINE])
@pytest.mark.parametrize("found", [FOUND, Explanation()])
def test_no_other_way_tells_more(report: GradeReport, level: Hints, found: Explanation) -> None:
    said = str(told(report, found, level, {}).to_dict())
    assert "guess" not in said
    assert "too_short" not in said
    assert "write 2" not in said
    assert ("line 2" in said) is (level is Hints.LINE and bool(found.changes))
    assert "1 m off" in said


@pytest.mark.parametrize("level", Hints)
def test_the_teachers_own_words_go_first(report: GradeReport, level: Hints) -> None:
    task = assignment()
    task = replace(task, items=(task.items[0], replace(task.items[1], hint=OWN)))
    own = own_hints(task, report)
    assert own == {"closed": OWN}
    blocked = tuple(replace(item, status=ItemStatus.NOT_CHECKED) for item in report.items)
    assert not own_hints(task, replace(report, items=blocked))
    shown = told(report, FOUND, level, own)
    assert shown.hint.en.startswith("think of the outer angle\n")
    assert [item.hint for item in shown.items if item.id == "closed"] == [OWN]


@pytest.mark.parametrize("level", Hints)
def test_where_nothing_gains_the_run_shows_a_line(report: GradeReport, level: Hints) -> None:
    cause = StatedCause(code="loop", line=9, text=Text(zh="第 9 行一直循环", en="line 9 loops for ever"))
    found = Explanation(cause=cause, tried=5)
    said = told(report, found, level, {}).hint.en
    assert ("line 9 loops" in said) is (level is not Hints.FACT)
