"""Credit: full in the band, a ramp outside, nothing for NaN."""

import math

import pytest

from grader.checks.scoring import credit, earned_points, item_status
from grader.contracts.assignment import ItemSpec
from grader.contracts.rubric import ItemStatus
from grader.contracts.text import EMPTY


def spec(low: float | None = None, high: float | None = None, ramp: float = 0.0) -> ItemSpec:
    return ItemSpec(id="x", title=EMPTY, points=10.0, measure="m", low=low, high=high, ramp=ramp)


@pytest.mark.parametrize(
    ("value", "expected"),
    [(87, 1.0), (90, 1.0), (93, 1.0), (96, 0.84375), (99, 0.5), (105, 0.0), (81, 0.5), (0, 0.0)],
)
def test_band_and_ramp(value: float, expected: float) -> None:
    assert credit(spec(87, 93, 12), value) == pytest.approx(expected)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_earns_nothing(value: float) -> None:
    assert credit(spec(low=-1, high=1, ramp=5), value) == 0.0


@pytest.mark.parametrize("band", [{"low": 1.0}, {"high": 1.0}])
def test_nan_earns_nothing_in_a_half_open_band(band: dict[str, float]) -> None:
    assert credit(spec(**band), math.nan) == 0.0


def test_without_ramp_it_is_all_or_nothing() -> None:
    assert credit(spec(low=1), 1.0) == 1.0
    assert credit(spec(low=1), 0.999999) == 0.0


def test_only_a_full_share_earns_all_points() -> None:
    assert earned_points(10.0, 1.0) == 10.0
    assert earned_points(10.0, 1.0 - 1e-12) == 9.99
    assert earned_points(10.0, 1e-12) == 0.0


@pytest.mark.parametrize(
    ("points", "part", "expected"),
    [(10.0, 1.0, ItemStatus.PASSED), (9.99, 1 - 1e-12, ItemStatus.PARTIAL), (0.0, 1e-12, ItemStatus.FAILED)],
)
def test_status_agrees_with_what_was_earned(points: float, part: float, expected: ItemStatus) -> None:
    assert item_status(points, part) is expected
