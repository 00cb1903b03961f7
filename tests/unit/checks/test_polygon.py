"""The polygon check on ideal and less than ideal motions."""

import math
from dataclasses import replace

import numpy as np
import pytest

from grader.contracts.assignment import WINDOW_M
from grader.contracts.outcome import RunStatus
from grader.contracts.rubric import ItemStatus
from grader.contracts.trajectory import Contact, Trajectory
from tests.unit.checks.shipped import POLYGONS, graded, item, score
from tests.unit.checks.trajectories import START, Leg, drive, polygon_legs

INTERRUPTED = RunStatus.INTERRUPTED


@pytest.mark.parametrize("sides", POLYGONS)
@pytest.mark.parametrize("w", [1.0, -1.0, 0.3, 3.1])
@pytest.mark.parametrize("v", [0.5, 2.0])
def test_right_figures_get_full_marks(sides: int, w: float, v: float) -> None:
    scoring = graded(POLYGONS[sides], drive(polygon_legs(sides, 1.5, v_mps=v, w_radps=w)))
    assert score(scoring) == 100
    assert scoring.mistakes == ()
    assert scoring.hint.zh == ""


@pytest.mark.parametrize("sides", POLYGONS)
def test_driving_backwards_round_the_figure_is_right_too(sides: int) -> None:
    assert score(graded(POLYGONS[sides], drive(polygon_legs(sides, v_mps=-1.0)))) == 100


@pytest.mark.parametrize("sides", POLYGONS)
def test_the_last_turn_is_optional(sides: int) -> None:
    assert score(graded(POLYGONS[sides], drive(polygon_legs(sides, last_turn=False)))) == 100


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("turned_deg", [60, 96, 180, 270, 450 - 24])
def test_a_wrong_last_turn_costs_the_rest_only(turned_deg: float, sense: float) -> None:
    legs = polygon_legs(4, corners_deg=[90, 90, 90, turned_deg], w_radps=sense)
    scoring = graded("square", drive(legs))
    assert score(scoring) == 95
    assert scoring.hint.zh.endswith(item(scoring, "rest").hint.zh)


@pytest.mark.parametrize("turned_deg", [92, 360, 450, 720, -270])
def test_a_right_last_turn_with_whole_turns_is_right(turned_deg: float) -> None:
    assert score(graded("square", drive(polygon_legs(4, corners_deg=[90, 90, 90, turned_deg])))) == 100


def test_an_approach_costs_the_way_back_only_and_the_more_the_longer_it_is() -> None:
    earned = []
    for approach_m in (0.1, 0.3, 0.5, 0.8, 1.2, 2.0):
        legs: list[Leg] = [(approach_m, 1.0, 0.0), (math.radians(45), 0.0, -1.0), *polygon_legs(4)]
        scoring = graded("square", drive(legs))
        earned.append(score(scoring))
        assert all(each.earned == each.points for each in scoring.items if each.id != "closed")
    assert earned == sorted(earned, reverse=True)
    assert earned[0] == 100
    assert earned[-1] == 85


def test_a_walk_after_the_figure_costs() -> None:
    walk: list[Leg] = [(math.radians(135), 0.0, -1.0), (1.5, 1.0, 0.0)]
    scoring = graded("square", drive([*polygon_legs(4), *walk]))
    assert score(scoring) == 80


@pytest.mark.parametrize("corner_deg", [92, 94, 98, 102])
def test_a_walk_after_a_figure_that_does_not_close_costs_no_more_than_after_one_that_does(
    corner_deg: float,
) -> None:
    legs = polygon_legs(4, corners_deg=[corner_deg] * 4)
    walk: list[Leg] = [(math.radians(30), 0.0, -1.0), (1.0, 1.0, 0.0), (0.8, 0.0, 1.0), (1.2, 1.0, 0.0)]
    alone, with_walk = graded("square", drive(legs)), graded("square", drive([*legs, *walk]))
    assert score(alone) - 20 <= score(with_walk) <= score(alone)


@pytest.mark.parametrize("turned_deg", [45, -45, 135])
def test_an_approach_to_a_figure_that_does_not_quite_close_is_no_side_either(turned_deg: float) -> None:
    turn: Leg = (math.radians(abs(turned_deg)), 0.0, math.copysign(1.0, turned_deg))
    earned = []
    for corner_deg in (90, 93, 94, 96, 98):
        legs: list[Leg] = [(0.8, 1.0, 0.0), turn, *polygon_legs(4, corners_deg=[corner_deg] * 4)]
        scoring = graded("square", drive(legs))
        assert item(scoring, "sides").measured == 4
        earned.append(score(scoring))
    assert earned == sorted(earned, reverse=True)
    assert earned[-1] > 70


@pytest.mark.parametrize("sides", [4, 3])
def test_sides_driven_forward_and_backing_up_in_turn_are_right(sides: int) -> None:
    turn = math.radians(360 / sides - 180)
    legs = [leg for i in range(sides) for leg in ((2.0, (-1.0) ** i, 0.0), (abs(turn), 0.0, -1.0))]
    scoring = graded(POLYGONS[sides], drive(legs[:-1]))
    assert score(scoring) == 100


def test_turning_before_each_side_is_right() -> None:
    legs = [(math.pi / 2, 0.0, 1.0), (2.0, 1.0, 0.0)] * 4
    assert score(graded("square", drive(legs))) == 100


def test_starting_in_the_middle_of_a_side_is_right() -> None:
    turn: Leg = (math.pi / 2, 0.0, 1.0)
    legs = [(1.0, 1.0, 0.0), turn, *[(2.0, 1.0, 0.0), turn] * 3, (1.0, 1.0, 0.0)]
    scoring = graded("square", drive(legs))
    assert score(scoring) == 100
    assert item(scoring, "sides").measured == 4


@pytest.mark.parametrize("laps", [2, 3.4, 2.5])
def test_repeating_until_ctrl_c_is_judged_on_the_first_figure(laps: float) -> None:
    legs = polygon_legs(4, 1.0, laps=5)
    lap_s = sum(duration for duration, _, _ in legs) / 5
    scoring = graded("square", drive(legs, horizon_s=laps * lap_s), INTERRUPTED)
    assert score(scoring) == 100


def test_repeating_with_long_pauses_and_interrupted_in_one() -> None:
    legs = polygon_legs(4, 1.0, laps=3, pause_s=1.0)
    stop_s = sum(duration for duration, _, _ in legs[:22]) - 0.3  # in the pause after the sixth side
    assert score(graded("square", drive(legs, horizon_s=stop_s), INTERRUPTED)) == 100


def test_a_side_in_many_pieces_is_one_side() -> None:
    legs: list[Leg] = []
    for _ in range(4):
        legs += [(0.1, 1.0, 0.0), (0.05, 0.0, 0.0)] * 20
        legs += [(math.pi / 20, 0.0, 1.0), (0.05, 0.0, 0.0)] * 10
    scoring = graded("square", drive(legs))
    assert score(scoring) == 100
    assert item(scoring, "sides").measured == 4


@pytest.mark.parametrize("by_m", [0.1, 0.24])
def test_corrections_after_overshooting_do_not_count(by_m: float) -> None:
    """The larger one is what a loop at 10 Hz does at 2 m/s."""
    legs: list[Leg] = []
    for _ in range(4):
        legs += [(2.0 + by_m, 1.0, 0.0), (by_m, -1.0, 0.0)]
        legs += [(math.radians(100), 0.0, 1.0), (math.radians(10), 0.0, -1.0)]
    scoring = graded("square", drive(legs))
    assert score(scoring) == 100
    assert 0.0 <= (item(scoring, "straight").measured or 0.0) < 1.0


def test_a_wobbling_heading_controller_is_right() -> None:
    wobble = [(0.1, 1.0, 0.6), (0.2, 1.0, -0.6), (0.1, 1.0, 0.6)] * 5
    legs = [*wobble, (math.pi / 2, 0.0, 1.0)] * 4
    assert score(graded("square", drive(legs))) >= 99


def test_slow_starts_and_lag_are_right() -> None:
    assert score(graded("square", drive(polygon_legs(4, pause_s=0.6), lag_s=0.08))) == 100


def test_a_proportional_turn_that_creeps_to_its_goal_is_right() -> None:
    creep = [(0.05, 0.0, 2.0 * math.radians(90) * math.exp(-0.1 * (k + 0.5))) for k in range(60)]
    legs = [*[(2.0, 1.0, 0.0)], *creep] * 4
    assert score(graded("square", drive(legs))) == 100


def test_noise_of_a_rough_world_is_borne() -> None:
    scoring = graded("pentagon", drive(polygon_legs(5), noise_m=0.003, noise_rad=0.01, lag_s=0.05))
    assert score(scoring) >= 99


@pytest.mark.parametrize(("task", "driven"), [(3, 4), (5, 4), (4, 3), (4, 5)])
def test_another_figure_fails(task: int, driven: int) -> None:
    scoring = graded(POLYGONS[task], drive(polygon_legs(driven)))
    assert item(scoring, "sides").status is ItemStatus.FAILED
    assert item(scoring, "angles").status is ItemStatus.NOT_CHECKED
    assert score(scoring) == 5


@pytest.mark.parametrize("sides", POLYGONS)
@pytest.mark.parametrize("corner", range(3))
def test_six_degrees_in_one_corner_cost_and_two_do_not(sides: int, corner: int) -> None:
    for defect, costs in ((2, False), (-2, False), (6, True), (-6, True)):
        corners = [360 / sides] * sides
        corners[corner] += defect
        scoring = graded(POLYGONS[sides], drive(polygon_legs(sides, corners_deg=corners)))
        assert (score(scoring) < 100) is costs, (defect, scoring.items)


@pytest.mark.parametrize("sides", POLYGONS)
@pytest.mark.parametrize("side", range(3))
def test_eight_percent_in_one_side_cost_and_three_do_not(sides: int, side: int) -> None:
    for defect, costs in ((0.03, False), (-0.03, False), (0.08, True), (-0.08, True)):
        lengths = [2.0] * sides
        lengths[side] *= 1 + defect
        scoring = graded(POLYGONS[sides], drive(polygon_legs(sides, lengths_m=lengths)))
        assert (score(scoring) < 100) is costs, (defect, scoring.items)


@pytest.mark.parametrize("sides", POLYGONS)
def test_a_timer_of_a_tenth_of_a_second_passes(sides: int) -> None:
    """At 1 rad/s each turn lasts whole ticks: 92, 120.3 and 74.5 degrees."""
    turn_s = math.ceil(2 * math.pi / sides * 10) / 10
    legs = [(2.0, 1.0, 0.0), (turn_s, 0.0, 1.0)] * sides
    assert score(graded(POLYGONS[sides], drive(legs))) == 100


def test_a_teleport_is_not_motion() -> None:
    """Three sides, then a jump to the start: the figure is not closed by it."""
    trajectory = drive(polygon_legs(4, laps=0.75, last_turn=False))
    x, y = trajectory.x_m.copy(), trajectory.y_m.copy()
    x[-1], y[-1] = x[0], y[0]
    jumped = type(trajectory)(
        t_ns=trajectory.t_ns,
        x_m=x,
        y_m=y,
        heading_rad=trajectory.heading_rad,
        v_mps=trajectory.v_mps,
        w_radps=trajectory.w_radps,
        end_ns=trajectory.end_ns,
        jumps=(len(x) - 1,),
        commands=trajectory.commands,
    )
    scoring = graded("square", jumped)
    assert item(scoring, "sides").measured == 3
    assert item(scoring, "closed").status is ItemStatus.FAILED


def test_an_empty_or_broken_trajectory_earns_nothing() -> None:
    whole = drive(polygon_legs(4))
    nothing = np.empty(0)
    for poses in (nothing, np.array([math.nan]), np.full(len(whole), math.nan)):
        broken = type(whole)(
            t_ns=np.arange(len(poses), dtype=np.int64),
            x_m=poses,
            y_m=poses,
            heading_rad=poses,
            v_mps=poses,
            w_radps=poses,
            end_ns=10**9,
        )
        for name in ("square", "straight", "spin"):
            scoring = graded(name, broken)
            assert score(scoring) == 0
            assert all(each.measured is None for each in scoring.items if each.measured != 0.0)


def test_never_moving_earns_nothing() -> None:
    assert score(graded("square", drive([(5.0, 0.0, 0.0)]))) == 0


def at_a_wall(side_m: float) -> Trajectory:
    trajectory = drive(polygon_legs(4, side_m))
    touched = int(trajectory.t_ns[np.argmax(trajectory.x_m > WINDOW_M)])
    contact = Contact(
        start_ns=touched, end_ns=touched + round((START[0] + side_m - WINDOW_M) * 1e9), wall="right"
    )
    return replace(trajectory, x_m=np.minimum(trajectory.x_m, WINDOW_M), contacts=(contact,))


def test_what_a_wall_takes_off_a_side_costs_the_more_the_longer_it_was_meant() -> None:
    scores = [
        sum(one.earned for one in graded("square", at_a_wall(side_m)).items)
        for side_m in (5.6, 5.7, 5.8, 5.9, 6.2)
    ]
    assert scores == sorted(scores, reverse=True)
    assert scores[0] == 100.0
    assert scores[3] < 95.0


def test_a_wall_is_named() -> None:
    scoring = graded("square", at_a_wall(7.0))
    assert scoring.mistakes[0] == "wall_hit"
    assert "右" in scoring.hint.zh


@pytest.mark.parametrize(
    ("name", "legs"),
    [
        ("square", polygon_legs(4, lengths_m=[3.0, 2.0, 3.0, 2.0])),
        ("square", polygon_legs(4, lengths_m=[3.0, 2.0, 3.0, 1.8])),
        ("rectangle", polygon_legs(4)),
        ("hexagon", polygon_legs(7, 1.0)),
        ("octagon", polygon_legs(7, 1.0)),
        ("pentagon", polygon_legs(6)),
        ("triangle", polygon_legs(4)),
    ],
)
def test_another_figure_earns_at_most_what_its_sides_and_corners_do(name: str, legs: list[Leg]) -> None:
    scoring = graded(name, drive(legs))
    assert score(scoring) <= 45
    assert {each.id for each in scoring.items if each.earned} <= {"moves", "sides", "angles"}


@pytest.mark.parametrize("cut_s", [None, 55.0])
def test_a_turn_between_laps_costs_no_less_the_further_it_is_off(cut_s: float | None) -> None:
    """Up to 9 degrees it is a corner; from there on, what follows the first lap is something else."""
    status = RunStatus.FINISHED if cut_s is None else RunStatus.INTERRUPTED
    scores = []
    for off_deg in (0.0, 2.0, 4.0, 6.0, 8.0, 9.5, 12.0, 15.0, 20.0, 60.0, 120.0, 170.0):
        legs = polygon_legs(4, 1.0, corners_deg=[90, 90, 90, 90 + off_deg] * 6, laps=6)
        scores.append(score(graded("square", drive(legs, horizon_s=cut_s), status)))
    assert scores[:2] == [100.0, 100.0]
    assert scores[-1] == (80.0 if cut_s is None else 95.0)
    if cut_s is None:
        assert scores == sorted(scores, reverse=True)


@pytest.mark.parametrize("bend_deg", [8.0, 20.0, 30.0, -20.0])
def test_who_turns_after_the_last_bent_side_as_after_the_others_has_stopped(bend_deg: float) -> None:
    bend, turn = math.radians(bend_deg), math.radians(90.0 - bend_deg)
    scoring = graded("square", drive([(2.0, 1.0, bend / 2.0), (turn, 0.0, 1.0)] * 4))
    assert item(scoring, "rest").earned == 5
    assert item(scoring, "angles").earned == 25


@pytest.mark.parametrize(("corner_deg", "told"), [(45.0, False), (15.05, True), (16.0, True)])
def test_nothing_counts_for_all_of_it_only(corner_deg: float, told: bool) -> None:
    corners = [45.0, 45.0, corner_deg, *[45.0] * 5]
    scoring = graded("octagon", drive(polygon_legs(8, 1.0, corners_deg=corners)))
    messages = [each.message.en for each in scoring.items]
    assert any("It counts for" in message or "% only" in message for message in messages) is told
    assert not any("counts for 100 %" in message for message in messages)
