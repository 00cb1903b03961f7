"""Changes of the headings that a script computes of what it hears: angles that jump by a turn, and quaternions."""

import ast
import re
from collections.abc import Iterator
from typing import Final

from grader.edits.situation import Proposal, Situation, replacing
from grader.edits.slices import callee, imported, number_of
from grader.edits.tree import ParsedScript

_HEADING: Final = re.compile(r"theta|yaw|heading")
_FOLDING: Final = ("sin", "cos", "atan2", "fmod", "remainder")


def heading_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield differences of headings folded to -π to π, and the heading that a quaternion stands for."""
    if not seen.outcome.hears:
        return
    for node in ast.walk(seen.script.tree):
        if getattr(node, "lineno", 0) not in seen.ledger.ran:
            continue
        if isinstance(node, ast.Compare | ast.BinOp):
            yield from _folded(seen.script, node)
        elif isinstance(node, ast.Call | ast.Attribute):
            yield from _yaw(seen.script, node)


def _folded(script: ParsedScript, node: ast.Compare | ast.BinOp) -> Iterator[Proposal]:
    """Yield a difference of headings without its jumps, also for the comparison of two headings."""
    ends = ""
    if isinstance(node, ast.BinOp):
        first, second = node.left, node.right
        if not isinstance(node.op, ast.Sub) or _is_folded(script, node):
            return
    else:
        first, second, ends = node.left, node.comparators[0], " > 0"
        if isinstance(node.ops[0], ast.Lt | ast.LtE):
            first, second = second, first
        elif len(node.ops) > 1 or not isinstance(node.ops[0], ast.Gt | ast.GtE):
            return
    sides = [script.source(one) for one in (first, second)]
    if any(number_of(one) is not None for one in (first, second)) or not any(map(_HEADING.search, sides)):
        return
    subtracted = f"({sides[1]})" if isinstance(second, ast.BinOp) else sides[1]
    difference = f"{sides[0]} - {subtracted}"
    new = f"math.atan2(math.sin({difference}), math.cos({difference})){ends}"
    yield _with_math(script, "folded", node, new)


def _is_folded(script: ParsedScript, node: ast.expr) -> bool:
    """Whether something around a difference takes its jumps away."""
    for above in script.around(node):
        if isinstance(above, ast.stmt):
            return False
        if callee(above).endswith(_FOLDING):
            return True
        if isinstance(above, ast.BinOp) and not isinstance(above.op, ast.Mult | ast.Div):
            return True
    return False


def _yaw(script: ParsedScript, node: ast.Call | ast.Attribute) -> Iterator[Proposal]:
    """Yield the heading of a quaternion for half of it, and for its z alone."""
    above = script.parent(node)
    if isinstance(above, ast.BinOp | ast.Call | ast.Attribute):
        return
    source = script.source(node)
    if isinstance(node, ast.Attribute) and source.endswith("orientation.z"):
        yield _with_math(script, "yaw", node, f"2 * math.atan2({source}, {source[:-1]}w)")
    elif isinstance(node, ast.Call) and callee(node).endswith("atan2"):
        legs = [getattr(one, "attr", "") for one in node.args]
        if legs == ["z", "w"]:
            yield _with_math(script, "yaw", node, f"2 * {source}")


def _with_math(script: ParsedScript, code: str, node: ast.expr, new: str) -> Proposal:
    return replacing(script, code, 0.9, node, new, *imported(script, "math"))
