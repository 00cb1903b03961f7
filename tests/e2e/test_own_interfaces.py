"""A workspace with a package of interfaces beside the node that uses them."""

from dataclasses import replace

import pytest

from grader.catalog import Catalog, set_root
from grader.contracts.assignment import Assignment, WantedPackage
from grader.contracts.conversation import Expectation, Step
from grader.contracts.grading import Grader, GradingJob
from grader.contracts.report import GradeReport
from grader.formats.packages.bundle import bundled
from tests.fakes.packages import NAME, package_files, zipped

CMAKE = """cmake_minimum_required(VERSION 3.8)
project(score_msgs)
find_package(rosidl_default_generators REQUIRED)
rosidl_generate_interfaces(${PROJECT_NAME}
  "msg/Score.msg"
  "srv/Best.srv"
)
ament_package()
"""
MANIFEST = """<?xml version="1.0"?>
<package format="3">
  <name>score_msgs</name><version>0.0.0</version><description>Scores</description>
  <maintainer email="a@b.cn">a</maintainer><license>MIT</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
NODE = """import rclpy
from rclpy.node import Node
from score_msgs.msg import Score
from score_msgs.srv import Best


class Book(Node):
    def __init__(self):
        super().__init__('book')
        self.best = Score()
        self.create_subscription(Score, 'score', self.on_score, 10)
        self.create_service(Best, 'best', self.on_best)

    def on_score(self, msg):
        if msg.points > self.best.points:
            self.best = msg

    def on_best(self, request, response):
        response.score = self.best
        return response


def main():
    rclpy.init()
    try:
        rclpy.spin(Book())
    except KeyboardInterrupt:
        pass
"""
INTERFACES = {
    "score_msgs/package.xml": MANIFEST,
    "score_msgs/CMakeLists.txt": CMAKE,
    "score_msgs/msg/Score.msg": "string name\nfloat64 points\n",
    "score_msgs/msg/Unlisted.msg": "string name\n",
    "score_msgs/srv/Best.srv": "---\nScore score\n",
}


def exercise(*, allowed: bool = True) -> Assignment:
    task = Catalog(set_root("nodes")).get("score_book")
    steps = (
        Step(id="scores", kind="publish", target="/score", type="score_msgs/msg/Score", at_ns=2_000_000_000,
             each=({"name": "li", "points": 60.0}, {"name": "wang", "points": 90.0}), every_ns=500_000_000),
        Step(id="best", kind="call", target="/best", type="score_msgs/srv/Best", at_ns=5_000_000_000),
    )  # fmt: skip
    wanted = Expectation(kind="answer", target="best", values={"score": {"name": "wang", "points": 90.0}})
    item = replace(
        task.items[1], id="best", points=100.0, needs=(), measure="expected.best", expect=(wanted,)
    )
    package = WantedPackage(executable="drive", interfaces=allowed)
    return replace(task, input="package", package=package, interfaces=(), steps=steps, items=(item,))


def graded(grader: Grader, changed: dict[str, str], *, allowed: bool = True) -> GradeReport:
    own = package_files(**{f"{NAME}/drive.py": NODE})
    files = {**{f"src/{NAME}/{path.partition('/')[2]}" if path.startswith(f"{NAME}/") else path: text
                for path, text in own.items()},
             **{f"src/{path}": text.encode() for path, text in {**INTERFACES, **changed}.items()}}  # fmt: skip
    job = GradingJob(file_name="p.zip", source=bundled(zipped(files)), assignment=exercise(allowed=allowed))
    return grader.grade(job).report


def test_interfaces_of_the_workspace_can_be_imported_and_spoken(grader: Grader) -> None:
    report = graded(grader, {})
    assert (report.score, report.mistakes) == (100.0, ())


@pytest.mark.parametrize(
    ("changed", "mistake", "said"),
    [
        ({"score_msgs/msg/Score.msg": "text name\n"}, "package_interface", "score_msgs/msg/Score.msg:1"),
        ({"score_msgs/CMakeLists.txt": "project(score_msgs)\n"}, "own_interfaces", "score_msgs"),
    ],
)
def test_what_is_wrong_with_them_is_told(
    grader: Grader, changed: dict[str, str], mistake: str, said: str
) -> None:
    report = graded(grader, changed)
    assert report.score == 0.0
    assert report.mistakes[0] == mistake
    assert said in report.hint.en


def test_they_are_left_out_where_the_assignment_does_not_allow_them(grader: Grader) -> None:
    report = graded(grader, {}, allowed=False)
    assert (report.score, report.mistakes[0]) == (0.0, "own_interfaces")
