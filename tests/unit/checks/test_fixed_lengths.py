"""Polygons whose side lengths are given: rectangles, and squares of the side a case asks for."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.checks import evaluate, problems, sketch
from grader.checks.kinds.polygon.figures import WantedPolygon
from grader.contracts.assignment import Case
from grader.contracts.outcome import RunStatus
from grader.contracts.rubric import ItemStatus
from grader.contracts.scoring import Run
from tests.unit.checks.shipped import assignment, graded, item, score
from tests.unit.checks.trajectories import Leg, drive, outcome_of, polygon_legs, run_of

LONG_FIRST, SHORT_FIRST = (3.0, 2.0, 3.0, 2.0), (2.0, 3.0, 2.0, 3.0)
RECTANGLE = WantedPolygon(4, LONG_FIRST)


@pytest.mark.parametrize("lengths", [LONG_FIRST, SHORT_FIRST])
@pytest.mark.parametrize("w", [1.0, -1.0])
def test_a_rectangle_from_either_side_and_either_way(lengths: tuple[float, ...], w: float) -> None:
    scoring = graded("rectangle", drive(polygon_legs(4, lengths_m=lengths, w_radps=w)))
    assert score(scoring) == 100
    assert scoring.mistakes == ()


def test_a_rectangle_begun_in_the_middle_of_a_side() -> None:
    turn: Leg = (math.pi / 2, 0.0, 1.0)
    legs = [(1.5, 1.0, 0.0), turn, (2.0, 1.0, 0.0), turn, (3.0, 1.0, 0.0), turn, (2.0, 1.0, 0.0), turn]
    assert score(graded("rectangle", drive([*legs, (1.5, 1.0, 0.0)]))) == 100


@pytest.mark.parametrize("laps", [2, 2.3, 2.6])
def test_a_repeated_rectangle(laps: float) -> None:
    legs = polygon_legs(4, lengths_m=LONG_FIRST * 3, laps=3)
    lap_s = sum(duration for duration, _, _ in legs) / 3
    assert score(graded("rectangle", drive(legs, horizon_s=laps * lap_s), RunStatus.INTERRUPTED)) == 100


@pytest.mark.parametrize(
    "lengths", [(2.0,) * 4, (3.0,) * 4, (1.5, 1.0) * 2, (3.0, 3.0, 2.0, 2.0), (3.0, 2.0, 3.0, 1.8)]
)
def test_other_lengths_cost_and_are_told(lengths: tuple[float, ...]) -> None:
    scoring = graded("rectangle", drive(polygon_legs(4, lengths_m=lengths)))
    assert item(scoring, "lengths").status in (ItemStatus.FAILED, ItemStatus.PARTIAL)
    assert "side" in scoring.hint.en


@pytest.mark.parametrize("side", range(4))
def test_eight_percent_cost_and_three_do_not(side: int) -> None:
    for defect, costs in ((0.03, False), (-0.03, False), (0.08, True), (-0.08, True)):
        lengths = list(LONG_FIRST)
        lengths[side] *= 1 + defect
        assert (score(graded("rectangle", drive(polygon_legs(4, lengths_m=lengths)))) < 100) is costs


@given(st.lists(st.floats(0.1, 10.0), max_size=9), st.integers(0, 3))
def test_the_pattern_may_begin_anywhere(sides: list[float], shift: int) -> None:
    error = RECTANGLE.side_error_pct(sides)
    assert math.isnan(error) if not sides else error >= 0.0
    assert RECTANGLE.side_error_pct(LONG_FIRST[shift:] + LONG_FIRST[:shift]) == 0.0


def test_the_ideal_figure_lies_under_the_driven_one() -> None:
    for lengths in (LONG_FIRST, SHORT_FIRST):
        for w in (1.0, -1.0):
            run = run_of(drive(polygon_legs(4, lengths_m=lengths, w_radps=w)))
            drawn = sketch(assignment("rectangle"), run)
            corners = [side.start_m for side in drawn.sides]
            assert max(map(math.dist, corners, drawn.ideal_m)) < 0.05
            assert all(side.ok for side in drawn.sides)


def test_a_case_has_its_own_side() -> None:
    task = assignment("square_input")
    runs = []
    for case, side in zip(task.cases, (1.5, 2.0, 0.8), strict=True):
        trajectory = drive(polygon_legs(4, side))
        runs.append(Run(trajectory=trajectory, outcome=outcome_of(trajectory), case=case.id))
    scoring = evaluate(task, runs)
    lost = [each.id for each in scoring.items if each.status is not ItemStatus.PASSED]
    assert lost == ["side_3/lengths", "every_length"]
    assert sum(each.points for each in scoring.items) == pytest.approx(100, abs=1e-9)
    assert "线速度" in scoring.hint.zh


def test_options_that_do_not_fit() -> None:
    square = assignment("square")
    for options, field in (
        ({"sides": 4, "side_m": 0.0}, "options.side_m"),
        ({"sides": 4, "side_m": True}, "options.side_m"),
        ({"sides": 5, "side_m": 1.0, "other_side_m": 2.0}, "options.other_side_m"),
        ({"sides": 4, "other_side_m": 2.0}, "options.other_side_m"),
    ):
        assert field in dict(problems(replace(square, options=options)))
    wrong_case = replace(square, cases=(Case(id="a", options={"sides": 2}),))
    assert "cases.0.options.sides" in dict(problems(wrong_case))
    assert "options.side_m" in dict(problems(replace(assignment("rectangle"), options={"sides": 4})))
