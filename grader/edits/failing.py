"""The line on which an exception ended a script, and proposals about it."""

import ast
from collections.abc import Iterator
from typing import Final

from grader.contracts.outcome import StudentError
from grader.edits.situation import Proposal, Situation
from grader.edits.slices import NameSet, assignments, dotted
from grader.edits.tree import Edit, ParsedScript

Functions: Final = (ast.FunctionDef, ast.AsyncFunctionDef)
_MOST_NODES: Final = 60


class FailingLine:
    """The failing line: its nodes, and proposals about them."""

    def __init__(self, seen: Situation, error: StudentError, line: int) -> None:
        self.seen = seen
        self.script = seen.script
        self.error = error
        self.line = line
        self.statements = (
            seen.script.statements_on(line)
            or [
                statement
                for statement in _statements(seen.script)
                if statement.lineno <= line <= (statement.end_lineno or 0)
            ][-1:]
        )
        own = [
            node
            for statement in self.statements
            for node in ast.walk(statement)
            if isinstance(node, ast.expr)
        ]
        self.nodes = [node for node in own if node.lineno <= line <= (node.end_lineno or 0)][:_MOST_NODES]
        self.calls = [node for node in self.nodes if isinstance(node, ast.Call)]
        self.known = assignments(seen.script)

    def mended(self, cost: float, node: ast.expr | ast.stmt, new: str, *others: Edit) -> Proposal:
        """Return the proposal that puts `new` in the place of a node."""
        old = self.script.source(node)
        values = {"line": node.lineno, "old": old.partition("\n")[0], "new": new, "error": self.error.type}
        return Proposal("mended", cost, (self.script.replaced(node, new), *others), values)

    def added(self, cost: float, edit: Edit, line: int, new: str) -> Proposal:
        """Return the proposal that adds a line."""
        return Proposal("added", cost, (edit,), {"line": line, "new": new, "error": self.error.type})

    def headed(self, cost: float, function: ast.stmt, head: str, *others: Edit) -> Proposal:
        """Return the proposal of another first line of a `def` or `class`."""
        line = self.script.line(function.lineno)
        start = self.script.span(function)[0]
        end = start + len(line.rstrip()) - (len(line) - len(line.lstrip()))
        values = {"line": function.lineno, "old": line.strip(), "new": head, "error": self.error.type}
        return Proposal("mended", cost, (Edit(start, end, head), *others), values)

    def function(self, node: ast.AST) -> "ast.FunctionDef | ast.AsyncFunctionDef | None":
        """Return the function around a node."""
        return next((one for one in self.script.around(node) if isinstance(one, Functions)), None)


def _statements(script: ParsedScript) -> Iterator[ast.stmt]:
    return (node for node in ast.walk(script.tree) if isinstance(node, ast.stmt))


def classes_of(script: ParsedScript) -> list[ast.ClassDef]:
    """Return the classes that a script defines."""
    return [node for node in ast.walk(script.tree) if isinstance(node, ast.ClassDef)]


def own_functions(script: ParsedScript) -> "list[ast.FunctionDef | ast.AsyncFunctionDef]":
    """Return the functions that a script defines."""
    return [node for node in ast.walk(script.tree) if isinstance(node, Functions)]


def makes_node(at: FailingLine, one: NameSet) -> bool:
    """Whether an assignment makes a node."""
    called = dotted(one.value.func) if isinstance(one.value, ast.Call) else ""
    return called in {each.name for each in classes_of(at.script)} or called.endswith(("create_node", "Node"))
