"""Numbers must be short, and never read as the opposite of the verdict beside them."""

import math
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.contracts.rubric import ItemStatus, Unit
from grader.contracts.text import Text
from grader.messages import quantity
from grader.render.prose import breaks
from tests.unit.checks.shipped import POLYGONS, graded
from tests.unit.checks.trajectories import drive, polygon_legs
from tests.unit.render.samples import item


@pytest.mark.parametrize("unit", [unit for unit in get_args(Unit) if unit])
def test_every_unit_can_be_shown_and_stays_on_the_line_of_its_number(unit: Unit) -> None:
    shown = quantity.number(2.0, unit)
    assert shown.startswith("2")
    text = f"word {shown}"
    assert list(breaks(text, len(text) - 1)) == [text.index("2")]
    assert quantity.is_unit(unit)


def test_a_unit_that_nobody_knows_is_none() -> None:
    assert not quantity.is_unit("furlong")
    assert not quantity.is_unit(None)


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [
        (4.8, "m", "4.8 m"),
        (2.0, "m", "2 m"),
        (90.04, "deg", "90°"),
        (0.785, "rad/s", "0.785 rad/s"),
        (-0.01, "s", "0 s"),
    ],
)
def test_number(value: float, unit: Unit, shown: str) -> None:
    assert quantity.number(value, unit) == shown


@pytest.mark.parametrize(
    ("values", "measured"),
    [
        ({"measured": 4.0, "target": 4.0, "tolerance": 0.0}, "4"),
        ({"measured": 1.62, "target": 2.0, "tolerance": 0.1, "unit": "m"}, "1.62 m"),
        ({"measured": 90.24, "target": 90.0, "tolerance": 3.0, "unit": "deg"}, "90.2°"),
        ({"measured": 18.44, "target": 0.0, "tolerance": 5.0, "unit": "%"}, "18.4 %"),
        ({"measured": -0.001, "target": 0.0, "tolerance": 1.0, "unit": "m"}, "0 m"),
        ({"measured": None, "target": 2.0, "tolerance": 0.1, "unit": "m"}, "—"),
        ({"measured": math.nan}, "—"),
        ({"measured": math.inf, "unit": "m"}, "—"),
        ({"measured": 1.0504, "target": 1.0, "tolerance": 0.05, "unit": "m"}, "1.0504 m"),
        ({"measured": 0.4996, "target": 0.5, "unit": "m"}, "0.4996 m"),
        ({"measured": 0.3, "target": 0.2, "tolerance": 0.1, "unit": "m"}, "0.3 m"),
    ],
)
def test_measured(values: dict[str, object], measured: str) -> None:
    assert quantity.measured(item(**values), "zh") == measured


@pytest.mark.parametrize("bend", [0.0, 1.0, 4.0, 11.0])
@pytest.mark.parametrize("sides", POLYGONS)
def test_the_table_writes_a_number_as_the_sentence_beside_it_does(sides: int, bend: float) -> None:
    motion = drive(polygon_legs(sides, corners_deg=[360.0 / sides + bend, *[360.0 / sides] * (sides - 1)]))
    seen = [each for each in graded(POLYGONS[sides], motion).items if each.measured is not None and each.unit]
    assert len(seen) >= 3
    for each in seen:
        assert quantity.measured(each, "en") in each.message.en


@given(st.floats(0.5, 1.5), st.floats(0.001, 0.2))
def test_the_shown_number_is_on_the_real_side_of_the_tolerance(value: float, tolerance: float) -> None:
    value, tolerance = round(value, 5), round(tolerance, 3)
    shown = quantity.measured(item(measured=value, target=1.0, tolerance=tolerance, unit="m"), "en")
    number = float(shown.removesuffix(" m"))
    assert (abs(number - 1.0) <= tolerance + 1e-9) == (abs(value - 1.0) <= tolerance + 1e-9)


def test_what_is_wanted_is_said_in_the_checks_words() -> None:
    line = item(target=0.5, unit="m", wanted=Text(zh="至少 0.5 m", en="at least 0.5 m"))
    assert quantity.wanted(line, "zh") == "至少 0.5 m"
    assert quantity.wanted(line, "en") == "at least 0.5 m"
    assert quantity.wanted(item(), "en") == "—"


@pytest.mark.parametrize(("value", "zh", "en"), [(1.0, "是", "yes"), (0.0, "否", "no")])
def test_yes_or_no(value: float, zh: str, en: str) -> None:
    line = item(ItemStatus.FAILED, measured=value, target=1.0, wanted=Text(zh="是", en="yes"))
    assert (quantity.measured(line, "zh"), quantity.measured(line, "en")) == (zh, en)


@pytest.mark.parametrize(
    ("value", "shown"), [(90.0, "+90°"), (-90.14, "−90.1°"), (0.01, "0°"), (-0.01, "0°")]
)
def test_signed(value: float, shown: str) -> None:
    assert quantity.signed(value, "deg") == shown


@pytest.mark.parametrize(("value", "shown"), [(10.0, "10"), (7.25, "7.25"), (7.5, "7.5"), (0.1 + 0.2, "0.3")])
def test_points(value: float, shown: str) -> None:
    assert quantity.points(value) == shown
