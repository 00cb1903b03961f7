"""Changes of numbers: what the ledger says a motion came to, against what was wanted."""

import ast
import itertools
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

from grader.contracts.outcome import RunStatus
from grader.edits.formulas import constant, formula_changes, is_pi, role_of, stale_changes, tolerance
from grader.edits.situation import Driven, Proposal, Situation, replacing
from grader.edits.slices import (
    Functions,
    NumberUse,
    assignments,
    callee,
    calls_of,
    dotted,
    expressions_behind,
    functions_of,
    known_number,
    named_in,
    number_of,
    numbers_behind,
    statement_around,
)
from grader.edits.tree import Edit, ParsedScript

_DEGREES: Final = frozenset((30, 36, 40, 45, 51.43, 60, 72, 90, 108, 120, 135, 144, 180, 270, 360))
_LEAST_DEGREES: Final = 20.0
_FITS: Final = 0.02
_MOST_WANTED: Final = 3
_MOST_CALLS: Final = 6
_MOST_SWAPS: Final = 2
_SWAP_COST: Final = 2.3  # as likely as a number that is not right
_PERIODS: Final = ("sleep", "create_timer", "create_rate", "Rate")
_DEPTHS: Final = ("create_publisher", "create_subscription")
_LONGEST_PERIOD_S: Final = 0.2
_MOST_RATIO: Final = 30.0
_USUAL_RATE: Final = 0.5  # m/s or rad/s
_USUAL_DEG_S: Final = 30.0
_NEAR: Final = 0.01  # what turtlesim's updates and a loop's period may add or take away
_QUANTUM: Final = 0.05  # of a motion's size: an update at 3 rad/s turns by 2.7 degrees
_COMPARISONS: Final = {
    ast.Lt: (">",),
    ast.LtE: (">=",),
    ast.Gt: ("<",),
    ast.GtE: ("<=",),
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

_CONVERTED: Final = re.compile(r"\bradians\b|\bdeg2rad\b|/\s*180")
_SECONDS: Final = re.compile(r"e-?9|0{6}|\*\* ?9|e-?6")
"""What turns nanoseconds into seconds."""
_NANOSECONDS: Final = re.compile(r"nanosec|_ns\b")
_NOW: Final = re.compile(r"theta|yaw|heading|position|pose\.|odom|actual|current")
"""What a script calls the angle or the place that it has; the wanted one is what it goes to."""
_DISTANCE: Final = re.compile("dist|length|juli|距", re.IGNORECASE)
_TOLERANCE: Final = "0.05"
_BRIEF_S: Final = 0.1
_DIRECTIONS: Final = (0, 90, 270)
_CONSTANTS: Final = frozenset({"pi", "π", "tau", "two_pi"})
_OPERATOR_COSTS: Final = {ast.BitXor: 0.5, ast.FloorDiv: 0.9}
"""Taken from mathematics and from a slip for `/`; of the others each is as often meant."""


def number_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield changes of the numbers that decide about a motion of the wrong size or direction."""
    for driven in seen.distinct:
        lines = _lines(seen, driven)
        targets = _targets(seen, driven)
        for use in numbers_behind(seen.script, lines):
            yield from _in_radians(seen, driven, use)
            yield from _scaled(seen, driven, use, targets)
            yield from _turned_round(seen, driven, use)
            yield from _too_slow(seen, driven, use)
        if driven.is_turn:
            yield from _angles(seen, driven, lines, targets)
        yield from formula_changes(seen, driven, lines, targets)
    yield from _operators(seen)
    yield from _rays(seen)
    yield from _clocked(seen)
    yield from stale_changes(seen)
    yield from _opposed(seen)
    yield from _crossed(seen)


def _lines(seen: Situation, driven: Driven) -> tuple[int, ...]:
    """Return the lines that decide about a motion, with those that create the timers of its callbacks."""
    functions = {row[1] for row in driven.motion.stack}
    timers = [call.lineno for call in calls_of(seen.script, "create_timer") if functions & named_in([call])]
    return (*driven.motion.lines, *timers)


def _targets(seen: Situation, driven: Driven) -> list[tuple[float, float]]:
    """Return what the motion came to and what was wanted instead, nearest first; nothing where it fits."""
    if seen.is_part(driven):
        return []
    if driven.is_turn:
        size, wanted = abs(driven.angle_deg), seen.wanted.turns_deg
    elif driven.is_drive:
        size, wanted = abs(driven.length_m), _lengths(seen)
        if seen.wanted.at_least_m and size >= min(seen.wanted.lengths_m):
            return []
    else:
        return []
    if size <= 0.0 or any(abs(size - one) <= _FITS * one for one in wanted):
        return []
    nearest = sorted(wanted, key=lambda one: abs(math.log(one / size)))
    return [(size, one) for one in nearest[:_MOST_WANTED]]


def _lengths(seen: Situation) -> tuple[float, ...]:
    """Return the wanted lengths; where the assignment asks for at least one, what the script calls a distance."""
    wanted = seen.wanted.lengths_m or seen.usual_lengths_m
    named = (number_of(one.value) for one in assignments(seen.script) if _DISTANCE.search(one.target))
    own = tuple(one for one in named if one and one >= min(wanted, default=0.0))
    return own if seen.wanted.at_least_m and own else wanted


def _in_radians(seen: Situation, driven: Driven, use: NumberUse) -> Iterator[Proposal]:
    """Yield a number of degrees in radians, where nothing between it and the motion converts it."""
    degrees = abs(use.value)
    is_plain = degrees in _DEGREES or degrees >= _LEAST_DEGREES
    if _with_pi(seen.script.parent(use.node)) is not None or _is_count(seen.script, use.node):
        return  # a part of a turn, or a number of rounds
    if driven.motion.w and is_plain and degrees <= 720.0 and not _is_converted(seen.script, use.node):
        new = written(math.radians(use.value), like_float=True)
        yield _replaced(seen, "degrees", 1.0 + use.steps * 0.1, (use, new))


def _is_count(script: ParsedScript, number: ast.expr) -> bool:
    """Whether a number is compared with a name that counts by whole steps, or stands in a `range`."""
    if any(callee(one) == "range" for one in script.around(number)):
        return True
    above = script.parent(number)
    compared = (
        {dotted(one) for one in ast.iter_child_nodes(above)} if isinstance(above, ast.Compare) else set()
    )
    return any(
        one.target in compared and isinstance(one.statement, ast.AugAssign) and not step % 1.0
        for one in assignments(script)
        if (step := number_of(one.value)) is not None
    )


def _is_converted(script: ParsedScript, number: ast.expr) -> bool:
    """Whether a number is converted where it stands or in the function that it is given to, or is an index."""
    node: ast.AST = number
    for above in script.around(number):
        if isinstance(above, ast.Subscript) and above.slice is node:
            return True
        if isinstance(above, ast.Call) and _converts(script, above):
            return True
        if isinstance(above, ast.comprehension | ast.For) and above.iter is node:
            inside = script.parent(above) if isinstance(above, ast.comprehension) else above
            calls = (one for one in ast.walk(inside or above) if isinstance(one, ast.Call))
            return any(_converts(script, one) for one in calls)
        if isinstance(above, ast.BinOp) and _CONVERTED.search(script.source(above)):
            return True
        if isinstance(above, ast.stmt):
            return False
        node = above
    return False


def _converts(script: ParsedScript, call: ast.Call) -> bool:
    """Whether a call makes radians of degrees, or calls a function of the script's own that does."""
    name = dotted(call.func).rpartition(".")[2]
    if name in ("radians", "deg2rad"):
        return True
    own = (node for node in functions_of(script) if node.name == name)
    return any(_CONVERTED.search(script.source(one)) for one in own)


def _scaled(
    seen: Situation, driven: Driven, use: NumberUse, targets: list[tuple[float, float]]
) -> Iterator[Proposal]:
    """Yield the wanted amount for a number that is the measured one, or that alone counts or waits.

    A factor within a larger expression, or a speed, would only make up for what is wrong elsewhere.
    """
    if _is_constant(seen.script, use.node):
        return
    unit = "deg" if driven.is_turn else "m"
    whole = callee(seen.script.parent(use.node)) == "range"
    for place, (size, wanted) in enumerate(targets):
        ratio = wanted / size
        if (
            driven.is_held
            or _unit_of(abs(use.value), wanted, unit, _NEAR) is not None
            or not 1.0 / _MOST_RATIO <= ratio <= _MOST_RATIO
        ):
            continue
        is_rate = role_of(_given_to(seen.script, use.node)) == "rate"  # and no time, if one as large
        value = _named(use.value, size, wanted, unit, math.inf if is_rate else driven.seconds)
        cost = 1.5 if value is not None or _is_of_ticks(seen.script, use, driven) else 1.8
        if value is None and _is_wait_or_count(seen.script, use, driven):
            value = use.value * ratio
            value = round(value) if use.value.is_integer() and value > 1.0 else float(f"{value:.2g}")
        if value is None or value == use.value or (value > _LONGEST_PERIOD_S and _paces(seen, use, driven)):
            continue
        new = written(
            value, like_float="." in seen.script.source(use.node), whole=whole, is_angle=unit == "deg"
        )
        cost += place * 0.6 + use.steps * 0.1 + 0.05 * len(new)
        cost += _unlikely(seen.script, use, ratio)
        yield _replaced(seen, "scaled", cost, (use, new), unit=unit, size=size, wanted=wanted)


def _is_constant(script: ParsedScript, number: ast.expr) -> bool:
    """Whether a number is that of mathematics, by the name that it is given."""
    statement = script.parent(number)
    targets = statement.targets if isinstance(statement, ast.Assign) else ()
    return any(dotted(target).rpartition(".")[2].casefold() in _CONSTANTS for target in targets)


def _unit_of(value: float, size: float, unit: str, share: float) -> float | None:
    """Return 1 where a number is a size within a share, π / 180 where it is one in radians; None: neither."""
    factors = (1.0, math.radians(1.0)) if unit == "deg" else (1.0,)
    return next((one for one in factors if abs(value - size * one) <= share * size * one), None)


def _angles(
    seen: Situation, driven: Driven, lines: tuple[int, ...], targets: list[tuple[float, float]]
) -> Iterator[Proposal]:
    """Yield the wanted angle for one that is written with pi and that the motion came to."""
    script = seen.script
    for node, steps in expressions_behind(script, lines):
        above, value = script.parent(node), _with_pi(node)
        if value is None or isinstance(node, ast.Constant) or _with_pi(above) is not None:
            continue
        for place, (size, wanted) in enumerate(targets):
            if abs(abs(math.degrees(value)) - size) > max(_QUANTUM, tolerance(driven)) * size:
                continue
            new = _angle_in(wanted, next(dotted(one) for one in ast.walk(node) if is_pi(one)))
            behind = isinstance(above, ast.BinOp) and above.right is node
            text, cost = f"({new})" if behind else new, 1.6 + place * 0.6 + steps * 0.1
            values = {"new": new, "unit": "deg", "size": size, "wanted": wanted}
            yield replacing(script, "scaled", cost, node, text, **values)


def _with_pi(node: ast.AST | None) -> float | None:
    """Return the value of an expression of numbers and pi; None for anything else, and for a lone number."""
    has_pi = isinstance(node, ast.expr) and any(map(is_pi, ast.walk(node)))
    return constant(node) if has_pi and isinstance(node, ast.expr) else None


def _angle_in(degrees: float, pi: str) -> str:
    """Return an angle as a part of a turn."""
    parts = 360.0 / degrees
    if math.isclose(degrees, 180.0):
        return pi
    if math.isclose(parts, round(parts), rel_tol=1e-4):
        whole = round(parts)
        if whole == 1:
            return f"2 * {pi}"
        return f"2 * {pi} / {whole}" if whole % 2 else f"{pi} / {whole // 2}"
    return f"{degrees:g} / 180 * {pi}"


def _named(value: float, size: float, wanted: float, unit: str, seconds: float = math.inf) -> float | None:
    """Return the wanted size where a number is the size of the motion, in degrees, radians, metres or seconds.

    Updates make a turn of 60 degrees one of 60.7: by the measured ratio 90 would be written as 89.
    """
    factor = _unit_of(abs(value), size, unit, _QUANTUM)
    if factor is not None:
        return math.copysign(wanted * factor, value)
    return value * wanted / size if value and abs(value - seconds) <= _QUANTUM * value else None


def _is_wait_or_count(script: ParsedScript, use: NumberUse, driven: Driven) -> bool:
    """Whether a number alone is how long a line of the motion waits, or how often its loop or its timer runs."""
    call = script.parent(use.node)
    if _is_of_ticks(script, use, driven):
        return True
    if not isinstance(call, ast.Call) or len(call.args) != 1 or use.value <= 0.0:
        return False
    is_wait = dotted(call.func).endswith("sleep") and call.lineno in driven.motion.waits
    return is_wait or dotted(call.func) == "range"


def _paces(seen: Situation, use: NumberUse, driven: Driven) -> bool:
    """Whether a number is the wait of a loop that went round more than once in a motion."""
    call = seen.script.parent(use.node)
    is_wait = isinstance(call, ast.Call) and dotted(call.func).endswith("sleep")
    return is_wait and driven.motion.waits.get(use.node.lineno, (0, 0))[0] > 1


def _is_of_ticks(script: ParsedScript, use: NumberUse, driven: Driven) -> bool:
    """Whether a number that is compared is how often the script waited in a motion."""
    waited = any(abs(use.value - times) <= 1 for times, _ in driven.motion.waits.values() if times > 1)
    return waited and isinstance(script.parent(use.node), ast.Compare)


def _unlikely(script: ParsedScript, use: NumberUse, ratio: float) -> float:
    """Return how unlikely it is that this number was meant otherwise: one far off, a period, a count, a depth."""
    value, called = abs(use.value), callee(script.parent(use.node))
    unlikely = min(abs(math.log(ratio)), 3.0) * 0.3
    if called.endswith(_PERIODS) and value <= _LONGEST_PERIOD_S:
        unlikely += 1.5
    if called.endswith(_DEPTHS):
        unlikely += 5.0
    if called == "range":
        unlikely += 1.0
    return unlikely + 2.0 * (value >= 1e3 or value <= 1e-3)


def _turned_round(seen: Situation, driven: Driven, use: NumberUse) -> Iterator[Proposal]:
    """Yield the other sign for a number that a speed is set to.

    A drive goes backward only where that is asked, and not where the script goes there and back. Of turns to both
    sides, those of the rarer one are wrong; where neither is, the script turns to each by turns.
    """
    against = sum(
        one.motion.v * driven.motion.v < 0.0 or one.motion.w * driven.motion.w < 0.0 for one in seen.driven
    )
    if driven.is_drive:
        is_kept = against > 0 or (use.value > 0.0 and "advance_m" not in seen.lost)
    else:
        is_kept = 0 < against <= sum(one.motion.w * driven.motion.w > 0.0 for one in seen.driven)
    if isinstance(seen.script.parent(use.node), ast.IfExp):
        return  # a speed by the sign of something else
    is_angle = driven.is_turn and _unit_of(-use.value, abs(driven.angle_deg), "deg", _QUANTUM) is not None
    if use.value < 0.0 and is_angle:
        new = written(-use.value, like_float="." in seen.script.source(use.node))
        yield _replaced(seen, "sign", 2.0 + use.steps * 0.1, (use, new))
    if use.value in (driven.motion.v, driven.motion.w) and use.value and not is_kept:
        new = written(-use.value, like_float="." in seen.script.source(use.node))
        cost = 2.2 if seen.outcome.hears else 4.0
        yield _replaced(seen, "sign", cost + use.steps * 0.2, (use, new))


def _too_slow(seen: Situation, driven: Driven, use: NumberUse) -> Iterator[Proposal]:
    """Yield a usual speed for a slower one, where the time was up while the car was on its way."""
    if seen.outcome.status is not RunStatus.INTERRUPTED or seen.comes_to_rest or driven.is_arc:
        return
    rate = abs(driven.motion.w or driven.motion.v)
    for value, usual in ((rate, _USUAL_RATE), (math.degrees(rate), _USUAL_DEG_S)):
        if value < usual and math.isclose(abs(use.value), value):
            new = written(math.copysign(usual, use.value), like_float="." in seen.script.source(use.node))
            yield _replaced(seen, "too_slow", 1.2, (use, new))


def _operators(seen: Situation) -> Iterator[Proposal]:
    """Yield the other comparison, operator, order or unit, where it decides about a motion."""
    behind = expressions_behind(seen.script, seen.lines)
    reached = {id(node) for node, _ in behind}
    tests = [node.test for node in ast.walk(seen.script.tree) if isinstance(node, ast.While | ast.If)]
    behind += [
        (test, 1) for test in tests if id(test) not in reached
    ]  # the same mistake, where it never came
    for node, steps in behind:
        cost = steps * 0.1
        if isinstance(node, ast.Compare) and len(node.ops) == 1:
            yield from _comparisons(seen, node, cost)
        elif isinstance(node, ast.BinOp):
            yield from _calculations(seen, node, cost)
        elif isinstance(node, ast.Call):
            yield from _conversions(seen.script, node, cost)
            yield from _unsigned(seen, node)
        elif 1e3 <= (value := number_of(node) or 0.0) <= 1e12 and math.log10(value).is_integer():
            if value != 1e9 and _NANOSECONDS.search(seen.script.text):
                yield _replaced(seen, "nanoseconds", 0.8, (NumberUse(node, value, steps), "1e9"))
        elif getattr(node, "attr", "") == "nanoseconds" and not _SECONDS.search(seen.script.text):
            source = seen.script.source(node)
            yield replacing(seen.script, "nanoseconds", 0.9, node, f"{source} / 1e9", old=source)


def _comparisons(seen: Situation, node: ast.Compare, cost: float) -> Iterator[Proposal]:
    script = seen.script
    operands = (node.left, node.comparators[0])
    if any(isinstance(getattr(one, "value", None), str) for one in operands):
        return
    exact = isinstance(node.ops[0], ast.Eq | ast.NotEq)
    if (
        exact
        and isinstance(node.left, ast.BinOp)
        and isinstance(node.left.op, ast.Div | ast.FloorDiv | ast.Mod)
    ):
        if not isinstance(node.left.op, ast.Mod):
            yield from _between(script, "operator", 0.9 + cost, (node.left.left, node.left.right), "%")
        return  # any other comparison with a remainder is nearly always true, or never
    if exact and number_of(operands[1]) == 0.0:
        start, end = script.span(operands[0])[1], script.span(node)[1]
        new = f"{'<' if isinstance(node.ops[0], ast.Eq) else '>'} {_TOLERANCE}"
        values = {"line": node.lineno, "old": script.text[start:end].strip(), "new": new}
        yield Proposal("comparison", 1.4 + cost, (Edit(start, end, f" {new}"),), values)
    for new in _COMPARISONS.get(type(node.ops[0]), ()):
        likely = exact or _at_once(seen, node)
        yield from _between(script, "comparison", (1.5 if likely else 5.5) + cost, operands, new)


def _at_once(seen: Situation, test: ast.Compare) -> bool:
    """Whether a test ended at once what it should end: its loop never ran, or a motion was over in no time."""
    loop = next((one for one in seen.script.around(test) if isinstance(one, ast.While | ast.If)), None)
    if isinstance(loop, ast.While):
        return loop.lineno in seen.ledger.ran and loop.body[0].lineno not in seen.ledger.ran
    return any(one.seconds <= _BRIEF_S for one in seen.driven)


def _calculations(seen: Situation, node: ast.BinOp, cost: float) -> Iterator[Proposal]:
    new = None if _with_pi(node) is not None else _OPERATORS.get(type(node.op))  # an angle is meant as it is
    operator_cost = _OPERATOR_COSTS.get(type(node.op), 5.0)
    yield from _between(seen.script, "operator", cost + operator_cost, (node.left, node.right), new)
    if isinstance(node.op, ast.Sub) and not _is_summand(seen.script, node):
        left, right = (
            any(one in seen.script.source(side) for one in ("time()", "now()"))
            for side in (node.left, node.right)
        )
        if not left:  # a time that has passed would be negative
            endless = right and seen.outcome.status is RunStatus.INTERRUPTED
            yield _exchanged(seen.script, cost + 5.0 - 3.0 * endless, node.left, node.right)


def _conversions(script: ParsedScript, node: ast.Call, cost: float) -> Iterator[Proposal]:
    called = dotted(node.func)
    if len(node.args) == 2 and called.endswith("atan2"):
        axes = [_axis(script.source(one)) for one in node.args]
        if axes != ["y", "x"]:
            yield _exchanged(script, (0.9 if axes == ["x", "y"] else 3.0) + cost, *node.args)
    if len(node.args) != 1 or not called.endswith(_CONVERSIONS):
        return
    new = script.source(node.args[0])
    above = script.parent(node)
    if called == "int" and isinstance(above, ast.BinOp) and isinstance(above.op, ast.Mult):
        other = script.source(above.right if above.left is node else above.left)
        yield replacing(script, "cut", 1.0, above, f"int({new} * {other})")
    values = {"sentence": "cut"} if called == "int" else {}
    yield replacing(script, "converted", 1.8 + cost, node, new, **values)
    for name, other in (("degrees", "radians"), ("radians", "degrees")):
        if called.endswith(name):
            right = called.replace(name, other)
            yield replacing(script, "name", 1.2 + cost, node.func, right, old=called)


def _unsigned(seen: Situation, node: ast.Call) -> Iterator[Proposal]:
    """Yield a speed without what makes it positive, where the car drove in the wrong direction or not at all."""
    kept = node.args[:1] if dotted(node.func) == "abs" else []
    if dotted(node.func) == "max" and len(node.args) == 2 and 0.0 in map(number_of, node.args):
        kept = [one for one in node.args if number_of(one) != 0.0]
    for one in kept if "advance_m" in seen.lost else ():
        new = seen.script.source(one)
        yield replacing(seen.script, "unsigned", 1.1, node, new)


def _axis(text: str) -> str:
    """Return which leg of a triangle an argument of `atan2` is by its letters: ``y`` goes first, ``x`` second."""
    names = re.findall(r"[A-Za-z_]\w*", text.lower())
    ends = {re.sub(r"[\d_]|^d", "", name)[-1:] if name not in ("sin", "cos") else name for name in names}
    first, second = {"y", "z", "sin"} & ends, {"x", "w", "cos"} & ends
    return "" if bool(first) == bool(second) else "y" if first else "x"


def _opposed(seen: Situation) -> Iterator[Proposal]:
    """Yield the difference of a controller the other way round, and its speed with the other sign."""
    if not seen.outcome.hears:
        return
    script = seen.script
    backward = [
        (node.left, node.right)
        for node in ast.walk(script.tree)
        if isinstance(node, ast.BinOp)
        and isinstance(node.op, ast.Sub)
        and not _is_summand(script, node)
        and _NOW.search(script.source(node.left))
        and not _NOW.search(script.source(node.right))
    ]
    swapped = [_exchanged(script, 1.15, *pair) for pair in backward[:_MOST_SWAPS]]
    if len(swapped) > 1:
        yield replace(swapped[0], edits=tuple(edit for one in swapped for edit in one.edits))
    only_turned = not any(one.motion.v for one in seen.driven)
    for one in assignments(script):
        if not one.target.endswith((".linear.x", ".angular.z")) or number_of(one.value) is not None:
            continue
        names = {dotted(node) for node in ast.walk(one.value)} - {""}
        for node in ast.walk(script.tree):
            if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Sub) and not _is_summand(script, node):
                left, right = (bool(_NOW.search(script.source(side))) for side in (node.left, node.right))
                # unless it is "wanted minus present" already
                if left > right or (left == right and _goes_into(script, node, names)):
                    yield _exchanged(script, 1.2 if left > right else 2.0, node.left, node.right)
        old = script.source(one.value)
        if one.target.endswith(".linear.x") and not old.startswith("-"):
            continue  # to back away from the goal is not meant
        new = f"-{old}" if _is_product(one.value) else f"-({old})"
        new = old[1:] if old.startswith("-") and _is_product(one.value) else new
        cost = 1.4 if only_turned and not backward and one.target.endswith(".angular.z") else 2.1
        yield replacing(script, "sign", cost, one.value, new)


def _goes_into(script: ParsedScript, node: ast.expr, names: set[str]) -> bool:
    """Whether an expression stands in what is assigned to one of `names`."""
    statement = statement_around(script, node)
    return isinstance(statement, ast.Assign) and any(dotted(one) in names for one in statement.targets)


def _is_summand(script: ParsedScript, node: ast.expr) -> bool:
    """Whether an expression is only a part of a longer sum: to turn that part round is to compute nonsense."""
    above = itertools.takewhile(lambda one: isinstance(one, ast.expr), script.around(node))
    return any(isinstance(one, ast.BinOp) and isinstance(one.op, ast.Add | ast.Sub) for one in above)


def _is_product(node: ast.expr) -> bool:
    while isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
        node = node.left
    return not isinstance(node, ast.BinOp | ast.IfExp | ast.Compare | ast.BoolOp)


def _crossed(seen: Situation) -> Iterator[Proposal]:
    """Yield two arguments of a function exchanged that takes a speed and a turn, or x and y."""
    functions = (node for node in functions_of(seen.script))
    led_here = {line for one in seen.driven for line, _, _ in one.motion.stack}
    for function in functions:
        names = [one.arg for one in function.args.args if one.arg != "self"]
        for place, pair in enumerate(itertools.pairwise(names)):
            calls = [
                call.args[place : place + 2]
                for call in calls_of(seen.script, function.name)
                if len(call.args) > place + 1
            ]
            calls = [given for given in calls if tuple(map(dotted, given)) != pair]
            here = [given for given in calls if given[0].lineno in led_here]
            if not _divides(function, pair):  # a rate and its time: exchanged, they come to the same
                here = [given for given in here if 0.0 in map(number_of, given)]
            yield from (_exchanged(seen.script, _SWAP_COST, *given) for given in here[:_MOST_SWAPS])
            if calls and _are_twins(seen, function, pair):
                swapped = [_exchanged(seen.script, 1.25, *given) for given in calls[:_MOST_CALLS]]
                edits = tuple(edit for one in swapped for edit in one.edits)
                yield Proposal("exchanged", 1.2, edits, swapped[0].values)
                yield from swapped[: _MOST_CALLS if len(swapped) > 1 else 0]


def _divides(function: Functions, pair: tuple[str, str]) -> bool:
    """Whether a function divides by one of two parameters."""
    quotients = (
        one for one in ast.walk(function) if isinstance(one, ast.BinOp) and isinstance(one.op, ast.Div)
    )
    return any(dotted(one.right) in pair for one in quotients)


def _are_twins(seen: Situation, function: Functions, pair: tuple[str, str]) -> bool:
    """Whether two parameters may be confused: x and y, or speed and turn of a car that turned first of all."""
    if seen.outcome.hears:
        return [name[-1:] for name in pair] in (["x", "y"], ["y", "x"])
    inside = {id(node) for node in ast.walk(function)}
    set_to = {
        dotted(one.value): one.target.rpartition(".")[0].rpartition(".")[2]
        for one in assignments(seen.script)
        if id(one.statement) in inside and one.target.endswith((".linear.x", ".angular.z"))
    }
    turned_first = bool(seen.driven) and seen.driven[0].is_turn
    return turned_first and {set_to.get(name) for name in pair} == {"linear", "angular"}


def _clocked(seen: Situation) -> Iterator[Proposal]:
    """Yield one period for a timer and for what its callback counts, where a script has two."""
    script = seen.script
    numbers = {number_of(node) for node in ast.walk(script.tree) if isinstance(node, ast.Constant)}
    for call in calls_of(script, "create_timer"):
        period = known_number(script, call.args[0]) if call.args else None
        if not period:
            continue
        for one in assignments(script):
            step = number_of(one.value)
            inside = {getattr(above, "name", "") for above in script.around(one.statement)}
            is_counted = isinstance(one.statement, ast.AugAssign) and inside & named_in([call])
            if is_counted and step and step % 1.0 and step != period:
                change = (NumberUse(one.value, step, 0), script.source(call.args[0]))
                yield _replaced(seen, "scaled", 1.0, change, sentence="clocked")
        ratios = {wanted / size for one in seen.distinct for size, wanted in _targets(seen, one)}
        for other in sorted(number for number in numbers if number and number % 1.0):
            if any(abs(other / period / ratio - 1.0) <= _FITS for ratio in ratios):
                change = (NumberUse(call.args[0], period, 0), f"{other:g}")
                yield _replaced(seen, "scaled", 1.2, change, sentence="period")


def _rays(seen: Situation) -> Iterator[Proposal]:
    """Yield another direction for the ray of a scan that is read."""
    for node in ast.walk(seen.script.tree):
        if isinstance(node, ast.Subscript) and dotted(node.value).endswith(".ranges"):
            old = number_of(node.slice)
            for place, new in enumerate(_DIRECTIONS if old is not None else ()):
                if new != old:
                    yield replacing(seen.script, "ray", 1.3 + 0.2 * place, node.slice, str(new))


def _exchanged(script: ParsedScript, cost: float, left: ast.expr, right: ast.expr) -> Proposal:
    other = script.replaced(right, script.source(left))
    return replacing(script, "exchanged", cost, left, script.source(right), other)


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


def _replaced(
    seen: Situation, code: str, cost: float, change: tuple[NumberUse, str], **values: object
) -> Proposal:
    use, new = change
    given_to = _given_to(seen.script, use.node)
    return replacing(seen.script, code, cost, use.node, new, field=given_to, **values)


def _given_to(script: ParsedScript, node: ast.expr) -> str:
    """Return what a number is given to, so that a speed of 1.0 and a time of 1.0 are not changed together."""
    parent = script.parent(node)
    if isinstance(parent, ast.keyword):
        return parent.arg or ""
    if isinstance(parent, ast.Assign):
        return dotted(parent.targets[0])
    return type(parent).__name__


def _rounded(value: float, is_angle: bool) -> float:
    """Return the angle in radians, or else the shortest number, that a measured one is near enough to."""
    for degrees in (30, 36, 45, 60, 72, 90, 120, 144, 180, 270, 360) if is_angle else ():
        exact = math.copysign(math.radians(degrees), value)
        if abs(value - exact) <= _NEAR * abs(exact):
            return exact
    for digits in range(4):
        if abs(round(value, digits) - value) <= _NEAR * abs(value):
            return round(value, digits)
    return value


def written(value: float, *, like_float: bool, whole: bool = False, is_angle: bool = True) -> str:
    """Return a number as a person would write it, to four digits behind the point."""
    if whole:
        return str(round(value))
    text = f"{_rounded(value, is_angle):.4f}".rstrip("0")
    if abs(value) >= 1e6:
        text = f"{value:g}"
    return text + "0" if text.endswith(".") and like_float else text.rstrip(".")
