"""Numbers as they stand in sentences: few digits, with their unit."""

from collections.abc import Iterable

from grader.contracts.text import Text

DECIMALS = {"m": 2, "s": 1, "deg": 1, "%": 1, "": 0}
SUFFIX = {"m": " m", "s": " s", "deg": "°", "%": " %", "": ""}
MAX_LISTED = 8
MAX_DECIMALS = 5


def plain(value: float, decimals: int) -> str:
    """Return `value` with at most `decimals` decimals and no trailing zeros; minus zero is zero."""
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def number(value: float, unit: str) -> str:
    """Return `value` with its unit."""
    return plain(value, DECIMALS[unit]) + SUFFIX[unit]


def number_beside(value: float, unit: str, edges: Iterable[float | None]) -> str:
    """Return `value` with enough digits that it reads as lying on its real side of each edge."""
    known = [edge for edge in edges if edge is not None]
    decimals = DECIMALS[unit]
    while decimals < MAX_DECIMALS and any(
        (value < edge) != (round(value, decimals) < edge) or (value > edge) != (round(value, decimals) > edge)
        for edge in known
    ):
        decimals += 1
    return plain(value, decimals) + SUFFIX[unit]


def listed(values: Iterable[float], unit: str) -> Text:
    """Return a short list of values with their unit, cut after eight."""
    texts = [number(float(value), unit) for value in values]
    shown = texts[:MAX_LISTED] + ["…"] * (len(texts) > MAX_LISTED)
    return Text(zh="、".join(shown), en=", ".join(shown))
