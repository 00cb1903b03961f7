"""Changes of what a script remembers: clocks, counters, states, and names that only one function knows."""

import ast
import difflib
import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Final, NamedTuple

from grader.edits.situation import Proposal, Situation, replacing
from grader.edits.slices import (
    Functions,
    NameSet,
    assignments,
    calls_of,
    classes_of,
    dotted,
    function_around,
    functions_of,
    known_number,
    mentions,
    named_in,
    number_of,
)
from grader.edits.tree import Edit, ParsedScript

_Tests: Final = (ast.While, ast.If)
_CLOCKS: Final = ("time.time", "monotonic", "perf_counter", ".now", "nanoseconds")
_MOST_CLOCKS: Final = 12
_MOST_TESTS: Final = 30
_MOST_NAMES: Final = 200
_LONG_PERIOD: Final = 5.0
_MILLISECONDS: Final = 40.0
_POWER: Final = re.compile(r"9|1e\d|000|10 ?\*\*")  # there a unit is converted already, if to a wrong one
_PERIODS: Final = ("create_timer", "sleep", "create_rate")


def state_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield changes of clocks, counters, states, scopes and periods."""
    known = assignments(seen.script)[:_MOST_NAMES]
    tests = [node for node in ast.walk(seen.script.tree) if isinstance(node, _Tests)][:_MOST_TESTS]
    yield from _clocks(seen, known, tests)
    yield from _resets(seen, known, tests)
    yield from _states(seen, known, tests)
    yield from _scopes(seen, known)
    yield from _units(seen, tests)
    yield from _factors(seen)
    yield from _signs(seen)
    yield from _classes(seen)
    yield from _kept_first(seen, known)
    yield from _forgotten(seen, known)


def _kept_first(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield a callback that keeps each message, for one whose `if` lets it keep only the first."""
    heard = named_in(calls_of(seen.script, "create_subscription"))
    for function in functions_of(seen.script):
        if function.name not in heard:
            continue
        for test in function.body:
            if not isinstance(test, ast.If) or test.orelse:
                continue
            asked = {dotted(node) for node in ast.walk(test.test)} - {""}
            if any(one.target in asked and one.statement in test.body for one in known):
                start, end = seen.script.line_start(test.lineno), seen.script.span(test.body[-1])[1]
                step = test.body[0].col_offset - test.col_offset
                lines = seen.script.text[seen.script.line_start(test.body[0].lineno) : end].splitlines()
                text = "\n".join(line[step:] for line in lines)
                values = {"line": test.lineno, "old": seen.script.source(test.test)}
                yield Proposal("kept_first", 1.5, (Edit(start, end, text),), values)


def _is_clock(script: ParsedScript, value: ast.expr) -> bool:
    text = script.source(value)
    return len(text) < 80 and any(one in text for one in _CLOCKS)


def _clocks(
    seen: Situation, known: tuple[NameSet, ...], tests: list[ast.While | ast.If]
) -> Iterator[Proposal]:
    """Yield a time that is taken anew before the loop that asks for it, or no more within that loop."""
    clocks = [
        one for one in known if isinstance(one.statement, ast.Assign) and _is_clock(seen.script, one.value)
    ]
    for one in clocks[:_MOST_CLOCKS]:
        text = seen.script.source(one.statement)
        taken = [each.statement for each in clocks if each.target == one.target]
        function = seen.script.parent(one.statement)
        loops: list[ast.stmt] = []
        for test in tests:
            if not mentions(test.test, one.target) and not _mentions_behind(seen, known, test, one):
                continue
            values = {"line": one.statement.lineno, "name": one.target, "loop": test.lineno}
            around = [*seen.script.around(test)]
            if isinstance(test, ast.While) and test in seen.script.around(one.statement):
                edits = (seen.script.removed(one.statement), seen.script.inserted_before(test, text))
                yield Proposal("clock_once", 1.6, edits, values)
            elif isinstance(test, ast.While) and not _is_set_for(seen.script, known, one.target, test):
                loops.append(test)
            elif isinstance(test, ast.While) and _waits_between(seen.script, one.statement, test):
                edits = (seen.script.removed(one.statement), seen.script.inserted_before(test, text))
                yield Proposal("clock_once", 1.2, edits, {**values, "sentence": "clock_early"})
            elif len(taken) > 1 and function in around and "." in one.target and one.statement in taken[1:]:
                values = {"line": one.statement.lineno, "old": text, "sentence": "clock_each_call"}
                yield Proposal("removed", 1.2, (seen.script.removed(one.statement),), values)
        anew = Proposal(
            "clock_anew", 0.0, (), {"line": one.statement.lineno, "name": one.target, "added": text}
        )
        yield from _anew(anew, loops, [seen.script.inserted_before(loop, text) for loop in loops], taken)
        if not any(isinstance(node, ast.Sub) for node in ast.walk(one.value)):  # a time that has passed
            changes = _changes(seen.script, known, tests, one.target)
            lacking = [each for each in changes if not any(s in taken for s in seen.script.block_of(each))]
            yield from _anew(
                anew, lacking, [seen.script.inserted_after(each, text) for each in lacking], taken
            )


def _waits_between(script: ParsedScript, clock: ast.stmt, loop: ast.stmt) -> bool:
    """Whether a script waits behind the line that takes a time, before the loop that asks how much is over."""
    between = range(clock.lineno, loop.lineno)
    return loop in script.block_of(clock) and any(
        call.lineno in between and script.parent(script.parent(call) or call) is script.parent(loop)
        for call in calls_of(script, "sleep")
    )


def _changes(
    script: ParsedScript, known: tuple[NameSet, ...], tests: list[ast.While | ast.If], besides: str
) -> list[ast.stmt]:
    """Return where a state changes, or a step is counted: in a branch, once, and a test asks for it."""
    changes: list[ast.stmt] = []
    for one in known:
        around = [
            node for node in (one.statement, *script.around(one.statement)) if isinstance(node, ast.stmt)
        ]
        beside = [statement for node in around for statement in script.block_of(node)]
        if (
            one.target != besides
            and isinstance(one.value, ast.Constant | ast.Name | ast.Attribute | ast.UnaryOp)
            and _in_test(one, tests)
            and any(mentions(test.test, one.target) for test in tests)
            and not any(each in beside for each in changes)
            and not _counts_down(script, one, tests)
        ):
            changes.append(one.statement)
    return changes


def _counts_down(script: ParsedScript, one: NameSet, tests: list[ast.While | ast.If]) -> bool:
    """Whether an assignment counts down what its own branch asks for: no motion begins there."""
    is_less = isinstance(one.statement, ast.AugAssign) and isinstance(one.statement.op, ast.Sub)
    return is_less and any(one.statement in test.body and mentions(test.test, one.target) for test in tests)


def _anew(
    proposal: Proposal, places: list[ast.stmt], edits: list[Edit], sets: list[ast.stmt]
) -> Iterator[Proposal]:
    """Yield a line that sets a name anew where a motion begins: at all places, if it is set only once by now."""
    together = [(places[0], tuple(edits), 1.2)] if len(sets) == 1 and places else []
    apart = [(one, (edit,), 2.0) for one, edit in zip(places, edits, strict=True)]
    for statement, parts, cost in together or apart:
        yield replace(proposal, cost=cost, edits=parts, values={**proposal.values, "loop": statement.lineno})


def _mentions_behind(
    seen: Situation, known: tuple[NameSet, ...], test: ast.While | ast.If, clock: NameSet
) -> bool:
    """Whether a test asks for a name or a function that is computed from the clock's."""
    asked = {dotted(node).rpartition(".")[2] for node in ast.walk(test.test)} - {""}
    functions = (node for node in functions_of(seen.script))
    if any(mentions(node, clock.target) for one in functions if one.name in asked for node in one.body):
        return True
    return any(mentions(one.value, clock.target) and mentions(test.test, one.target) for one in known)


def _in_test(change: NameSet, tests: list[ast.While | ast.If]) -> bool:
    return any(
        test.lineno < change.statement.lineno <= (test.end_lineno or 0)
        for test in tests
        if isinstance(test, ast.If)
    )


def _is_set_for(script: ParsedScript, known: tuple[NameSet, ...], name: str, loop: ast.stmt) -> bool:
    """Whether a name is set in the block of a loop, before it."""
    block = script.block_of(loop)
    return any(
        one.target == name
        and one.statement.lineno < loop.lineno
        and any(each is one.statement for each in block)
        for one in known
    )


def _resets(
    seen: Situation, known: tuple[NameSet, ...], tests: list[ast.While | ast.If]
) -> Iterator[Proposal]:
    """Yield a count or sum that begins again where a state changes, or before the loop that it ends."""
    for one in known:
        sets = [
            each for each in known if each.target == one.target and isinstance(each.statement, ast.Assign)
        ]
        begin = sets[0] if sets else None
        if not isinstance(one.statement, ast.AugAssign) or begin is None or number_of(begin.value) is None:
            continue
        if _ends_rounds(seen, one.target, tests):
            continue
        line = f"{one.target} = {seen.script.source(begin.value)}"
        own = seen.script.block_of(one.statement)
        anew = Proposal("reset", 0.0, (), {"name": one.target, "added": line})
        statements = [each.statement for each in sets]
        changes = [each for each in _changes(seen.script, known, tests, one.target) if each not in own]
        lacking = [each for each in changes if not any(s in statements for s in seen.script.block_of(each))]
        edits = [seen.script.inserted_after(each, line) for each in lacking]
        yield from _anew(anew, lacking, edits, statements)
        loops: list[ast.stmt] = [
            test
            for test in tests
            if isinstance(test, ast.While)
            and mentions(test.test, one.target)
            and not _is_set_for(seen.script, known, one.target, test)
        ]
        yield from _anew(anew, loops, [seen.script.inserted_before(loop, line) for loop in loops], statements)


def _ends_rounds(seen: Situation, name: str, tests: list[ast.While | ast.If]) -> bool:
    """Whether a counter is compared with the wanted number of rounds: set back, it would never get there."""
    compared = (node for test in tests for node in ast.walk(test.test) if isinstance(node, ast.Compare))
    return any(
        dotted(node.left) == name and number_of(node.comparators[0]) in seen.wanted.counts
        for node in compared
    )


def _states(
    seen: Situation, known: tuple[NameSet, ...], tests: list[ast.While | ast.If]
) -> Iterator[Proposal]:
    """Yield the state that is set, for one that is asked for and set nowhere."""
    given = {one.value.value for one in known if isinstance(one.value, ast.Constant)}
    texts = sorted(one for one in given if isinstance(one, str))
    for test in tests:
        for node in ast.walk(test.test):
            asked = node.value if isinstance(node, ast.Constant) else None
            if not isinstance(asked, str) or asked in texts or not isinstance(node, ast.Constant):
                continue
            for place, text in enumerate(_alike(asked, texts, 0.3)):
                yield replacing(
                    seen.script, "state", 1.0 + place * 0.2, node, f"'{text}'", old=asked, new=text
                )
    branches = list(_branches(seen.script, tests))
    for name in dict.fromkeys(one.name for one in branches):
        own = [one for one in branches if one.name == name]
        yield from _of_state(seen.script, own, [one for one in known if one.target == name])


def _alike(text: str, others: list[str], least: float) -> list[str]:
    folded = {one.casefold(): one for one in others}
    return [folded[one] for one in difflib.get_close_matches(text.casefold(), folded, 3, least)]


class _Branch(NamedTuple):
    """What runs in one state. `state`: as the script writes it."""

    name: str
    state: str
    body: list[ast.stmt]


def _branches(script: ParsedScript, tests: list[ast.While | ast.If]) -> Iterator[_Branch]:
    for test in tests:
        asked, turned = test.test, isinstance(test.test, ast.UnaryOp)
        if isinstance(asked, ast.UnaryOp):
            asked = asked.operand
        if isinstance(asked, ast.Compare) and len(asked.ops) == 1 and isinstance(asked.ops[0], ast.Eq):
            yield _Branch(dotted(asked.left), script.source(asked.comparators[0]), test.body)
        elif isinstance(test, ast.If) and (name := dotted(asked)):
            yield _Branch(name, str(not turned), test.body)
            yield _Branch(name, str(turned), test.orelse)


def _of_state(script: ParsedScript, branches: list[_Branch], sets: list[NameSet]) -> Iterator[Proposal]:
    """Yield the state that a branch does not go on to: the one that all began with, or any but its own."""
    states = list(dict.fromkeys(one.state for one in branches))
    given = [script.source(one.value) for one in sets if isinstance(one.statement, ast.Assign)]
    if len(given) != len(sets) or len(states) < 2 or len(set(given)) < 2:
        return
    for one, text in zip(sets, given, strict=True):
        for new in _alike(text, states, 0.7) if text not in states else ():
            yield replacing(script, "state", 1.0, one.value, new, sentence="state_set")
    for branch in branches:
        inside = {id(node) for statement in branch.body for node in ast.walk(statement)}
        for one, text in zip(sets, given, strict=True):
            others = [each for each in states if each != text] if id(one.statement) in inside else []
            for place, new in enumerate(others if text == branch.state else ()):
                values = {
                    "line": one.statement.lineno,
                    "name": branch.name,
                    "new": new,
                    "sentence": "state_next",
                }
                yield Proposal("state", 0.8 + place * 0.1, (script.replaced(one.value, new),), values)
        if given[0] not in states or given[0] in given[1:] or branch.state == given[0]:
            continue
        line = f"{branch.name} = {given[0]}"
        for inner in (one for one in branch.body if isinstance(one, ast.If)):
            values = {"line": inner.lineno, "name": branch.name, "new": given[0], "sentence": "state_back"}
            yield Proposal("state", 0.9, (script.inserted_before(inner.body[0], line),), values)


def _scopes(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield ``self.`` or ``global`` for a name that a function sets only for itself."""
    own = {one.target.removeprefix("self.") for one in known if one.target.startswith("self.")}
    top = {one.target for one in known if isinstance(seen.script.parent(one.statement), ast.Module)}
    for one in known:
        function = function_around(seen.script, one.statement)
        if function is None or not isinstance(one.statement, ast.Assign | ast.AugAssign) or "." in one.target:
            continue
        values = {"line": one.statement.lineno, "old": one.target, "name": one.target}
        if one.target in own:
            start, _ = seen.script.span(one.statement)
            values["new"] = f"self.{one.target}"
            yield Proposal("own", 1.2, (Edit(start, start, "self."),), values)
        if one.target in top and f"global {one.target}" not in seen.script.source(function):
            edit = seen.script.inserted_before(function.body[0], f"global {one.target}")
            yield Proposal("global", 1.3, (edit,), values)


def _units(seen: Situation, tests: list[ast.While | ast.If]) -> Iterator[Proposal]:
    """Yield seconds for what is given in milliseconds, and nanoseconds where these are compared."""
    for name in _PERIODS:
        for call in calls_of(seen.script, name):
            value = known_number(seen.script, call.args[0]) if call.args else None
            if value is not None and value >= _LONG_PERIOD and name != "create_rate":
                new = (
                    f"{value / 1000.0:g}" if value >= _MILLISECONDS else f"{1.0 / value:.2g}"
                )  # or so often a second
                yield replacing(seen.script, "seconds", 1.0, call.args[0], new)
    for test in tests:
        for node in ast.walk(test.test):
            if isinstance(node, ast.Compare) and len(node.ops) == 1:
                yield from _nanoseconds(seen.script, node)


def _nanoseconds(script: ParsedScript, node: ast.Compare) -> Iterator[Proposal]:
    left, right = node.left, node.comparators[0]
    for one, other in ((left, right), (right, left)):
        written, limit = script.source(one), script.source(other)
        if (
            "nanoseconds" in written
            and "e9" not in written
            and "nanoseconds" not in limit
            and not _POWER.search(limit)
        ):
            is_simple = isinstance(other, ast.Name | ast.Constant | ast.Attribute)
            new = f"{limit} * 1e9" if is_simple else f"({limit}) * 1e9"
            yield replacing(script, "nanoseconds", 0.9, other, new)


def _factors(seen: Situation) -> Iterator[Proposal]:
    """Yield a product without the loop's variable, which lets it grow from round to round."""
    for loop in ast.walk(seen.script.tree):
        if not isinstance(loop, ast.For) or not isinstance(loop.target, ast.Name):
            continue
        for node in ast.walk(loop):
            if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
                for one, other in ((node.left, node.right), (node.right, node.left)):
                    if mentions(one, loop.target.id):
                        new = seen.script.source(other)
                        yield replacing(seen.script, "factor", 2.0, node, new)


def _signs(seen: Situation) -> Iterator[Proposal]:
    """Yield the positive value of a number that makes a time or a count negative."""
    if any(one.is_turn for one in seen.driven) and any(one.is_drive for one in seen.driven):
        return
    rates = {rate for one in seen.driven for rate in (one.motion.v, one.motion.w)}
    for node in ast.walk(seen.script.tree):
        value = number_of(node)
        if value is not None and value < 0.0 and isinstance(node, ast.UnaryOp) and value not in rates:
            new = seen.script.source(node.operand)
            yield replacing(seen.script, "sign", 2.4, node, new)
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div) and number_of(node.right) is None:
            old = seen.script.source(node.right)
            yield replacing(seen.script, "absolute", 2.6, node.right, f"abs({old})")


def _classes(seen: Situation) -> Iterator[Proposal]:
    """Yield the class of the script's own that nobody makes, for another one that is made in its place."""
    classes = classes_of(seen.script)
    unmade = [one.name for one in classes if not calls_of(seen.script, one.name)]
    for one in assignments(seen.script):
        if isinstance(one.value, ast.Call) and unmade:
            made = dotted(one.value.func)
            if made.endswith("Node") or made in {each.name for each in classes}:
                new = f"{unmade[0]}()"
                yield replacing(seen.script, "class", 1.0, one.value, new)


def _forgotten(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield ``self.`` for a name that a callback sets to the same number each time before it counts it."""
    heard = named_in(calls_of(seen.script, "create_timer", "create_subscription"))
    for one in known:
        function = seen.script.parent(one.statement)
        if not isinstance(function, Functions) or function.name not in heard or number_of(one.value) is None:
            continue
        counts = any(
            each.target == one.target and each.statement.lineno > one.statement.lineno
            for each in known
            if function in seen.script.around(each.statement)
        )
        beside = getattr(seen.script.parent(function), "body", ())
        init = next((each for each in beside if getattr(each, "name", "") == "__init__"), None)
        if "." in one.target or not counts or init is None:
            continue
        new = f"self.{one.target}"
        inside = (node for each in function.body if each is not one.statement for node in ast.walk(each))
        uses = [node for node in inside if isinstance(node, ast.Name) and node.id == one.target]
        begin = seen.script.inserted_after(init.body[-1], f"{new} = {seen.script.source(one.value)}")
        edits = (begin, seen.script.removed(one.statement), *(seen.script.replaced(use, new) for use in uses))
        yield Proposal("own", 0.9, edits, {"line": one.statement.lineno, "old": one.target, "new": new})
