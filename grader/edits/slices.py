"""What decides about a line: the names in it, what is assigned to them, and the numbers in that."""

import ast
from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Final, NamedTuple

from grader.edits.tree import Edit, ParsedScript

_MOST_STEPS: Final = 5
_MOST_NUMBERS: Final = 40
_MOST_FOLLOWED: Final = 60
_MOST_EXPRESSIONS: Final = 600
Functions = ast.FunctionDef | ast.AsyncFunctionDef


class NumberUse(NamedTuple):
    """A number that a line depends on. `steps`: over so many assignments. `sign`: -1 behind a minus sign."""

    node: ast.expr
    value: float
    steps: int


class NameSet(NamedTuple):
    """An assignment: its statement, the dotted name that it sets, and what it sets it to."""

    statement: ast.stmt
    target: str
    value: ast.expr


def dotted(node: ast.AST | None) -> str:
    """Return a name with its attributes (``self.msg.linear.x``); empty for what is no name."""
    parts: list[str] = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
    if not isinstance(node, ast.Name):
        return ""
    return ".".join((node.id, *reversed(parts)))


def callee(node: ast.AST | None) -> str:
    """Return the dotted name of what a call calls; empty for what is no such call."""
    return dotted(node.func) if isinstance(node, ast.Call) else ""


@lru_cache(maxsize=2)  # every operator asks
def assignments(script: ParsedScript) -> tuple[NameSet, ...]:
    """Return all assignments to names and attributes, in the order of the text."""
    found: list[NameSet] = []
    for node in ast.walk(script.tree):
        if isinstance(node, ast.Assign):
            for target in node.targets:
                found += _pairs(node, target, node.value)
        elif isinstance(node, ast.AnnAssign | ast.AugAssign) and node.value is not None:
            found += _pairs(node, node.target, node.value)
    return tuple(sorted(found, key=lambda one: one.statement.lineno))


def _pairs(statement: ast.stmt, target: ast.expr, value: ast.expr) -> Iterator[NameSet]:
    if isinstance(target, ast.Tuple | ast.List):
        values = value.elts if isinstance(value, ast.Tuple | ast.List) else []
        if len(values) == len(target.elts):
            for one, given in zip(target.elts, values, strict=True):
                yield from _pairs(statement, one, given)
    elif name := dotted(target):
        yield NameSet(statement, name, value)


def is_read(script: ParsedScript, node: ast.AST) -> bool:
    """Whether a name stands where its value is asked for, and not where it is set."""
    parent = script.parent(node)
    return not isinstance(parent, ast.Assign) or all(one is not node for one in parent.targets)


def mentions(part: ast.AST, name: str) -> bool:
    """Whether a name stands somewhere in a part of the script."""
    return any(dotted(node) == name for node in ast.walk(part))


def heads(script: ParsedScript, statement: ast.stmt) -> Iterator[ast.expr]:
    """Yield what decides whether and how often a statement runs, up to its function: tests, what loops go over."""
    for node in script.around(statement):
        if isinstance(node, ast.While | ast.If):
            yield node.test
        elif isinstance(node, ast.For):
            yield node.iter
        elif isinstance(node, Functions | ast.ClassDef):
            return


def own_parts(statement: ast.stmt) -> list[ast.AST]:
    """Return the parts of a statement without the blocks in it."""
    if isinstance(statement, ast.While | ast.If):
        return [statement.test]
    if isinstance(statement, ast.For):
        return [statement.target, statement.iter]
    if isinstance(statement, ast.With):
        return [item.context_expr for item in statement.items]
    if isinstance(statement, Functions):
        return [*statement.args.defaults]
    return [] if isinstance(statement, ast.ClassDef | ast.Try) else [statement]


def numbers_behind(script: ParsedScript, lines: Iterable[int]) -> list[NumberUse]:
    """Return the numbers that the given lines depend on, nearest first."""
    numbers = [
        NumberUse(node, value, steps)
        for node, steps in expressions_behind(script, lines)
        if (value := number_of(node)) is not None and not _is_part_of_number(script, node)
    ]
    return numbers[:_MOST_NUMBERS]


def expressions_behind(script: ParsedScript, lines: Iterable[int]) -> list[tuple[ast.expr, int]]:
    """Return all expressions that the given lines depend on, with over how many assignments, nearest first."""
    known = [_as_attribute(script, one) for one in assignments(script)]
    waiting: list[tuple[ast.AST, int]] = []
    for line in lines:
        for statement in statements_over(script, line):
            waiting += [(part, 0) for part in own_parts(statement)]
            waiting += [(head, 0) for head in heads(script, statement)]
    expressions: dict[int, tuple[ast.expr, int]] = {}
    followed: set[str] = set()
    left = _MOST_FOLLOWED
    while waiting and len(expressions) < _MOST_EXPRESSIONS:
        part, steps = waiting.pop(0)
        for node in ast.walk(part):
            if isinstance(node, ast.expr):
                expressions.setdefault(id(node), (node, steps))
        if steps >= _MOST_STEPS:
            continue
        waiting += [(one, steps + 1) for one in _declared(script, part)]
        for name in _names(part):
            if name in followed or left <= 0:
                continue
            left -= 1
            followed.add(name)
            waiting += [(one, steps + 1) for one in _behind(script, known, name)]
    return list(expressions.values())


def _behind(script: ParsedScript, known: list[NameSet], name: str) -> Iterator[ast.expr]:
    """Yield what gives a name its values, and the tests that decide whether it does."""
    for one in known:
        if _sets(one, name):
            yield one.value
            yield from _tests(script, one.statement)
    yield from (over for target, over in _loops(script) if name == target)
    for given in (_defaults, _arguments, _returned):
        yield from given(script, name)


def number_of(node: ast.AST) -> float | None:
    """Return the value of a number in the text, also behind a minus sign; None for anything else."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        inner = number_of(node.operand)
        return None if inner is None else -inner
    if (
        isinstance(node, ast.Constant)
        and isinstance(node.value, int | float)
        and not isinstance(node.value, bool)
    ):
        return float(node.value)
    return None


def known_number(script: ParsedScript, node: ast.expr) -> float | None:
    """Return the value of a number, or of a name that is set once, to a number; None for anything else."""
    return number_of(set_once(script, node))


def set_once(script: ParsedScript, node: ast.expr) -> ast.expr:
    """Return what a name that is set once is set to; for anything else the node itself."""
    values = [one.value for one in assignments(script) if one.target == dotted(node)]
    return values[0] if len(values) == 1 else node


def _is_part_of_number(script: ParsedScript, node: ast.expr) -> bool:
    parent = script.parent(node)
    return isinstance(parent, ast.UnaryOp) and number_of(parent) is not None


def statements_over(script: ParsedScript, line: int) -> list[ast.stmt]:
    """Return the innermost statement that covers a line, or all that begin there."""
    if begun := script.statements_on(line):
        return begun
    covering = [
        node
        for node in ast.walk(script.tree)
        if isinstance(node, ast.stmt) and node.lineno < line <= (node.end_lineno or node.lineno)
    ]
    return covering and [max(covering, key=lambda node: node.lineno)]


def _names(part: ast.AST) -> Iterator[str]:
    """Yield the names in a part: an attribute as a whole, a plain name, and a function that is called."""
    for node in ast.walk(part):
        if isinstance(node, ast.Name) and node.id != "self":
            yield node.id
        elif isinstance(node, ast.Attribute):
            yield dotted(node) or node.attr


def _as_attribute(script: ParsedScript, one: NameSet) -> NameSet:
    """Return an assignment in the body of a class as one to an attribute of its objects."""
    in_class = isinstance(script.parent(one.statement), ast.ClassDef)
    return one._replace(target=f"self.{one.target}") if in_class else one


def _sets(one: NameSet, name: str) -> bool:
    """Whether an assignment changes what `name` stands for: itself, or a field of it.

    ``node.SPEED`` is what the class of the node calls ``self.SPEED``.
    """
    target, named = one.target.split("."), name.split(".")
    if len(named) == 1 or len(target) == 1:
        return target[0] == name
    return target[1] == named[1] and (target[0] == named[0] or "self" in (target[0], named[0]))


def _tests(script: ParsedScript, statement: ast.stmt) -> Iterator[ast.expr]:
    """Yield the tests of the branches that a statement stands in, up to its function or loop."""
    for node in script.around(statement):
        if isinstance(node, ast.If):
            yield node.test
        elif not isinstance(node, ast.With | ast.Try):
            return


@lru_cache(maxsize=2)  # as `assignments`
def _loops(script: ParsedScript) -> tuple[tuple[str, ast.expr], ...]:
    loops = (node for node in ast.walk(script.tree) if isinstance(node, ast.For | ast.comprehension))
    return tuple((dotted(target), one.iter) for one in loops for target in ast.walk(one.target))


def _declared(script: ParsedScript, part: ast.AST) -> Iterator[ast.expr]:
    """Yield the defaults of the parameters that a part asks for by name."""
    for node in ast.walk(part):
        if isinstance(node, ast.Call) and dotted(node.func).endswith("get_parameter") and node.args:
            name = getattr(node.args[0], "value", None)
            for call in calls_of(script, "declare_parameter"):
                if len(call.args) > 1 and getattr(call.args[0], "value", None) == name:
                    yield call.args[1]


@lru_cache(maxsize=2)  # as `assignments`
def functions_of(script: ParsedScript) -> tuple[Functions, ...]:
    """Return the functions and methods that a script defines."""
    return tuple(node for node in ast.walk(script.tree) if isinstance(node, Functions))


@lru_cache(maxsize=2)  # as `assignments`
def classes_of(script: ParsedScript) -> tuple[ast.ClassDef, ...]:
    """Return the classes that a script defines."""
    return tuple(node for node in ast.walk(script.tree) if isinstance(node, ast.ClassDef))


def _defaults(script: ParsedScript, name: str) -> Iterator[ast.expr]:
    """Yield the default values of parameters called `name`."""
    for function in functions_of(script):
        arguments = [*function.args.posonlyargs, *function.args.args]
        given = zip(reversed(arguments), reversed(function.args.defaults), strict=False)
        yield from (default for argument, default in given if argument.arg == name)


def _arguments(script: ParsedScript, name: str) -> Iterator[ast.expr]:
    """Yield what callers give for parameters called `name`."""
    for function in functions_of(script):
        names = [one.arg for one in (*function.args.posonlyargs, *function.args.args)]
        if name not in names:
            continue
        place = names.index(name) - (names[:1] == ["self"])
        for call in calls_of(script, function.name):
            if place < len(call.args):
                yield call.args[place]
            yield from (one.value for one in call.keywords if one.arg == name)


def _returned(script: ParsedScript, name: str) -> Iterator[ast.expr]:
    """Yield what a function called `name` returns."""
    for function in functions_of(script):
        if function.name == name.rpartition(".")[2]:
            for node in ast.walk(function):
                if isinstance(node, ast.Return) and node.value is not None:
                    yield node.value


def calls_of(script: ParsedScript, *names: str) -> list[ast.Call]:
    """Return the calls of functions and methods of these names."""
    calls = _calls(script)
    return [call for name in names for call in calls.get(name, ())]


def named_in(calls: Iterable[ast.Call]) -> set[str]:
    """Return the names given to calls, such as those of callbacks, without what stands before the last dot."""
    given = (value for call in calls for value in (*call.args, *(one.value for one in call.keywords)))
    return {dotted(value).rpartition(".")[2] for value in given} - {""}


@lru_cache(maxsize=2)  # as `assignments`
def _calls(script: ParsedScript) -> dict[str, list[ast.Call]]:
    calls: dict[str, list[ast.Call]] = {}
    for node in ast.walk(script.tree):
        if isinstance(node, ast.Call):
            calls.setdefault(dotted(node.func).rpartition(".")[2], []).append(node)
    return calls


def makes_node(script: ParsedScript, one: NameSet) -> bool:
    """Whether an assignment makes a node."""
    maker = callee(one.value)
    return maker in {each.name for each in classes_of(script)} or maker.endswith(("create_node", "Node"))


def is_call(node: ast.AST, names: tuple[str, ...]) -> bool:
    """Whether a statement only calls something whose name ends in one of `names`."""
    return isinstance(node, ast.Expr) and callee(node.value).endswith(names)


def is_method(script: ParsedScript, node: ast.AST) -> bool:
    """Whether a node stands in a function that knows its object as ``self``."""
    inside = function_around(script, node)
    return inside is not None and [one.arg for one in inside.args.args[:1]] == ["self"]


def function_around(script: ParsedScript, node: ast.AST) -> Functions | None:
    """Return the innermost function around a node; None on the top level."""
    return next((one for one in script.around(node) if isinstance(one, Functions)), None)


def statement_around(script: ParsedScript, node: ast.AST) -> ast.stmt | None:
    """Return the innermost statement around a node, or the node itself if it is one."""
    return next((one for one in (node, *script.around(node)) if isinstance(one, ast.stmt)), None)


def imported(script: ParsedScript, module: str) -> list[Edit]:
    """Return the import of a module, if the script has none."""
    imports = [one for one in script.tree.body if isinstance(one, ast.Import)]
    has = any(name.name == module and name.asname is None for one in imports for name in one.names)
    return [] if has else [at_top(script, f"import {module}")]


def at_top(script: ParsedScript, line: str) -> Edit:
    """Return the edit that adds an import before the first one."""
    imports = [one for one in script.tree.body if isinstance(one, ast.Import | ast.ImportFrom)]
    return script.inserted_before(imports[0] if imports else script.tree.body[0], line)
