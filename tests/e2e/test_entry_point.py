"""Files without a call of `main`: drivers of a course that starts scripts by ros2 run, nothing in any other."""

from grader.contracts.assignment import RunsAs
from grader.contracts.grading import GradingJob
from grader.contracts.report import GradeReport
from grader.grading.slot import Slot
from tests.e2e.grading_slot import catalog

GUARD = "if __name__ =="


def graded(slot: Slot, source: bytes, runs_as: RunsAs) -> GradeReport:
    task = catalog().get("straight")
    return slot.grade(
        GradingJob(file_name="a.py", source=source, assignment=task.of_course(None, runs_as))
    ).report


def test_a_file_that_only_defines_main(slot: Slot) -> None:
    text = catalog().scripts("straight")["solution.py"].decode()
    unguarded = text[: text.index(GUARD)].encode()
    right = graded(slot, unguarded, "ros2_run")
    assert (right.score, [one.code for one in right.runs[0].outcome.notes]) == (100.0, ["main_called"])
    guarded = [graded(slot, text.encode(), way) for way in ("python", "ros2_run")]
    assert guarded[0] == guarded[1]
    wrong = graded(slot, unguarded, "python")
    assert wrong.score == 0.0
    assert "main()" in wrong.hint.en


def test_a_file_without_main_is_told_what_is_missing(slot: Slot) -> None:
    report = graded(slot, b"import rclpy\nif __name__ == '__main__':\n    rclpy.init()\n", "ros2_run")
    assert (report.score, report.mistakes[0]) == (0.0, "no_main")
    assert "def main():" in report.hint.en
