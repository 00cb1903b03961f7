"""Motions that go one way and then the other, by turns, where all are to go one way."""

import ast
import itertools
from collections.abc import Iterator
from typing import Final

from grader.edits.situation import Driven, Proposal, Situation, replacing
from grader.edits.slices import assignments, number_of

_MOST_MOTIONS: Final = 8


def alternating(seen: Situation) -> Iterator[tuple[str, list[Driven]]]:
    """Yield the rate (``v``, ``w``) whose sign changes from drive to drive, or from turn to turn; with these."""
    if seen.outcome.hears or seen.wanted.arcs:
        return
    for rate, is_one in (("w", "is_turn"), ("v", "is_drive")):
        motions = [one for one in seen.driven if getattr(one, is_one) and not seen.is_part(one)]
        rates = [getattr(one.motion, rate) for one in motions[:_MOST_MOTIONS]]
        is_even = len({round(abs(one), 3) for one in rates}) == 1
        if len(rates) > 1 and is_even and all(a * b < 0.0 for a, b in itertools.pairwise(rates)):
            yield rate, motions


def direction_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield a rate that keeps its sign."""
    for rate, (_, other, *more) in alternating(seen):
        if not more:  # once there and back may be meant as a brake, or as the way home
            continue
        value = getattr(other.motion, rate)
        yield from _numbers(seen, value, {row[0] for row in other.motion.stack})
        yield from _flips(seen)


def _numbers(seen: Situation, value: float, lines: set[int]) -> Iterator[Proposal]:
    """Yield the other sign for the number that the second motion is given."""
    for node in ast.walk(seen.script.tree):
        if isinstance(node, ast.expr) and node.lineno in lines and number_of(node) == value:
            yield replacing(seen.script, "steady", 1.1, node, f"{-value}")


def _flips(seen: Situation) -> Iterator[Proposal]:
    """Yield the script without the statement that turns a name's sign round, and one branch for both."""
    script = seen.script
    for one in assignments(script):
        factor = isinstance(one.statement, ast.AugAssign) and isinstance(one.statement.op, ast.Mult)
        text = script.source(one.value).replace(" ", "")
        if (number_of(one.value) == -1.0) if factor else text in (f"-{one.target}", f"-1*{one.target}"):
            values = {
                "line": one.statement.lineno,
                "old": script.source(one.statement),
                "sentence": "removed",
            }
            yield Proposal("steady", 1.2, (script.removed(one.statement),), values)
    for node in ast.walk(script.tree):
        if isinstance(node, ast.IfExp):
            for place, new in enumerate(script.source(each) for each in (node.body, node.orelse)):
                yield replacing(script, "steady", 1.2 + 0.1 * place, node, new)
