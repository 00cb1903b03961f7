"""Numbers must be short, and never read as the opposite of the verdict beside them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.contracts.rubric import ItemStatus
from grader.contracts.text import Text
from grader.render import quantity
from tests.unit.render.samples import item


@pytest.mark.parametrize(
    ("values", "measured", "wanted"),
    [
        ({"measured": 4.0, "target": 4.0, "tolerance": 0.0}, "4", "4"),
        ({"measured": 1.62, "target": 2.0, "tolerance": 0.1, "unit": "m"}, "1.62 m", "2 ± 0.1 m"),
        ({"measured": 90.24, "target": 90.0, "tolerance": 3.0, "unit": "deg"}, "90.2°", "90° ± 3°"),
        ({"measured": 18.44, "target": 0.0, "tolerance": 5.0, "unit": "%"}, "18.4 %", "0 ± 5 %"),
        ({"measured": -0.001, "target": 0.0, "tolerance": 1.0, "unit": "m"}, "0.00 m", "0 ± 1 m"),
        ({"measured": None, "target": 2.0, "tolerance": 0.1, "unit": "m"}, "—", "2 ± 0.1 m"),
        ({"measured": math.nan}, "—", "—"),
        ({"measured": math.inf, "unit": "m"}, "—", "—"),
        ({"measured": 1.0504, "target": 1.0, "tolerance": 0.05, "unit": "m"}, "1.0504 m", "1 ± 0.05 m"),
    ],
)
def test_measured_and_wanted(values: dict[str, object], measured: str, wanted: str) -> None:
    line = item(**values)
    assert quantity.measured(line, "zh") == measured
    assert quantity.wanted(line, "zh") == wanted


@given(st.floats(0.5, 1.5), st.floats(0.001, 0.2))
def test_the_shown_number_is_on_the_real_side_of_the_tolerance(value: float, tolerance: float) -> None:
    value, tolerance = round(value, 5), round(tolerance, 3)
    shown = quantity.measured(item(measured=value, target=1.0, tolerance=tolerance, unit="m"), "en")
    number = float(shown.removesuffix(" m"))
    assert (abs(number - 1.0) <= tolerance + 1e-9) == (abs(value - 1.0) <= tolerance + 1e-9)


def test_the_checks_words_come_first() -> None:
    line = item(target=0.5, unit="m", wanted=Text(zh="至少 0.5 m", en="at least 0.5 m"))
    assert quantity.wanted(line, "zh") == "至少 0.5 m"
    assert quantity.wanted(line, "en") == "at least 0.5 m"


@pytest.mark.parametrize(("value", "zh", "en"), [(1.0, "是", "yes"), (0.0, "否", "no")])
def test_yes_or_no(value: float, zh: str, en: str) -> None:
    line = item(ItemStatus.FAILED, measured=value, target=1.0, wanted=Text(zh="是", en="yes"))
    assert (quantity.measured(line, "zh"), quantity.measured(line, "en")) == (zh, en)


@pytest.mark.parametrize(
    ("value", "shown"), [(90.0, "+90.0"), (-90.04, "−90.0"), (0.01, "0.0"), (-0.01, "0.0")]
)
def test_signed(value: float, shown: str) -> None:
    assert quantity.signed(value, 1) == shown


@pytest.mark.parametrize(("value", "shown"), [(10.0, "10"), (7.25, "7.25"), (7.5, "7.5"), (0.1 + 0.2, "0.3")])
def test_score(value: float, shown: str) -> None:
    assert quantity.score(value) == shown
