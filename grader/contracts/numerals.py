"""Numbers in writing: plain decimal digits, read without guessing and written without rounding.

Python's own readers take more than anybody means: ``1_0`` and full-width digits are 10, ``nan`` and ``inf`` are
numbers, blanks are passed over. Its ``:g`` writes six digits of 1234567.5. Points pass through here both ways.
"""

import math
import re

_WHOLE = re.compile(r"-?[0-9]+")
_DECIMAL = re.compile(r"-?[0-9]+(\.[0-9]+)?")
_LONGEST = 40  # characters: longer than any number that fits where numbers are asked for


def whole(text: str) -> int:
    """Return the whole number that `text` writes in digits.

    Raises:
        ValueError: it is anything else, or longer than 40 characters.
    """
    if len(text) > _LONGEST or not _WHOLE.fullmatch(text):
        raise ValueError("no whole number in digits")
    return int(text)


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

    Raises:
        ValueError: `value` is not finite.
    """
    if not math.isfinite(value):
        raise ValueError(f"{value} cannot be written in digits")
    text = repr(float(value) + 0.0)  # minus zero becomes zero
    if "e" in text:
        from decimal import Decimal  # rare, and a cold start pays for every import

        text = format(Decimal(text), "f")
    return text.removesuffix(".0")
