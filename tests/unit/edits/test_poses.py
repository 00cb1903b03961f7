"""What a run shows of a script that steers by its pose: one fact, of the line that has it."""

from dataclasses import replace

import pytest

from grader.contracts.outcome import Endpoint, RunStatus, StudentError
from grader.edits.causes import stated_cause
from grader.edits.received import Ledger, Motion
from grader.edits.situation import Situation, Stated, WantedSizes
from grader.edits.tree import ParsedScript
from tests.unit.checks.trajectories import drive, run_of

POSE = Endpoint(kind="subscription", name="/turtle1/pose", type="turtlesim/msg/Pose", node="/mover")
DRIVES, TURNS = (0.5, 0.0), (0.0, 0.5)
ARC, OTHER_ARC, BACKWARD_ARC = (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)
EIGHT = WantedSizes(arcs=((1.0, 360.0), (1.0, -360.0)))

AT_START = """
def on_pose(self, pose):
    if abs(pose.theta - self.start) < 0.05:
        self.done = True
    if self.done:
        stop()
    else:
        msg.angular.z = 1.0
"""
WAITS = """
def on_pose(self, pose):
    self.since = time.time()
    if time.time() - self.since > 1.0:
        self.goal += 1
"""
KEEPS = """
def on_pose(self, pose):
    self.x = pose.x
def go(self):
    self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
    drive(self.x)
"""
BY_X = """
def on_pose(self, pose):
    if abs(pose.x - self.x0) < 2.0:
        drive()
"""
TWICE = """
def way(self):
    return math.hypot(self.pose.x - x0, self.pose.x - x0)
"""
STOPS = """
def on_pose(self, pose):
    if near():
        self.pub.publish(Twist())
    self.pub.publish(msg)
"""

SERVER = """class Server(Node):
    def __init__(self):
        super().__init__('server')
    def NAME(self):
        pass
"""


def _stated(
    text: str,
    motions: tuple[tuple[float, float], ...] = (),
    *,
    idle: tuple[int, ...] = (),
    lost: str = "",
    wanted: WantedSizes | None = None,
    error: StudentError | None = None,
) -> tuple[str, int] | None:
    """Return the code and line that are stated: of line 5 came all `motions`, and the lines `idle` never ran."""
    outcome = run_of(drive([(1.0, 1.0, 0.0)]), RunStatus.INTERRUPTED).outcome
    if error is not None:
        outcome = replace(outcome, status=RunStatus.CRASHED, error=error)
    times = [round(6.2832e9 * i) for i in range(len(motions) + 1)]
    rows = [
        Motion(v=v, w=w, line=5, t=start, until=end, times=9, topic="/turtle1/cmd_vel")
        for (v, w), start, end in zip(motions, times, times[1:], strict=False)
    ]
    seen = Situation(
        script=ParsedScript.parsed(text),
        ledger=Ledger(ran=frozenset(range(99)) - set(idle), motions=tuple(rows)),
        outcome=replace(outcome, endpoints=(POSE,), duration_ns=times[-1] or 10**9),
        wanted=wanted or WantedSizes(),
        lost=frozenset(lost.split()),
        asked=Stated(goals=((2.0, 2.0),)),
    )
    cause = stated_cause(seen)
    return None if cause is None else (cause.code, cause.line)


def test_an_end_that_is_true_at_the_start_is_named() -> None:
    assert _stated(AT_START, idle=(8,)) == ("true_at_start", 8)
    assert _stated(AT_START, (TURNS,), idle=(8,)) != ("true_at_start", 8)


def test_a_time_that_is_set_anew_is_named_where_the_wait_never_ended() -> None:
    assert _stated(WAITS, (DRIVES,), idle=(5,)) == ("set_anew", 3)
    assert _stated(WAITS, (DRIVES,)) is None


def test_a_callback_is_named_that_nothing_spun_for() -> None:
    assert _stated(KEEPS, (DRIVES,), idle=(3,)) == ("unheard", 2)
    assert _stated(KEEPS + "    rclpy.spin_once(self)\n", (DRIVES,), idle=(3,)) is None
    assert _stated(KEEPS.replace("drive(self.x)", "drive()"), (DRIVES,), idle=(3,)) is None


def test_an_index_is_named_that_begins_again_though_the_car_is_to_stay() -> None:
    text = "goal = (goal + 1) % len(goals)\n"
    assert _stated(text, (DRIVES,), lost="settled end_off_m") == ("begins_again", 1)
    assert _stated(text, (DRIVES,), lost="settled end_off_m reached_pct") is None


def test_a_distance_of_one_coordinate_is_named() -> None:
    assert _stated(BY_X, (DRIVES, TURNS)) == ("one_axis", 3)
    assert _stated(BY_X, (DRIVES,)) is None
    assert _stated(BY_X + "    print(pose.y)\n", (DRIVES, TURNS)) is None
    assert _stated(TWICE, (DRIVES,)) == ("same_twice", 3)
    assert _stated(TWICE.replace("x - x0)", "y - y0)"), (DRIVES,)) is None


def test_a_difference_of_headings_is_named_where_nothing_folds_it() -> None:
    text = "\ndef on_pose(self, pose):\n    error = self.goal - pose.theta\n"
    assert _stated(text, (TURNS,), lost="corner_deg") == ("unfolded", 3)
    assert _stated(text, (TURNS,)) is None
    folded = text + "    error = math.atan2(math.sin(error), math.cos(error))\n"
    assert _stated(folded, (TURNS,), lost="corner_deg") is None


@pytest.mark.parametrize(
    ("second", "code"), [(TURNS, "no_arc_spins"), (DRIVES, "no_arc_straight"), (BACKWARD_ARC, "other_side")]
)
def test_the_motion_that_spoils_a_figure_of_arcs_is_named(second: tuple[float, float], code: str) -> None:
    assert _stated("pass\n", (ARC, second), lost="off_pct", wanted=EIGHT) == (code, 5)
    assert _stated("pass\n", (ARC, OTHER_ARC), lost="off_pct", wanted=EIGHT) is None


def test_a_stop_is_named_that_the_next_publish_overrules() -> None:
    assert _stated(STOPS, (ARC,), lost="settled") == ("overwritten", 4)
    left = STOPS.replace("Twist())\n", "Twist())\n        return\n")
    assert _stated(left, (ARC,), lost="settled") != ("overwritten", 4)


@pytest.mark.parametrize(
    ("name", "message", "stated"),
    [
        ("handle", "'method' object does not support the context manager protocol", True),
        ("get_name", "Server.get_name() missing 1 required positional argument: 'response'", True),
        ("handle", "unsupported operand type(s) for +: 'int' and 'str'", False),
        ("answer", "'method' object is not iterable", False),
    ],
)
def test_what_has_a_name_of_nodes_own_is_named(name: str, message: str, stated: bool) -> None:
    text = SERVER.replace("NAME", name)
    error = StudentError(type="TypeError", message=message, line=3, traceback="")
    assert _stated(text, error=error) == (("overridden", 4) if stated else None)
