"""Check ``places``: what counts as a visit, in which order, and what is said when one is missing."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.checks import evaluate, problems, sketch
from grader.contracts.assignment import (
    Assignment,
    Case,
    ItemSpec,
    Region,
    StartPose,
    WantedGoal,
    WantedPlaces,
    World,
)
from grader.contracts.outcome import Endpoint, RunStatus
from grader.contracts.scoring import Scoring
from grader.contracts.text import Text
from grader.contracts.trajectory import Contact, Trajectory
from tests.examples import examples
from tests.unit.checks.shipped import assignment
from tests.unit.checks.trajectories import Leg, drive, run_of

POINTS = ((8.0, 3.0), (8.0, 8.0), (3.0, 8.0))
START = (3.0, 3.0)
MEASURED = "reached missed_m time_s end_off_m settled contacts clearance_m detour_pct speed_mps jolt_mps"


def circle(x: float, y: float, radius: float = 0.2) -> Region:
    return Region(kind="circle", x_m=x, y_m=y, radius_m=radius)


def task(*goals: WantedGoal, measures: str = "reached", **places: object) -> Assignment:
    """Return an assignment with an item for each measure; full credit where nothing is wrong."""
    bands = {"reached": {"low": float(len(goals))}, "settled": {"low": 1.0}, "time_s": {"high": 60.0}}
    items = tuple(
        ItemSpec(
            id=measure,
            title=Text(zh="项", en="item"),
            points=10.0,
            measure=measure,
            **bands.get(measure, {"high": 0.3}),
        )
        for measure in measures.split()
    )
    return replace(
        assignment("go_to_goal"),
        items=items,
        cases=(Case(),),
        world=World(start=StartPose(x_m=START[0], y_m=START[1])),
        places=WantedPlaces(visit=goals, **places),  # type: ignore[arg-type]
    )


def goals(*points: tuple[float, float], hold_s: float = 0.0, by_s: float | None = None) -> list[WantedGoal]:
    return [WantedGoal(region=circle(*point), hold_s=hold_s, by_s=by_s) for point in points]


def through(*points: tuple[float, float], rest_s: float = 0.1, v: float = 1.0) -> Trajectory:
    """Drive from point to point in straight lines, turning on the spot."""
    legs: list[Leg] = []
    (x, y), heading = START, 0.0
    for there_x, there_y in points:
        ahead = math.atan2(there_y - y, there_x - x)
        turn = math.remainder(ahead - heading, math.tau)
        legs += [(abs(turn), 0.0, math.copysign(1.0, turn)), (0.1, 0.0, 0.0)]
        legs += [(math.dist((x, y), (there_x, there_y)) / v, v, 0.0), (rest_s, 0.0, 0.0)]
        x, y, heading = there_x, there_y, ahead
    return drive(legs, start_m=START)


def graded(asked: Assignment, trajectory: Trajectory, *heard: str, ended: str = "finished") -> Scoring:
    run = run_of(trajectory, RunStatus(ended))
    listens = [
        Endpoint(kind="subscription", node="/a", name=name, type="turtlesim/msg/Pose") for name in heard
    ]
    return evaluate(
        asked, [replace(run, outcome=replace(run.outcome, endpoints=(*run.outcome.endpoints, *listens)))]
    )


def value(scoring: Scoring, measure: str) -> float | None:
    return next(item.measured for item in scoring.items if item.id == measure)


def test_all_goals_in_order_and_how_they_were_reached() -> None:
    scoring = graded(task(*goals(*POINTS), measures=MEASURED), through(*POINTS))
    assert value(scoring, "reached") == 3
    assert value(scoring, "missed_m") == 0
    assert value(scoring, "time_s") == pytest.approx(15.0 + math.pi + 0.6 - 0.2, abs=0.2)
    assert value(scoring, "end_off_m") == pytest.approx(0.0, abs=0.02)
    assert value(scoring, "clearance_m") == pytest.approx(3.0, abs=0.15)
    assert value(scoring, "detour_pct") == pytest.approx(0.0, abs=3.0)
    assert value(scoring, "speed_mps") == pytest.approx(1.0)
    assert value(scoring, "jolt_mps") == pytest.approx(1.0)


def test_the_order_counts_where_it_is_given() -> None:
    other = (POINTS[1], POINTS[2], POINTS[0])
    given_order = graded(task(*goals(*POINTS)), through(*other))
    assert value(given_order, "reached") == 2  # the second and the third came one after the other
    assert given_order.mistakes[0] == "place_order"
    assert "2 → 3 → 1" in given_order.hint.en
    assert value(graded(task(*goals(*POINTS), any_order=True), through(*other)), "reached") == 3


@settings(max_examples=examples(12))
@given(st.permutations(range(3)), st.sets(st.integers(0, 2)))
def test_as_many_count_as_stand_one_after_the_other(order: list[int], skipped: set[int]) -> None:
    driven = [i for i in order if i not in skipped]
    trajectory = through(*(POINTS[i] for i in driven)) if driven else drive([(0.2, 1.0, 0.0)], start_m=START)
    longest = max(
        (bin(mask).count("1") for mask in range(8) if _is_rising([i for i in driven if mask >> i & 1], mask)),
        default=0,
    )
    assert value(graded(task(*goals(*POINTS)), trajectory), "reached") == longest
    any_order = value(graded(task(*goals(*POINTS), any_order=True), trajectory), "reached")
    assert any_order == len(driven)


def _is_rising(chosen: Sequence[int], mask: int) -> bool:
    return len(chosen) == bin(mask).count("1") and list(chosen) == sorted(chosen)


@given(
    offs_m=st.lists(st.sampled_from([0.0, 0.1, 0.15, 0.205, 0.25, 0.35, 1.0]), min_size=3, max_size=3),
    ordered=st.booleans(),
)
@settings(max_examples=examples(20), deadline=None)
def test_a_missed_goal_counts_the_less_the_larger_it_would_have_to_be(
    offs_m: list[float], ordered: bool
) -> None:
    asked = task(*goals(*POINTS), measures="reached reached_pct", any_order=not ordered)
    half = math.sqrt(0.5)
    sides = ((-half, half), (-half, -half), (1.0, 0.0))  # the corners are cut, and the end is too early
    passed = [
        (x + off_m * dx, y + off_m * dy)
        for (x, y), (dx, dy), off_m in zip(POINTS, sides, offs_m, strict=True)
    ]
    scoring = graded(asked, through(*passed))
    reached, share = value(scoring, "reached"), value(scoring, "reached_pct")
    assert reached is not None
    assert share is not None
    nearly = [0.75 * (2.0 - off_m / 0.2) for off_m in offs_m if 0.2 < off_m < 0.4]
    assert reached == sum(off_m <= 0.2 for off_m in offs_m)
    assert share == pytest.approx(100.0 * (reached + sum(nearly)) / 3.0, abs=3.1)  # in steps of 3 % of a goal
    assert ("nearly" in scoring.items[1].message.en) == (len(nearly) > 0)


def test_a_missed_goal_counts_less_and_less() -> None:
    asked = task(*goals((8.0, 3.0)), measures="reached_pct")
    shares = []
    for short_m in (0.201, 0.21, 0.24, 0.26, 0.299, 0.32, 0.34, 0.36, 0.38, 0.41):
        share = value(graded(asked, through((8.0 - short_m, 3.0))), "reached_pct")
        assert share is not None
        shares.append(share)
    assert 70.0 < shares[0] < 75.0
    assert shares == sorted(shares, reverse=True)
    assert max(one - other for one, other in itertools.pairwise(shares)) <= 20.0
    assert shares[-1] == 0.0


def test_who_stops_just_before_the_goal_does_not_lose_all_that_needs_it() -> None:
    asked = replace(
        assignment("go_to_goal"), cases=(Case(),), world=World(start=StartPose(x_m=START[0], y_m=START[1]))
    )
    earned = []
    for short_m in (0.15, 0.21, 0.25, 0.27, 0.28, 0.295, 0.31, 0.33, 0.345, 0.4, 0.7, 1.0, 1.5):
        scoring = graded(asked, through((8.0 - short_m, 3.0)))
        earned.append(sum(item.earned for item in scoring.items))
    assert earned[0] == 100
    assert earned[1] == pytest.approx(94, abs=2.0)  # 35 while all else needed the whole goal
    assert earned == sorted(earned, reverse=True)
    assert max(one - other for one, other in itertools.pairwise(earned)) < 22


@pytest.mark.parametrize(
    ("asked", "trajectory", "code", "words"),
    [
        (goals(*POINTS, hold_s=5.0), through(*POINTS), "place_not_held", "5 s is wanted"),
        (goals(POINTS[0], by_s=3.0), through(POINTS[0]), "place_late", "3 s is the latest"),
        (
            goals(POINTS[0]),
            drive([(4.0, 0.1, 0.0)], start_m=START, idle_s=0.0),
            "time_was_up",
            "Time was up",
        ),
    ],
)
def test_what_is_said_of_a_goal_that_was_missed(
    asked: list[WantedGoal], trajectory: Trajectory, code: str, words: str
) -> None:
    scoring = graded(task(*asked), trajectory, ended="interrupted" if "time" in words.lower() else "finished")
    assert scoring.mistakes[0] == code
    assert words in scoring.hint.en


def test_who_stays_at_the_end_has_held_and_who_drives_on_has_left() -> None:
    held = graded(task(*goals(POINTS[0], hold_s=30.0)), through(POINTS[0]))
    assert value(held, "reached") == 1
    asked = task(*goals(POINTS[0]), measures="reached end_off_m settled")
    left = graded(asked, through(POINTS[0], (8.0, 6.0)))
    assert "Slow down as you come near" in left.hint.en
    asked = task(*goals(POINTS[0]), measures="reached settled")
    moving = graded(asked, drive([(20.0, 1.0, 0.0)], start_m=START, horizon_s=5.5))
    assert "Publish a Twist of zeros" in moving.hint.en


def test_an_end_heading_is_looked_at_round_the_circle() -> None:
    asked = task(*goals(POINTS[0]), measures="reached heading_error_deg", end_heading_deg=350.0)
    assert value(graded(asked, through(POINTS[0])), "heading_error_deg") == pytest.approx(10.0, abs=0.1)


def test_walls_and_places_to_avoid() -> None:
    box = Region(kind="box", x_m=5.5, y_m=3.0, width_m=1.0, height_m=1.0)
    asked = task(*goals(POINTS[0]), measures="reached entered clearance_m", avoid=(box,))
    through_it = graded(asked, through(POINTS[0]))
    assert (value(through_it, "entered"), value(through_it, "clearance_m")) == (1, 0)
    assert "Go round it" in through_it.hint.en
    round_it = graded(asked, through((5.5, 1.5), POINTS[0]))
    assert value(round_it, "entered") == 0
    assert value(round_it, "clearance_m") == pytest.approx(0.53, abs=0.1)
    hit = replace(through(POINTS[0]), contacts=(Contact(wall="top", start_ns=1, end_ns=2),))
    wall = graded(task(*goals(POINTS[0]), measures="contacts"), hit)
    assert (value(wall, "contacts"), wall.mistakes[0]) == (1, "place_wall")


def test_a_teleport_to_the_goal_is_no_visit() -> None:
    way = through((4.0, 3.0))
    x = way.x_m.copy()
    x[-20:] = POINTS[0][0]
    jumped = replace(way, x_m=x, jumps=(len(x) - 20,))
    assert value(graded(task(*goals(POINTS[0])), jumped), "reached") == 0
    fast = replace(through(POINTS[0], (10.5, 3.0), v=9.0), jumps=())
    small = WantedGoal(region=circle(*POINTS[0], radius=0.05))
    assert value(graded(task(small), fast), "reached") == 1  # passed between two samples


def test_hostile_numbers_measure_nothing() -> None:
    way = through(POINTS[0])
    broken = replace(way, x_m=np.full_like(way.x_m, np.nan))
    assert value(graded(task(*goals(*POINTS)), broken), "reached") is None


def test_the_sketch_shows_goals_and_how_near_the_car_came() -> None:
    asked = task(*goals(*POINTS), avoid=(circle(1.0, 1.0),))
    shown = sketch(asked, run_of(through(*POINTS[:2], (3.6, 8.0))))
    assert [(region.text.en, region.ok, region.avoid) for region in shown.regions] == [
        ("1", True, False),
        ("2", True, False),
        ("3", False, False),
        ("×", True, True),
    ]
    assert [label.text.en for label in shown.labels] == ["0.6 m away"]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"places": None}, "missing; give places"),
        ({"world": World(walls=False, start=StartPose(x_m=1.0))}, "there is no wall to touch"),
        ({"world": World(start=StartPose(x_m=8.0, y_m=3.0))}, "in it from the beginning"),
    ],
)
def test_places_that_do_not_fit_the_rubric_are_refused(changes: dict[str, object], words: str) -> None:
    asked = replace(task(*goals(POINTS[0]), measures="contacts"), **changes)  # type: ignore[arg-type]
    assert any(words in told.en for _, told in problems(asked))
    far = task(*goals((20.0, 3.0)), measures="reached heading_error_deg entered")
    told = [
        each.en for _, each in problems(replace(far, items=(replace(far.items[0], low=2.0), *far.items[1:])))
    ]
    assert [words.partition(";")[0] for words in told] == [
        "there are only 1 goals",
        "there is no places.end_heading_deg",
        "there is no places.avoid",
        "lies outside the field (0 to 11.09 m)",
    ]


def test_who_never_drove_is_told_to_drive_and_not_where_to() -> None:
    scoring = graded(task(*goals(POINTS[0])), drive([(5.0, 0.0, 1.0)], start_m=START))
    assert scoring.mistakes == ("no_drive",)
