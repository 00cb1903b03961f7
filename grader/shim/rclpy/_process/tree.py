"""A script's syntax tree as rows of plain values, for the episode's end to read (`grader.edits.received`)."""

from __future__ import annotations

import _ast
import math

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MOST_NODES = 3_000
MOST_INTEGER = 1 << 62
MOST_CHARACTERS = 200

_LEFT_OUT = frozenset({"ctx", "type_ignores", "type_comment", "kind"})
_PLACE = ("lineno", "col_offset", "end_lineno", "end_col_offset")


def tree_rows(source: bytes, file_name: str) -> list[list[Any]]:
    """Return one row for each node; none if the source is no Python or has too many.

    A row: kind, row of its parent (-1: none), field of the parent, place (line, column, end line, end column, or
    null), and the fields that hold no node.
    """
    try:
        tree = compile(source, file_name, "exec", _ast.PyCF_ONLY_AST, dont_inherit=True)
    except (SyntaxError, ValueError, RecursionError, MemoryError, OverflowError):
        return []
    rows: list[list[Any]] = []
    waiting: list[tuple[_ast.AST, int, str]] = [(tree, -1, "")]
    while waiting:
        node, parent, name = waiting.pop()
        if len(rows) >= MOST_NODES:
            return []
        place = [getattr(node, attribute, None) for attribute in _PLACE]
        plain: dict[str, Any] = {}
        children: list[tuple[_ast.AST, int, str]] = []
        for field in node._fields:
            value = getattr(node, field, None)
            if field in _LEFT_OUT or value is None:
                continue
            if isinstance(value, _ast.AST):
                children.append((value, len(rows), field))
            elif isinstance(value, list) and any(isinstance(element, _ast.AST) for element in value):
                children += [
                    (element, len(rows), field) for element in value if isinstance(element, _ast.AST)
                ]
            else:
                plain[field] = _plain(value)
        rows.append([type(node).__name__, parent, name, None if place[0] is None else place, plain])
        waiting += reversed(children)
    return rows


def _plain(value: object) -> object:
    """Return a constant as JSON can hold it; None for what it cannot."""
    if isinstance(value, list):
        return [element for element in value if isinstance(element, str)]
    if isinstance(value, str):
        return value[:MOST_CHARACTERS].encode("utf-8", "replace").decode()
    if isinstance(value, int):
        return value if abs(value) < MOST_INTEGER else None
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return None
