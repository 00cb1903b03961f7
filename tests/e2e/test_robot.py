"""Scripts of the robot's exercises, in the real sandbox: sensors arrive, QoS counts, the same bytes come again."""

import os

import pytest

from grader.catalog import Catalog, set_root
from grader.commands.validation import examine
from grader.contracts.grading import Grader
from grader.contracts.text import EMPTY
from tests.e2e.grading_slot import catalog, grade
from tests.rows import slow_but

EXERCISES = [one.id for one in Catalog(set_root("robot")).all()]
SEEDS = int(os.environ.get("SEEDS", "0"))


@pytest.mark.parametrize("name", slow_but(2, EXERCISES))
def test_own_scripts_get_what_they_must(grader: Grader, name: str) -> None:
    """The solution gets full marks. ``SEEDS=20`` tries all scripts with so many rooms, noises and wheels."""
    assert grade(grader, name, own(name)).score == 100
    for shift in range(SEEDS):
        findings = examine(catalog().with_seeds(100 * shift), name, grader).findings
        assert len(findings) >= 6
        assert not [finding for finding in findings if finding.problem != EMPTY], shift


def own(name: str, file: str = "solution.py") -> bytes:
    return catalog().scripts(name)[file]


@pytest.mark.slow
def test_a_robot_stops_before_the_wall_with_the_same_bytes_after_others(grader: Grader) -> None:
    first = grade(grader, "stop_before_wall", own("stop_before_wall"))
    assert (first.score, first.simulator[:5]) == (100, "robot")
    assert grade(grader, "spin", own("spin")).score == 100
    assert grade(grader, "follow_line", own("follow_line")).score == 100
    assert grade(grader, "stop_before_wall", own("stop_before_wall")).sha256() == first.sha256()


def test_the_wrong_qos_is_told_by_the_script_and_by_the_hint(grader: Grader) -> None:
    report = grade(grader, "stop_before_wall", own("stop_before_wall", "wrong/reliable_scan.py"))
    assert (report.score, report.mistakes[0]) == (0, "sensor_qos")
    assert "qos_profile_sensor_data" in report.hint.en
    assert [note.code for note in report.runs[0].outcome.notes if "qos" in note.code] == ["sensor_qos"]
    warned = report.runs[0].outcome.logs[0]
    assert "'/scan', offering incompatible QoS" in warned.message


TICKS = """import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

class Stop(Node):
    def __init__(self):
        super().__init__('stop')
        self.pub = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(LaserScan, 'scan', self.on_scan, qos_profile_sensor_data)
        self.ahead = None
        self.create_timer(0.05, self.tick)
    def on_scan(self, scan):
        self.ahead = scan.ranges[0]
    def tick(self):
        msg = Twist()
        if self.ahead is not None and self.ahead > 0.53:
            msg.linear.x = 0.2
        self.pub.publish(msg)

rclpy.init()
rclpy.spin(Stop())
"""


@pytest.mark.parametrize(
    ("old", "new", "mistakes", "words"),
    [
        ("import rclpy\n", "import rclpy\n", (), ""),
        ("ranges[0]", "ranges[180]", ("room_hit",), "slow down, stop or turn away"),
        ("ranges[0]", "ranges[360]", ("index_range",), "out of range"),
        ("LaserScan", "PointCloud2", ("not_received",), "The type of /scan is wrong"),
    ],
    ids=["right", "wrong ray", "no such ray", "wrong type"],
)
def test_who_reads_the_scan_wrongly_is_told_how(
    grader: Grader, old: str, new: str, mistakes: tuple[str, ...], words: str
) -> None:
    report = grade(grader, "stop_before_wall", TICKS.replace(old, new))
    assert report.mistakes[:1] == mistakes
    assert words in report.hint.en
    assert (report.score == 100) == (not mistakes)
