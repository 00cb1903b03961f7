"""Read numbers with units out of sentences, in Chinese and English: ``约 12 秒``, ``12.0s``, ``0.2 min``."""

import math
import re
import unicodedata
from collections.abc import Iterator

from grader.contracts.record import positional_record

_UNITS: dict[str, tuple[str, float, tuple[str, ...]]] = {
    # canonical name: the unit it is a multiple of, the factor, and how it is written
    "s": ("s", 1.0, ("seconds", "second", "secs", "sec", "s", "秒钟", "秒")),
    "ms": ("s", 1e-3, ("milliseconds", "ms", "毫秒")),
    "min": ("s", 60.0, ("minutes", "minute", "min", "分钟")),
    "m": ("m", 1.0, ("meters", "metres", "meter", "metre", "m", "米")),
    "cm": ("m", 1e-2, ("centimeters", "centimetres", "cm", "厘米")),
    "km": ("m", 1e3, ("kilometers", "kilometres", "km", "公里", "千米")),
    "rad": ("rad", 1.0, ("radians", "radian", "rad", "弧度")),
    "deg": ("rad", math.pi / 180.0, ("degrees", "degree", "deg", "°", "度")),
    "m/s": ("m/s", 1.0, ("m/s", "米/秒", "米每秒")),
    "rad/s": ("rad/s", 1.0, ("rad/s", "弧度/秒", "弧度每秒")),
}
UNITS = tuple(_UNITS)
_BY_SPELLING = {spelling: name for name, (_, _, spellings) in _UNITS.items() for spelling in spellings}
_SPELLINGS = "|".join(re.escape(spelling) for spelling in sorted(_BY_SPELLING, key=len, reverse=True))
_ALONE = r"(?<!\d,)"  # not in the middle of a list: 1,2,3
_WHOLE = r"(?![.,]?\d)"
_QUANTITY = re.compile(
    r"(?<![\w.])(?P<number>[-+]?(?:"
    rf"(?P<grouped>{_ALONE}[1-9]\d{{0,2}}(?:,\d{{3}}){{1,4}}(?:\.\d{{0,15}})?{_WHOLE})"
    rf"|(?P<comma>{_ALONE}\d{{1,15}},\d{{1,15}}{_WHOLE})"
    r"|\d{1,15}(?:\.\d{0,15})?)(?:e[-+]?\d{1,2})?)"
    rf"(?:\s*[(\[]?\s*(?P<unit>{_SPELLINGS})(?![A-Za-z/]))?",
    re.IGNORECASE,
)


@positional_record
class SpokenQuantity:
    """A number in a text. `unit` is one of `UNITS`, or empty when none that is known follows."""

    value: float
    unit: str

    def in_unit(self, unit: str) -> float | None:
        """Return the value in `unit`; a bare number is taken to be in it. None: another kind of quantity."""
        if not self.unit:
            return self.value
        base, factor, _ = _UNITS[self.unit]
        wanted_base, wanted_factor, _ = _UNITS[unit]
        return self.value * factor / wanted_factor if base == wanted_base else None


def quantities(text: str) -> Iterator[SpokenQuantity]:
    """Yield the numbers of `text` in order; full-width characters count as the ordinary ones.

    A comma between digits is a decimal one (``12,0``), before each three of them a thousands separator
    (``1,200``); a full-width comma is punctuation.
    """
    for match in _QUANTITY.finditer(unicodedata.normalize("NFKC", text.replace("，", "， "))):
        unit = match["unit"]
        number = match["number"].replace(",", "" if match["grouped"] else ".")
        yield SpokenQuantity(float(number), _BY_SPELLING[unit.lower()] if unit else "")
