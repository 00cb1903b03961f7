"""A script's text and its syntax tree together: from a node to its characters, and from edits to the new text."""

import ast
import difflib
import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from grader.contracts.python import Self

_LINE_END = re.compile(r"\r\n|\r|\n")


class Edit(NamedTuple):
    """Replaces the characters from `start` up to `end` by `text`; with `start == end` it only inserts."""

    start: int
    end: int
    text: str


class ChangedLine(NamedTuple):
    """A line before and after a change; None: there was none, or there is none any more.

    Attributes:
        number: 1-based, in the text before; of a new line the number of the line that it follows.
    """

    number: int
    before: str | None
    after: str | None


class ParsedScript:
    """A text and its tree. Positions in the tree count bytes of UTF-8, as Python's do; edits count characters."""

    def __init__(self, text: str, tree: ast.Module) -> None:
        self.text = text
        self.tree = tree
        ends = [found.end() for found in _LINE_END.finditer(text)]
        self._starts = [0, *ends]
        self._parents: dict[ast.AST, ast.AST] | None = None
        self._begun: dict[int, list[ast.stmt]] | None = None

    @classmethod
    def parsed(cls, text: str) -> Self:
        """Return a trusted text with its tree.

        Raises SyntaxError: it is not Python.
        """
        return cls(text, ast.parse(text))

    def line(self, number: int) -> str:
        """Return the text of a line (1-based) without its end; empty behind the last one."""
        if not 1 <= number <= len(self._starts):
            return ""
        start = self._starts[number - 1]
        ending = _LINE_END.search(self.text, start)
        return self.text[start : ending.start() if ending else len(self.text)]

    def span(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        """Return the characters that a node covers, as start and end.

        Raises ValueError: the node has no place in this text.
        """
        if node.end_lineno is None or node.end_col_offset is None:
            raise ValueError("the node has no end")
        return self._offset(node.lineno, node.col_offset), self._offset(node.end_lineno, node.end_col_offset)

    def source(self, node: ast.expr | ast.stmt) -> str:
        """Return the text that a node covers."""
        start, end = self.span(node)
        return self.text[start:end]

    def replaced(self, node: ast.expr | ast.stmt, text: str) -> Edit:
        """Return the edit that puts `text` in the place of a node."""
        return Edit(*self.span(node), text)

    def removed(self, statement: ast.stmt) -> Edit:
        """Return the edit that takes a statement out: its lines, or `pass` if its block holds nothing else."""
        block = self.block_of(statement)
        if len(block) == 1:
            return self.replaced(statement, "pass")
        start, end = self.span(statement)
        first, last = (
            self.line_start(statement.lineno),
            self._line_end(statement.end_lineno or statement.lineno),
        )
        alone = not self.text[first:start].strip() and not self.text[end:last].partition("#")[0].strip()
        return Edit(first, last, "") if alone else Edit(start, end, "pass")

    def inserted_after(self, statement: ast.stmt, *lines: str) -> Edit:
        """Return the edit that adds lines behind a statement, indented as it is."""
        return self._inserted(self._line_end(statement.end_lineno or statement.lineno), statement, lines)

    def inserted_before(self, statement: ast.stmt, *lines: str) -> Edit:
        """Return the edit that adds lines before a statement, indented as it is."""
        first = min(
            (one.lineno for one in getattr(statement, "decorator_list", ())), default=statement.lineno
        )
        return self._inserted(self.line_start(first), statement, lines)

    def block_of(self, statement: ast.stmt) -> list[ast.stmt]:
        """Return the statements of the block that a statement stands in."""
        parent = self.parent(statement) or self.tree
        for _, value in ast.iter_fields(parent):
            if isinstance(value, list) and any(one is statement for one in value):
                return value
        return [statement]

    def behind(self, statement: ast.stmt) -> list[ast.stmt]:
        """Return the statements behind one in its block."""
        block = self.block_of(statement)
        return block[next(i for i, one in enumerate(block) if one is statement) + 1 :]

    def parent(self, node: ast.AST) -> ast.AST | None:
        """Return the node around `node`; None around the module."""
        if self._parents is None:
            self._parents = {
                child: parent for parent in ast.walk(self.tree) for child in ast.iter_child_nodes(parent)
            }
        return self._parents.get(node)

    def around(self, node: ast.AST) -> Iterator[ast.AST]:
        """Yield the nodes around `node`, from the inside out."""
        while (parent := self.parent(node)) is not None:
            yield parent
            node = parent

    def statements_on(self, line: int) -> list[ast.stmt]:
        """Return the statements that begin on a line."""
        if self._begun is None:
            self._begun = {}
            for node in ast.walk(self.tree):
                if isinstance(node, ast.stmt):
                    self._begun.setdefault(node.lineno, []).append(node)
        return self._begun.get(line, [])

    def _inserted(self, at: int, beside: ast.stmt, lines: Iterable[str]) -> Edit:
        indent = re.match(r"[ \t]*", self.line(beside.lineno))
        added = "".join(f"{indent[0] if indent else ''}{line}\n" for line in lines)
        is_open = at == len(self.text) and not self.text.endswith(("\n", "\r"))
        return Edit(at, at, "\n" + added if is_open else added)

    def line_start(self, number: int) -> int:
        """Return where a line (1-based) begins."""
        return self._starts[number - 1]

    def _line_end(self, number: int) -> int:
        """Return where the line behind `number` starts."""
        return self._starts[number] if number < len(self._starts) else len(self.text)

    def _offset(self, line: int, column: int) -> int:
        if not 1 <= line <= len(self._starts):
            raise ValueError(f"line {line} is not in the text")
        start = self.line_start(line)
        written = self.text[start : self._line_end(line)]
        if written.isascii():
            return start + min(column, len(written))
        return start + len(written.encode()[:column].decode("utf-8", "ignore"))


def applied(text: str, edits: Iterable[Edit]) -> str:
    """Return `text` with all edits made. Insertions at one place keep their order.

    Raises ValueError: an edit is outside of the text, or two overlap.
    """
    pieces: list[str] = []
    at = 0
    for start, end, new in sorted(edits, key=lambda edit: (edit.start, edit.end)):
        if not at <= start <= end <= len(text):
            raise ValueError("edits overlap, or are outside of the text")
        pieces += (text[at:start], new)
        at = end
    return "".join((*pieces, text[at:]))


def changed_lines(before: str, after: str) -> tuple[ChangedLine, ...]:
    """Return the lines in which two texts differ, in the order of the text."""
    old, new = _LINE_END.split(before), _LINE_END.split(after)
    changes: list[ChangedLine] = []
    for kind, a, b, c, d in difflib.SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        if kind == "equal":
            continue
        for i in range(max(b - a, d - c)):
            number = min(a + i + 1, b) if b > a else a
            changes.append(
                ChangedLine(number, old[a + i] if a + i < b else None, new[c + i] if c + i < d else None)
            )
    return tuple(changes)
