"""Changes of how often something is done: the bounds of loops and counters, and rounds that are missing."""

import ast
from collections.abc import Iterator
from typing import Final

from grader.edits.situation import Proposal, Situation, removing, replacing
from grader.edits.slices import (
    assignments,
    callee,
    calls_of,
    dotted,
    known_number,
    mentions,
    number_of,
)
from grader.edits.tree import Edit, ParsedScript

_MOST_COUNT: Final = 40
_NAMES: Final = ("i", "j", "k", "n", "count")
_PHASES: Final = 2  # of a round, where drives and turns are counted
_ONE_MORE: Final = {ast.Lt: "<=", ast.GtE: ">"}
_ONE_LESS: Final = {ast.LtE: "<", ast.Gt: ">="}
"""Comparisons with the bound of what is counted upwards; counted downwards the two are exchanged."""


def count_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield other counts for what was done too often or too seldom."""
    for node in ast.walk(seen.script.tree) if seen.rounds_missing else ():
        if isinstance(node, ast.Compare) and len(node.ops) == 1 and node.lineno in seen.ledger.ran:
            yield from _bound(seen, node)
        elif isinstance(node, ast.Call) and callee(node) == "range":
            yield from _range(seen, node)
        elif isinstance(node, ast.List | ast.Tuple):
            yield from _rows(seen, node)
    yield from _overwritten(seen)
    yield from _alternating(seen)
    yield from _wanted(seen)


def _bound(seen: Situation, node: ast.Compare) -> Iterator[Proposal]:
    """Yield another end for a counter that came as far as the rounds that were driven."""
    script, missing, bound = seen.script, seen.rounds_missing, node.comparators[0]
    name, end = dotted(node.left), known_number(script, bound)
    steps = [one for one in assignments(script) if one.target == name]
    begin = next((number_of(one.value) for one in steps), None) if name else 0.0
    if end is None or begin is None or not float(end - begin).is_integer():
        return
    wanted, is_down = seen.wanted.counts[0], begin > end
    rounds = abs(end - begin) + isinstance(node.ops[0], ast.GtE if is_down else (ast.LtE, ast.Gt))
    counting = [one.statement for one in steps if isinstance(one.statement, ast.AugAssign)]
    if rounds == wanted - missing:
        other = (_ONE_MORE if (missing > 0) != is_down else _ONE_LESS).get(type(node.ops[0]))
        is_meant = (begin if is_down else end) == wanted
        if is_meant and abs(missing) == 1 and other is not None:
            start, stop = script.span(node.left)[1], script.span(bound)[0]
            values = {"line": node.lineno, "old": script.text[start:stop].strip(), "new": other}
            yield Proposal("comparison", 0.9, (Edit(start, stop, f" {other} "),), values)
        elif not is_meant:
            yield from _number(script, steps[0].value if is_down else bound, missing)
    elif rounds in (_PHASES * (wanted - missing), _PHASES * (wanted - missing) - 1):
        for one in counting if len(counting) > 1 else ():
            yield removing(script, 1.0, one)
        yield from _number(script, bound, _PHASES * wanted - int(rounds))


def _number(script: ParsedScript, node: ast.expr, more: int) -> Iterator[Proposal]:
    """Yield a count that is so much greater, where it is written: there, or where its name is set."""
    written = next((one.value for one in assignments(script) if one.target == dotted(node)), node)
    value = number_of(written)
    if value is not None:
        yield replacing(script, "count", 1.0, written, str(int(value) + more))


def _range(seen: Situation, call: ast.Call) -> Iterator[Proposal]:
    """Yield a range of the wanted length, for one as long as the rounds that were driven."""
    script, missing = seen.script, seen.rounds_missing
    last = call.args[min(len(call.args), 2) - 1] if call.args else None
    if last is None or len(call.args) > 2:
        return
    end, begin = known_number(script, last), number_of(call.args[0]) if len(call.args) == 2 else 0.0
    if isinstance(last, ast.BinOp) and number_of(last.right) == 1.0 and abs(missing) == 1:
        if isinstance(last.op, ast.Sub if missing > 0 else ast.Add):
            new = script.source(last.left)
            yield replacing(script, "count", 0.9, last, new)
    elif end is not None and begin is not None and end - begin == seen.wanted.counts[0] - missing:
        if not begin or end != seen.wanted.counts[0]:
            yield from _number(script, last, missing)
            return
        loop, bound = script.parent(call), script.source(last)
        is_asked = isinstance(loop, ast.For) and any(mentions(one, dotted(loop.target)) for one in loop.body)
        further = f"{bound} + 1" if number_of(last) is None else f"{end + 1:g}"
        new = f"range(1, {further})" if is_asked else f"range({bound})"
        yield replacing(script, "count", 0.9, call, new)


def _rows(seen: Situation, node: ast.List | ast.Tuple) -> Iterator[Proposal]:
    """Yield another number of times for a plan that was driven as often."""
    missing, above = seen.rounds_missing, seen.script.parent(node)
    driven = seen.wanted.counts[0] - missing
    if isinstance(above, ast.BinOp) and isinstance(above.op, ast.Mult) and number_of(above.right) == driven:
        yield from _number(seen.script, above.right, missing)


def _overwritten(seen: Situation) -> Iterator[Proposal]:
    """Yield another name for what a loop counts, where it has the name of an outer count, or of a value."""
    script = seen.script
    used = {node.id for node in ast.walk(script.tree) if isinstance(node, ast.Name)}
    new = next((name for name in _NAMES if name not in used), "")
    for loop in ast.walk(script.tree) if new else ():
        if not isinstance(loop, ast.For | ast.While):
            continue
        sets = [one for one in assignments(script) if one.statement.lineno < loop.lineno]
        if isinstance(loop, ast.For):
            old = dotted(loop.target)
            parts: list[ast.AST] = [loop.target] if any(one.target == old for one in sets) else []
        else:
            old = dotted(getattr(loop.test, "left", None))
            outer = [
                one for one in script.around(loop) if isinstance(one, ast.While) and mentions(one.test, old)
            ]
            begins = [one.statement for one in sets if one.target == old and outer]
            parts = [loop, *(one for one in begins if one in script.block_of(loop))]
        nodes = [
            node for one in parts for node in ast.walk(one) if isinstance(node, ast.Name) and node.id == old
        ]
        if len(parts) > isinstance(loop, ast.While) and old.isidentifier():
            values = {"line": parts[-1].lineno, "old": old, "new": new}  # type: ignore[attr-defined]
            yield Proposal("renamed", 0.9, tuple(script.replaced(node, new) for node in nodes), values)


def _alternating(seen: Situation) -> Iterator[Proposal]:
    """Yield long and short sides by turns, for the long ones first and then the short ones."""
    is_asked = "side_error_pct" in seen.lost and len(seen.wanted.lengths_m) > 1
    names = {dotted(loop.target) for loop in ast.walk(seen.script.tree) if isinstance(loop, ast.For)} - {""}
    for node in ast.walk(seen.script.tree) if is_asked else ():
        if not isinstance(node, ast.Compare) or dotted(node.left) not in names:
            continue
        if isinstance(node.ops[0], ast.Lt) and number_of(node.comparators[0]) == seen.wanted.counts[0] / 2:
            new = f"{dotted(node.left)} % 2 == 0"
            values = {"line": node.lineno, "old": seen.script.source(node), "new": new}
            edit = seen.script.replaced(node, new)
            yield Proposal("comparison", 0.9, (edit,), {**values, "sentence": "alternating"})


def _wanted(seen: Situation) -> Iterator[Proposal]:
    """Yield a count that the assignment names for another one that ran, and the next one to what it waited for."""
    for node in ast.walk(seen.script.tree):
        if (
            not isinstance(node, ast.Constant)
            or type(node.value) is not int
            or not 1 <= node.value <= _MOST_COUNT
        ):
            continue
        if not _counts_something(seen.script, node) or node.lineno not in seen.ledger.ran:
            continue
        offered = [
            (2.2 + place * 0.3 + abs(count - node.value) * 0.05, count)
            for place, count in enumerate(seen.wanted.counts)
        ]
        loop = next((one for one in seen.script.around(node) if isinstance(one, ast.While)), node)
        lines = range(node.lineno, (loop.end_lineno or node.lineno) + 1)
        if any(line in lines for line, _, _ in seen.ledger.end):
            offered += [(1.5, node.value + 1), (1.5, node.value - 1)]
        for cost, count in offered:
            if count != node.value:
                yield replacing(seen.script, "count", cost, node, str(count), old=str(node.value))


def _counts_something(script: ParsedScript, node: ast.Constant) -> bool:
    """Whether a whole number says how often: in a `range`, a comparison, or behind a list."""
    parent = script.parent(node)
    if isinstance(parent, ast.Call):
        return dotted(parent.func) == "range" and node is parent.args[len(parent.args) > 1]
    if isinstance(parent, ast.BinOp) and isinstance(parent.op, ast.Mult):
        return isinstance(parent.left, ast.List | ast.Tuple)
    if isinstance(parent, ast.Assign):  # a number of rounds, and no period or size
        names = {dotted(one) for one in parent.targets}
        compared = (one for one in ast.walk(script.tree) if isinstance(one, ast.Compare))
        return any(
            dotted(one) in names for each in (*calls_of(script, "range"), *compared) for one in ast.walk(each)
        )
    return isinstance(parent, ast.Compare)
