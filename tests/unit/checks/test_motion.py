"""The check on straight motion, forward and backward."""

import math

import pytest

from grader.checks import sketch
from grader.contracts.outcome import RunStatus
from grader.contracts.rubric import ItemStatus
from grader.contracts.trajectory import Contact, Trajectory
from tests.unit.checks.shipped import assignment, graded, item, score
from tests.unit.checks.trajectories import drive, once_each, run_of

INTERRUPTED = RunStatus.INTERRUPTED


def bounced(wall_s: float = 5.0) -> Trajectory:
    """Against the wall, which turns the car and pushes it back: none of it is the student's doing."""
    trajectory = drive([(wall_s, 1.0, 0.0), (3.0, -0.3, 0.5)])
    contact = Contact(start_ns=round(wall_s * 1e9), end_ns=trajectory.end_ns, wall="right")
    values = {name: getattr(trajectory, name) for name in Trajectory.__slots__}
    return Trajectory(**{**values, "contacts": (contact,)})


@pytest.mark.parametrize("heading_deg", [0, 84, 200])
@pytest.mark.parametrize(("name", "v"), [("straight", 1.0), ("backward", -1.0)])
def test_right_motions_get_full_marks(name: str, v: float, heading_deg: float) -> None:
    scoring = graded(name, drive([(0.8, v, 0.0)], heading_deg=heading_deg))
    assert score(scoring) == 100
    assert scoring.hint.en == ""


def test_driving_for_ever_is_judged_up_to_the_wall() -> None:
    assert score(graded("straight", bounced(), INTERRUPTED)) == 100


def test_still_moving_at_the_horizon_costs_nothing() -> None:
    assert score(graded("straight", drive([(60.0, 0.2, 0.0)], horizon_s=20.0), INTERRUPTED)) == 100


@pytest.mark.parametrize(("name", "v"), [("straight", -1.0), ("backward", 1.0)])
def test_the_wrong_way(name: str, v: float) -> None:
    scoring = graded(name, drive([(2.0, v, 0.0)]))
    assert item(scoring, "distance").status is ItemStatus.FAILED
    assert item(scoring, "lateral").status is ItemStatus.NOT_CHECKED
    assert "sign" in scoring.hint.en


def test_credit_for_the_distance_falls_smoothly() -> None:
    scores = [score(graded("straight", drive([(length, 1.0, 0.0)]))) for length in (0.5, 0.4, 0.25, 0.1)]
    assert scores[0] == 100
    assert scores == sorted(scores, reverse=True)
    assert len(set(scores)) == 4


def test_a_curve_costs_heading_and_line() -> None:
    scoring = graded("straight", drive([(3.0, 1.0, 0.3)]))
    assert item(scoring, "heading").earned < 15
    assert item(scoring, "lateral").earned < 20


def test_coming_back() -> None:
    scoring = graded("straight", drive([(3.0, 1.0, 0.0), (1.0, -1.0, 0.0)]))
    assert item(scoring, "no_return").status is ItemStatus.FAILED
    distance = item(scoring, "distance")
    assert (distance.status, distance.measured) == (ItemStatus.FAILED, 2.0)
    assert "0 % at most, because points were lost in: No way back" in distance.message.en
    assert score(scoring) == 40


@pytest.mark.parametrize("name", ["straight", "backward"])
@pytest.mark.parametrize("horizon_s", [5.0, 12.0, 20.0, 60.0])
@pytest.mark.parametrize("v", [0.5, 1.0, 3.0])
def test_the_score_falls_as_the_path_bends_whatever_the_horizon(
    name: str, horizon_s: float, v: float
) -> None:
    sense = -1.0 if name == "backward" else 1.0
    radii = [
        0.5,
        0.7,
        1.0,
        1.11,
        1.25,
        1.43,
        1.67,
        2.0,
        2.5,
        3.3,
        4.0,
        4.9,
        6.0,
        8.0,
        10.0,
        14.0,
        20.0,
        100.0,
    ]
    scores = []
    for radius_m in radii:
        circle = drive([(horizon_s, sense * v, v / radius_m)], horizon_s=horizon_s)
        scores.append(score(graded(name, circle, RunStatus.INTERRUPTED)))
    assert scores == sorted(scores)
    assert all(
        points <= 30
        for radius_m, points in zip(radii, scores, strict=True)
        if radius_m * 0.7 < v * horizon_s and radius_m < 5.0
    )
    straight = drive([(horizon_s, sense * v, 0.0)], horizon_s=horizon_s)
    assert score(graded(name, straight, RunStatus.INTERRUPTED)) == 100


def test_turning_on_the_spot_is_not_driving() -> None:
    scoring = graded("straight", drive([(3.0, 0.0, 1.0)]))
    assert score(scoring) == 10
    assert scoring.mistakes == ("no_drive",)


@pytest.mark.parametrize(("name", "v"), [("straight", -1.0), ("backward", 1.0)])
def test_whoever_turns_round_first_has_not_driven_the_way_that_was_asked(name: str, v: float) -> None:
    scoring = graded(name, drive([(math.pi, 0.0, 1.0), (2.0, v, 0.0)]))
    assert item(scoring, "distance").status is ItemStatus.FAILED
    assert score(scoring) == 10


def test_a_drive_that_is_cut_short_is_not_told_to_whoever_turned_round_before_it() -> None:
    turned = once_each([(1.0, 0.0, math.pi), (2.0, 1.0, 0.0), (1.0, 0.0, 0.0)])
    assert graded("backward", turned).mistakes == ()
    assert graded("straight", once_each([(2.0, 0.3, 0.0), (1.0, 0.1, 0.0)])).mistakes[0] == "published_once"


def test_a_turn_on_the_spot_is_not_called_a_curve() -> None:
    scoring = graded("straight", drive([(2.0, 1.0, 0.0), (1.5, 0.0, 1.0)]))
    assert score(scoring) == 55.56  # the line is right: a third of heading and distance
    assert item(scoring, "heading").measured == 30
    assert "85.9°" in item(scoring, "heading").message.en
    assert "while driving" not in item(scoring, "heading").message.en


def test_a_turn_while_driving_is_told_in_full() -> None:
    heading = item(graded("straight", drive([(7.0, 1.0, 1.0)])), "heading")
    assert heading.measured == pytest.approx(math.degrees(7.0), abs=1.0)
    assert "on the spot" not in heading.message.en


@pytest.mark.parametrize("turned_deg", [90, 360, -120])
def test_turns_on_the_spot_cost_the_same_wherever_the_line_is_right(turned_deg: float) -> None:
    rate = math.copysign(1.0, turned_deg)
    turn, ahead = (abs(math.radians(turned_deg)), 0.0, rate), (1.0, 1.0, 0.0)
    back = (turn[0], 0.0, -rate)
    for legs in ([turn, back, ahead], [ahead, turn], [ahead, turn, back, ahead]):
        assert score(graded("straight", drive(legs))) == 55.56
    aside = score(graded("straight", drive([ahead, turn, (0.3, 1.0, 0.0), back, ahead])))
    assert aside == 55.56 if turned_deg == 360 else aside < 50


def test_sketch() -> None:
    shown = sketch(assignment("backward"), run_of(drive([(2.0, -1.0, 0.0)], heading_deg=90)))
    assert shown.sides[0].length_m == pytest.approx(2.0)
    assert not shown.ideal_closed
    assert math.dist(shown.ideal_m[1], shown.sides[0].end_m) < 1e-6


def test_the_sketch_says_where_points_were_lost() -> None:
    curved = sketch(assignment("straight"), run_of(drive([(2.0, 1.0, 0.4)])))
    assert curved.sides[0].ok
    assert [label.ok for label in curved.labels] == [False, False]
    assert "偏离" in curved.labels[0].text.zh
    assert "45.8°" in curved.labels[1].text.en
    short = sketch(assignment("straight"), run_of(drive([(0.3, 1.0, 0.0)])))
    assert short.sides[0].ok is False
    assert short.labels == ()
    assert math.dist(*short.ideal_m) == pytest.approx(0.49)  # what was asked for, not what was driven
