"""What a script that steers by its pose has wrong in a formula or a test: told where no change was proven."""

import ast
import re
from collections.abc import Iterator
from typing import Final

from grader.contracts.outcome import RunStatus
from grader.edits.headings import heading_changes
from grader.edits.situation import Cause, Situation
from grader.edits.slices import assignments, calls_of, dotted, function_around, is_read, mentions, named_in
from grader.edits.spins import SPINS

_CLOCK: Final = re.compile(r"\bnow\b|\btime\(\)|monotonic|perf_counter|nanoseconds")
_FOLDS: Final = re.compile(r"\bsin\(|fmod|remainder|\bpi\b|\btau\b|3\.14|6\.28|180|360|normal")
_CORNERS: Final = frozenset({"corner_deg", "corner_error_deg"})


def set_anew(seen: Situation) -> Iterator[Cause]:
    """Yield the time that is taken anew each time before a test asks how long ago it was: the test never holds."""
    for one in assignments(seen.script):
        if one.statement.lineno not in seen.ledger.ran or not _CLOCK.search(seen.script.source(one.value)):
            continue
        behind = (each for each in seen.script.behind(one.statement) if isinstance(each, ast.If))
        test = next((each for each in behind if _asks(each.test, one.target)), None)
        repeats = function_around(seen.script, one.statement) is not None and "." in one.target
        if (
            repeats
            and test is not None
            and test.lineno in seen.ledger.ran
            and test.body[0].lineno not in seen.ledger.ran
        ):
            values = {"name": one.target, "before": test.lineno, "test": seen.script.source(test.test)}
            yield Cause("set_anew", one.statement.lineno, values)


def _asks(test: ast.expr, name: str) -> bool:
    return isinstance(test, ast.Compare) and mentions(test, name)


def unheard(seen: Situation) -> Iterator[Cause]:
    """Yield the subscription's callback that never ran, as nothing spun, and whose values were used."""
    spins = calls_of(seen.script, *SPINS)
    if any(call.lineno in seen.ledger.ran for call in spins) or not seen.ledger.whole:
        return
    callbacks = named_in(calls_of(seen.script, "create_subscription"))
    nodes = list(ast.walk(seen.script.tree))
    for one in nodes:
        if not isinstance(one, ast.FunctionDef) or one.name not in callbacks:
            continue
        lines = range(one.body[0].lineno, (one.end_lineno or 0) + 1)
        kept = {each.target for each in assignments(seen.script) if each.statement.lineno in lines}
        used = sorted(
            node.lineno
            for node in nodes
            if isinstance(node, ast.Attribute) and dotted(node) in kept and is_read(seen.script, node)
        )
        before = next((line for line in used if line in seen.ledger.ran), None)
        if before is not None and not set(lines) & seen.ledger.ran:
            yield Cause("unheard", one.lineno, {"name": one.name, "before": before})


def begins_again(seen: Situation) -> Iterator[Cause]:
    """Yield the index that goes back to the first goal behind the last one, where the car is to stay there."""
    is_over = seen.outcome.status is RunStatus.INTERRUPTED and seen.asked.goals
    for one in assignments(seen.script) if is_over and seen.lost == {"settled", "end_off_m"} else ():
        is_index = isinstance(one.value, ast.BinOp) and isinstance(one.value.op, ast.Mod)
        source = seen.script.source(one.value)
        if is_index and "% len(" in source and one.statement.lineno in seen.ledger.ran:
            yield Cause("begins_again", one.statement.lineno, {"test": source})


def one_coordinate(seen: Situation) -> Iterator[Cause]:
    """Yield the distance that a script takes of one coordinate twice, or of x alone though it turns as well."""
    if not seen.outcome.hears:
        return
    turns = any(one.is_turn for one in seen.driven) and any(one.is_drive for one in seen.driven)
    by_x_alone = turns and not any(getattr(one, "attr", "") == "y" for one in ast.walk(seen.script.tree))
    for node in ast.walk(seen.script.tree):
        if getattr(node, "lineno", 0) not in seen.ledger.ran:
            continue
        sources = [seen.script.source(one) for one in _parts(node)]
        if len(sources) == 2 and sources[0] == sources[1] and _coordinates(node):
            yield Cause("same_twice", node.lineno, {"part": sources[0]})  # type: ignore[attr-defined]
        elif by_x_alone and isinstance(node, ast.Compare) and _coordinates(node) and _is_difference(node):
            yield Cause("one_axis", node.lineno, {"test": seen.script.source(node)})


def _parts(node: ast.AST) -> list[ast.expr]:
    """Return the two squares or legs of which a distance is made."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return [node.left, node.right]
    return node.args if isinstance(node, ast.Call) and dotted(node.func).endswith("hypot") else []


def _coordinates(node: ast.AST) -> set[str]:
    return {one.attr for one in ast.walk(node) if isinstance(one, ast.Attribute) and one.attr in ("x", "y")}


def _is_difference(node: ast.AST) -> bool:
    return any(isinstance(one, ast.BinOp) and isinstance(one.op, ast.Sub) for one in ast.walk(node))


def unfolded(seen: Situation) -> Iterator[Cause]:
    """Yield the difference of headings that jumps by a turn, where corners are wrong and nothing folds it."""
    if seen.lost & _CORNERS and not _FOLDS.search(seen.script.text):
        for one in heading_changes(seen):
            if one.code == "folded" and not str(one.values["new"]).endswith("> 0"):
                values = {name: one.values[name] for name in ("old", "new")}
                yield Cause("unfolded", int(str(one.values["line"])), values)
