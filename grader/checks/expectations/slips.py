"""Usual slips, tried as formulas: what a script computes when it does not compute what is wanted.

A slip is named only if it explains every answer that came, and at least one of these is not what was wanted.
"""

import itertools
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from grader.checks.expectations.verdict import Verdict, equals
from grader.checks.measure import Mistake, mistake
from grader.contracts.conversation import shown
from grader.contracts.formula import FormulaError, formula

Pair = tuple[Mapping[str, Any], Any, Mapping[str, Any] | None]
"""What was sent, what is wanted, what came."""

_MOST_PAIRS: Final = 50
_MOST_FIELDS: Final = 6
_EXACT: Final = 1e-6
_OF_WANTED: Final = (
    ("wanted + 1", "slip_one_more"),
    ("wanted - 1", "slip_one_less"),
    ("-wanted", "slip_sign"),
    ("degrees(wanted)", "slip_degrees"),
    ("radians(wanted)", "slip_radians"),
    ("2 * wanted", "slip_twice"),
    ("wanted / 2", "slip_half"),
)
_OF_CODE: Final = {
    **{code: text for text, code in _OF_WANTED},
    "slip_factor": "{} * wanted",
    "slip_offset": "wanted {}",
}
_OF_ALL: Final[Sequence[tuple[str, Callable[[Any], float]]]] = (
    ("sum({})", sum),
    ("sum({0}) / len({0})", lambda values: sum(values) / len(values)),
    ("max({})", max),
    ("min({})", min),
    ("len({})", len),
)
_NUMBER: Final = re.compile(r"[-+]?\d+(?:\.\d+)?")


def of_values(name: str, pairs: Sequence[Pair]) -> Mistake | None:
    """Return the slip that explains the values which came under `name`, a topic, service or action."""
    answered = [pair for pair in pairs[:_MOST_PAIRS] if pair[2] is not None and isinstance(pair[1], Mapping)]
    for field in _leaves(answered[0][1]) if answered else ():
        triples = [(sent, _at(field, wanted), _at(field, came)) for sent, wanted, came in answered]
        wrong = next((each for each in triples if not _same(each[1], each[2])), None)
        if wrong is None:
            continue
        found = _slip(triples)
        if found is not None:
            code, text = found
            values = {
                "field": ".".join(field),
                "came": shown(wrong[2]),
                "wanted": shown(wrong[1]),
                "formula": text,
            }
            return mistake(code, name=name, sent=shown(wrong[0]), **values)
    return None


def of_messages(name: str, pairs: Sequence[Pair]) -> Mistake | None:
    """Return the slip in messages that answer nothing: all are alike, or a formula of their number gives them."""
    answered = [pair for pair in pairs[:_MOST_PAIRS] if pair[2] is not None and isinstance(pair[1], Mapping)]
    for field in _leaves(answered[0][1]) if answered else ():
        triples = [
            ({"n": sent["n"]}, _at(field, wanted), _at(field, came)) for sent, wanted, came in answered
        ]
        wrong = next((each for each in triples if not _same(each[1], each[2])), None)
        if wrong is None:
            continue
        code, text = _slip(triples) or ("", "")
        values = {"field": ".".join(field), "came": shown(wrong[2]), "wanted": shown(wrong[1])}
        number = wrong[0]["n"] + 1
        if computed := _OF_CODE.get(code, "").format(text):
            return mistake("messages_off", name=name, n=number, formula=computed, **values)
        if code == "slip_letters":
            return mistake("messages_letters", name=name, n=number, **values)
        if code in ("slip_constant", "slip_unset"):
            return mistake("messages_alike", name=name, n=number, **values)
        if code == "slip_formula":
            return mistake("messages_count", name=name, n=number, formula=text, **values)
    return None


def _slip(triples: Sequence[tuple[Mapping[str, Any], Any, Any]]) -> tuple[str, str] | None:
    """Return the kind of slip, and the formula that it is."""
    if (numbers := _numbers_in_texts(triples)) is not None:
        return _slip(numbers)
    came = [each[2] for each in triples]
    if all(one in (0, "", False, []) and one is not None for one in came):
        return "slip_unset", ""
    if len(came) > 1 and all(_same(one, came[0]) for one in came) and not _same(triples[0][1], triples[1][1]):
        return "slip_constant", ""
    for text, code in _OF_WANTED:
        if all(_gives(text, {"wanted": wanted}, out) for _, wanted, out in triples):
            return code, ""
    for text in _of_sent(triples[0][0]):
        if all(_gives(text, sent, out) for sent, _, out in triples):
            return "slip_formula", text
    if all(isinstance(out, list) and isinstance(wanted, list) for _, wanted, out in triples):
        return _list_slip([(wanted, out) for _, wanted, out in triples])
    if all(isinstance(out, str) and isinstance(wanted, str) for _, wanted, out in triples) and all(
        _letters(wanted) == _letters(out) for _, wanted, out in triples
    ):
        return "slip_letters", ""
    return _steady_slip([(wanted, out) for _, wanted, out in triples]) or _slip_of_all(triples)


def _letters(text: str) -> str:
    """Return a text without spaces and capital letters, its numbers written in one way."""
    plain = "".join(text.split()).lower()
    return _NUMBER.sub(lambda digits: f"{float(digits[0]):g}", plain)


def _numbers_in_texts(
    triples: Sequence[tuple[Mapping[str, Any], Any, Any]],
) -> list[tuple[Mapping[str, Any], Any, Any]] | None:
    """Return the first numbers that differ in texts which else are alike; None where that is not all."""
    if not all(isinstance(wanted, str) and isinstance(out, str) for _, wanted, out in triples):
        return None
    if any(_NUMBER.split(wanted) != _NUMBER.split(out) for _, wanted, out in triples):
        return None
    rows = [(sent, _NUMBER.findall(wanted), _NUMBER.findall(out)) for sent, wanted, out in triples]
    places = range(min(len(wanted) for _, wanted, _ in rows))
    differs = (k for k in places if any(float(wanted[k]) != float(out[k]) for _, wanted, out in rows))
    place = next(differs, None)
    if place is None:
        return None
    return [(sent, _as_number(wanted[place]), _as_number(out[place])) for sent, wanted, out in rows]


def _as_number(digits: str) -> float:
    return float(digits) if "." in digits else int(digits)


def _steady_slip(pairs: Sequence[tuple[Any, Any]]) -> tuple[str, str] | None:
    """Return that two answers are swapped, or that each is by one factor or by one amount off."""
    choices = [wanted for k, (wanted, _) in enumerate(pairs) if wanted not in [each[0] for each in pairs[:k]]]
    if len(choices) == 2 and all(out == choices[wanted == choices[0]] for wanted, out in pairs):
        return "slip_swapped", ""
    if len(choices) < 2 or not all(_is_number(wanted) and _is_number(out) for wanted, out in pairs):
        return None
    factors = [out / wanted for wanted, out in pairs if wanted]
    if len(factors) == len(pairs) and all(_same(factors[0] * wanted, out) for wanted, out in pairs):
        return "slip_factor", f"{factors[0]:.6g}"
    offset = pairs[0][1] - pairs[0][0]
    if all(_same(wanted + offset, out) for wanted, out in pairs):
        return "slip_offset", f"{offset:+.6g}"
    return None


def _slip_of_all(triples: Sequence[tuple[Mapping[str, Any], Any, Any]]) -> tuple[str, str] | None:
    """Return the formula of all that was sent up to then that gives each answer."""
    if len(triples) < 3:  # of two, chance gives one too easily
        return None
    for name in list(triples[0][0])[:_MOST_FIELDS]:
        values = [sent.get(name) for sent, _, _ in triples]
        if not all(map(_is_number, values)):
            continue
        for text, function in _OF_ALL:
            if all(_same(function(values[: k + 1]), out) for k, (_, _, out) in enumerate(triples)):
                return "slip_formula", text.format(name)
    return None


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _list_slip(pairs: Sequence[tuple[list[Any], list[Any]]]) -> tuple[str, str] | None:
    if all(out == wanted[: len(out)] and len(out) < len(wanted) for wanted, out in pairs):
        return "slip_list_short", ""
    if all(out[: len(wanted)] == wanted and len(out) > len(wanted) for wanted, out in pairs):
        return "slip_list_long", ""
    if all(out and out == wanted[-len(out) :] and len(out) < len(wanted) for wanted, out in pairs):
        return "slip_list_late", ""
    if all(out == wanted[::-1] for wanted, out in pairs):
        return "slip_list_reversed", ""
    if any(len(wanted) != len(out) for wanted, out in pairs):
        return None
    each = [pair for wanted, out in pairs for pair in zip(wanted, out, strict=True)][:_MOST_PAIRS]
    codes = (code for text, code in _OF_WANTED if all(_gives(text, {"wanted": w}, out) for w, out in each))
    code = next(codes, None) if each else None
    return None if code is None else (code, "")


def _of_sent(sent: Mapping[str, Any]) -> Iterator[str]:
    """Yield formulas of what was sent: a field alone, and two of them combined."""
    names = [name for name, each in _numbers(sent)][:_MOST_FIELDS]
    for name in names:
        yield from (name, f"-{name}", f"{name} + 1", f"{name} - 1", f"2 * {name}", f"{name} * {name}")
    for one, other in itertools.permutations(names, 2):
        yield from (f"{one} - {other}", f"{one} / {other}", f"{one} // {other}")
    for one, other in itertools.combinations(names, 2):
        yield from (f"{one} + {other}", f"{one} * {other}")


def _numbers(values: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, float]]:
    for name, each in values.items():
        if isinstance(each, Mapping):
            yield from _numbers(each, f"{before}{name}.")
        elif isinstance(each, int | float) and not isinstance(each, bool):
            yield f"{before}{name}", each


def _gives(text: str, names: Mapping[str, Any], out: Any) -> bool:
    if not isinstance(out, int | float) or isinstance(out, bool):
        return False
    try:
        value = formula(text).value(names)
    except FormulaError:
        return False
    if isinstance(value, float) and isinstance(out, int):
        value = math.trunc(value) if math.isfinite(value) else value
    return _same(value, out)


def _same(wanted: Any, came: Any) -> bool:
    return equals(wanted, came, _EXACT)


def _leaves(values: Mapping[str, Any], before: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for name, each in values.items():
        if isinstance(each, Mapping):
            yield from _leaves(each, (*before, name))
        else:
            yield (*before, name)


def _at(field: Sequence[str], values: Any) -> Any:
    for name in field:
        values = values.get(name) if isinstance(values, Mapping) else None
    return list(values) if isinstance(values, bytes) else values


def seen_only(row: Verdict, share: float) -> Verdict:
    """Return a verdict with another share."""
    return replace(row, share=share)
