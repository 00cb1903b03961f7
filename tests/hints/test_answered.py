"""Scripts whose first hint once misled: what must be told now, a proven change or the cause in words."""

from pathlib import Path

import pytest

from grader.contracts.grading import GradingJob
from grader.grading.slot import Slot
from tests.e2e.grading_slot import catalog, grade
from tests.hints.beginners import beginners
from tests.hints.obeyed import obeyed, tried
from tests.rows import slow_but

FOLDER = Path(__file__).parent / "answered" / "scripts"
CHANGES = {  # file: assignment, kind of the first change, line, what it comes to
    "s14_string_type": ("straight", "type", 23, 100),
    "a57_wrong_pub_type_pose": ("square", "type", 21, 100),
    "b10_temp_twist": ("straight", "one_message", 36, 100),
    "q21_two_scripts": ("square", "two_scripts", 60, 100),
    "a43_oct_90": ("octagon", "scaled", 32, 100),
    "x02_hex_interior": ("hexagon", "scaled", 36, 100),
    "q31_str_speed": ("square", "float", 26, 100),
    "q23_stop_in_while": ("square", "out_of_loop", 54, 100),
    "o01_oct_range6": ("octagon", "count", 86, 100),
    "a42_pent_range3": ("pentagon", "count", 86, 100),
    "b22_tri_range2": ("triangle", "count", 86, 100),
}
UNFINISHED = {  # file, of a script with several faults: assignment
    "a19_pose_nospin": "square",
    "a53_float_ne": "square",
    "q36_caret_int": "square",
    "a70_keyword": "hello",
}
CAUSES = {  # file: assignment, code, a word that stands in both texts
    "r01_spawn_only_publishes_pose2d": ("square", "no_publisher", "/turtle1/cmd_vel"),
    "r02_never_published_on_other_topic": ("square", "nothing_sent", "/robot/cmd_vel"),
    "r03_kill_turtle1_drive_turtle2": ("square", "turtle_killed", "turtle1"),
    "r09_custom_interface": ("square", "own_interfaces", "my_robot_interfaces"),
    "a46_traceback_paste": ("square", "terminal_output", "1"),
    "b25_term_paste2": ("square", "terminal_output", "1"),
    "h11_terminal_paste": ("hello", "terminal_output", "1"),
}
SAMPLE = slow_but(7, [script for script in beginners() if script.verdict == "wrong"][12::40])


@pytest.mark.parametrize(("name", "expected"), CHANGES.items(), ids=CHANGES)
def test_the_change_that_mends_it_is_told_first(
    slot: Slot, name: str, expected: tuple[str, str, int, float]
) -> None:
    assignment, code, line, least = expected
    source = (FOLDER / f"{name}.py").read_text(encoding="utf-8")
    job = GradingJob(file_name="script.py", source=source.encode(), assignment=catalog().get(assignment))
    first = slot.explain(job).changes[0]
    assert (first.code, str(line) in first.text.zh, str(line) in first.text.en) == (code, True, True)
    score = grade(slot, assignment, obeyed(source, first)).score
    assert score is not None
    assert score >= max(least, first.before + 1)


@pytest.mark.parametrize(("name", "assignment"), UNFINISHED.items(), ids=UNFINISHED)
def test_a_change_that_does_not_end_at_full_marks_is_not_told(slot: Slot, name: str, assignment: str) -> None:
    source = (FOLDER / f"{name}.py").read_bytes()
    job = GradingJob(file_name="script.py", source=source, assignment=catalog().get(assignment))
    explanation = slot.explain(job)
    assert all(one.after == 100 for one in explanation.changes[-1:])
    assert explanation.changes or explanation.cause or grade(slot, assignment, source).hint.zh


@pytest.mark.parametrize(("name", "expected"), CAUSES.items(), ids=CAUSES)
def test_where_no_change_can_be_tried_the_cause_is_told(
    slot: Slot, name: str, expected: tuple[str, str, str]
) -> None:
    assignment, code, word = expected
    report = grade(slot, assignment, (FOLDER / f"{name}.py").read_bytes())
    assert report.mistakes[0] == code
    assert word in report.hint.zh
    assert word in report.hint.en


def test_a_timer_made_in_a_callback_is_stated_with_its_line(slot: Slot) -> None:
    source = (FOLDER / "q41_timer_in_callback.py").read_bytes()
    job = GradingJob(file_name="script.py", source=source, assignment=catalog().get("square"))
    cause = slot.explain(job).cause
    assert cause is not None
    assert (cause.code, cause.line) == ("timer_in_callback", 17)


@pytest.mark.parametrize("script", SAMPLE, ids=lambda script: script.file)
def test_a_change_that_is_told_gains_when_obeyed(slot: Slot, script: object) -> None:
    seen = tried(slot, script)  # type: ignore[arg-type]
    assert seen is None or seen.gains in (True, None)
