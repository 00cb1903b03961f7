"""The line on which an exception ended a script, and proposals about it."""

import ast
from collections.abc import Iterable
from typing import Final

from grader.contracts.outcome import StudentError
from grader.edits.situation import Proposal, Situation
from grader.edits.slices import assignments, statements_over
from grader.edits.tree import Edit

_MOST_NODES: Final = 60


class FailingLine:
    """The failing line: its nodes, and proposals about them."""

    def __init__(self, seen: Situation, error: StudentError, line: int) -> None:
        self.seen = seen
        self.script = seen.script
        self.error = error
        self.line = line
        self.statements = statements_over(seen.script, line)
        own = [
            node
            for statement in self.statements
            for node in ast.walk(statement)
            if isinstance(node, ast.expr)
        ]
        self.nodes = [node for node in own if node.lineno <= line <= (node.end_lineno or 0)][:_MOST_NODES]
        self.calls = [node for node in self.nodes if isinstance(node, ast.Call)]
        self.known = assignments(seen.script)

    def proposal(
        self, code: str, cost: float, edits: Iterable[Edit], line: int, **values: object
    ) -> Proposal:
        """Return a proposal whose sentence names the exception; each edit is made once."""
        values = {"line": line, "error": self.error.type, **values}
        return Proposal(code, cost, tuple(dict.fromkeys(edits)), values)

    def mended(self, cost: float, node: ast.expr | ast.stmt, new: str, *others: Edit) -> Proposal:
        """Return the proposal that puts `new` in the place of a node."""
        old = self.script.source(node)
        edits = (self.script.replaced(node, new), *others)
        return self.proposal("mended", cost, edits, node.lineno, old=old.partition("\n")[0], new=new)

    def added(self, cost: float, edit: Edit, line: int, new: str) -> Proposal:
        """Return the proposal that adds a line."""
        return self.proposal("added", cost, (edit,), line, new=new)

    def headed(self, cost: float, function: ast.stmt, head: str, *others: Edit) -> Proposal:
        """Return the proposal of another first line of a `def` or `class`."""
        line = self.script.line(function.lineno)
        start = self.script.span(function)[0]
        end = start + len(line.rstrip()) - (len(line) - len(line.lstrip()))
        edits = (Edit(start, end, head), *others)
        return self.proposal("mended", cost, edits, function.lineno, old=line.strip(), new=head)
