"""The agent check: what the car did between tool calls, and what the answers said."""

import math
from dataclasses import replace
from typing import Any

import pytest

from grader.checks import evaluate, problems
from grader.contracts.assignment import Assignment
from grader.contracts.outcome import AgentResult, Endpoint, RunOutcome, RunStatus
from grader.contracts.scoring import Run, Scoring
from grader.contracts.trajectory import Trajectory
from tests.unit.checks.shipped import assignment, item, score
from tests.unit.checks.trajectories import Leg, drive

TASK = assignment("agent_tools")
SECOND = 1_000_000_000
HERE = object()  # where the car is


def drives(
    moves: tuple[float, ...] = (1.0, -0.5, 1.5), turns: tuple[float, ...] = (90.0, -45.0)
) -> Trajectory:
    """Return a drive in which each tool call moves or turns the car by this, within two seconds."""
    asked = [(3.0, moves[0], 0.0), (12.0, 0.0, turns[0]), (21.0, moves[1], 0.0), (30.0, 0.0, turns[1])]
    asked += [(39.0, 1.5, 0.0), (47.0, moves[2], 0.0)]
    legs: list[Leg] = []
    now_s = 0.0
    for at_s, move, turn in asked:
        legs += [(at_s - now_s, 0.0, 0.0), (2.0, move / 2.0, math.radians(turn) / 2.0)]
        now_s = at_s + 2.0
    return drive([*legs, (60.0 - now_s, 0.0, 0.0)], idle_s=0.0)


def judged(
    track: Trajectory,
    *,
    task: Assignment = TASK,
    told: object = HERE,
    answered: int = 99,
    offered: int = 99,
    **outcome: Any,
) -> Scoring:
    """Score a run of whose steps the first so many were offered and answered."""
    results = []
    for number, step in enumerate(task.agent):
        index = max(int((track.t_ns <= step.at_ns).sum()) - 1, 0)
        here = {"x": float(track.x_m[index]), "y": float(track.y_m[index])}
        values = here if told is HERE else told
        results.append(
            AgentResult(
                step=step,
                sent_ns=step.at_ns if number < offered else None,
                answered_ns=step.at_ns if number < min(answered, offered) else None,
                values=values if step.tells else {},  # type: ignore[arg-type]
            )
        )
    services = {step.target: step.type for step in task.agent[:offered] if step.tool == "call"}
    known = tuple(Endpoint(kind="service", node="/n", name=n, type=t, count=0) for n, t in services.items())
    values = {
        "status": RunStatus.INTERRUPTED,
        "duration_ns": 60 * SECOND,
        "nodes": ("/n",),
        "endpoints": known,
    }
    run = Run(trajectory=track, outcome=RunOutcome(**{**values, **outcome}), agent=tuple(results))
    return evaluate(task, [run])


def test_a_script_that_does_what_it_is_asked_earns_everything() -> None:
    scoring = judged(drives())
    assert score(scoring) == 100
    assert scoring.mistakes == ()


@pytest.mark.parametrize(
    ("moves", "turns", "mistake", "loses"),
    [
        ((1.0, 0.5, 1.5), (90.0, -45.0), "tool_ignores_sign", "moves"),
        ((1.0, -0.5, 1.5), (90.0, 45.0), "tool_ignores_sign", "turns"),
        ((1.0, 1.0, 1.0), (90.0, -45.0), "tool_ignores_request", "moves"),
        ((1.0, -0.5, 1.5), (0.0, 0.0), "tool_moves_nothing", "turns"),
    ],
)
def test_what_is_done_otherwise_is_named(
    moves: tuple[float, ...], turns: tuple[float, ...], mistake: str, loses: str
) -> None:
    scoring = judged(drives(moves, turns))
    assert scoring.mistakes == (mistake,)
    assert [one.id for one in scoring.items if one.earned < one.points] == [loses]


def test_nothing_is_said_of_numbers_that_were_not_sent() -> None:
    silent = replace(TASK, agent=tuple(replace(step, values={}) for step in TASK.agent))
    scoring = judged(drives((1.0, 0.5, 1.5), (90.0, 45.0)), task=silent)
    assert scoring.mistakes == ()
    assert [one.id for one in scoring.items if one.earned < one.points] == ["moves", "turns"]


@pytest.mark.parametrize(("error", "least", "most"), [(1.04, 25.0, 25.0), (1.3, 10.0, 20.0), (1.9, 0.0, 0.0)])
def test_a_wrong_way_costs_by_how_wrong_it_is(error: float, least: float, most: float) -> None:
    scoring = judged(drives((error, -0.5 * error, 1.5 * error)))
    assert least <= item(scoring, "moves").earned <= most


def test_a_place_that_was_told_once_and_for_all_is_named() -> None:
    scoring = judged(drives(), told={"x": 5.544445, "y": 5.544445})
    assert (item(scoring, "where").earned, scoring.mistakes) == (0.0, ("told_stale",))


@pytest.mark.parametrize("told", [{}, {"x": "here", "y": 1.0}, {"x": math.nan, "y": 1.0}, {"x": 1.0}])
def test_an_answer_that_tells_no_place_earns_nothing_and_raises_nothing(told: object) -> None:
    assert item(judged(drives(), told=told), "where").earned == 0.0


def test_a_service_that_is_missing_or_silent_is_named() -> None:
    scoring = judged(drives(), offered=2)
    assert scoring.mistakes[0] == "no_service"
    assert item(scoring, "offered").measured == 2
    assert judged(drives(), answered=2).mistakes[0] == "service_silent"


def test_an_agent_needs_steps_and_other_checks_take_none() -> None:
    assert [field for field, _ in problems(replace(TASK, agent=()))] == ["agent"]
    other = replace(assignment("rosclaw"), agent=TASK.agent)
    assert [field for field, _ in problems(other)] == ["agent"]
