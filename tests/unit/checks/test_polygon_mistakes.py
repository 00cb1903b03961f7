"""Mistakes of a polygon that its measures do not show; of all others the items say what was measured."""

import math
from dataclasses import replace

import pytest

from grader.checks import evaluate
from grader.contracts.outcome import Endpoint, RunStatus
from grader.contracts.trajectory import Command, Contact, Trajectory
from tests.unit.checks.shipped import assignment, graded, score
from tests.unit.checks.trajectories import Leg, drive, once_each, polygon_legs, run_of

POSE = Endpoint(kind="subscription", name="/turtle1/pose", type="turtlesim/msg/Pose", node="/mover")


@pytest.mark.parametrize(
    ("name", "legs", "code"),
    [
        ("square", polygon_legs(4, corners_deg=[57.3] * 4), "one_radian"),
        ("triangle", polygon_legs(3, corners_deg=[57.3] * 3), "one_radian"),
        ("octagon", polygon_legs(8, 1.0, corners_deg=[57.3] * 8), "one_radian"),
        ("triangle", polygon_legs(3, corners_deg=[60] * 3), "interior_angle"),
        ("pentagon", polygon_legs(5, corners_deg=[108] * 5), "interior_angle"),
        ("hexagon", polygon_legs(6, corners_deg=[120] * 6), "interior_angle"),
        ("square", [(2.0, 1.0, 0.0)], "no_turns"),
        ("square", [(2.0, 1.0, 0.0), (1.0, 0.0, 90.0)] * 4, "degrees_as_radians"),
        ("square", [(1.57, 0.0, 1.0)] * 4, "no_drive"),
    ],
)
def test_what_no_measure_shows_is_recognised(name: str, legs: list[Leg], code: str) -> None:
    scoring = graded(name, drive(legs))
    assert scoring.mistakes[0] == code
    assert score(scoring) < 100


@pytest.mark.parametrize(
    ("name", "legs", "told"),
    [
        ("octagon", polygon_legs(8, 1.0, corners_deg=[54] * 8), "exterior angle"),  # ticks of a 10 Hz timer
        ("square", polygon_legs(4, corners_deg=[90, 80, 90, 90]), "exterior angle"),
        ("square", polygon_legs(4, corners_deg=[57.3, 90, 57.3, 90]), "exterior angle"),
        ("square", polygon_legs(4, laps=0.75), "number of repetitions"),
        ("square", polygon_legs(4, lengths_m=[2, 2, 2, 1.7]), "same speed"),
    ],
)
def test_what_a_measure_shows_its_item_says(name: str, legs: list[Leg], told: str) -> None:
    scoring = graded(name, drive(legs))
    assert scoring.mistakes == ()
    assert told in scoring.hint.en


def test_published_once_is_told_before_the_angle_it_leads_to() -> None:
    scoring = graded("square", once_each([(2.0, 1.0, 0.0), (1.5708, 0.0, 1.0)] * 4))
    assert scoring.mistakes == ("published_once",)
    assert "2 s" in scoring.hint.en


@pytest.mark.parametrize(
    ("name", "legs", "codes"),
    [
        ("triangle", [(2.0, 1.0, 0.0), (1.0, 0.0, math.pi / 3)] * 3, ("interior_angle",)),
        ("square", [(2.0, 1.0, 0.0), (1.0, 0.0, math.pi / 2)] * 3, ()),
        ("square", [(3.0, 1.0, 0.0), (1.0, 0.0, math.pi / 2), (0.8, 1.0, 0.0), (1.0, 0.0, math.pi / 2)] * 2,
         ("published_once",)),
    ],
)  # fmt: skip
def test_drives_that_turtlesim_cuts_to_the_same_length_explain_no_figure(
    name: str, legs: list[Leg], codes: tuple[str, ...]
) -> None:
    assert graded(name, once_each(legs)).mistakes[:1] == codes


@pytest.mark.parametrize("left_s", [0.2, 1.2, 1.9])
@pytest.mark.parametrize("name", ["square", "triangle"])
def test_who_is_cut_on_the_way_is_told_that_time_was_up(name: str, left_s: float) -> None:
    legs = polygon_legs({"square": 4, "triangle": 3}[name], pause_s=0.0)
    cut = drive(legs, horizon_s=sum(leg[0] for leg in legs) - left_s)
    assert graded(name, cut, RunStatus.INTERRUPTED).mistakes[0] == "time_was_up"


def test_who_publishes_stop_until_the_horizon_had_time_enough() -> None:
    waiting = drive([*polygon_legs(4, laps=0.75), (20.0, 0.0, 0.0)])
    assert graded("square", waiting, RunStatus.INTERRUPTED).mistakes == ()


def test_who_drives_on_after_the_figure_had_time_enough() -> None:
    straying = drive([*polygon_legs(4), (60.0, 0.1, 0.0)], horizon_s=60.0)
    scoring = graded("square", straying, RunStatus.INTERRUPTED)
    assert (scoring.mistakes, score(scoring)) == ((), 80)  # nor is it back at the start
    assert "Publish a Twist of zeros" in next(item.hint.en for item in scoring.items if item.id == "rest")


def test_who_leaves_the_stop_to_turtlesim_has_stopped() -> None:
    trajectory = drive(polygon_legs(4))
    values = {name: getattr(trajectory, name) for name in Trajectory.__slots__}
    moving = Command(t_ns=trajectory.commands[-1].t_ns + 1, v_mps=0.0, w_radps=1.0)
    coasting = Trajectory(**{**values, "commands": (*trajectory.commands, moving)})
    scoring = graded("square", coasting)
    assert (scoring.mistakes, score(scoring)) == ((), 100)


def test_a_wall_that_spoilt_the_figure_is_told_and_a_later_one_is_not() -> None:
    legs = [*polygon_legs(4, laps=0.75), (5.0, 0.0, 0.0)]
    for hit_ns, codes in ((3_000_000_000, ("wall_hit",)), (1 << 40, ())):
        hit = Contact(wall="right", start_ns=hit_ns, end_ns=1 << 41)
        assert graded("square", replace(drive(legs), contacts=(hit,))).mistakes == codes


def test_a_fast_turn_by_pose_is_no_degrees() -> None:
    fast = drive([(2.0, 1.0, 0.0), (0.1, 0.0, 15.0), (2.0, 1.0, 0.0)])
    by_pose = evaluate(assignment("square"), [run_of(fast, endpoints=(POSE,))])
    assert "degrees_as_radians" not in by_pose.mistakes
