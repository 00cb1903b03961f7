"""Changes are told only where they end at full marks, at another horizon too; forged facts gain nothing."""

from dataclasses import replace

import pytest

from grader.contracts.explanation import Explanation
from grader.contracts.grading import GradingJob
from grader.edits.tree import changed_lines
from grader.grading.slot import Slot
from tests.e2e.grading_slot import LESSON, catalog, grade
from tests.hints.beginners import FOLDER
from tests.hints.obeyed import obeyed as with_change

TURNING = "msg.linear.x = 0.0\n        msg.angular.z = float"
SQUARE = (LESSON / "square_mover.py").read_text(encoding="utf-8")


def explained(slot: Slot, source: str, assignment: str = "square") -> Explanation:
    job = GradingJob(file_name="script.py", source=source.encode(), assignment=catalog().get(assignment))
    return slot.explain(job)


def obeyed(source: str, explanation: Explanation) -> str:
    """Return the script with all changes made as they were told."""
    for change in explanation.changes:
        source = with_change(source, change)
    return source


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("1.5708 / self.TURN_SPEED", "90 / self.TURN_SPEED", "degrees"),
        ("1.5708 / self.TURN_SPEED", "1.0 / self.TURN_SPEED", "scaled"),
        ("range(4)", "range(3)", "count"),
        ("msg.angular.z = float", "msg.angular.x = float", "axis"),
        ("'/turtle1/cmd_vel'", "'/turtle1/cmdvel'", "topic"),
        (TURNING, TURNING.replace("0.0", "1.0"), "left_over"),
        ("import time\n", "", "import"),
        ("self.SPEED = 1.0 ", "self.SPEDE = 1.0 ", "name"),
    ],
)
def test_the_first_change_that_is_told_gains_when_obeyed(slot: Slot, old: str, new: str, code: str) -> None:
    assert old in SQUARE
    wrong = SQUARE.replace(old, new, 1)
    before = grade(slot, "square", wrong).score
    explanation = explained(slot, wrong)
    assert [one.code for one in explanation.changes] == [code]
    (change,) = explanation.changes
    assert before == change.before < change.after == 100
    assert str(change.lines[0].number) in change.text.zh or code == "import"
    assert "100" in change.text.en
    after = obeyed(wrong, explanation)
    assert grade(slot, "square", after).score == 100
    assert len(changed_lines(wrong, after)) == len(change.lines) <= 2


LOOP = """        while (self.get_clock().now() - start_time).nanoseconds < duration * 1e9:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
"""
SENT_ONCE = "        self.cmd_vel_pub.publish(msg)\n        time.sleep(duration)\n"
NEVER_SENT = LOOP.replace("            self.cmd_vel_pub.publish(msg)\n", "")
TURN = SQUARE.index("def turn(")
FIRST = SQUARE.index(LOOP)


@pytest.mark.parametrize(
    ("old", "new", "at", "code"),
    [
        ("1.5708 / self", "1.5708 // self", 0, "operator"),
        ("1.5708 / self", "2 * 3.14159 // 4 / self", 0, "operator"),
        (LOOP, SENT_ONCE, TURN, "sent_once"),
        ("self.TURN_SPEED = 1.0 ", "self.TURN_SPEED = 0.5 ", 0, "sent_once"),
        (LOOP, NEVER_SENT, TURN, "publish_in_loop"),
        (LOOP, NEVER_SENT, FIRST, "publish_in_loop"),
        (LOOP, "        time.sleep(duration)\n", TURN, "publish_in_loop"),
    ],
)
def test_what_was_meant_is_told_before_a_number_that_also_fits(
    slot: Slot, old: str, new: str, at: int, code: str
) -> None:
    wrong = SQUARE[:at] + SQUARE[at:].replace(old, new, 1)
    if old.startswith("self.TURN_SPEED"):
        wrong = wrong[:TURN] + wrong[TURN:].replace(LOOP, SENT_ONCE, 1)
    assert wrong != SQUARE
    change = explained(slot, wrong).changes[0]
    assert (change.code, change.after) == (code, 100)


def test_a_stop_is_no_mistake_and_a_side_effect_no_explanation(slot: Slot) -> None:
    wrong = SQUARE.replace("1.5708 / self", "1.0 / self", 1)
    assert [one.code for one in explained(slot, wrong).changes] == ["scaled"]
    for spin in ("math.pi", "1.5"):
        script = (
            "import math, time, rclpy\nfrom geometry_msgs.msg import Twist\nrclpy.init()\n"
            "node = rclpy.create_node('a')\npub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
            "time.sleep(1)\nmsg = Twist()\nmsg.angular.z = 1.0\nend = time.time() + "
            f"{spin}\nwhile time.time() < end:\n    pub.publish(msg)\n    time.sleep(0.05)\npub.publish(Twist())\n"
        )
        assert all(one.code != "message" for one in explained(slot, script, "spin").changes)


WALKER = """import rclpy, threading, time
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Walker(Node):
    def __init__(self):
        super().__init__('walker')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.ticks = 0
        self.create_timer(0.05, self.step)
        OTHER
    def step(self):
        self.ticks += 1
        msg = Twist()
        if self.ticks % 61 < 40:
            msg.linear.x = 1.0
        else:
            msg.angular.z = 1.0
        self.pub.publish(msg)
    def forward(self):
        msg = Twist()
        msg.linear.x = 1.0
        self.pub.publish(msg)
    def always(self):
        while rclpy.ok():
            self.forward()
            time.sleep(0.1)
rclpy.init()
rclpy.spin(Walker())
"""


@pytest.mark.parametrize(
    "other",
    [
        "self.create_timer(0.05, self.forward)",
        "self.create_timer(0.1, self.forward)",
        "threading.Thread(target=self.always, daemon=True).start()",
    ],
)
def test_two_sources_that_overrule_each_other_are_stated_first(slot: Slot, other: str) -> None:
    explanation = explained(slot, WALKER.replace("OTHER", other))
    assert explanation.changes == ()
    assert explanation.cause is not None
    assert (explanation.cause.code, explanation.cause.line) == ("contended", 18)
    assert "22" in explanation.cause.text.zh


@pytest.mark.parametrize("head", ["range(4):", "def main(args=None):"])
def test_a_missing_colon_is_called_so(slot: Slot, head: str) -> None:
    assert head in SQUARE
    change = explained(slot, SQUARE.replace(head, head[:-1], 1)).changes[0]
    assert change.text.en.startswith("A colon : is missing at the end of line")


def test_one_change_is_looked_for_on_top_of_another(slot: Slot) -> None:
    wrong = SQUARE.replace("1.5708", "1.0", 1).replace("import time\n", "", 1)
    explanation = explained(slot, wrong)
    assert [one.code for one in explanation.changes] == ["import", "scaled"]
    assert explanation.changes[0].after == explanation.changes[1].before
    assert grade(slot, "square", obeyed(wrong, explanation)).score == 100


def test_the_same_script_gets_the_same_explanation(slot: Slot) -> None:
    wrong = SQUARE.replace("1.5708", "1.2", 1)
    assert explained(slot, wrong) == explained(slot, wrong)


def test_full_marks_cost_no_trial_and_prose_gets_no_change(slot: Slot) -> None:
    assert explained(slot, SQUARE) == Explanation()
    assert explained(slot, "for\n").changes == ()


def test_a_line_that_is_no_python_is_rewritten(slot: Slot) -> None:
    wrong = SQUARE.replace("range(4):", "range(4)：", 1)
    explanation = explained(slot, wrong)
    assert [one.code for one in explanation.changes] == ["syntax"]
    assert "English :" in explanation.changes[0].text.en
    assert obeyed(wrong, explanation) == SQUARE


STRAIGHT = (LESSON / "straight_mover.py").read_text(encoding="utf-8")
ONE = "        msg = Twist()\n"
ENDS = "        node.destroy_node()\n        rclpy.shutdown()\n"
ERRORS = {
    "module": [("rclpy", "Rclpy")],
    "rate": [
        (
            STRAIGHT[STRAIGHT.index("    try:") : STRAIGHT.index("    finally")],
            "    rate = rclpy.Rate(10)\n    try:\n        while rclpy.ok():\n"
            "            node.timer_callback()\n            rate.sleep()\n",
        )
    ],
    "subscription": [
        ("create_publisher(", "create_subscription("),
        ("            10\n", "            print, 10\n"),
    ],
    "callback": [
        ("def timer_callback(self)", "def timer_callback()"),
        ("self.cmd_vel_pub.publish", "cmd_vel_pub.publish"),
    ],
    "class's name": [
        ("msg = Twist()", "Twist = Twist()"),
        ("msg.", "Twist."),
        ("publish(msg)", "publish(Twist)"),
    ],
    "underscores": [("__init__", "_init_")],
    "ended": [
        ("    try:\n", "    node.destroy_node()\n    try:\n"),
        (ENDS, "        pass\n"),
    ],
    "fields": [(ONE, "        msg = Twist(linear.x=1.0)\n"), ("        msg.", "        # msg.")],
    "fence": [("#!/usr", "这是程序！\n```python\n#!/usr"), ("    main()\n", "    main()\n```\n好了！\n")],
    "scope": [("rclpy.spin", "rclpy::spin")],
    "docstring": [('"""定时器回调函数:每0.1秒执行一次"""', '"""定时器回调函数')],
    "parameter": [("x = 1.0", "x = self.get_parameter('speed').value")],
    "macro": [("self.get_logger().info(", "RCLCPP_INFO(self.get_logger(), ")],
    "clock": [(ONE, ONE + "        self.last = rclpy.time.Time.now()\n")],
}


@pytest.mark.parametrize("edits", ERRORS.values(), ids=ERRORS)
def test_what_an_exception_dictates_is_told(slot: Slot, edits: list[tuple[str, str]]) -> None:
    source = STRAIGHT
    for old, new in edits:
        assert old in source
        source = source.replace(old, new)
    explanation = explained(slot, source, "straight")
    assert explanation.changes
    assert grade(slot, "straight", obeyed(source, explanation)).score == 100


def test_two_errors_that_gain_only_together_are_told_as_one_change(slot: Slot) -> None:
    wrong = SQUARE.replace("import time\n", "", 1).replace("def __init__(self):", "def __init__(self)：", 1)
    (change,) = explained(slot, wrong).changes
    assert (change.code, change.before, change.after) == ("syntax", 0, 100)
    assert "import time" in change.text.en


def test_what_is_not_proven_is_stated_with_its_line(slot: Slot) -> None:
    call = "    node.move_square()"
    assert call in SQUARE
    cause = explained(slot, SQUARE.replace(call, f"    time.sleep(9999 + 1)\n{call}", 1)).cause
    assert cause is not None
    assert cause.code == "waits_before"
    assert str(cause.line) in cause.text.en


FORGERIES = {
    "a ledger of nonsense": b"\x32\x02" + b'{"ran":[1e9]}',
    "a ledger that is deep": b"\x32\x02" + b"[" * 50_000,
    "lines that are not there": b"\x32\x02"
    + b'{"ran":[1],"motions":[{"v":1.0,"w":0.0,"line":99999,"t":-5,"until":7,"times":1,"topic":""}],"end":[]}',
    "another tree": b"\x32\x01" + b'[["Module",-1,"",null,{}]]',
}


@pytest.mark.parametrize("frame", FORGERIES.values(), ids=FORGERIES)
def test_a_script_that_writes_facts_itself_gains_nothing(slot: Slot, frame: bytes) -> None:
    forger = f"import os\nbody = {frame!r}\nos.write(3, len(body).to_bytes(4, 'little') + body)\n"
    assert explained(slot, forger).changes == ()
    report = grade(slot, "square", forger)
    assert report.score == 0
    assert grade(slot, "square", SQUARE).score == 100


def test_an_assignment_that_names_its_check_by_an_older_name_is_explained(slot: Slot) -> None:
    task = replace(catalog().get("hello"), check="node")
    source = "import rclpy\nrclpy.init()\nnode = rclpy.create_node('hello node')\n"
    source += "node.get_logger().info('hello')\nrclpy.spin(node)\n"
    job = GradingJob(file_name="script.py", source=source.encode(), assignment=task)
    assert [one.code for one in slot.explain(job).changes] == ["node_name"]


TURTLE = """\
import math
import time
import rclpy
from geometry_msgs.msg import Twist
rclpy.init()
node = rclpy.create_node("turtle")
pub = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
time.sleep(1)
def drive(v, w, seconds):
    msg = Twist()
    msg.linear.x, msg.angular.z = v, w
    for _ in range(round(seconds / 0.02)):
        pub.publish(msg)
        time.sleep(0.02)
    pub.publish(Twist())
    time.sleep(0.1)
MOTIONS
"""
SLOW_TIMER = """\
def back():
    msg = Twist()
    msg.linear.x = -0.15
    pub.publish(msg)
node.create_timer(HERTZ, back)
rclpy.spin(node)"""
CIRCLES = "for r in (0.8, 1.6):\n    drive(1.0, RATE, WAY * r)"
MOST_OF_A_RECTANGLE = """\
for _ in range(2):
    drive(1.0, 0.0, 3.0)
    drive(0.0, 1.0, math.pi / 2)
    drive(1.0, 0.0, 2.0)"""


@pytest.mark.parametrize(
    ("assignment", "motions", "stated"),
    [
        ("backward", SLOW_TIMER.replace("HERTZ", "5"), ("period", 21)),
        ("backward", SLOW_TIMER.replace("HERTZ", "10 / 2"), ("period", 21)),
        ("two_circles", CIRCLES.replace("RATE", "r").replace("WAY * r", "2 * math.pi / r"), ("radius", 13)),
        ("two_circles", CIRCLES.replace("RATE", "1 / r").replace("WAY", "math.pi"), ("turned_plain", 13)),
        ("rectangle", MOST_OF_A_RECTANGLE, ("in_line", 18)),
    ],
)
def test_what_a_line_did_is_stated(
    slot: Slot, assignment: str, motions: str, stated: tuple[str, int]
) -> None:
    explanation = explained(slot, TURTLE.replace("MOTIONS", motions), assignment)
    assert explanation.cause is not None
    assert (explanation.changes, explanation.cause.code, explanation.cause.line) == ((), *stated)


@pytest.mark.parametrize(
    "motions",
    [
        "i = 1\nwhile i < 4:\n    drive(1.0, 0.0, 2.0)\n    drive(0.0, 1.0, 1.5708)\n    i += 1",
        "side = 2.0\nfor i in range(4):\n    drive(1.0, 0.0, side)\n    drive(0.0, 1.0, side)",
    ],
    ids=["a loop that would never end", "a number that changes the sides, too"],
)
def test_what_earns_all_by_a_trick_is_not_told(slot: Slot, motions: str) -> None:
    for change in explained(slot, TURTLE.replace("MOTIONS", motions)).changes:
        assert change.code not in ("out_of_loop", "scaled", "sign")


TIMED = """import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Steps(Node):
    def __init__(self):
        super().__init__('steps')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.begin, self.index = self.get_clock().now(), 0
        self.timer = self.create_timer(0.01, self.update)
    def update(self):
        elapsed = (self.get_clock().now() - self.begin).nanoseconds / 1e9
        msg = Twist()
LOOP
rclpy.init()
rclpy.spin(Steps())
"""
PLAN = """        if self.index == 5:
            self.timer.cancel()
            return
        v, w, t = [(1.0, 0.0, 2.0), (0.0, 1.0, 2.0944)][self.index % 2]
        if elapsed >= t:
            self.index, self.begin = self.index + 1, self.get_clock().now()
            return
        msg.linear.x, msg.angular.z = v, w
        self.pub.publish(msg)"""
BRIEF = """        if elapsed < 3.0:
            msg.linear.x = 1.0
        self.pub.publish(msg)"""


@pytest.mark.parametrize(
    ("assignment", "script", "after"),
    [
        ("straight", "speed = 0.2\ndistance = 1.0\ndrive(speed, 0.0, distance * speed)", "distance / speed"),
        ("straight", "DISTANCE = 2.0\nV = 0.5\ndrive(V, 0.0, V / DISTANCE)", "DISTANCE / V"),
        ("straight", TIMED.replace("LOOP", BRIEF).replace("1e9", "1e6"), "nanoseconds / 1e9"),
        ("triangle", TIMED.replace("LOOP", PLAN), "self.pub.publish(Twist())"),
    ],
    ids=[
        "at least 0.5 m, but 1 m by name",
        "upside down",
        "a time that has passed is not negative",
        "the end",
    ],
)
def test_what_is_meant_by_the_names_of_a_script_is_told(
    slot: Slot, assignment: str, script: str, after: str
) -> None:
    text = script if script.startswith("import") else TURTLE.replace("MOTIONS", script)
    (change,) = explained(slot, text, assignment).changes
    assert after in (change.lines[0].after or "")


def test_two_arguments_that_were_confused_are_exchanged(slot: Slot) -> None:
    motions = "for i in range(4):\n    drive(0.0, 2.0, 1.0)\n    drive(1.5708, 0.0, 1.0)"
    (change,) = explained(slot, TURTLE.replace("MOTIONS", motions)).changes
    assert (change.code, len(change.lines)) == ("exchanged", 2)


def test_the_first_step_is_of_what_its_own_measurement_costs(slot: Slot) -> None:
    five = "for _ in range(5):\n    drive(1.0, 0.0, 1.5)\n    drive(0.0, 1.0, math.pi / 3)"
    report = grade(slot, "hexagon", TURTLE.replace("MOTIONS", five))
    sides = next(item for item in report.items if item.id == "sides")
    assert report.hint.en.startswith(f"{sides.title.en}: {sides.message.en}")
    assert report.hint.en.endswith(sides.hint.en)


def test_what_an_error_after_full_marks_means_is_said(slot: Slot) -> None:
    report = grade(slot, "straight", TURTLE.replace("MOTIONS", "drive(1.0, 0.0, 1.0)\nprint(way)"))
    assert report.score == 100
    assert "way" in report.hint.en


def test_a_constant_is_not_scaled_and_an_empty_message_is_replaced(slot: Slot) -> None:
    half = "PI = 3.1416\ndrive(0.0, 1.0, PI)"
    turn = explained(slot, TURTLE.replace("MOTIONS", half), "spin")
    assert not any("6.28" in (line.after or "") for change in turn.changes for line in change.lines)
    empty = TURTLE.replace("        pub.publish(msg)", "        pub.publish(Twist())")
    (change,) = explained(slot, empty.replace("MOTIONS", "drive(-0.5, 0.0, 4)"), "backward").changes
    assert (change.code, change.after) == ("message", 100)


CALL = "            self.turn(self.TURN_TIME)\n"
METHOD = "    def move_square(self):"
SILENT = {
    "spun_early": ("    time.sleep(1)\n", "    rclpy.spin(node)\n"),
    "brackets": (CALL, "            self.turn\n"),
    "commented": (CALL, CALL.replace("self", "# self", 1)),
    "call": (CALL, ""),
    "defined_twice": (METHOD, "    def turn(self, duration):\n        pass\n\n" + METHOD),
    "stalls": ("time.sleep(0.01)", "rclpy.spin_once(self)"),
    "quality": ("            10\n", "            rclpy.qos.qos_profile_sensor_data\n"),
    "await": (METHOD, METHOD.replace("def", "async def")),
}


@pytest.mark.parametrize("code", SILENT)
def test_what_keeps_lines_from_running_is_taken_away(slot: Slot, code: str) -> None:
    old, new = SILENT[code]
    assert old in SQUARE
    explanation = explained(slot, SQUARE.replace(old, new))
    assert [(one.code, one.after) for one in explanation.changes] == [(code, 100)]


@pytest.mark.parametrize(
    ("file", "assignment", "stated"),
    [
        ("093_straight_loop_in_constructor", "straight", ("frozen_loop", 12)),
        ("193_square_wait_in_callback", "square", ("deaf_callback", 30)),
        ("491_square_looks_like_error_hidden", "square", ("deaf_loop", 11)),
        ("224_triangle_half_done", "triangle", ("unfinished", 33)),
        ("278_feedback_square_starter_pass", "feedback_square", ("unfinished", 28)),
    ],
)
def test_what_never_changes_or_is_still_to_be_written_is_stated(
    slot: Slot, file: str, assignment: str, stated: tuple[str, int]
) -> None:
    source = (FOLDER / "scripts" / f"{file}.py").read_text(encoding="utf-8")
    cause = explained(slot, source, assignment).cause
    assert cause is not None
    assert (cause.code, cause.line) == stated
