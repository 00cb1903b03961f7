"""How often something is done: the change that is told is the one that was meant, at the place that counts."""

import pytest

from grader.contracts.explanation import Explanation
from grader.contracts.grading import GradingJob
from grader.grading.slot import Slot
from tests.e2e.grading_slot import LESSON, catalog

SQUARE = (LESSON / "square_mover.py").read_text(encoding="utf-8")
HEAD = "        for i in range(4):\n"
SIDE = "            self.move_straight(self.MOVE_TIME)\n            self.turn(self.TURN_TIME)\n"
COUNTED = "            i += 1\n"
STEP = (
    "            if step == 'go':\n                self.move_straight(self.MOVE_TIME)\n"
    "            else:\n                self.turn(self.TURN_TIME)\n"
)
INNER = """            while i < 5:
                self.move_straight(self.MOVE_TIME / 5)
                i += 1
            self.turn(self.TURN_TIME)
            i += 1
"""

TIMER = """import math, rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.state = 'go'
        self.start = self.get_clock().now()
        self.sides = 0
        self.create_timer(0.02, self.tick)
    def tick(self):
        passed = (self.get_clock().now() - self.start).nanoseconds / 1e9
        msg = Twist()
        if self.sides >= 4:
            self.pub.publish(msg)
            return
        if self.state == 'go':
            msg.linear.x = 1.0
            if passed >= 2.0:
                self.state = 'turn'
                self.start = self.get_clock().now()
        elif self.state == 'turn':
            msg.angular.z = math.pi / 4
            if passed >= 2.0:
                self.start = self.get_clock().now()
                self.sides += 1
                self.state = 'go'
        self.pub.publish(msg)
rclpy.init()
rclpy.spin(Square())
"""


def explained(slot: Slot, source: str) -> Explanation:
    job = GradingJob(file_name="script.py", source=source.encode(), assignment=catalog().get("square"))
    return slot.explain(job)


def loop(head: str, body: str = SIDE) -> str:
    """Return the lesson's square with another loop over the sides."""
    begin, end = SQUARE.index(HEAD), SQUARE.index("        self.get_logger().info('🎉")
    return SQUARE[:begin] + head + body + SQUARE[end:]


@pytest.mark.parametrize(
    ("script", "code", "before", "after"),
    [
        (loop("        for i in range(1, 4):\n"), "count", "range(1, 4)", "range(4)"),
        (
            loop("        for i in range(1, 4):\n            print(i)\n"),
            "count",
            "range(1, 4)",
            "range(1, 5)",
        ),
        (loop("        for i in range(5):\n"), "count", "range(5)", "range(4)"),
        (loop("        for i in range(4 - 1):\n"), "count", "range(4 - 1)", "range(4)"),
        (loop("        n = 3\n        for i in range(n):\n"), "count", "n = 3", "n = 4"),
        (loop("        i = 0\n        while i <= 4:\n", SIDE + COUNTED), "comparison", "i <= 4", "i < 4"),
        (loop("        i = 1\n        while i < 4:\n", SIDE + COUNTED), "comparison", "i < 4", "i <= 4"),
        (loop("        i = 0\n        while i < 3:\n", SIDE + COUNTED), "count", "i < 3", "i < 4"),
        (
            loop("        i = 4\n        while i > 1:\n", SIDE + COUNTED.replace("+", "-")),
            "comparison",
            "i > 1",
            "i >= 1",
        ),
        (
            loop("        i = 3\n        while i > 0:\n", SIDE + COUNTED.replace("+", "-")),
            "count",
            "i = 3",
            "i = 4",
        ),
        (loop("        for step in ['go', 'turn'] * 3:\n", STEP), "count", "* 3", "* 4"),
        (
            loop("        i = 0\n        while i < 4:\n            i = 0\n", INNER),
            "renamed",
            "i = 0",
            "j = 0",
        ),
        (TIMER.replace("self.sides >= 4", "self.sides >= 3"), "count", ">= 3", ">= 4"),
        (TIMER.replace("self.sides >= 4", "self.sides > 4"), "comparison", "> 4", ">= 4"),
        (TIMER.replace("'turn'\n", "'turn'\n                self.sides += 1\n", 1), "removed", "+= 1", ""),
        (TIMER.replace("                self.state = 'go'\n", "", 1), "state", "", "self.state = 'go'"),
        (
            TIMER.replace(
                "+= 1\n                self.state = 'go'", "+= 1\n                self.state = 'turn'"
            ),
            "state",
            "'turn'",
            "'go'",
        ),
        (TIMER.replace("self.state = 'go'", "self.state = 'Go'", 1), "state", "'Go'", "'go'"),
        (
            TIMER.replace("self.state == 'go'", "self.sides % 2 == 0")
            .replace("elif self.state == 'turn'", "else")
            .replace("self.sides >= 4", "self.sides >= 8")
            .replace("                self.sides += 1\n", ""),
            "counter",
            "",
            "self.sides += 1",
        ),
        (
            TIMER.replace("                self.start = self.get_clock().now()\n", ""),
            "clock_anew",
            "",
            "self.start = self.get_clock().now()",
        ),
        (
            TIMER.replace(
                "        msg = Twist()\n",
                "        self.start = self.get_clock().now()\n        msg = Twist()\n",
                1,
            ),
            "removed",
            "self.start = ",
            "",
        ),
        (TIMER.replace("if passed >= 2.0", "if passed <= 2.0", 1), "comparison", "<= 2.0", ">= 2.0"),
        (
            TIMER.replace("passed >=", "self.passed() >=")
            .replace("        passed = (", "    def passed(self):\n        return (")
            .replace("    def tick(self):\n", "")
            .replace("/ 1e9\n", "/ 1e9\n    def tick(self):\n")
            .replace("                self.start = self.get_clock().now()\n", ""),
            "clock_anew",
            "",
            "self.start = self.get_clock().now()",
        ),
    ],
)
def test_the_count_that_was_meant_is_told(
    slot: Slot, script: str, code: str, before: str, after: str
) -> None:
    (change,) = explained(slot, script).changes
    assert (change.code, change.after) == (code, 100)
    line = change.lines[0]
    assert before in (line.before or "")
    assert after in (line.after or "")
