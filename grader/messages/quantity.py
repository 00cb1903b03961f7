"""Numbers with units, as sentences, tables, plots and pages show them and as students write them.

Every number that a reader sees passes through here, so that a message, the table beside it and the plot write
it alike: ``4.8 m``, never ``4.80 m`` as well.
"""

import math
import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Final, TypeGuard

from grader.contracts.notation import significant, written
from grader.contracts.record import Record
from grader.contracts.rubric import RubricItem, Unit
from grader.contracts.text import Language, Text
from grader.messages import sentence
from grader.messages.words import in_digits, words_pattern

NOTHING: Final = "—"
"""Shown in the place of a number that is not there."""

_MAX_LISTED: Final = 8  # the sides of an octagon: more would fill the sentence
_MAX_DECIMALS: Final = 5  # of a number near the edge of a band; reports keep four
_EXACTNESS: Final = re.compile(r"\s*(?:±|\+ ?/ ?[-−–])\s*\d+(?:[.,]\d+)?")
_FOREIGN: Final = (
    r"平方(?:厘米|分米|千米|公里|米)|平米|立方(?:厘米|分米|米)"
    r"|小时|公斤|千克|[ck]?m(?:\^?[23])(?!\d)|(?:kg|hours?|h)(?![A-Za-z])"
)


class _UnitKind(Record, kw_only=False):
    """How numbers of one unit are shown and read.

    Attributes:
        decimals: most that are shown; trailing zeros never are.
        suffix: what follows the number, with its space where one belongs.
        base, factor: one of this unit is `factor` of `base`.
        spellings: how students write it; none where no question asks for it.
    """

    decimals: int
    suffix: str
    base: Unit
    factor: float = 1.0
    spellings: tuple[str, ...] = ()


_UNITS: Final[Mapping[Unit, _UnitKind]] = {
    "s": _UnitKind(1, " s", "s", 1.0, ("seconds", "second", "secs", "sec", "s", "秒钟", "秒")),
    "ms": _UnitKind(0, " ms", "s", 1e-3, ("milliseconds", "ms", "毫秒")),
    "min": _UnitKind(1, " min", "s", 60.0, ("minutes", "minute", "min", "分钟")),
    "m": _UnitKind(2, " m", "m", 1.0, ("meters", "metres", "meter", "metre", "m", "米")),
    "cm": _UnitKind(1, " cm", "m", 1e-2, ("centimeters", "centimetres", "cm", "厘米")),
    "km": _UnitKind(3, " km", "m", 1e3, ("kilometers", "kilometres", "km", "公里", "千米")),
    "rad": _UnitKind(3, " rad", "rad", 1.0, ("radians", "radian", "rad", "弧度")),
    "deg": _UnitKind(1, "°", "rad", math.pi / 180.0, ("degrees", "degree", "deg", "°", "度")),
    # Three decimals, because scripts command numbers such as 0.785.
    "m/s": _UnitKind(3, " m/s", "m/s", 1.0, ("m/s", "米/秒", "米每秒")),
    "rad/s": _UnitKind(3, " rad/s", "rad/s", 1.0, ("rad/s", "弧度/秒", "弧度每秒")),
    "deg/s": _UnitKind(1, "°/s", "rad/s", math.pi / 180.0),
    "Hz": _UnitKind(1, " Hz", "Hz"),
    "%": _UnitKind(1, " %", "1", 1e-2),
    "1": _UnitKind(2, "", "1"),
    "": _UnitKind(0, "", ""),  # a count
}
ANSWER_UNITS: Final = tuple(unit for unit, kind in _UNITS.items() if kind.spellings)
"""The units in which a question may ask for a number."""

SUFFIXES: Final = tuple(kind.suffix for kind in _UNITS.values() if kind.suffix)
"""What may follow a number and must stay on its line."""


def is_unit(text: object) -> TypeGuard[Unit]:
    """Whether numbers in that unit can be shown."""
    return text in _UNITS


def number(value: float, unit: Unit, decimals: int | None = None) -> str:
    """Return `value` with its unit.

    Args:
        value: a finite number.
        unit: of it.
        decimals: most that are shown; None: as many as the unit is worth.
    """
    kind = _UNITS[unit]
    return _digits(value, kind.decimals if decimals is None else decimals) + kind.suffix


def number_beside(value: float, unit: Unit, edges: Iterable[float | None]) -> str:
    """Return `value` with enough digits that it reads as lying on its real side of each edge."""
    known = [edge for edge in edges if edge is not None]
    decimals = _UNITS[unit].decimals
    while decimals < _MAX_DECIMALS and any(
        (value < edge) != (round(value, decimals) < edge) or (value > edge) != (round(value, decimals) > edge)
        for edge in known
    ):
        decimals += 1
    return number(value, unit, decimals)


def signed(value: float, unit: Unit) -> str:
    """Return `value` with its unit, with ``+`` or a typographic minus before it; zero without either."""
    text = number(abs(value), unit)
    if text == number(0.0, unit):
        return text
    return f"+{text}" if value > 0 else f"−{text}"


def listed(values: Iterable[float], unit: Unit) -> Text:
    """Return a short list of values with their unit."""
    texts = [number(float(value), unit) for value in values]
    shown = texts[:_MAX_LISTED] + ["…"] * (len(texts) > _MAX_LISTED)
    return Text(zh="、".join(shown), en=", ".join(shown))


def points(value: float) -> str:
    """Return points or a score: two decimals at most."""
    return _digits(value, 2)


def exact(value: float) -> str:
    """Return a number that somebody set, such as a share in per cent: nine decimals at most."""
    return written(round(value, 9))


def measured(item: RubricItem, language: Language) -> str:
    """Return what was measured as the item's message writes it; a dash when there is no number."""
    if item.measured is None or not math.isfinite(item.measured):
        return NOTHING
    if item.wanted.en == sentence("en", "word.yes"):
        return sentence(language, "word.yes" if item.measured >= 1.0 else "word.no")
    return number_beside(item.measured, item.unit, _edges(item))


def wanted(item: RubricItem, language: Language) -> str:
    """Return what earns full credit; a dash where nothing was asked."""
    return item.wanted.get(language) or NOTHING


def _edges(item: RubricItem) -> tuple[float, ...]:
    """Return the ends of the band of full credit, from its middle and its half width."""
    if item.target is None:
        return ()
    if item.tolerance is None:
        return (item.target,)
    # Nine decimals give back the number in the assignment: 0.2 + 0.1 is a little more than 0.3.
    return round(item.target - item.tolerance, 9), round(item.target + item.tolerance, 9)


def _digits(value: float, decimals: int) -> str:
    text = f"{significant(value):.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


class SpokenQuantity(Record, kw_only=False):
    """A number in a text.

    Attributes:
        unit: one of `ANSWER_UNITS`, or empty when none of them follows.
        foreign: a unit that no question asks for, as written (``平方米``); or empty.
        behind: the text from there to the next number, or to the end.
    """

    value: float
    unit: Unit
    foreign: str = ""
    behind: str = ""

    def in_unit(self, unit: Unit) -> float | None:
        """Return the value in `unit`; a bare number is taken to be in it. None: another kind, or no known unit."""
        if self.foreign:
            return None
        if not self.unit:
            return self.value
        own, wanted = _UNITS[self.unit], _UNITS[unit]
        return self.value * own.factor / wanted.factor if own.base == wanted.base else None


def quantities(text: str) -> Iterator[SpokenQuantity]:
    """Yield the numbers of `text` in order: ``约 12 秒``, ``12.0s``, ``0.2 min``; no exactness (``± 0.1``).

    Full-width characters count as the ordinary ones. A comma between digits is a decimal one (``12,0``), before
    each three of them a thousands separator (``1,200``); a full-width comma is punctuation. A number in words
    counts where a unit follows it (``十二秒``).
    """
    pattern, words, units = _reader()
    plain = _EXACTNESS.sub("", unicodedata.normalize("NFKC", text.replace("，", "， ")))
    plain = in_digits(plain, words)
    found = list(pattern.finditer(plain))
    ends = [*(match.start() for match in found[1:]), len(plain)]
    for match, end in zip(found, ends, strict=False):  # without numbers there is one end
        unit = match["unit"]
        digits = match["number"].replace(",", "" if match["grouped"] else ".")
        known = units[unit.lower()] if unit else ""
        yield SpokenQuantity(float(digits), known, match["foreign"] or "", plain[match.end() : end])


@cache
def _reader() -> tuple[re.Pattern[str], re.Pattern[str], Mapping[str, Unit]]:
    """Return the pattern of a number with its unit, that of one in words, and the unit of each spelling.

    Made when the first text is read: compiling it would cost every start of the command line a millisecond.
    """
    units: dict[str, Unit] = {spelling: unit for unit, kind in _UNITS.items() for spelling in kind.spellings}
    spellings = "|".join(re.escape(spelling) for spelling in sorted(units, key=len, reverse=True))
    alone = r"(?<!\d,)"  # not in the middle of a list: 1,2,3
    whole = r"(?![.,]?\d)"
    pattern = re.compile(
        r"(?<![A-Za-z0-9_.第])(?P<number>[-+]?(?:"
        rf"(?P<grouped>{alone}[1-9]\d{{0,2}}(?:,\d{{3}}){{1,4}}(?:\.\d{{0,15}})?{whole})"
        rf"|(?P<comma>{alone}\d{{1,15}},\d{{1,15}}{whole})"
        r"|\d{1,15}(?:\.\d{0,15})?)(?:e[-+]?\d{1,2})?)"
        rf"(?:\s*[(\[]?\s*(?:(?P<unit>{spellings})(?![A-Za-z0-9/^])|(?P<foreign>{_FOREIGN})))?",
        re.IGNORECASE,
    )
    return pattern, words_pattern(units), units
