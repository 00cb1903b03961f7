"""A number that is the size of a motion becomes the size that was wanted, not a multiple by the measured ratio."""

import math

import pytest

from grader.edits.numbers import _named


@pytest.mark.parametrize(
    ("value", "size", "wanted", "unit", "named"),
    [
        (60.0, 60.7, 90.0, "deg", 90.0),
        (-60.0, 60.7, 90.0, "deg", -90.0),
        (1.0472, 60.7, 90.0, "deg", math.radians(90.0)),
        (1.5, 1.504, 2.0, "m", 2.0),
        (1.5, 60.7, 90.0, "deg", None),  # seconds, say
        (3.0, 2.0, 4.0, "m", None),
    ],
)
def test_sizes_are_named(value: float, size: float, wanted: float, unit: str, named: float | None) -> None:
    assert _named(value, size, wanted, unit) == (None if named is None else pytest.approx(named))
