"""Checkpoints in the `while` loops of a script.

A loop that neither blocks nor asks anything (``while not done: pass``) would keep the processor for ever,
since threads switch only in the kernel. Each turn of a `while` loop therefore begins with a call of
`CHECKPOINT`, placed on the line of the loop's head; nothing else of the program changes.
"""

import _ast
from types import CodeType

CHECKPOINT = "__while_checkpoint__"
"""Name of the function called; the runner puts it among the builtins."""

_PyCF_ONLY_AST = 0x400
_BODIES = ("body", "orelse", "finalbody", "handlers", "cases")


def compile_script(source: bytes, file_name: str) -> CodeType:
    """Compile `source` as Python does (PEP 263 codings, byte order mark, line ends), with checkpoints.

    Raises:
        SyntaxError, ValueError, RecursionError, MemoryError, OverflowError: as `compile` does.
    """
    if b"while" not in source:
        return _compile(source, file_name)
    try:
        tree = compile(source, file_name, "exec", _PyCF_ONLY_AST, dont_inherit=True)
        _mark(tree)
        return _compile(tree, file_name)
    except RecursionError:
        # The detour over the tree nests deeper than Python's own way.
        return _compile(source, file_name)


def _compile(source: bytes | _ast.AST, file_name: str) -> CodeType:
    code: CodeType = compile(source, file_name, "exec", dont_inherit=True)  # type: ignore[call-overload]
    return code


def _mark(tree: _ast.AST) -> None:
    """Insert a checkpoint into every `while` loop below `tree`; only statements can hold one."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        for field in _BODIES:
            children = getattr(node, field, None)
            if isinstance(children, list):
                waiting.extend(children)
        if isinstance(node, _ast.While):
            node.body.insert(0, _checkpoint(node.test))


def _checkpoint(head: _ast.expr) -> _ast.Expr:
    place = {
        "lineno": head.lineno,
        "col_offset": head.col_offset,
        "end_lineno": head.end_lineno,
        "end_col_offset": head.end_col_offset,
    }
    name = _ast.Name(id=CHECKPOINT, ctx=_ast.Load(), **place)
    call = _ast.Call(func=name, args=[], keywords=[], **place)
    return _ast.Expr(value=call, **place)
