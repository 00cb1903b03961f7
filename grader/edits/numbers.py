"""Changes of numbers: what the ledger says a motion came to, against what was wanted."""

import ast
import math
from collections.abc import Iterator
from typing import Final

from grader.contracts.outcome import RunStatus
from grader.edits.situation import Driven, Proposal, Situation
from grader.edits.slices import NumberUse, dotted, expressions_behind, numbers_behind
from grader.edits.tree import Edit, ParsedScript

_DEGREES: Final = frozenset((30, 36, 40, 45, 51.43, 60, 72, 90, 108, 120, 135, 144, 180, 270, 360))
_LEAST_DEGREES: Final = 20.0
_FITS: Final = 0.02
_MOST_WANTED: Final = 3
_PERIODS: Final = ("sleep", "create_timer", "create_rate", "Rate")
_DEPTHS: Final = ("create_publisher", "create_subscription")
_LONGEST_PERIOD_S: Final = 0.2
_MOST_RATIO: Final = 30.0
_HELD: Final = 4.0  # a number that only fits because turtlesim drops a command after a second
_NEAR: Final = 0.01  # what turtlesim's updates and a loop's period may add or take away
_QUANTUM: Final = 0.05  # of a motion's size: an update at 3 rad/s turns by 2.7 degrees
_COMPARISONS: Final = {
    ast.Lt: ("<=", ">"),
    ast.LtE: ("<", ">="),
    ast.Gt: (">=", "<"),
    ast.GtE: (">", "<="),
    ast.Eq: (">=", "<="),
    ast.NotEq: ("<", ">"),
}
_CONVERSIONS: Final = ("radians", "degrees", "deg2rad", "rad2deg", "int", "round")
_OPERATORS: Final = {
    ast.Mult: "/",
    ast.Div: "*",
    ast.Add: "-",
    ast.Sub: "+",
    ast.FloorDiv: "/",
    ast.BitXor: "**",
}

_OPERATOR_COSTS: Final = {ast.BitXor: 0.5, ast.FloorDiv: 0.9}
"""Taken from mathematics and from a slip for `/`; of the others each is as often meant."""


def number_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield changes of the numbers that decide about a motion of the wrong size or direction."""
    for driven in seen.distinct:
        numbers = numbers_behind(seen.script, _lines(seen, driven))
        targets = _targets(seen, driven)
        for use in numbers:
            yield from _scaled(seen, driven, use, targets)
            yield from _turned_round(seen, driven, use)
    yield from _counts(seen)
    yield from _operators(seen)


def _lines(seen: Situation, driven: Driven) -> tuple[int, ...]:
    """Return the lines that decide about a motion, with those that create the timers of its callbacks."""
    functions = {row[1] for row in driven.motion.stack}
    timers = [
        node.lineno
        for node in ast.walk(seen.script.tree)
        if isinstance(node, ast.Call)
        and dotted(node.func).endswith("create_timer")
        and any(dotted(one).rpartition(".")[2] in functions for one in node.args)
    ]
    return (*driven.motion.lines, *timers)


def _targets(seen: Situation, driven: Driven) -> list[tuple[float, float]]:
    """Return what the motion came to and what was wanted instead, nearest first; nothing where it fits."""
    if driven.is_turn:
        size, wanted = abs(driven.angle_deg), seen.wanted.turns_deg
    elif driven.is_drive:
        size, wanted = abs(driven.length_m), seen.wanted.lengths_m
    else:
        return []
    if size <= 0.0 or any(abs(size - one) <= _FITS * one for one in wanted):
        return []
    nearest = sorted(wanted, key=lambda one: abs(math.log(one / size)))
    return [(size, one) for one in nearest[:_MOST_WANTED]]


def _scaled(
    seen: Situation, driven: Driven, use: NumberUse, targets: list[tuple[float, float]]
) -> Iterator[Proposal]:
    """Yield a number in radians, by the measured ratio or its inverse, or in nanoseconds."""
    unit = "deg" if driven.is_turn else "m"
    degrees = abs(use.value)
    if driven.motion.w and (degrees in _DEGREES or degrees >= _LEAST_DEGREES) and degrees <= 720.0:
        new = written(math.radians(use.value), like_float=True)
        yield _replaced(seen, "degrees", 1.0 + use.steps * 0.1, (use, new))
    whole = _is_whole(seen.script, use.node)
    for place, (size, wanted) in enumerate(targets):
        ratio = wanted / size
        for share in (ratio, 1.0 / ratio):
            if not 1.0 / _MOST_RATIO <= ratio <= _MOST_RATIO or use.value == 0.0:
                continue
            value = _named(use.value, size, wanted, unit) if share == ratio else None
            value = use.value * share if value is None else value
            new = written(value, like_float="." in seen.script.source(use.node), whole=whole)
            cost = 1.8 + place * 0.6 + use.steps * 0.2 + 0.05 * len(new) + 1.5 * (share != ratio)
            cost += _unlikely(seen.script, use, ratio) + _HELD * driven.is_held
            yield _replaced(seen, "scaled", cost, (use, new), unit=unit, size=size, wanted=wanted)
    if 1e3 <= abs(use.value) <= 1e12 and math.log10(abs(use.value)).is_integer() and use.value != 1e9:
        yield _replaced(seen, "nanoseconds", 1.5, (use, "1e9"))


def _named(value: float, size: float, wanted: float, unit: str) -> float | None:
    """Return the wanted size where a number is the size of the motion, in degrees, radians or metres.

    Updates make a turn of 60 degrees one of 60.7: by the measured ratio 90 would be written as 89.
    """
    for factor in (1.0, math.radians(1.0)) if unit == "deg" else (1.0,):
        if abs(abs(value) - size * factor) <= _QUANTUM * size * factor:
            return math.copysign(wanted * factor, value)
    return None


def _unlikely(script: ParsedScript, use: NumberUse, ratio: float) -> float:
    """Return how unlikely it is that this number was meant otherwise: one far off, a period, a count, a depth."""
    value, parent = abs(use.value), script.parent(use.node)
    called = dotted(parent.func) if isinstance(parent, ast.Call) else ""
    unlikely = min(abs(math.log(ratio)), 3.0) * 0.3
    if called.endswith(_PERIODS) and value <= _LONGEST_PERIOD_S:
        unlikely += 1.5
    if called.endswith(_DEPTHS):
        unlikely += 5.0
    if called == "range":
        unlikely += 1.0
    return unlikely + 2.0 * (value >= 1e3 or value <= 1e-3)


def _turned_round(seen: Situation, driven: Driven, use: NumberUse) -> Iterator[Proposal]:
    """Yield the other sign for a number that a speed is set to."""
    if use.value in (driven.motion.v, driven.motion.w) and use.value:
        new = written(-use.value, like_float="." in seen.script.source(use.node))
        yield _replaced(seen, "sign", 4.0 + use.steps * 0.2, (use, new))


def _counts(seen: Situation) -> Iterator[Proposal]:
    """Yield other counts for loops and comparisons that ran."""
    for node in ast.walk(seen.script.tree):
        if not isinstance(node, ast.Constant) or type(node.value) is not int or not 1 <= node.value <= 40:
            continue
        if not _counts_something(seen.script, node) or node.lineno not in seen.ledger.ran:
            continue
        use = NumberUse(node, float(node.value), 0)
        for place, count in enumerate(seen.wanted.counts):
            if count != node.value:
                cost = 2.2 + place * 0.3 + abs(count - node.value) * 0.05
                yield _replaced(seen, "count", cost, (use, str(count)))
        waited = any(line == node.lineno for line, _, _ in seen.ledger.end)
        for near in (node.value + 1, node.value - 1):
            if near not in seen.wanted.counts and near >= 0:
                yield _replaced(seen, "count", 1.5 if waited else 5.0, (use, str(near)))


def _counts_something(script: ParsedScript, node: ast.Constant) -> bool:
    """Whether a whole number says how often: in a `range`, a comparison, or behind a list."""
    parent = script.parent(node)
    if isinstance(parent, ast.Call):
        return dotted(parent.func) == "range"
    if isinstance(parent, ast.BinOp) and isinstance(parent.op, ast.Mult):
        return isinstance(parent.left, ast.List | ast.Tuple)
    if isinstance(parent, ast.Assign):
        return True
    return isinstance(parent, ast.Compare)


def _operators(seen: Situation) -> Iterator[Proposal]:
    """Yield the other comparison, operator, order or unit, where it decides about a motion."""
    behind = expressions_behind(seen.script, seen.lines)
    reached = {id(node) for node, _ in behind}
    tests = [node.test for node in ast.walk(seen.script.tree) if isinstance(node, ast.While)]
    behind += [
        (test, 1) for test in tests if id(test) not in reached
    ]  # the same mistake, where it never came
    for node, steps in behind:
        cost = steps * 0.1
        if isinstance(node, ast.Compare) and len(node.ops) == 1:
            yield from _comparisons(seen.script, node, cost)
        elif isinstance(node, ast.BinOp):
            yield from _calculations(seen, node, cost)
        elif isinstance(node, ast.Call):
            yield from _conversions(seen.script, node, cost)


def _comparisons(script: ParsedScript, node: ast.Compare, cost: float) -> Iterator[Proposal]:
    operands = (node.left, node.comparators[0])
    if any(isinstance(getattr(one, "value", None), str) for one in operands):
        return
    exact = isinstance(node.ops[0], ast.Eq | ast.NotEq)
    for new in _COMPARISONS.get(type(node.ops[0]), ()):
        yield from _between(script, "comparison", (1.5 if exact else 5.5) + cost, operands, new)


def _calculations(seen: Situation, node: ast.BinOp, cost: float) -> Iterator[Proposal]:
    new = _OPERATORS.get(type(node.op))
    cost += _OPERATOR_COSTS.get(type(node.op), 5.0)
    yield from _between(seen.script, "operator", cost, (node.left, node.right), new)
    if isinstance(node.op, ast.Sub):
        clock = any(one in seen.script.source(node) for one in ("time()", "now()"))
        endless = clock and seen.outcome.status is RunStatus.INTERRUPTED
        yield from _exchanged(seen.script, cost - 3.0 * endless, node.left, node.right)


def _conversions(script: ParsedScript, node: ast.Call, cost: float) -> Iterator[Proposal]:
    called = dotted(node.func)
    if len(node.args) == 2 and called.endswith("atan2"):
        yield from _exchanged(script, 3.0 + cost, *node.args)
    if len(node.args) != 1 or not called.endswith(_CONVERSIONS):
        return
    new = script.source(node.args[0])
    values = {"line": node.lineno, "old": script.source(node), "new": new}
    yield Proposal("converted", 1.8 + cost, (script.replaced(node, new),), values)
    for name, other in (("degrees", "radians"), ("radians", "degrees")):
        if called.endswith(name):
            right = called.replace(name, other)
            values = {"line": node.lineno, "old": called, "new": right}
            yield Proposal("name", 1.2 + cost, (script.replaced(node.func, right),), values)


def _exchanged(script: ParsedScript, cost: float, left: ast.expr, right: ast.expr) -> Iterator[Proposal]:
    edits = (script.replaced(left, script.source(right)), script.replaced(right, script.source(left)))
    yield Proposal("exchanged", cost, edits, {"line": left.lineno})


def _between(
    script: ParsedScript, code: str, cost: float, operands: tuple[ast.expr, ast.expr], new: str | None
) -> Iterator[Proposal]:
    """Yield another operator between two operands, if nothing but the operator stands there."""
    left, right = operands
    start, end = script.span(left)[1], script.span(right)[0]
    old = script.text[start:end]
    if new is not None and not set(old) & set("()#\n"):
        spaced = f" {new} " if old.startswith(" ") else new
        values = {"line": left.lineno, "old": old.strip(), "new": new}
        yield Proposal(code, cost, (Edit(start, end, spaced),), values)


def _is_whole(script: ParsedScript, node: ast.expr) -> bool:
    """Whether only a whole number can stand there."""
    parent = script.parent(node)
    return isinstance(parent, ast.Call) and dotted(parent.func) == "range"


def _replaced(
    seen: Situation, code: str, cost: float, change: tuple[NumberUse, str], **values: object
) -> Proposal:
    use, new = change
    edit = seen.script.replaced(use.node, new)
    old = seen.script.source(use.node)
    return Proposal(code, cost, (edit,), {**values, "line": use.node.lineno, "old": old, "new": new})


def _rounded(value: float) -> float:
    """Return the angle in radians, or else the shortest number, that a measured one is near enough to."""
    for degrees in (30, 36, 45, 60, 72, 90, 120, 144, 180, 270, 360):
        exact = math.copysign(math.radians(degrees), value)
        if abs(value - exact) <= _NEAR * abs(exact):
            return exact
    for digits in range(4):
        if abs(round(value, digits) - value) <= _NEAR * abs(value):
            return round(value, digits)
    return value


def written(value: float, *, like_float: bool, whole: bool = False) -> str:
    """Return a number as a person would write it, to four digits behind the point."""
    if whole:
        return str(round(value))
    text = f"{_rounded(value):.4f}".rstrip("0")
    if abs(value) >= 1e6:
        text = f"{value:g}"
    return text + "0" if text.endswith(".") and like_float else text.rstrip(".")
