"""Scripts that drive three sides and then misbehave: told why, paid for what they drove, each time the same."""

from dataclasses import replace

import pytest

from grader.contracts.assignment import MIB, Limits
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.outcome import RunStatus
from grader.contracts.report import GradeStatus
from grader.grading.slot import Slot
from tests.e2e.grading_slot import catalog
from tests.rows import slow_but

LIMITS = Limits(grace_cpu_s=0.2, output_bytes=256 * 1024, memory_bytes=192 * MIB)
BRIEF = replace(LIMITS, cpu_s=0.3, steps=100_000)  # three sides and what was seen take 0.06 s
THREE_SIDES = """\
import math, os, sys, threading, time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

rclpy.init()
node = Node('mover')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
def drive(v, w, seconds):
    msg = Twist()
    msg.linear.x, msg.angular.z = v, w
    for _ in range(round(seconds / 0.05)):
        pub.publish(msg)
        time.sleep(0.05)
for _ in range(3):
    drive(2.0, 0.0, 1.0)
    drive(0.0, math.pi / 2, 1.0)
pub.publish(Twist())
node.get_logger().info('three sides')
print('nearly done', object())
"""
SEEN = """
from turtlesim.msg import Pose
listener = node.create_subscription(Pose, '/turtle1/pose', lambda pose: None, 10)
for _ in range(200):
    rclpy.spin_once(node)
node.destroy_subscription(listener)
"""  # what was printed has been read by then, however long the grader is kept waiting from there on
FIRST_LINE = THREE_SIDES.count("\n") + 1

# name -> (what follows, status, words of the hint in Chinese and in English)
ENDINGS = {
    "loops": (SEEN + "while True:\n    pass\n", RunStatus.CPU_LIMIT, ("计算时间", "computing time")),
    "counts": (SEEN + "sum(range(10**12))\n", RunStatus.CPU_LIMIT, ("计算时间", "computing time")),
    "prints": (
        "while True:\n    print('x' * 100)\n",
        RunStatus.OUTPUT_LIMIT,
        ("输出太多", "printed too much"),
    ),
    "prints on both": (
        "while True:\n    print('x' * 100)\n    print('y' * 33, file=sys.stderr)\n",
        RunStatus.OUTPUT_LIMIT,
        ("输出太多", "printed too much"),
    ),
    "logs": (
        "while True:\n    node.get_logger().warn('x' * 50)\n",
        RunStatus.OUTPUT_LIMIT,
        ("输出太多", "printed too much"),
    ),
    "runs a program": (
        "os.execv('/bin/ls', ['ls'])\n",
        RunStatus.FORBIDDEN,
        ("os.exec: /bin/ls", "os.exec: /bin/ls"),
    ),
    "writes a file": (
        "open('/etc/result.txt', 'w')\n",
        RunStatus.FORBIDDEN,
        ("写文件 /etc/result.txt", "writing the file /etc/result.txt"),
    ),
    "asks the network": (
        "import urllib.request\nurllib.request.urlopen('http://127.0.0.1:9')\n",
        RunStatus.FORBIDDEN,
        ("socket", "socket"),
    ),
    "waits for ever": (
        "threading.Event().wait()\n",
        RunStatus.STALLED,
        (f"第 {FIRST_LINE} 行", f"line {FIRST_LINE}"),
    ),
    "takes all memory": (
        "kept = []\nwhile True:\n    kept.append(bytearray(1 << 20))\n",
        RunStatus.MEMORY_LIMIT,
        ("内存", "memory"),
    ),
    "takes all memory in a thread": (
        "def hoard():\n    kept = []\n    while True:\n        kept.append(bytearray(1 << 20))\n"
        "worker = threading.Thread(target=hoard)\nworker.start()\nworker.join()\n",
        RunStatus.MEMORY_LIMIT,
        ("内存", "memory"),
    ),
    "tampers": (
        "os.write(3, b'\\x01\\0\\0\\0\\x7f')\ntime.sleep(1)\n",
        RunStatus.PROTOCOL,
        ("通信", "channel"),
    ),
    "crashes in C": (
        "import ctypes\nctypes.string_at(0)\n",
        RunStatus.CRASHED,
        ("SIGSEGV", "SIGSEGV"),
    ),
}


@pytest.fixture(scope="module")
def part(slot: Slot) -> float:
    score = grade(slot, "").report.score
    assert score is not None
    assert 20 < score < 90
    return score


def grade(slot: Slot, ending: str, limits: Limits = LIMITS) -> GradingResult:
    assignment = replace(catalog().get("square"), limits=limits)
    job = GradingJob(file_name="script.py", source=(THREE_SIDES + ending).encode(), assignment=assignment)
    return slot.grade(job)


@pytest.mark.parametrize("name", slow_but(3, ENDINGS))
def test_three_sides_and_then(slot: Slot, part: float, name: str) -> None:
    ending, status, (zh, en) = ENDINGS[name]
    limits = BRIEF if status is RunStatus.CPU_LIMIT else LIMITS
    first, second = grade(slot, ending, limits), grade(slot, ending, limits)
    report = first.report
    (run,) = report.runs
    assert run.outcome.status is status
    assert report.status is GradeStatus(status.value)
    assert report.score == part
    assert zh in report.hint.zh
    assert en in report.hint.en
    assert run.outcome.nodes == ("/mover",)
    assert [record.message for record in run.outcome.logs][:1] == ["three sides"]
    if status is not RunStatus.PROTOCOL:
        assert run.outcome.stdout.text.startswith("nearly done <object object at 0x…>\n")
        assert first.measurements.cut_output == ()
    assert report.canonical_bytes() == second.report.canonical_bytes()
    assert first.trajectories == second.trajectories


@pytest.mark.parametrize(
    ("ending", "status", "words"),
    [
        (
            "for n in range(1, 10**12):\n    if n % 1000 == 0:\n        print(n)\n",
            GradeStatus.CPU_LIMIT,
            "1000\n2000\n",
        ),
        ("while True:\n    os.write(1, b'x' * 1000)\n", GradeStatus.OUTPUT_LIMIT, "xxxxxx"),
    ],
)
def test_what_a_script_was_printing_when_it_was_ended_stands_beside_the_report(
    slot: Slot, ending: str, status: GradeStatus, words: str
) -> None:
    first, second = grade(slot, ending, BRIEF), grade(slot, ending, BRIEF)
    assert first.report.canonical_bytes() == second.report.canonical_bytes()
    assert first.report.status is status
    assert first.report.runs[0].outcome.stdout.text == ""
    (cut,) = first.measurements.cut_output
    assert cut.stdout.text.startswith("nearly done <object object at 0x…>\n" + words)


def test_a_script_that_survives_a_refusal_goes_on(slot: Slot, part: float) -> None:
    result = grade(slot, "try:\n    open('/etc/a.txt', 'w')\nexcept OSError as error:\n    print(error)\n")
    (run,) = result.report.runs
    assert run.outcome.status is RunStatus.FINISHED
    assert run.outcome.stdout.text.endswith("[Errno 13] Permission denied: '/etc/a.txt'\n")
    assert result.report.score == part


def test_a_script_that_ignores_ctrl_c_has_only_its_grace(slot: Slot) -> None:
    head = "while True:\n    try:\n        time.sleep(100)\n    except KeyboardInterrupt:\n"
    ending = head + "        while True:\n            pass\n"
    result = grade(slot, ending, replace(LIMITS, cpu_s=60.0))
    assert result.report.runs[0].outcome.status is RunStatus.INTERRUPTED
    assert result.measurements.jail_cpu_s < 30.0
