"""Check ``path``: a measure of the figure, not of the style; what may differ, what costs, and what is said."""

import cmath
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.checks import evaluate, problems, sketch
from grader.checks.kinds.path.mistakes import named_corner
from grader.contracts.assignment import Assignment, PathPiece, WantedPath
from grader.contracts.outcome import RunStatus
from grader.contracts.scoring import Scoring
from grader.contracts.trajectory import Contact, Trajectory
from grader.messages import say
from tests.examples import examples
from tests.unit.checks.shipped import assignment, graded, item, score
from tests.unit.checks.trajectories import Leg, drive, run_of

TRIANGLE = [("line", 2.0), ("turn", 90.0), ("line", 2.0), ("turn", 135.0), ("line", 2.0 * math.sqrt(2.0))]
EIGHT = [("arc", 360.0, 1.0), ("arc", -360.0, 1.0)]
L = [("line", 3.0), ("turn", 90.0), ("line", 1.5)]


def legs(pieces: Sequence[tuple[object, ...]], scale: float = 1.0, sense: float = 1.0) -> list[Leg]:
    """Return the legs of a script that drives `pieces` one after the other, at 1 m/s and 1 rad/s."""
    found: list[Leg] = []
    for kind, size, *radius in pieces:
        value = float(size)  # type: ignore[arg-type]
        if kind == "line":
            found.append((abs(value) * scale, math.copysign(1.0, value), 0.0))
        elif kind == "turn":
            found.append((abs(math.radians(value)), 0.0, math.copysign(sense, value * sense)))
        else:
            radius_m = float(radius[0]) * scale  # type: ignore[arg-type]
            turn = math.copysign(1.0 / radius_m, value * sense)
            found.append((abs(math.radians(value)) * radius_m, 1.0, turn))
        found.append((0.1, 0.0, 0.0))
    return found


def freed(name: str, **changes: object) -> Assignment:
    """Return a shipped assignment that leaves other things free."""
    task = assignment(name)
    assert task.path is not None
    return replace(task, path=replace(task.path, **changes))


def graded_as(task: Assignment, trajectory: Trajectory, status: RunStatus = RunStatus.FINISHED) -> Scoring:
    return evaluate(task, [run_of(trajectory, status)])


@settings(max_examples=examples(10))
@given(
    st.sampled_from(["right_triangle", "figure_eight"]),
    st.floats(-180.0, 180.0),
    st.floats(1.0, 9.0),
    st.floats(1.0, 9.0),
    st.booleans(),
    st.booleans(),
)
def test_start_heading_mirror_image_and_direction_cost_nothing(
    name: str, heading_deg: float, x: float, y: float, mirrored: bool, backwards: bool
) -> None:
    pieces = TRIANGLE if name == "right_triangle" else EIGHT
    pieces = pieces[::-1] if backwards else pieces
    way = legs(pieces, sense=-1.0 if mirrored else 1.0)
    assert score(graded(name, drive(way, heading_deg=heading_deg, start_m=(x, y)))) == 100


@pytest.mark.parametrize("share", [0.02, 0.3, 0.5, 0.9])
@pytest.mark.parametrize("side", [0, 1, 2])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_closed_path_may_begin_within_a_line(share: float, side: int, sense: float) -> None:
    lines = [2.0, 2.0, 2.0 * math.sqrt(2.0)]
    turns = [90.0, 135.0, 135.0]
    order = [(side + i) % 3 for i in range(3)]
    lap = [piece for i in order for piece in (("line", lines[i]), ("turn", turns[i]))]
    begun, ends = ("line", (1.0 - share) * lines[side]), ("line", share * lines[side])
    once = legs([begun, *lap[1:], ends], sense=sense)
    assert score(graded("right_triangle", drive(once, heading_deg=30.0))) == 100
    assert score(graded("right_triangle", drive([(1.0, 0.0, 1.0), *once, (1.0, 0.0, 1.0)]))) == 100
    for_ever = drive(legs([begun, *lap[1:], *lap * 4], sense=sense), horizon_s=40.0)
    assert score(graded("right_triangle", for_ever, RunStatus.INTERRUPTED)) >= 95  # 100 with whole laps
    shown = sketch(assignment("right_triangle"), run_of(drive(once)))
    assert [corner.ok for corner in shown.corners] == [True, True]


@pytest.mark.parametrize("between", ["turn", "line"])
def test_what_is_driven_between_two_circles_costs_the_more_the_larger_it_is(between: str) -> None:
    points = []
    for share in (0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0):
        extra = (between, share * (90.0 if between == "turn" else 1.5))
        scoring = graded("figure_eight", drive(legs([EIGHT[0], extra, EIGHT[1]] if share else EIGHT)))
        points.append(score(scoring))
    assert points[:2] == [100, 100]
    assert points == sorted(points, reverse=True)
    assert points[-1] < 80
    assert item(scoring, "touch").earned == 0
    assert item(scoring, "radius").earned == 25


def test_an_approach_to_a_closed_path_costs_the_way_back_only() -> None:
    points = []
    for length_m in (0.0, 0.2, 0.3, 0.5, 0.7, 1.0, 2.0):
        approach = [("line", length_m), ("turn", 50.0)] if length_m else []
        scoring = graded("right_triangle", drive(legs([*approach, *TRIANGLE, ("turn", 135.0)])))
        points.append(score(scoring))
    assert points[0] == 100
    assert min(points) == points[-1] == 90
    square = legs([("line", 2.0), ("turn", 90.0)] * 4)
    assert score(graded("right_triangle", drive(square))) < 30


def test_who_ends_beside_the_beginning_within_a_line_has_a_gap() -> None:
    points = []
    for beyond_m in (0.0, 0.2, 0.4, 0.6, 0.8):
        way = [("line", 1.0), *TRIANGLE[1:], ("turn", 135.0), ("line", 1.0 + beyond_m)]
        points.append(score(graded("right_triangle", drive(legs(way)))))
    assert points[0] == 100
    assert points == sorted(points, reverse=True)
    assert 50 < points[-1] < 75


@pytest.mark.parametrize("scale", [0.4, 0.8, 1.7])
def test_another_size_costs_nothing_where_the_size_is_free(scale: float) -> None:
    for name, pieces in (("right_triangle", TRIANGLE), ("figure_eight", EIGHT)):
        trajectory = drive(legs(pieces, scale))
        assert score(graded_as(freed(name, any_scale=True), trajectory)) == 100
        told = graded(name, trajectory)
        assert 70 <= score(told) < 90


@pytest.mark.parametrize(("name", "left"), [("right_triangle", 80), ("figure_eight", 75)])
def test_the_right_path_in_another_size_loses_lengths_and_radii_only(name: str, left: float) -> None:
    pieces = {"right_triangle": TRIANGLE, "figure_eight": EIGHT}[name]
    for scales in ((1.0, 1.03, 1.06, 1.1, 1.2, 1.5), (1.0, 0.97, 0.94, 0.9, 0.8, 0.6)):
        earned = [score(graded(name, drive(legs(pieces, scale)))) for scale in scales]
        assert earned == sorted(earned, reverse=True)
        assert (earned[0], earned[-1]) == (100, left)


def test_a_closed_path_may_begin_at_any_piece() -> None:
    for first in (0, 2, 4):
        rotated = [*TRIANGLE, ("turn", 135.0)]
        rotated = rotated[first:] + rotated[:first]
        assert score(graded("right_triangle", drive(legs(rotated)))) == 100
    only = freed("right_triangle", any_direction=False, mirror=False)
    assert score(graded_as(only, drive(legs([*TRIANGLE[2:], ("turn", 135.0), TRIANGLE[0]])))) < 90


@pytest.mark.parametrize(
    ("name", "way", "to_zero_m"),
    [
        ("right_triangle", [*TRIANGLE, ("turn", 135.0)], 1.1),
        ("right_triangle", [*TRIANGLE, ("turn", -45.0)], 1.1),
        ("figure_eight", EIGHT, 1.6),
    ],
)
def test_a_way_on_from_a_path_costs_the_more_the_longer_it_is(
    name: str, way: list[tuple[object, ...]], to_zero_m: float
) -> None:
    ons = (0.1, 0.3, 0.5, 0.7, 0.9, 1.1, 1.3, 1.6, 2.5)
    earned = [score(graded(name, drive(legs([*way, ("line", on_m)])))) for on_m in ons]
    assert earned[0] == 100
    assert earned == sorted(earned, reverse=True)
    assert [points > 85 for points, on_m in zip(earned, ons, strict=True)] == [
        on_m < to_zero_m for on_m in ons
    ]
    assert score(graded(name, drive(legs([*way, ("line", 0.6)])))) < 95  # a tenth of a lap counted as a lap


def test_a_last_line_that_leads_past_the_start_is_too_long() -> None:
    scoring = graded("right_triangle", drive(legs([*TRIANGLE[:4], ("line", 4.0)])))
    assert "line 3: 4 m instead of 2.83 m" in item(scoring, "lengths").message.en
    assert score(scoring) == 65


def test_an_arc_that_goes_too_far_round_costs_its_end() -> None:
    earned = [
        score(graded("figure_eight", drive(legs([EIGHT[0], ("arc", -360.0 - over, 1.0)]))))
        for over in (0.0, 20.0, 40.0, 60.0, 80.0)
    ]
    assert earned == sorted(earned, reverse=True)
    assert earned[3] < 90  # a metre beyond the start


def test_an_eight_may_begin_at_its_top() -> None:
    for side in (1.0, -1.0):
        way = [("arc", side * 180.0, 1.0), ("arc", side * -360.0, 1.0), ("arc", side * 180.0, 1.0)]
        assert score(graded("figure_eight", drive(legs(way)))) == 100
    way[1] = ("arc", way[1][1], 1.3)


@pytest.mark.parametrize("name", ["right_triangle", "figure_eight"])
def test_noise_of_one_percent_costs_nothing_and_ten_percent_costs(name: str) -> None:
    way = legs(TRIANGLE if name == "right_triangle" else EIGHT)
    for seed in (1, 2, 3):
        assert score(graded(name, drive(way, noise_m=0.01, seed=seed))) == 100
    assert score(graded(name, waved(drive(way), 0.3))) < 85


def waved(trajectory: Trajectory, wide_m: float) -> Trajectory:
    """Return a motion that swings to and fro across its way, which noise from sample to sample does not."""
    swing = wide_m * np.sin(np.arange(len(trajectory)) / 25.0)
    return replace(
        trajectory,
        x_m=trajectory.x_m - swing * np.sin(trajectory.heading_rad),
        y_m=trajectory.y_m + swing * np.cos(trajectory.heading_rad),
    )


@pytest.mark.parametrize(
    ("name", "spoilt"),
    [
        ("right_triangle", lambda e: [*TRIANGLE[:4], ("line", 2.0 * math.sqrt(2.0) * (1.0 - e))]),
        ("right_triangle", lambda e: [TRIANGLE[0], ("turn", 90.0 * (1.0 + e)), *TRIANGLE[2:]]),
        ("figure_eight", lambda e: [EIGHT[0], ("arc", -360.0, 1.0 + e)]),
        ("letter_l", lambda e: [("line", 3.0), ("turn", 90.0), ("line", 1.5 * (1.0 + e))]),
        ("letter_l", lambda e: [("line", 3.0), ("turn", 90.0 * (1.0 - e)), ("line", 1.5)]),
    ],
)
def test_credit_falls_as_one_error_grows(name: str, spoilt: object) -> None:
    scores = [
        score(graded(name, drive(legs(spoilt(error)))))  # type: ignore[operator]
        for error in (0.0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3)
    ]
    assert scores[:2] == [100, 100]
    assert scores == sorted(scores, reverse=True)
    assert scores[-1] < 75


def steered(*points: complex, gain: float) -> list[Leg]:
    """Drive from point to point, turning and driving at once, as fast as the distance and the heading say."""
    at, heading_rad, legs = 0j, 0.0, []
    for point in points:
        while abs(point - at) > 0.05:
            error_rad = math.remainder(cmath.phase(point - at) - heading_rad, math.tau)
            v = abs(point - at) * max(math.cos(error_rad), 0.02)
            legs.append((0.02, v, gain * error_rad))
            heading_rad += 0.01 * gain * error_rad
            at += cmath.rect(0.02 * v, heading_rad)
            heading_rad += 0.01 * gain * error_rad
    return legs


def test_a_corner_that_is_steered_round_is_where_half_of_it_is_turned() -> None:
    scores = [
        score(graded("letter_l", drive(steered(3 + 0j, 3 + 1.5j, gain=gain)))) for gain in (6, 4, 3, 2, 1.5)
    ]
    assert scores == sorted(scores, reverse=True)
    assert scores[0] > 99
    assert scores[-1] > 85


@pytest.mark.parametrize(
    "spoilt",
    [
        lambda e: [*TRIANGLE[:4], ("line", 2.0 * math.sqrt(2.0) * (1.0 - e))],
        lambda e: [*TRIANGLE[:2], ("line", 2.0 * (1.0 - e)), *TRIANGLE[3:]],
        lambda e: [*TRIANGLE[:2], ("line", 2.0 * (1.0 + e)), *TRIANGLE[3:]],
    ],
)
def test_a_line_far_too_short_or_too_long_costs_no_corner(spoilt: object) -> None:
    """Another way of driving the path may lie nearer to such a drive, with all its corners wrong."""
    scorings = [graded("right_triangle", drive(legs(spoilt(e)))) for e in (0.3, 0.4, 0.45, 0.5, 0.6)]  # type: ignore[operator]
    assert all(item(scoring, "corners").earned == 25 for scoring in scorings)
    scores = list(map(score, scorings))
    assert scores == sorted(scores, reverse=True)
    assert scores[-1] > 30


@pytest.mark.parametrize("laps", [2, 3])
def test_a_closed_path_may_be_driven_over_again_and_cut_by_the_horizon(laps: int) -> None:
    way = legs([*TRIANGLE, ("turn", 135.0)]) * laps
    assert score(graded("right_triangle", drive(way))) == 100
    cut = drive(way, horizon_s=sum(leg[0] for leg in way) - 4.0)
    assert score(graded("right_triangle", cut, RunStatus.INTERRUPTED)) == 100
    assert score(graded_as(freed("right_triangle", laps=False), drive(way))) < 100


@pytest.mark.parametrize(
    ("name", "pieces", "id_", "words"),
    [
        ("figure_eight", [EIGHT[0], ("arc", -360.0, 1.3)], "radius", "circle 2: 1.3 m instead of 1 m"),
        ("figure_eight", [EIGHT[0]], "whole", "50 % of the wanted path"),
        ("right_triangle", [*TRIANGLE[:4], ("line", 2.0)], "lengths", "line 3: 2 m instead of 2.83 m"),
        ("right_triangle", [TRIANGLE[0], ("turn", 75.0), *TRIANGLE[2:]], "corners", "75°"),
    ],
)
def test_what_is_said(name: str, pieces: list[tuple[object, ...]], id_: str, words: str) -> None:
    scoring = graded(name, drive(legs(pieces)))
    assert scoring.mistakes == ()
    assert words in item(scoring, id_).message.en
    assert score(scoring) <= 85


@pytest.mark.parametrize(
    ("driven_deg", "wanted_deg", "said"),
    [
        (80.0, 90.0, "80°"),
        (-80.0, -90.0, "80°"),
        (269.8, 90.0, "90.2° to the other side"),
        (-20.0, 135.0, "20° to the other side"),
        (0.0, 90.0, "0°"),
    ],
)
def test_a_corner_is_told_as_it_was_turned(driven_deg: float, wanted_deg: float, said: str) -> None:
    told = say("path.corner_error_deg.seen", value="", **named_corner(driven_deg, wanted_deg)).en
    assert f" is {said} instead of {abs(wanted_deg):.0f}°" in told


def test_a_wall_comes_first_and_standing_still_is_no_path() -> None:
    hit = replace(drive(legs(L[:1])), contacts=(Contact(wall="right", start_ns=1, end_ns=2),))
    assert graded("letter_l", hit).mistakes[0] == "wall_hit"
    circle = replace(drive(legs(EIGHT[:1])), contacts=hit.contacts)
    assert graded("figure_eight", circle).mistakes[0] == "wall_hit"
    assert score(graded("letter_l", drive([(1.0, 0.0, 0.0)]))) == 0
    spun = graded("figure_eight", drive([(30.0, 0.0, 1.0)]))
    assert (score(spun), spun.mistakes[0]) == (0, "no_drive")


def test_the_sketch_shows_the_wanted_path_where_it_fits() -> None:
    shown = sketch(assignment("figure_eight"), run_of(drive(legs([EIGHT[0], ("arc", -360.0, 1.3)]))))
    assert [(label.text.en, label.ok) for label in shown.labels] == [("r = 1 m", True), ("r = 1.3 m", False)]
    assert len(shown.ideal_m) > 100
    assert math.dist(shown.ideal_m[0], (5.544, 5.544)) < 0.01  # from where the car set out
    first = shown.ideal_m[: len(shown.ideal_m) // 2]
    assert max(abs(math.dist(point, (5.544, 6.544)) - 1.0) for point in first) < 0.05
    lines = sketch(assignment("right_triangle"), run_of(drive(legs(TRIANGLE))))
    assert [round(side.length_m, 2) for side in lines.sides] == [2.0, 2.0, 2.83]
    assert [round(corner.angle_deg) for corner in lines.corners] == [90, 135]
    assert all(side.ok for side in lines.sides)


@pytest.mark.parametrize(
    ("pieces", "measure", "words"),
    [
        ((), "off_pct", "missing; give path"),
        ((PathPiece(kind="turn", angle_deg=90.0),), "off_pct", "nothing of it is driven"),
        ((PathPiece(kind="line", length_m=1.0),), "radius_error_pct", "no arc"),
        ((PathPiece(kind="line", length_m=1.0),), "corner_error_deg", "no corner"),
        ((PathPiece(kind="arc", radius_m=1.0, angle_deg=90.0),), "length_error_pct", "no line"),
    ],
)
def test_a_path_that_does_not_fit_its_rubric_is_refused(
    pieces: tuple[PathPiece, ...], measure: str, words: str
) -> None:
    task = assignment("right_triangle")
    items = (replace(task.items[0], measure=measure),)
    path = WantedPath(pieces=pieces) if pieces else None
    found = problems(replace(task, items=items, path=path))
    assert any(words in told.en for _, told in found), found


def test_points_may_be_given_instead_of_lengths() -> None:
    goals = tuple(PathPiece(kind="goto", x_m=x, y_m=y) for x, y in ((2.0, 0.0), (2.0, 2.0), (0.0, 0.0)))
    task = freed("right_triangle", pieces=goals)
    assert score(graded_as(task, drive(legs(TRIANGLE)))) == 100


def test_backing_up_along_a_line_is_a_line() -> None:
    there_and_back = (PathPiece(kind="line", length_m=2.0), PathPiece(kind="turn", angle_deg=90.0))
    there_and_back += (PathPiece(kind="line", length_m=-1.0),)
    task = freed("letter_l", pieces=there_and_back)
    trajectory = drive(legs([("line", 2.0), ("turn", 90.0), ("line", -1.0)]))
    scoring = graded_as(task, trajectory)
    assert score(scoring) == 100, [(each.id, each.measured) for each in scoring.items]
    assert item(scoring, "corners").measured == pytest.approx(0.0, abs=1.0)


def test_without_mirror_images_a_closed_path_of_left_turns_is_not_driven_with_right_ones() -> None:
    task = freed("right_triangle", mirror=False)
    for first in (0, 2, 4):
        around = [*TRIANGLE, ("turn", 135.0)]
        around = around[first:] + around[:first]
        assert score(graded_as(task, drive(legs(around)))) == 100
        right = graded_as(task, drive(legs(around, sense=-1.0)))
        assert score(right) < 50
    # an eight turns both ways: from its end it is no mirror image
    assert score(graded_as(freed("figure_eight", mirror=False), drive(legs(EIGHT[::-1])))) == 100


SPIRAL = [("arc", 180.0, 1.0), ("arc", 180.0, 1.6), ("arc", 180.0, 2.2)]


@pytest.mark.parametrize("any_start", [False, True])
def test_who_drives_the_first_part_well_is_told_how_much_that_is(any_start: bool) -> None:
    pieces = tuple(PathPiece(kind="arc", angle_deg=180.0, radius_m=radius) for radius in (1.0, 1.6, 2.2))
    task = freed("figure_eight", pieces=pieces, any_start=any_start, any_direction=False, laps=False)
    scoring = graded_as(task, drive(legs(SPIRAL[:2])))
    whole = next(each for each in scoring.items if "covered" in each.title.en.lower() or each.id == "whole")
    assert whole.measured == pytest.approx(100.0 * 2.6 / 4.8, abs=1.0)


def test_another_size_is_told_with_how_large_it_is() -> None:
    told = graded("figure_eight", drive(legs(EIGHT, 0.5)))
    assert "0.5 m instead of 1 m" in item(told, "radius").message.en
