"""Runs and turns of a path."""

import math

import pytest

from grader.geometry.figure import readings
from grader.geometry.path import Path, Segments, driven_path, segment
from tests.unit.checks.trajectories import Leg, drive, polygon_legs


def path_of(legs: list[Leg], **how: float) -> Path:
    trajectory = drive(legs, **how)  # type: ignore[arg-type]
    return driven_path(trajectory.x_m, trajectory.y_m, trajectory.heading_rad)


def lengths(segments: Segments) -> list[float]:
    return [round(run.length_m, 1) for run in segments.straights]


def angles(segments: Segments) -> list[int | None]:
    return [None if turn is None else round(math.degrees(turn.angle_rad)) for turn in segments.turns]


def test_runs_and_turns_alternate() -> None:
    segments = segment(path_of(polygon_legs(3, 1.0)))
    assert lengths(segments) == [1.0, 1.0, 1.0]
    assert angles(segments) == [None, 120, 120, 120]


def test_turning_first() -> None:
    segments = segment(path_of([(1.0, 0.0, -1.0), (2.0, 1.0, 0.0)]))
    assert lengths(segments) == [2.0]
    assert angles(segments) == [-57, None]


def test_nothing_but_a_turn() -> None:
    segments = segment(path_of([(7.0, 0.0, 1.0)]))
    assert segments.straights == ()
    assert angles(segments) == [401]


def test_rest() -> None:
    assert segment(path_of([(2.0, 0.0, 0.0)])) == Segments((), (None,))


def test_arcs_between_sides_are_turns_with_a_length() -> None:
    segments = segment(path_of([(2.0, 1.0, 0.0), (math.pi / 2, 1.0, 1.0)] * 4))
    assert lengths(segments) == pytest.approx([2.0] * 4, abs=0.3)
    assert [round(turn.length_m, 1) for turn in segments.turns if turn] == pytest.approx([1.5] * 4, abs=0.4)


def test_a_circle_has_no_run() -> None:
    assert segment(path_of([(7.0, 1.0, 1.0)])).straights == ()


def test_a_slight_bend_stays_one_run() -> None:
    assert lengths(segment(path_of([(2.0, 1.0, 0.1)]))) == [2.0]


def test_a_kink_below_the_threshold_is_no_corner() -> None:
    segments = segment(path_of([(1.0, 1.0, 0.0), (math.radians(12), 0.0, 1.0), (1.0, 1.0, 0.0)]))
    assert lengths(segments) == [2.0]


def test_directions_are_continuous_over_more_than_a_full_turn() -> None:
    segments = segment(path_of([(1.0, 1.0, 0.0), (math.radians(450), 0.0, 1.0), (1.0, 1.0, 0.0)]))
    change = segments.straights[1].direction_rad - segments.straights[0].direction_rad
    assert math.degrees(change) == pytest.approx(450, abs=0.1)


def test_going_back_is_a_run_of_its_own_half_a_turn_away() -> None:
    segments = segment(path_of([(2.0, 1.0, 0.0), (1.5, -1.0, 0.0)]))
    assert lengths(segments) == [2.0, 1.5]
    change = segments.straights[1].direction_rad - segments.straights[0].direction_rad
    assert math.degrees(change) == pytest.approx(180, abs=0.1)


@pytest.mark.parametrize("sides", [3, 4, 5, 6, 8, 12])
def test_figures_up_to_twelve_sides(sides: int) -> None:
    path = path_of(polygon_legs(sides, 0.8))
    figure = next(readings(path, segment(path), sides=sides, cut_short=False))
    assert len(figure.sides_m) == sides
    turns = [math.degrees(turn) for turn in (*figure.corners_rad, figure.last_turn_rad)]
    assert turns == pytest.approx([360 / sides] * sides, abs=0.2)
    assert figure.gap_m < 0.01
    assert not figure.repeated
    assert not figure.overrun


@pytest.mark.parametrize("swing_deg", [4, 7, 10])
@pytest.mark.parametrize("waves", [1, 2, 4])
@pytest.mark.parametrize("sides", [3, 4, 6])
def test_steering_that_weaves_along_is_straight(sides: int, waves: int, swing_deg: int) -> None:
    """As steering by the sign of the error does: to and fro about the wanted direction."""
    swing, quarter = math.radians(swing_deg), 1.5 / waves / 4
    wave = [(quarter, 1.0, sign * swing / quarter) for sign in (1.0, -1.0, -1.0, 1.0)]
    path = path_of([*wave * waves, (math.tau / sides, 0.0, 1.0)] * sides)
    figure = next(readings(path, segment(path), sides=sides, cut_short=False))
    assert len(figure.sides_m) == sides
    assert figure.curved_share < 0.25


def test_corners_to_and_fro_are_no_wobble() -> None:
    left, right = (math.radians(30), 0.0, 1.0), (math.radians(30), 0.0, -1.0)
    segments = segment(path_of([*[(1.0, 1.0, 0.0), left, (1.0, 1.0, 0.0), right] * 2, (1.0, 1.0, 0.0)]))
    assert len(segments.straights) == 5


def test_a_side_that_bends_is_a_run_unless_its_arc_is_narrower_than_the_path() -> None:
    gentle = segment(path_of([(2.0, 1.0, 0.2), (math.pi / 2, 0.0, 1.0), (2.0, 1.0, 0.2)]))
    assert [round(math.degrees(run.bend_rad)) for run in gentle.straights] == [23, 23]
    narrow = segment(path_of([(2.0, 1.0, 0.0), (1.0, 1.0, 1.0), (2.0, 1.0, 0.0)]))
    assert len(narrow.straights) == 2
    assert all(run.bend_rad < 0.05 for run in narrow.straights)


@pytest.mark.parametrize("swing_deg", [6, 8, 10])
@pytest.mark.parametrize("sides", [3, 4])
def test_a_heading_that_is_corrected_too_far_on_the_spot_is_straight(sides: int, swing_deg: float) -> None:
    """Ten steps to a side, aside by the swing to the left and to the right in turn."""
    swing = math.radians(swing_deg)
    legs = []
    for _ in range(sides):
        legs.append((swing, 0.0, 1.0))
        for i in range(10):
            legs += [(0.2, 1.0, 0.0), (2.0 * swing, 0.0, -1.0 if i % 2 == 0 else 1.0)]
        legs[-1] = (math.tau / sides + swing, 0.0, 1.0)
    path = path_of(legs)
    assert len(segment(path).straights) == sides


@pytest.mark.parametrize("swing_deg", [10, 17, 30])
@pytest.mark.parametrize("sides", [3, 4, 6])
def test_steering_that_swings_far_within_a_narrow_strip_is_straight(sides: int, swing_deg: float) -> None:
    """As steering at 10 Hz by the sign of the error does: 5 cm to one side, 5 cm to the other."""
    swing = math.radians(swing_deg)
    steps = [(0.05, 1.0, 2.0 * swing / 0.05), (0.05, 1.0, -2.0 * swing / 0.05)] * 15
    side = [(swing, 0.0, -1.0), *steps, (swing, 0.0, 1.0)]
    path = path_of([*side, (math.tau / sides, 0.0, 1.0)] * sides)
    figure = next(readings(path, segment(path), sides=sides, cut_short=False))
    assert len(figure.sides_m) == sides
    assert [math.degrees(corner) for corner in figure.corners_rad] == pytest.approx(
        [360 / sides] * (sides - 1), abs=3.0
    )
