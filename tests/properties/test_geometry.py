"""What must not matter to a figure's measures does not, and credit falls as defects grow."""

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.checks import evaluate
from grader.contracts.rubric import ItemStatus, RubricItem
from grader.contracts.trajectory import Trajectory
from tests.examples import examples
from tests.unit.checks.shipped import POLYGONS, assignment, graded, score
from tests.unit.checks.trajectories import Leg, drive, polygon_legs, run_of

TOLERANCE = {"m": 0.03, "deg": 0.6, "%": 0.6, "": 0.0}


@dataclass(frozen=True)
class Figure:
    """A polygon with defects, large or small."""

    sides: int
    corners_deg: tuple[float, ...]
    lengths_m: tuple[float, ...]

    def legs(self, **style: float) -> list[Leg]:
        return polygon_legs(
            self.sides,
            corners_deg=self.corners_deg,
            lengths_m=self.lengths_m,
            **style,  # type: ignore[arg-type]
        )


@st.composite
def figures(draw: st.DrawFn) -> Figure:
    sides = draw(st.sampled_from(sorted(POLYGONS)))
    size = draw(st.floats(0.5, 4.0))
    corners = [360.0 / sides + draw(st.floats(-12.0, 12.0)) for _ in range(sides)]
    lengths = [size * draw(st.floats(0.8, 1.2)) for _ in range(sides)]
    return Figure(sides, tuple(corners), tuple(lengths))


def items_of(figure: Figure, trajectory: Trajectory) -> tuple[RubricItem, ...]:
    return evaluate(assignment(POLYGONS[figure.sides]), [run_of(trajectory)]).items


def assert_same(one: tuple[RubricItem, ...], other: tuple[RubricItem, ...]) -> None:
    for left, right in zip(one, other, strict=True):
        assert left.status == right.status or abs(left.earned - right.earned) < 0.05 * left.points, left.id
        if left.measured is not None and right.measured is not None:
            assert abs(left.measured - right.measured) <= TOLERANCE[left.unit], (left, right)


@settings(max_examples=examples(40))
@given(figures(), st.floats(-360.0, 360.0), st.floats(-50.0, 50.0), st.floats(-50.0, 50.0))
def test_rotation_and_translation(figure: Figure, heading_deg: float, x_m: float, y_m: float) -> None:
    here = drive(figure.legs())
    there = drive(figure.legs(), heading_deg=heading_deg, start_m=(x_m, y_m))
    assert_same(items_of(figure, here), items_of(figure, there))


@settings(max_examples=examples(40))
@given(figures())
def test_mirror_image(figure: Figure) -> None:
    left, right = drive(figure.legs(w_radps=1.0)), drive(figure.legs(w_radps=-1.0))
    assert_same(items_of(figure, left), items_of(figure, right))


@settings(max_examples=examples(40))
@given(figures(), st.floats(0.3, 3.0), st.floats(0.3, 3.1))
def test_speed(figure: Figure, v_mps: float, w_radps: float) -> None:
    slow, fast = drive(figure.legs()), drive(figure.legs(v_mps=v_mps, w_radps=w_radps), period_s=1 / 240)
    assert_same(items_of(figure, slow), items_of(figure, fast))


@settings(max_examples=examples(40))
@given(figures(), st.floats(0.0, 0.9))
def test_pauses(figure: Figure, pause_s: float) -> None:
    assert_same(items_of(figure, drive(figure.legs())), items_of(figure, drive(figure.legs(pause_s=pause_s))))


@settings(max_examples=examples(40))
@given(figures(), st.floats(1 / 500, 1 / 25))
def test_resampling_of_time(figure: Figure, period_s: float) -> None:
    assert_same(
        items_of(figure, drive(figure.legs())), items_of(figure, drive(figure.legs(), period_s=period_s))
    )


@settings(max_examples=examples(40))
@given(figures(), st.integers(1, 12))
def test_splitting_motions_into_pieces(figure: Figure, pieces: int) -> None:
    whole = figure.legs()
    split = [leg for d, v, w in whole for leg in [(d / pieces, v, w), (0.02, 0.0, 0.0)] * pieces]
    assert_same(items_of(figure, drive(whole)), items_of(figure, drive(split)))


@settings(max_examples=examples(40))
@given(figures(), st.floats(0.0, 3.0), st.floats(0.0, 3.0))
def test_idle_time_before_and_after(figure: Figure, before_s: float, after_s: float) -> None:
    legs = [(before_s, 0.0, 0.0), *figure.legs()]
    assert_same(items_of(figure, drive(figure.legs())), items_of(figure, drive(legs, idle_s=1.0 + after_s)))


@settings(max_examples=examples(25))
@given(figures(), st.integers(0, 1000))
def test_small_noise(figure: Figure, seed: int) -> None:
    clean = items_of(figure, drive(figure.legs()))
    noisy = items_of(figure, drive(figure.legs(), noise_m=0.002, noise_rad=0.005, seed=seed))
    for left, right in zip(clean, noisy, strict=True):
        assert abs(left.earned - right.earned) <= 0.15 * left.points, (left, right)


@pytest.mark.parametrize(
    ("name", "legs", "step", "most"),
    [
        ("straight", lambda size: [(size, 1.0, 0.0)], 0.02, 10.0),
        ("backward", lambda size: [(size, -1.0, 0.0)], 0.02, 10.0),
        ("spin", lambda size: [(math.radians(size), 0.0, 1.0)], 10.0, 7.0),
    ],
)
def test_credit_grows_step_by_step_with_what_was_driven(
    name: str, legs: Callable[[float], list[Leg]], step: float, most: float
) -> None:
    totals = [score(graded(name, drive(legs(i * step)))) for i in range(40, 0, -1)]
    assert totals == sorted(totals, reverse=True)
    assert (totals[0], totals[-1]) == (100, 10)
    assert most_lost(totals) < most


def most_lost(totals: list[float]) -> float:
    """The largest loss from one to the next."""
    return max(before - after for before, after in itertools.pairwise(totals))


legs_of_any_kind = st.lists(
    st.tuples(st.floats(0.0, 4.0), st.floats(-3.0, 3.0), st.floats(-7.0, 7.0)), max_size=12
)


@settings(max_examples=examples(150))
@given(legs_of_any_kind, st.sampled_from(["straight", "backward", "spin", "square", "triangle", "pentagon"]))
def test_any_motion_is_judged_within_bounds(legs: list[Leg], name: str) -> None:
    verdict = graded(name, drive(legs))
    assert len(verdict.items) == len(assignment(name).items)
    for each in verdict.items:
        assert 0.0 <= each.earned <= each.points
        assert (each.earned == each.points) is (each.status is ItemStatus.PASSED)
        assert each.status is not ItemStatus.NOT_CHECKED or each.earned == 0.0
        assert each.measured is None or math.isfinite(each.measured)
    assert (score(verdict) == 100) is (verdict.mistakes == () and verdict.hint.en == "")


@settings(max_examples=examples(30))
@given(legs_of_any_kind, st.sampled_from(["x_m", "y_m", "heading_rad"]), st.floats(0.0, 1.0))
def test_one_nan_earns_nothing(legs: list[Leg], name: str, where: float) -> None:
    trajectory = drive(legs)
    values = getattr(trajectory, name).copy()
    values[int(where * (len(values) - 1))] = math.nan
    verdict = graded("square", replace(trajectory, **{name: values}))
    assert score(verdict) == 0
