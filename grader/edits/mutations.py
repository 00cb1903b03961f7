"""Single small edits of a right script, to find out what a rubric sees: numbers, order, statements left out."""

import ast
from collections.abc import Iterator
from typing import NamedTuple

from grader.edits.tree import Edit, ParsedScript, applied

_SIMPLE = (ast.Expr, ast.Assign, ast.AugAssign)
_FACTORS = (2.0, 0.5, 1.1)


class Mutant(NamedTuple):
    """A script with one edit.

    Attributes:
        line: of the edit, 1-based. change: before and after it, for people. text: the whole script.
    """

    line: int
    change: str
    text: str


def mutants(script: ParsedScript) -> Iterator[Mutant]:
    """Yield the script's mutants, by place: numbers scaled, counts one off, statements removed or swapped."""
    for node in sorted(_places(script.tree), key=lambda place: (place.lineno, place.col_offset)):
        edits = _of_number(script, node) if isinstance(node, ast.Constant) else _of_statement(script, node)
        for change, edit in edits:
            yield Mutant(node.lineno, change, applied(script.text, [edit]))


def _places(tree: ast.Module) -> Iterator[ast.Constant | ast.stmt]:
    for node in ast.walk(tree):
        is_number = isinstance(node, ast.Constant) and type(node.value) in (int, float)
        if is_number or (isinstance(node, _SIMPLE) and not _is_text(node)):
            yield node  # type: ignore[misc]


def _is_text(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


def _of_number(script: ParsedScript, node: ast.Constant) -> Iterator[tuple[str, Edit]]:
    value = node.value
    assert isinstance(value, int | float)
    if isinstance(value, int):
        others: list[int | float] = [value + 1, value - 1] if value > 1 else [value + 1]
    else:
        others = [round(value * factor, 6) for factor in _FACTORS] if value else [0.1]
    for other in others:
        yield f"{value!r} -> {other!r}", script.replaced(node, repr(other))


def _of_statement(script: ParsedScript, node: ast.stmt) -> Iterator[tuple[str, Edit]]:
    text = script.source(node)
    yield f"- {text}", script.removed(node)
    block = script.block_of(node)
    place = next(i for i, one in enumerate(block) if one is node)
    after = block[place + 1] if place + 1 < len(block) else None
    if isinstance(after, _SIMPLE) and not _is_text(after):
        (start, end), (next_start, next_end) = script.span(node), script.span(after)
        swapped = script.text[next_start:next_end] + script.text[end:next_start] + script.text[start:end]
        yield f"{text} <-> {script.source(after)}", Edit(start, next_end, swapped)
