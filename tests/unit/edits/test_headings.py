"""Headings that a script hears jump by a turn, and come as quaternions: both are put right in its own terms."""

from dataclasses import replace

import pytest

from grader.contracts.outcome import Endpoint, RunStatus
from grader.edits.headings import heading_changes
from grader.edits.received import Ledger
from grader.edits.situation import Situation, WantedSizes
from grader.edits.tree import ParsedScript, applied
from tests.unit.checks.trajectories import drive, run_of

POSE = Endpoint(kind="subscription", name="/turtle1/pose", type="turtlesim/msg/Pose", node="/mover")


def _offered(line: str, *, hears: bool = True) -> list[str]:
    text = f"import math\n{line}\n"
    outcome = run_of(drive([(1.0, 1.0, 0.0)]), RunStatus.INTERRUPTED).outcome
    seen = Situation(
        script=ParsedScript.parsed(text),
        ledger=Ledger(ran=frozenset((1, 2))),
        outcome=replace(outcome, endpoints=(POSE,) if hears else ()),
        wanted=WantedSizes(),
    )
    return [applied(text, one.edits).split("\n")[1] for one in heading_changes(seen)]


@pytest.mark.parametrize(
    ("line", "mended"),
    [
        ("err = goal - p.theta", "err = math.atan2(math.sin(goal - p.theta), math.cos(goal - p.theta))"),
        (
            "while p.theta < goal: pass",
            "while math.atan2(math.sin(goal - p.theta), math.cos(goal - p.theta)) > 0: pass",
        ),
        ("yaw = math.atan2(q.z, q.w)", "yaw = 2 * math.atan2(q.z, q.w)"),
        ("yaw = p.orientation.z", "yaw = 2 * math.atan2(p.orientation.z, p.orientation.w)"),
    ],
    ids=["difference", "comparison", "half", "z"],
)
def test_headings_are_put_right(line: str, mended: str) -> None:
    assert _offered(line) == [mended]
    assert _offered(line, hears=False) == []


@pytest.mark.parametrize(
    "line",
    [
        "err = math.sin(goal - p.theta)",
        "err = (goal - p.theta + math.pi) % (2 * math.pi)",
        "yaw = 2 * math.atan2(q.z, q.w)",
        "while p.theta < 1.5: pass",
    ],
)
def test_what_is_right_is_left_alone(line: str) -> None:
    assert _offered(line) == []
