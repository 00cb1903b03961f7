"""The expectation ``moved``: what the car did between what was said to the script and what was said next."""

import math
from typing import Any

import pytest

from grader.checks import evaluate
from grader.contracts.assignment import Assignment
from grader.contracts.conversation import Conversation, Party, Sent
from grader.contracts.outcome import RunOutcome, RunStatus
from grader.contracts.scoring import Run, Scoring
from grader.contracts.trajectory import Trajectory
from tests.unit.checks.shipped import assignment, item
from tests.unit.checks.trajectories import Leg, drive

TASK = assignment("agent_tools")
SECOND = 1_000_000_000
MOVES, TURNS = (0.8, -0.5, -1.2), (60.0, -45.0)


def drives(
    moves: tuple[float, ...] = MOVES, turns: tuple[float, ...] = TURNS, *, also: float = 0.0
) -> Trajectory:
    """Return a drive in which each call moves or turns the car by this, within two seconds.

    `also`: by how many metres it moves in each turn.
    """
    asked = [(3.0, moves[0], 0.0), (12.0, also, turns[0]), (21.0, moves[1], 0.0), (30.0, also, turns[1])]
    asked += [(39.0, moves[2], 0.0)]
    legs: list[Leg] = []
    now_s = 0.0
    for at_s, move, turn in asked:
        legs += [(at_s - now_s, 0.0, 0.0), (2.0, move / 2.0, math.radians(turn) / 2.0)]
        now_s = at_s + 2.0
    return drive([*legs, (60.0 - now_s, 0.0, 0.0)], idle_s=0.0)


def exchanges(task: Assignment, *, offered: bool) -> tuple[Sent, ...]:
    sent = []
    for step in task.steps:
        for n in range(step.sends):
            at_ns = step.at_ns + n * step.every_ns if offered else None
            values = step.each[n] if step.each else step.values
            sent.append(
                Sent(step=step.id, n=n, values=values, sent_ns=at_ns, answered_ns=at_ns, answer={"x": 1.0})
            )
    return tuple(sent)


def judged(
    track: Trajectory, *, task: Assignment = TASK, offered: bool = True, names: tuple[str, ...] = ()
) -> Scoring:
    types = {step.target: step.type for step in task.steps if step.kind == "call"}
    there = [(name, kind) for name, kind in types.items() if offered] + [(name, "") for name in names]
    parties = tuple(
        Party(id=number, kind="service", node="/n", name=name, type=kind)
        for number, (name, kind) in enumerate(there)
    )
    run = Run(
        trajectory=track,
        outcome=RunOutcome(status=RunStatus.INTERRUPTED, duration_ns=60 * SECOND, nodes=("/n",)),
        conversation=Conversation(exchanges=exchanges(task, offered=offered), parties=parties),
    )
    return evaluate(task, [run])


def test_a_script_that_does_what_it_is_asked_earns_everything() -> None:
    scoring = judged(drives())
    assert (item(scoring, "moves").earned, item(scoring, "turns").earned) == (25.0, 20.0)


@pytest.mark.parametrize(
    ("moves", "turns", "loses"),
    [((0.8, 0.5, 1.2), TURNS, "moves"), (MOVES, (60.0, 45.0), "turns"), (MOVES, (170.0, -45.0), "turns")],
)
def test_what_is_done_otherwise_costs(moves: tuple[float, ...], turns: tuple[float, ...], loses: str) -> None:
    scoring = judged(drives(moves, turns))
    assert [name for name in ("moves", "turns") if item(scoring, name).earned < 20] == [loses]


@pytest.mark.parametrize(("error", "least", "most"), [(1.04, 25.0, 25.0), (1.2, 10.0, 20.0), (1.9, 0.0, 0.0)])
def test_a_wrong_way_costs_by_how_wrong_it_is(error: float, least: float, most: float) -> None:
    moves: Any = tuple(error * move for move in MOVES)
    assert least <= item(judged(drives(moves)), "moves").earned <= most


@pytest.mark.parametrize(("also_m", "earned"), [(0.04, 20.0), (0.075, 10.0), (0.2, 0.0)])
def test_a_turn_that_drives_the_car_away_is_no_turn(also_m: float, earned: float) -> None:
    assert item(judged(drives(also=also_m)), "turns").earned == pytest.approx(earned, abs=1.5)


def test_a_service_of_another_name_is_told_beside_those_that_are_asked_for() -> None:
    assert "no_service" in judged(drives(), offered=False).mistakes
    assert "other_name" in judged(drives(), offered=False, names=("/movement",)).mistakes
