"""Numbers written in words, before a unit: ``十二秒``, ``一百二十点五 厘米``, ``twenty-one seconds``."""

import re
from collections.abc import Iterable
from typing import Final

_DIGITS: Final = {one: value for value, one in enumerate("零一二三四五六七八九")} | {"〇": 0, "两": 2}
_PLACES: Final = {"十": 10, "百": 100, "千": 1_000}
_TEN_THOUSAND: Final = "万"
# fmt: off
_ENGLISH: Final = {
    "zero": 0, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9,
    "ten": 10, "eleven": 11, "twelve": 12, "thirteen": 13, "fourteen": 14, "fifteen": 15, "sixteen": 16,
    "seventeen": 17, "eighteen": 18, "nineteen": 19, "twenty": 20, "thirty": 30, "forty": 40, "fifty": 50,
    "sixty": 60, "seventy": 70, "eighty": 80, "ninety": 90,
}
# fmt: on
_NUMERAL: Final = "".join((*_DIGITS, *_PLACES, _TEN_THOUSAND))
_BEGIN: Final = "".join((*_DIGITS, "十"))  # 千米 is a unit, 第一 no amount
_ENGLISH_WORD: Final = "|".join(sorted(_ENGLISH, key=len, reverse=True))


def words_pattern(units: Iterable[str]) -> re.Pattern[str]:
    """Return the pattern of a number in words that one of `units` follows."""
    spellings = "|".join(re.escape(unit) for unit in sorted(units, key=len, reverse=True))
    return re.compile(
        rf"(?<![第\d.{_NUMERAL}])(?P<chinese>[{_BEGIN}][{_NUMERAL}]*)(?:点(?P<decimals>[{''.join(_DIGITS)}]+))?"
        rf"(?=\s*(?:{spellings})(?!之))"
        rf"|\b(?P<english>{_ENGLISH_WORD})(?:[- ](?P<more>{_ENGLISH_WORD}))?(?=\s+(?:{spellings})\b)",
        re.IGNORECASE,
    )


def in_digits(text: str, pattern: re.Pattern[str]) -> str:
    """Return a text in which the numbers that `pattern` finds are written in digits."""
    return pattern.sub(_digits, text)


def _digits(found: re.Match[str]) -> str:
    if found["english"]:
        return str(sum(_ENGLISH[one.lower()] for one in (found["english"], found["more"]) if one))
    decimals = "".join(str(_DIGITS[sign]) for sign in found["decimals"] or "")
    return f"{_value(found['chinese'])}{'.' if decimals else ''}{decimals}"


def _value(numeral: str) -> int:
    """Return the value of a Chinese number, with places (``一百零二``) or without (``一二``)."""
    if all(sign in _DIGITS for sign in numeral):
        return int("".join(str(_DIGITS[sign]) for sign in numeral))
    before, _, behind = numeral.rpartition(_TEN_THOUSAND)
    if before:
        return 10_000 * _value(before) + (_value(behind) if behind else 0)
    value = digit = 0
    for sign in numeral:
        if sign in _PLACES:
            value, digit = value + (digit or 1) * _PLACES[sign], 0
        else:
            digit = _DIGITS.get(sign, 0)
    return value + digit
