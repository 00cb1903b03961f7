"""Numbers as a reader wants them: few digits, with their unit, never contradicting the verdict."""

import math

from grader.contracts.numerals import written
from grader.contracts.rubric import RubricItem
from grader.contracts.text import Language
from grader.render.labels import word

_DECIMALS = {"m": 2, "s": 2, "deg": 1, "%": 1}
_MOST_DECIMALS = 5
_SUFFIX = {"deg": "°", "%": " %", "": ""}
NOTHING = "—"


def suffix(unit: str) -> str:
    """Return what follows a number of that unit, with its space where one belongs."""
    return _SUFFIX.get(unit, f" {unit}")


def number(value: float, decimals: int) -> str:
    """Return `value` with at most `decimals` decimals; counts stay whole, minus zero is zero."""
    if value == round(value) and abs(value) < 1e15 and decimals <= 0:
        return str(int(value))
    text = f"{value:.{max(decimals, 0)}f}"
    return text[1:] if text.startswith("-") and not text.strip("-0.") else text


def signed(value: float, decimals: int) -> str:
    """Return `value` with ``+`` or a typographic minus, zero without either."""
    text = number(abs(value), decimals)
    if not text.strip("0."):
        return text
    return f"+{text}" if value > 0 else f"−{text}"


def _trimmed(value: float) -> str:
    return written(round(value, 4))


def plain(value: float) -> str:
    """Return a number that somebody set, such as a share in per cent: nine decimals at most."""
    return written(round(value, 9))


def _inside(value: float, target: float, tolerance: float) -> bool:
    return abs(value - target) <= tolerance + 1e-12


def _decimals(item: RubricItem) -> int:
    """Return the fewest decimals at which the shown number lies on the real one's side of the tolerance."""
    least = _DECIMALS.get(item.unit, 0 if _whole(item) else 2)
    if item.measured is None or item.target is None or item.tolerance is None:
        return least
    real = _inside(item.measured, item.target, item.tolerance)
    for decimals in range(least, _MOST_DECIMALS):
        if _inside(float(number(item.measured, decimals)), item.target, item.tolerance) == real:
            return decimals
    return _MOST_DECIMALS


def _whole(item: RubricItem) -> bool:
    return item.measured is not None and float(item.measured).is_integer()


def measured(item: RubricItem, language: Language) -> str:
    """Return the measured value with its unit, a dash when nothing (or no number) was measured."""
    if item.measured is None or not math.isfinite(item.measured):
        return NOTHING
    if item.wanted.en == "yes":
        return word("yes" if item.measured >= 1.0 else "no", language)
    return number(item.measured, _decimals(item)) + suffix(item.unit)


def wanted(item: RubricItem, language: Language) -> str:
    """Return what earns full credit, in the checks' words or else as target and tolerance with their unit."""
    if words := item.wanted.get(language):
        return words
    if item.target is None:
        return NOTHING
    if not item.tolerance:
        return _trimmed(item.target) + suffix(item.unit)
    if item.unit == "deg":
        return f"{_trimmed(item.target)}° ± {_trimmed(item.tolerance)}°"
    return f"{_trimmed(item.target)} ± {_trimmed(item.tolerance)}{suffix(item.unit)}"


def score(value: float) -> str:
    """Return a score with at most two decimals and no trailing zeros."""
    return written(round(value, 2))
