import math
from datetime import UTC, datetime, timedelta
from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.contracts.notation import decimal, instant, whole, written

NO_NUMBERS = [
    *("", " ", "1_0", " 10", "10 ", "+10", "1e1", "1E400", "0x10", "١٠", "１０", "²", "½", "1,5", "1.", ".5"),
    *("nan", "NaN", "inf", "-Infinity", "--1", "1.2.3", "1\n", "10\x00", "true", "9" * 41, "0." + "1" * 60),
]
CENTS = st.integers(0, 10**12).map(lambda cents: cents / 100)


@pytest.mark.parametrize("text", NO_NUMBERS)
def test_what_python_would_read_or_people_might_mean_is_no_number(text: str) -> None:
    for read in (whole, decimal):
        with pytest.raises(ValueError, match="digits"):
            read(text)


def test_numbers_in_digits() -> None:
    assert (whole("10"), whole("-3"), whole("007")) == (10, -3, 7)
    assert (decimal("10"), decimal("22.50"), decimal("-0.25")) == (10.0, 22.5, -0.25)
    with pytest.raises(ValueError, match="whole"):
        whole("1.0")


@given(st.text(max_size=12))
def test_whatever_is_read_was_written_in_ascii_digits(text: str) -> None:
    try:
        number = decimal(text)
    except ValueError:
        return
    assert set(text) <= set("-.0123456789")
    assert Decimal(text) == Decimal(repr(number)) or float(Decimal(text)) == number


@given(CENTS)
def test_points_are_written_in_full_and_read_back_the_same(points: float) -> None:
    text = written(points)
    assert decimal(text) == points
    assert "e" not in text
    assert len(text.partition(".")[2]) <= 2


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_any_finite_number_reads_back_the_same(value: float) -> None:
    text = written(value)
    assert float(text) == value
    assert set(text) <= set("-.0123456789")


def test_what_six_digits_lose() -> None:
    assert written(1234567.5) == "1234567.5"
    assert written(99999.99) == "99999.99"
    assert (written(10.0), written(-0.0), written(1e-7), written(1e22)) == (
        "10",
        "0",
        "0.0000001",
        "1" + "0" * 22,
    )
    for value in (math.nan, math.inf):
        with pytest.raises(ValueError, match="digits"):
            written(value)


PLAIN = datetime(2026, 3, 20, 23, 59)


@pytest.mark.parametrize("text", ["2026-03-20T23:59", "2026-03-20 23:59:00", "2026-03-20t23:59:00.000000"])
def test_without_an_offset(text: str) -> None:
    assert instant(text) == PLAIN


def test_with_an_offset() -> None:
    assert instant("2026-03-20T23:59:00Z") == PLAIN.replace(tzinfo=UTC)
    assert instant("2026-03-20T23:59+08:00").utcoffset() == timedelta(hours=8)


@pytest.mark.parametrize(
    "text",
    [
        *(
            "",
            "tomorrow",
            "2026-03-20",
            "20260320T2359",
            "2026-W12-5T23:59",
            "1772409600",
            "2026-02-30T23:59",
        ),
        *(
            "2026-03-20T24:30",
            "2026-03-20T2_:59",
            "２０２６-03-20T23:59",
            " 2026-03-20T23:59",
            "2026-03-20T23:59 CST",
        ),
    ],
)
def test_what_is_no_instant(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        instant(text)
