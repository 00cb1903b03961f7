"""Formulas behind a motion of the wrong size: the change that makes up for just what it was off comes first."""

import pytest

from grader.contracts.outcome import RunStatus
from grader.edits.formulas import tolerance
from grader.edits.numbers import number_changes
from grader.edits.received import Ledger, Motion
from grader.edits.situation import Driven, Situation, WantedSizes
from grader.edits.tree import ParsedScript, applied
from tests.unit.checks.trajectories import drive, run_of

SCRIPT = """\
class Car:
    SPEED = 0.5
    TURN_SPEED = 1.0
    def __init__(self):
        self.MOVE_TIME = 2.0 / self.SPEED
        self.TURN_TIME = {time}
    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        end = time.time() + t
        while time.time() < end:
            self.pub.publish(m)
            time.sleep(0.01)
N = 4
car = Car()
car.go(0.0, {rate}, {used})
"""


def _first(time: str, rate: float, seconds: float, used: str = "car.TURN_TIME", name: str = "") -> str:
    """Return the line that the first change of a turn's formula comes to, of a turn of 90 degrees."""
    text = SCRIPT.format(time=time, rate=name or rate, used=used)
    step_ns = 10_000_000
    count = round(seconds * 1e9) // step_ns
    motion = Motion(
        v=0.0,
        w=rate,
        line=13,
        t=0,
        until=(count - 1) * step_ns,
        times=count,
        topic="",
        stack=((13, "go", {}), (17, "<module>", {})),
        waits={14: (count, count * step_ns)},
    )
    stop = Motion(v=0.0, w=0.0, line=13, t=count * step_ns, until=count * step_ns, times=1, topic="")
    seen = Situation(
        script=ParsedScript.parsed(text),
        ledger=Ledger(ran=frozenset(range(1, 18)), motions=(motion, stop)),
        outcome=run_of(drive([(1.0, 1.0, 0.0)]), RunStatus.FINISHED).outcome,
        wanted=WantedSizes(turns_deg=(90.0,)),
    )
    scaled = (one for one in number_changes(seen) if one.code == "scaled")
    best = min(scaled, key=lambda one: one.cost)
    after = applied(text, best.edits)
    return next(b.strip() for a, b in zip(text.split("\n"), after.split("\n"), strict=True) if a != b)


@pytest.mark.parametrize(
    ("given", "mended"),
    [
        ({"time": "1.5708 * 0.5", "rate": 0.5, "seconds": 0.79}, "self.TURN_TIME = 1.5708 / 0.5"),
        ({"time": "0.5 / 1.5708", "rate": 0.5, "seconds": 0.32}, "self.TURN_TIME = 1.5708 / 0.5"),
        (
            {"time": "1.5708 / self.SPEED", "rate": 1.0, "seconds": 3.15, "name": "car.TURN_SPEED"},
            "self.TURN_TIME = 1.5708 / self.TURN_SPEED",
        ),
        ({"time": "1.5708", "rate": 0.25, "seconds": 1.58}, "self.TURN_TIME = 1.5708 / 0.25"),
        (
            {"time": "1.5708", "rate": 1.0, "seconds": 4.0, "used": "car.MOVE_TIME"},
            "car.go(0.0, 1.0, car.TURN_TIME)",
        ),
        ({"time": "a * 1.5", "rate": 0.5, "seconds": 4.72}, "self.TURN_TIME = a"),
        ({"time": "math.pi", "rate": 1.0, "seconds": 3.15}, "self.TURN_TIME = math.pi / 2"),
        ({"time": "math.pi / N", "rate": 1.0, "seconds": 0.79}, "self.TURN_TIME = 2 * math.pi / N"),
        ({"time": "PI", "rate": 1.0, "seconds": 3.15}, "self.TURN_TIME = PI / 2"),
        ({"time": "2.0", "rate": 0.5, "seconds": 2.0}, "self.TURN_TIME = 3.1416"),
    ],
    ids=[
        "operator",
        "turned_round",
        "speed",
        "no_rate",
        "name",
        "factor",
        "pi",
        "sides",
        "own_pi",
        "number",
    ],
)
def test_the_formula_is_changed_that_the_measured_ratio_explains(
    given: dict[str, object], mended: str
) -> None:
    assert _first(**given) == mended  # type: ignore[arg-type] # a row of the table above


def test_a_motion_of_few_waits_is_compared_less_closely() -> None:
    motion = Motion(v=0.0, w=1.0, line=1, t=0, until=0, times=3, topic="", waits={2: (3, 60_000_000)})
    assert tolerance(Driven(motion, 3.0)) < 0.04
    assert tolerance(Driven(motion, 0.06)) == 0.15


OTHERS = {
    "clocked": ("car.create_timer(0.02, tick)\ndef tick():\n    t += 0.2\n", "t += 0.02"),
    "stale": (
        "class A:\n    def __init__(self):\n        self.t = self.side / 2\na = A()\na.side = 3.0\n",
        "a.t = a.side / 2",
    ),
    "nanoseconds": (
        "while (now - self.begin).nanoseconds < 2.0:\n    pub.publish(m)\n",
        "(now - self.begin).nanoseconds / 1e9",
    ),
}


@pytest.mark.parametrize(("text", "new"), OTHERS.values(), ids=OTHERS)
def test_times_are_counted_in_one_unit_and_computed_when_they_are_known(text: str, new: str) -> None:
    seen = Situation(
        script=ParsedScript.parsed(text),
        ledger=Ledger(ran=frozenset(range(1, 9))),
        outcome=run_of(drive([(1.0, 1.0, 0.0)]), RunStatus.FINISHED).outcome,
        wanted=WantedSizes(),
    )
    assert new in applied(text, min(number_changes(seen), key=lambda one: one.cost).edits)


def test_a_drive_is_made_faster_only_where_time_was_up() -> None:
    text = "m.linear.x = 0.1\npub.publish(m)\n"
    motion = Motion(v=0.1, w=0.0, line=2, t=0, until=10**12, times=10, topic="", stack=((2, "", {}),))
    statuses = (RunStatus.INTERRUPTED, RunStatus.FINISHED)
    offered = [
        [
            one.code
            for one in number_changes(
                Situation(
                    ParsedScript.parsed(text),
                    Ledger(ran=frozenset((1, 2)), motions=(motion,)),
                    run_of(drive([(1.0, 1.0, 0.0)]), status).outcome,
                    WantedSizes(),
                )
            )
        ]
        for status in statuses
    ]
    assert ["too_slow" in codes for codes in offered] == [True, False]
    assert all("sign" not in codes for codes in offered)


def test_a_timer_gets_the_period_that_its_counts_were_computed_for() -> None:
    text = "n = round(1.5708 / 0.1)\ncar.create_timer(0.05, tick)\ndef tick():\n    pub.publish(m)\n"
    stack: tuple[tuple[int, str, dict[str, float]], ...] = ((4, "tick", {}),)
    motion = Motion(v=0.0, w=1.0, line=4, t=0, until=700_000_000, times=15, topic="", stack=stack)
    stop = Motion(v=0.0, w=0.0, line=4, t=785_000_000, until=785_000_000, times=1, topic="")
    seen = Situation(
        script=ParsedScript.parsed(text),
        ledger=Ledger(ran=frozenset(range(1, 5)), motions=(motion, stop)),
        outcome=run_of(drive([(1.0, 1.0, 0.0)]), RunStatus.FINISHED).outcome,
        wanted=WantedSizes(turns_deg=(90.0,)),
    )
    texts = [applied(text, one.edits) for one in number_changes(seen)]
    assert text.replace("0.05", "0.1") in texts


def test_the_usual_length_is_wanted_where_all_sides_are_to_be_equal() -> None:
    times_s = (0, 2, 4, 7)
    motions = tuple(
        Motion(v=float(v), w=0.0, line=1, t=t * 10**9, until=(t + 1) * 10**9, times=9, topic="")
        for t, v in zip(times_s, (1, 1, 1, 0), strict=True)
    )
    outcome = run_of(drive([(1.0, 1.0, 0.0)]), RunStatus.FINISHED).outcome
    script = ParsedScript.parsed("pub.publish(m)\n")
    seen = Situation(script, Ledger(motions=motions), outcome, WantedSizes())
    assert seen.usual_lengths_m == ()
    unequal = Situation(
        script, Ledger(motions=motions), outcome, WantedSizes(), lost=frozenset(("side_spread_pct",))
    )
    assert unequal.usual_lengths_m == (2.0,)
