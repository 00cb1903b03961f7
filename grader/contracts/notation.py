"""Numbers and instants in writing: read without guessing, written without rounding.

Python's own readers accept more than anybody means: ``1_0`` and full-width digits are 10, ``nan`` and ``inf`` are
numbers, blanks are ignored. Its ``:g`` writes six digits of 1234567.5. Points are read and written here.
"""

import math
import re
from datetime import datetime

SIGNIFICANT_DIGITS = 9
"""Of a measured value: far finer than anything that is scored, and coarse enough that no last bit is left."""

_WHOLE = re.compile(r"-?[0-9]+")
_DECIMAL = re.compile(r"-?[0-9]+(\.[0-9]+)?")
_LONGEST = 40  # characters: longer than any number that fits where numbers are asked for
_INSTANT = re.compile(
    r"[0-9]{4}-[0-9]{2}-[0-9]{2}[T ][0-9]{2}:[0-9]{2}(:[0-9]{2}([.][0-9]{1,9})?)?(Z|[+-][0-9]{2}:[0-9]{2})?"
)


def whole(text: str) -> int:
    """Return the whole number that `text` writes in digits.

    Raises ValueError: it is anything else, or longer than 40 characters.
    """
    if len(text) > _LONGEST or not _WHOLE.fullmatch(text):
        raise ValueError("no whole number in digits")
    return int(text)


def significant(value: float) -> float:
    """Return a measured value without the digits that no measurement has, so that 31.250000000000004 is 31.25.

    Values that differ in their last bits are then compared, scored and worded alike.
    """
    return float(f"{value:.{SIGNIFICANT_DIGITS}g}")


def decimal(text: str) -> float:
    """Return the number that `text` writes in digits, with a point and digits after it or without.

    Raises:
        ValueError: it is anything else (no exponents, infinities or other scripts' digits), or longer than 40
            characters.
    """
    if len(text) > _LONGEST or not _DECIMAL.fullmatch(text):
        raise ValueError("no number in digits")
    return float(text)


def written(value: float) -> str:
    """Return the shortest digits that read back as `value`, without exponent; whole numbers without a point.

    Raises ValueError: `value` is not finite.
    """
    if not math.isfinite(value):
        raise ValueError(f"{value} cannot be written in digits")
    text = repr(float(value) + 0.0)  # minus zero becomes zero
    if "e" in text:
        from decimal import Decimal  # rare, and a cold start pays for every import

        text = format(Decimal(text), "f")
    return text.removesuffix(".0")


def instant(text: str) -> datetime:
    """Return the instant that `text` writes; naive when it names no offset.

    A date alone is refused: taken as midnight, it would end a day before its writer means. A number is refused,
    too, because some parsers take one for seconds since 1970.

    Raises ValueError: it is not a date and time, or there is no such date.
    """
    upper = text.upper()
    if not _INSTANT.fullmatch(upper):
        raise ValueError("no date and time such as 2026-03-20T23:59:59")
    return datetime.fromisoformat(upper)
