"""Usual slips, tried as formulas: what a script computes when it does not compute what is wanted.

A slip is named only if it explains every answer that came, and at least one of these is not what was wanted.
"""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
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
        if code in ("slip_constant", "slip_unset"):
            return mistake("messages_alike", name=name, n=number, **values)
        if code == "slip_formula":
            return mistake("messages_count", name=name, n=number, formula=text, **values)
    return None


def _slip(triples: Sequence[tuple[Mapping[str, Any], Any, Any]]) -> tuple[str, str] | None:
    """Return the kind of slip, and the formula that it is."""
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
    texts = all(isinstance(out, str) and isinstance(wanted, str) for _, wanted, out in triples)
    return (
        ("slip_letters", "") if texts and all(_letters(w) == _letters(out) for _, w, out in triples) else None
    )


def _letters(text: str) -> str:
    return "".join(text.split()).lower()


def _list_slip(pairs: Sequence[tuple[list[Any], list[Any]]]) -> tuple[str, str] | None:
    if all(out == wanted[: len(out)] and len(out) < len(wanted) for wanted, out in pairs):
        return "slip_list_short", ""
    if all(out[: len(wanted)] == wanted and len(out) > len(wanted) for wanted, out in pairs):
        return "slip_list_long", ""
    return ("slip_list_reversed", "") if all(out == wanted[::-1] for wanted, out in pairs) else None


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
