"""Checkpoints in the loops of a script that may never end.

A loop that neither blocks nor asks anything (``while not done: pass``) would keep the processor for ever,
since threads switch only in the kernel. Each turn of a `while` loop, and of a `for` loop over one of `ENDLESS`,
therefore begins with a call of `CHECKPOINT`, placed on the line of the loop's head. Other `for` loops end by
themselves and go without: computing takes no virtual time. An ``except`` for any error begins with a call of
`CAUGHT`, so that a report can tell what was hidden there. Nothing else of the program changes.
"""

from __future__ import annotations

import _ast

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import CodeType
    from typing import Any

CHECKPOINT = "__while_checkpoint__"
CAUGHT = "__tell_caught__"
"""Names of the functions called; the runner puts them among the builtins."""

ENDLESS = frozenset({"count", "cycle", "repeat", "iter"})
"""Functions (of itertools, and the builtin) by whose names a `for` loop that may never end is known."""

_ANY_ERROR = frozenset({"BaseException", "Exception"})
_WORDS = (b"while", b"except:", b"Exception", *(name.encode() for name in sorted(ENDLESS)))
_BODIES = ("body", "orelse", "finalbody", "handlers", "cases")


def compile_script(source: bytes, file_name: str) -> CodeType:
    """Compile `source` as Python does (PEP 263 codings, byte order mark, line ends), with checkpoints.

    Raises as `compile`.
    """
    if not any(word in source for word in _WORDS):
        return _compile(source, file_name)
    try:
        tree: Any = compile(source, file_name, "exec", _ast.PyCF_ONLY_AST, dont_inherit=True)
        _mark(tree)
        return _compile(tree, file_name)
    except RecursionError:
        # The detour over the tree nests deeper than Python's own way.
        return _compile(source, file_name)


def _compile(source: bytes | _ast.Module, file_name: str) -> CodeType:
    return compile(source, file_name, "exec", dont_inherit=True)


def _mark(tree: _ast.AST) -> None:
    """Insert the calls into every loop below `tree` that may never end, and every ``except`` for any error."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        for field in _BODIES:
            children = getattr(node, field, None)
            if isinstance(children, list):
                waiting.extend(children)
        if isinstance(node, _ast.While):
            node.body.insert(0, _call(CHECKPOINT, node.test))
        elif isinstance(node, _ast.For) and _is_endless(node.iter):
            node.body.insert(0, _call(CHECKPOINT, node.iter))
        elif isinstance(node, _ast.ExceptHandler) and _takes_any(node.type):
            node.body.insert(0, _call(CAUGHT, node))


def _is_endless(iterable: _ast.expr) -> bool:
    if not isinstance(iterable, _ast.Call):
        return False
    function = iterable.func
    name = function.attr if isinstance(function, _ast.Attribute) else getattr(function, "id", "")
    return name in ENDLESS


def _takes_any(kind: _ast.expr | None) -> bool:
    return kind is None or getattr(kind, "id", "") in _ANY_ERROR


def _call(function: str, head: Any) -> _ast.Expr:
    name = _ast.Name(function, _ast.Load())
    call = _ast.Call(name, [], [])
    statement = _ast.Expr(call)
    for node in (name, call, statement):
        node.lineno, node.col_offset = head.lineno, head.col_offset
        node.end_lineno, node.end_col_offset = head.end_lineno, head.end_col_offset
    return statement
