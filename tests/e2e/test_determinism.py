"""The same submission gets the same bytes: again, beside others on a loaded machine, after anything before it."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest

from grader.contracts.grading import Grader, GradingJob, RunProgress
from grader.grading.slot import Slot, SlotConfig
from tests.e2e.grading_slot import LESSON, catalog, grade

SQUARE = (LESSON / "square_mover.py").read_bytes()
TIMES = 4


def digests(grader: Grader, others: list[bytes]) -> list[str]:
    """Grade the square again and again, with another script in between."""
    found = []
    for turn in range(TIMES):
        found.append(grade(grader, "square", SQUARE).sha256())
        grade(grader, "spin", others[turn % len(others)])
    return found


def test_one_report_whatever_else_the_machine_does() -> None:
    others = [source for name, source in catalog().scripts("spin").items() if name.startswith("wrong/")]
    slots = [Slot(SlotConfig()) for _ in range(3)]
    try:
        with ThreadPoolExecutor(len(slots)) as pool:
            found = list(pool.map(lambda slot: digests(slot, others), slots))
    finally:
        for slot in slots:
            slot.close()
    assert len({digest for each in found for digest in each}) == 1


def test_what_differs_in_the_file_differs_in_the_report(grader: Grader) -> None:
    source = (LESSON / "hello_node.py").read_bytes()
    first = grade(grader, "hello", source)
    other = grade(grader, "hello", source.replace("我是".encode(), "这是".encode()))
    assert first.score == other.score == 100
    assert first.sha256() != other.sha256()


def test_a_slot_grades_both_releases_each_as_its_own(slot: Slot) -> None:
    """A slot's processes are prepared for Humble before it is known what comes."""
    wrong = SQUARE.replace(b"float(self.SPEED)", b"int(self.SPEED) + 1")
    on_humble = catalog().get("square")
    on_jazzy = replace(on_humble, distro="jazzy")
    found = [
        slot.grade(GradingJob(file_name="a.py", source=source, assignment=assignment)).report
        for source in (SQUARE, wrong)
        for assignment in (on_humble, on_jazzy, on_humble)
    ]
    assert [report.interface for report in found[:3]] == ["ros2-humble", "ros2-jazzy", "ros2-humble"]
    assert [report.score for report in found[:3]] == [100, 100, 100]
    assert found[0].sha256() == found[2].sha256()
    mistakes = ["int_in_float", "int_in_float_at_publish", "int_in_float"]
    assert [report.mistakes[0] for report in found[3:]] == mistakes


BUSY = b"""
import rclpy
rclpy.init()
node = rclpy.create_node('counter')
def tick():
    node.get_logger().info(str(sum(range(300_000))))
node.create_timer(0.5, tick)
rclpy.spin(node)
"""


@pytest.mark.slow
def test_a_run_that_is_told_of_is_the_same_run(slot: Slot) -> None:
    job = GradingJob(file_name="a.py", source=BUSY, assignment=catalog().get("square"))
    told: list[RunProgress] = []
    followed = slot.grade(job, lambda: None, told.append)
    alone = slot.grade(job)
    assert followed.report.sha256() == alone.report.sha256()
    assert followed.trajectories == alone.trajectories
    assert told[-1].t_ns > 0
    assert "44999850000" in told[-1].stderr


def test_clocks_copied_by_modules_are_looked_for_in_all_that_a_process_is_forked_with(
    grader: Grader,
) -> None:
    source = b"""
import sys
from rclpy._patches import install
print([name for name in sys.modules if name not in install._searched and not name.startswith(install._OURS)])
"""
    (run,) = grade(grader, "hello", source).runs
    assert run.outcome.stdout.text == "[]\n"
