"""Changes of what a script remembers: clocks, counters, states, and names that only one function knows."""

import ast
import difflib
from collections.abc import Iterator
from itertools import islice
from typing import Final

from grader.edits.situation import Proposal, Situation
from grader.edits.slices import NameSet, assignments, calls_of, dotted, known_number, named_in, number_of
from grader.edits.tree import Edit, ParsedScript

_Functions: Final = (ast.FunctionDef, ast.AsyncFunctionDef)
_Tests: Final = (ast.While, ast.If)
_CLOCKS: Final = ("time.time", "monotonic", "perf_counter", ".now", "nanoseconds")
_MOST_CLOCKS: Final = 12
_MOST_TESTS: Final = 30
_MOST_NAMES: Final = 200
_LONG_PERIOD: Final = 5.0
_MILLISECONDS: Final = 40.0
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
    yield from _started(seen, known)
    yield from _classes(seen)
    yield from _kept_first(seen, known)


def _kept_first(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield a callback that keeps each message, for one whose `if` lets it keep only the first."""
    heard = named_in(calls_of(seen.script, "create_subscription"))
    for function in ast.walk(seen.script.tree):
        if not isinstance(function, _Functions) or function.name not in heard:
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
    clocks = (
        one for one in known if isinstance(one.statement, ast.Assign) and _is_clock(seen.script, one.value)
    )
    for one in islice(clocks, _MOST_CLOCKS):
        text = seen.script.source(one.statement)
        for test in tests:
            if not _mentions(seen.script, test.test, one.target) and not _mentions_behind(
                seen, known, test, one
            ):
                continue
            values = {"line": one.statement.lineno, "name": one.target, "loop": test.lineno}
            inside = any(node is test for node in seen.script.around(one.statement))
            if inside and isinstance(test, ast.While):
                edits = (seen.script.removed(one.statement), seen.script.inserted_before(test, text))
                yield Proposal("clock_once", 1.6, edits, values)
            elif isinstance(test, ast.While) and not _is_set_for(seen.script, known, one.target, test):
                yield Proposal("clock_anew", 2.0, (seen.script.inserted_before(test, text),), values)
        for change in known:
            if (
                change.target != one.target
                and isinstance(change.value, ast.Constant)
                and _in_test(change, tests)
            ):
                values = {"line": one.statement.lineno, "name": one.target, "loop": change.statement.lineno}
                edit = seen.script.inserted_after(change.statement, text)
                yield Proposal("clock_anew", 2.8, (edit,), values)


def _mentions(script: ParsedScript, part: ast.expr, name: str) -> bool:
    return any(dotted(node) == name for node in ast.walk(part))


def _mentions_behind(
    seen: Situation, known: tuple[NameSet, ...], test: ast.While | ast.If, clock: NameSet
) -> bool:
    """Whether a test asks for a name that is computed from the clock's."""
    return any(
        _mentions(seen.script, one.value, clock.target) and _mentions(seen.script, test.test, one.target)
        for one in known
    )


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
        if not isinstance(one.statement, ast.AugAssign):
            continue
        begin = next(
            (each for each in known if each.target == one.target and isinstance(each.statement, ast.Assign)),
            None,
        )
        if begin is None or number_of(begin.value) is None:
            continue
        line = f"{one.target} = {seen.script.source(begin.value)}"
        own = seen.script.block_of(one.statement)
        for change in known:
            if (
                change.target != one.target
                and isinstance(change.value, ast.Constant)
                and _in_test(change, tests)
                and any(_mentions(seen.script, test.test, change.target) for test in tests)  # a state
                and not any(each is change.statement for each in own)  # it would count no more
            ):
                values = {"line": change.statement.lineno, "name": one.target, "new": line}
                yield Proposal("reset", 2.2, (seen.script.inserted_after(change.statement, line),), values)
        for test in tests:
            if isinstance(test, ast.While) and _mentions(seen.script, test.test, one.target):
                values = {"line": test.lineno, "name": one.target, "new": line}
                if not _is_set_for(seen.script, known, one.target, test):
                    yield Proposal("reset", 2.0, (seen.script.inserted_before(test, line),), values)


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
            for place, text in enumerate(difflib.get_close_matches(asked, texts, 3, 0.3)):
                values = {"line": node.lineno, "old": asked, "new": text}
                yield Proposal("state", 1.0 + place * 0.2, (seen.script.replaced(node, f"'{text}'"),), values)


def _scopes(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield ``self.`` or ``global`` for a name that a function sets only for itself."""
    own = {one.target.removeprefix("self.") for one in known if one.target.startswith("self.")}
    top = {one.target for one in known if isinstance(seen.script.parent(one.statement), ast.Module)}
    for one in known:
        function = next(
            (each for each in seen.script.around(one.statement) if isinstance(each, _Functions)), None
        )
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
                values = {"line": call.lineno, "old": seen.script.source(call.args[0]), "new": new}
                yield Proposal("seconds", 1.0, (seen.script.replaced(call.args[0], new),), values)
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
            and "9" not in limit
        ):
            is_simple = isinstance(other, ast.Name | ast.Constant | ast.Attribute)
            new = f"{limit} * 1e9" if is_simple else f"({limit}) * 1e9"
            values = {"line": node.lineno, "old": limit, "new": new}
            yield Proposal("nanoseconds", 0.9, (script.replaced(other, new),), values)


def _factors(seen: Situation) -> Iterator[Proposal]:
    """Yield a product without the loop's variable, which lets it grow from round to round."""
    for loop in ast.walk(seen.script.tree):
        if not isinstance(loop, ast.For) or not isinstance(loop.target, ast.Name):
            continue
        for node in ast.walk(loop):
            if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
                for one, other in ((node.left, node.right), (node.right, node.left)):
                    if _mentions(seen.script, one, loop.target.id):
                        new = seen.script.source(other)
                        values = {"line": node.lineno, "old": seen.script.source(node), "new": new}
                        yield Proposal("factor", 2.0, (seen.script.replaced(node, new),), values)


def _signs(seen: Situation) -> Iterator[Proposal]:
    """Yield the positive value of a number that makes a time or a count negative."""
    if any(one.is_turn for one in seen.driven) and any(one.is_drive for one in seen.driven):
        return
    for node in ast.walk(seen.script.tree):
        value = number_of(node)
        if value is not None and value < 0.0 and isinstance(node, ast.UnaryOp):
            new = seen.script.source(node.operand)
            values = {"line": node.lineno, "old": seen.script.source(node), "new": new}
            yield Proposal("sign", 2.4, (seen.script.replaced(node, new),), values)
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div) and number_of(node.right) is None:
            old = seen.script.source(node.right)
            values = {"line": node.lineno, "old": old, "new": f"abs({old})"}
            yield Proposal("absolute", 2.6, (seen.script.replaced(node.right, f"abs({old})"),), values)


def _started(seen: Situation, known: tuple[NameSet, ...]) -> Iterator[Proposal]:
    """Yield the start of a thread that is made and not started."""
    started = {dotted(call.func).rpartition(".")[0] for call in calls_of(seen.script, "start")}
    for one in known:
        is_thread = isinstance(one.value, ast.Call) and dotted(one.value.func).endswith(("Thread", "Timer"))
        if is_thread and one.target not in started:
            edit = seen.script.inserted_after(one.statement, f"{one.target}.start()")
            yield Proposal("start", 0.9, (edit,), {"line": one.statement.lineno, "name": one.target})


def _classes(seen: Situation) -> Iterator[Proposal]:
    """Yield the class of the script's own that nobody makes, for another one that is made in its place."""
    classes = [node for node in ast.walk(seen.script.tree) if isinstance(node, ast.ClassDef)]
    unmade = [one.name for one in classes if not any(True for _ in calls_of(seen.script, one.name))]
    for one in assignments(seen.script):
        if isinstance(one.value, ast.Call) and unmade:
            made = dotted(one.value.func)
            if made.endswith("Node") or made in {each.name for each in classes}:
                new = f"{unmade[0]}()"
                values = {"line": one.statement.lineno, "old": seen.script.source(one.value), "new": new}
                yield Proposal("class", 1.0, (seen.script.replaced(one.value, new),), values)
