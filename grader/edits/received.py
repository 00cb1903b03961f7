"""The facts of a traced run, as the jail wrote them: the syntax tree, and the ledger of motions.

Both are decoded strictly and bounded by the episode that took them. The tree was written before the script's first
line ran; the ledger may be falsified by the script, so nothing but words may depend on it.
"""

import ast
from typing import Final

from grader.contracts.errors import ProtocolError
from grader.contracts.record import Record, field, from_json
from grader.edits.tree import ParsedScript

_Plain = bool | int | float | str | list[str] | None
_Row = tuple[str, int, str, tuple[int, int, int, int] | None, dict[str, _Plain]]

_MOST_NODES: Final = 3_000  # several times what beginners write: operators look at much with much
_KINDS: Final = {
    name: kind
    for name, kind in vars(ast).items()
    if isinstance(kind, type) and issubclass(kind, ast.AST) and kind.__module__ in ("ast", "_ast")
}
_LISTS: Final = frozenset(
    """args bases body cases comparators decorator_list defaults elts finalbody generators handlers ifs items keys
    keywords kw_defaults kwd_attrs kwd_patterns kwonlyargs names ops orelse patterns posonlyargs targets
    type_ignores type_params values""".split()  # noqa: SIM905 - ten lines shorter
)
_TEXTS: Final = frozenset(("arg", "attr", "id"))


class Motion(Record):
    """A row of equal commands that one line published.

    Attributes:
        v, w: m/s and rad/s. line: of the publish; 0: not the script's own. t, until: ns of the first and the last.
        stack: the lines that led there, from the inside out: line, function, and the numbers of its names.
        waits: per line for how long it kept the script waiting until the next motion: times and ns.
    """

    v: float
    w: float
    line: int
    t: int
    until: int
    times: int
    topic: str
    stack: tuple[tuple[int, str, dict[str, float]], ...] = ()
    waits: dict[int, tuple[int, int]] = field(default_factory=dict)

    @property
    def is_stop(self) -> bool:
        """Whether the car is told to stand still."""
        return self.v == 0.0 and self.w == 0.0

    @property
    def lines(self) -> tuple[int, ...]:
        """The lines that decide about this motion: those that led to it, and those that waited in it."""
        return tuple(dict.fromkeys((*(row[0] for row in self.stack), *self.waits)))


class Ledger(Record):
    """What the script's lines did.

    Attributes:
        ran: the lines that ran. whole: whether no line was left out of them.
        end: where the main thread was at the horizon's Ctrl+C, as a motion's `stack`.
    """

    ran: frozenset[int] = frozenset()
    motions: tuple[Motion, ...] = ()
    end: tuple[tuple[int, str, dict[str, float]], ...] = ()
    whole: bool = True


def received_ledger(content: bytes) -> Ledger:
    """Return the ledger; an empty one where none came.

    Raises ProtocolError: it is not one.
    """
    if not content:
        return Ledger()
    try:
        return from_json(Ledger, content)
    except (ValueError, RecursionError) as error:
        raise ProtocolError(f"FACTS.ledger: {error}") from None


def received_script(text: str, content: bytes) -> ParsedScript | None:
    """Return the script's text with its tree; None where no tree came.

    Raises ProtocolError: it is no tree of this text.
    """
    if not content:
        return None
    try:
        rows = from_json(list[_Row], content)
    except (ValueError, RecursionError) as error:
        raise ProtocolError(f"FACTS.tree: {error}") from None
    if not 1 <= len(rows) <= _MOST_NODES or rows[0][:2] != ("Module", -1):
        raise ProtocolError("FACTS.tree has too many rows, or does not begin with a module")
    nodes: list[ast.AST] = []
    for number, row in enumerate(rows):
        node = _node(row)
        if number:
            _hang(nodes, row, node)
        nodes.append(node)
    script = ParsedScript(text, nodes[0])  # type: ignore[arg-type] # the first row is a module
    for node in nodes:
        if isinstance(node, ast.expr | ast.stmt):
            _check_place(script, node)
    return script


def _node(row: _Row) -> ast.AST:
    name, _, _, place, plain = row
    kind = _KINDS.get(name)
    if kind is None or not set(plain) <= set(kind._fields):
        raise ProtocolError(f"FACTS.tree has an unknown node {name[:40]!r}")
    for text in _TEXTS & set(kind._fields):
        if not isinstance(plain.get(text), str) and not (name == "keyword" and plain.get(text) is None):
            raise ProtocolError(f"FACTS.tree.{name}.{text} is no text")
    node: ast.AST = kind()
    for one in kind._fields:
        setattr(node, one, plain.get(one, [] if one in _LISTS and not _is_lone(name, one) else None))
    if issubclass(kind, ast.expr | ast.stmt) != (place is not None) and place is None:
        raise ProtocolError(f"FACTS.tree.{name} has no place")
    if place is not None:
        for attribute, value in zip(
            ("lineno", "col_offset", "end_lineno", "end_col_offset"), place, strict=True
        ):
            setattr(node, attribute, value)
    return node


def _is_lone(kind: str, name: str) -> bool:
    """Whether a field whose name is mostly a list's holds one node here."""
    return (kind, name) in {
        ("Lambda", "args"),
        ("Lambda", "body"),
        ("FunctionDef", "args"),
        ("AsyncFunctionDef", "args"),
        ("IfExp", "body"),
        ("IfExp", "orelse"),
        ("Expression", "body"),
    }


def _hang(nodes: list[ast.AST], row: _Row, node: ast.AST) -> None:
    """Put a node below its parent, which came before it."""
    _, above, name, _, _ = row
    if not 0 <= above < len(nodes) or name not in nodes[above]._fields:
        raise ProtocolError("FACTS.tree has a node without a parent")
    parent = nodes[above]
    held = getattr(parent, name)
    if isinstance(held, list):
        held.append(node)
    elif held is None:
        setattr(parent, name, node)
    else:
        raise ProtocolError(f"FACTS.tree has two nodes for {name}")


def _check_place(script: ParsedScript, node: ast.expr | ast.stmt) -> None:
    try:
        start, end = script.span(node)
    except ValueError as error:
        raise ProtocolError(f"FACTS.tree: {error}") from None
    if start > end:
        raise ProtocolError("FACTS.tree has a node that ends before it begins")
