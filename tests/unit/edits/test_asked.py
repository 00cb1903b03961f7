"""Changes towards what the assignment itself names: names, types, answers, rates, distances and places."""

import pytest

from grader.contracts.outcome import RunStatus
from grader.edits.asked import asked_changes, asked_of
from grader.edits.causes import stated_cause
from grader.edits.directions import direction_changes
from grader.edits.received import Ledger, Motion
from grader.edits.situation import Situation, Stated, WantedSizes
from grader.edits.tree import ParsedScript, applied
from tests.e2e.grading_slot import catalog
from tests.unit.checks.trajectories import drive, run_of

SUMS = Stated(fields=frozenset({"sum"}), inputs=("a", "b"))
BEATS = Stated(fields=frozenset({"data"}), rates_hz=(2.0,))
CHANGES = {
    "a name": ("n.create_service(A, 'add', f)", Stated(names={"service": ("/add_ints",)}), "'add_ints'"),
    "a parameter": (
        "s.declare_parameter('size', 1)\ns.get_parameter('size')",
        Stated(names={"parameter": ("side",)}),
        "s.declare_parameter('side', 1)\ns.get_parameter('side')",
    ),
    "a type": (
        "from std_msgs.msg import Int32, String\nn.create_publisher(String, '/n', 10)",
        Stated(kinds=frozenset({"Int32"})),
        "create_publisher(Int32,",
    ),
    "an operator": ("r.sum = q.a * q.b", SUMS, "r.sum = q.a + q.b"),
    "an operand": ("r.sum = q.a + q.a", SUMS, "r.sum = q.a + q.b"),
    "a summand": ("r.sum = q.a + q.b + 1", SUMS, "r.sum = q.a + q.b"),
    "a number": ("k = 1\nm.data = k", BEATS, "k = 0"),
    "a period": ("n.create_timer(2.0, f)", BEATS, "create_timer(0.5, f)"),
    "a count": ("k = 0\nm.data = k\np.publish(m)", BEATS, "m.data = k\nk += 1\n"),
    "a node": (
        "class N: pass\ne = SingleThreadedExecutor()\na = N()\nb = N()\ne.add_node(a)\n",
        Stated(),
        "b = N()\ne.add_node(b)\n",
    ),
    "that a goal succeeded": (
        "def run(goal):\n    r = F.Result()\n    return r\nActionServer(n, F, 'f', run)",
        Stated(),
        "    goal.succeed()\n    return r",
    ),
    "the result of a goal": (
        "def run(goal):\n    r = F.Result()\n    goal.succeed()\nActionServer(n, F, 'f', run)",
        Stated(),
        "goal.succeed()\n    return r\n",
    ),
    "a distance": ("GOAL = 50\nif scan.ranges[0] > GOAL: go()", Stated(levels=(0.5,)), "GOAL = 0.5\n"),
    "a parameter that is set later": (
        "def init(self):\n    self.v = self.get_parameter('v').value\ndef tick(self):\n    m.data = self.v\n",
        Stated(names={"parameter": ("v",)}),
        "m.data = self.get_parameter('v').value",
    ),
    "a logged field": (
        "def heard(self, msg):\n    self.get_logger().info(f'{msg}')\n",
        Stated(logs=True, inputs=("data",)),
        "info(f'{msg.data}')",
    ),
    "a place": ("goals = [(1.2, 0.6), (1.8, 0.5)]", Stated(goals=((1.2, 0.6), (1.8, -0.5))), "(1.8, -0.5)]"),
    "a goal's names": ("goal_x, goal_y = 8, 2", Stated(goals=((2.0, 8.0),)), "goal_x, goal_y = 2.0, 8.0"),
}


def _seen(text: str, asked: Stated, motions: tuple[Motion, ...] = ()) -> Situation:
    return Situation(
        script=ParsedScript.parsed(text),
        ledger=Ledger(ran=frozenset(range(1, text.count("\n") + 2)), motions=motions),
        outcome=run_of(drive([(1.0, 1.0, 0.0)]), RunStatus.FINISHED).outcome,
        wanted=WantedSizes((90.0,), (), (4,)),
        asked=asked,
    )


@pytest.mark.parametrize(("text", "asked", "part"), CHANGES.values(), ids=CHANGES)
def test_what_the_assignment_names_is_proposed(text: str, asked: Stated, part: str) -> None:
    changed = [applied(text, one.edits) for one in asked_changes(_seen(text, asked))]
    assert any(part in one for one in changed), changed


@pytest.mark.parametrize(("text", "asked", "part"), CHANGES.values(), ids=CHANGES)
def test_nothing_is_proposed_for_what_is_right(text: str, asked: Stated, part: str) -> None:
    changes = [one for one in asked_changes(_seen(text, Stated())) if one.code != "missing"]
    assert not changes


def test_an_assignment_tells_what_it_names() -> None:
    square = asked_of(catalog().get("square_parameter"), frozenset())
    assert square.names["parameter"] == ("side",)
    room = asked_of(catalog().get("stop_before_wall"), frozenset())
    assert room.levels == (0.5,)
    assert asked_of(catalog().get("three_goals"), frozenset()).goals[1] == (1.8, -0.5)
    adding = catalog().get("add_server")
    named = asked_of(adding, frozenset(item.measure for item in adding.items))
    assert "sum" in named.fields
    assert named.inputs[:2] == ("a", "b")


def _turn(rate: float, line: int, at_s: int) -> Motion:
    stack = ((3, "turn", {}), (line, "main", {}))
    return Motion(
        v=0.0, w=rate, line=3, t=at_s * 10**9, until=(at_s + 1) * 10**9, times=50, topic="", stack=stack
    )


@pytest.mark.parametrize(
    ("last", "part"),
    [("turn(-1.0)", "turn(1.0)"), ("w = -w", "\n\n"), ("turn(w if odd else -w)", "turn(w)")],
)
def test_turns_that_go_left_and_right_by_turns_are_told_and_mended(last: str, part: str) -> None:
    text = f"def turn(w):\n    m.angular.z = w\n    p.publish(m)\n\nturn(1.0)\n{last}\n\n"
    seen = _seen(text, Stated(), (_turn(1.0, 5, 1), _turn(-1.0, 6, 3), _turn(1.0, 5, 5), _turn(-1.0, 6, 7)))
    assert any(part in applied(text, one.edits)[-12:] for one in direction_changes(seen))
    cause = stated_cause(seen)
    assert cause is not None
    assert (cause.code, cause.line) == ("alternates", 6)
    for second in (1.0, -1.0):  # one way, and once to and fro
        few = _seen(text, Stated(), (_turn(1.0, 5, 1), _turn(second, 6, 3)))
        assert not list(direction_changes(few))
