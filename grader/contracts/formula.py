"""Formulas: what an assignment computes from messages, in a small part of Python's own notation.

``2 * in.data``, ``all(each < 100 for each in out.sequence)``. A formula is read as Python is, and carried out
here, node by node. It has no attributes but the fields of messages, no names but those it is given, no functions
but `FUNCTIONS`, and no loop but over what is already there. Numbers, texts, lists and the work of one formula are
bounded, whatever a script sends, so that every formula ends soon and gives the same value anywhere.
"""

import ast
import math
import re
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from typing import Any, Final

MOST_CHARACTERS: Final = 400
MOST_WORK: Final = 50_000  # nodes carried out: a list of 4,096 numbers, looked at with three comparisons each
MOST_ITEMS: Final = 10_000
LARGEST: Final = 1 << 128
"""No whole number beyond it: the largest field of a message has 64 bits, and products of two still fit."""

_IN: Final = re.compile(r"\bin(?=\s*\.\s*[A-Za-z_])")
_FORMAT: Final = re.compile(r"0?\d{0,2}(\.\d{1,2})?[dfgs]?")

Value = Any
"""A number, a text, a truth value, None, a list, or the fields of a message."""


class FormulaError(ValueError):
    """A formula cannot be read, or has no value for what it was given."""


def matches(pattern: str, text: str) -> bool:
    """Return whether a text fits a pattern, in which ``#`` is a number and ``*`` any text."""
    reached = {0}  # how far in the text the pattern may have come
    parts = _parts(pattern)
    for index, part in enumerate(parts):
        if part == "*":
            if index == len(parts) - 2 and not parts[-1]:
                return bool(reached)
            reached = set(range(min(reached, default=len(text) + 1), len(text) + 1))
        elif part == "#":
            reached = {end for start in reached for end in _ends_of_number(text, start)}
        elif part:
            reached = {start + len(part) for start in reached if text.startswith(part, start)}
    return len(text) in reached


@lru_cache(maxsize=4_096)
def _parts(pattern: str) -> list[str]:
    return re.split(r"([#*])", pattern)


_NUMBER: Final = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?")


def _ends_of_number(text: str, start: int) -> Iterator[int]:
    """Yield where a number that begins there may end: before a dot that ends a sentence, too."""
    number = _NUMBER.match(text, start)
    if number is not None:
        yield number.end()
        if text[number.end() - 1] == ".":
            yield number.end() - 1


def _joined(between: str, texts: list[str]) -> str:
    if len(between) * len(texts) + sum(map(len, texts)) > 8 * MOST_ITEMS:
        raise FormulaError("too long a text")
    return between.join(texts)


def _near(one: float, other: float, tolerance: float = 1e-6) -> bool:
    return abs(one - other) <= tolerance


FUNCTIONS: Final[Mapping[str, Callable[..., Value]]] = {
    **{
        each.__name__: each
        for each in (abs, min, max, round, len, sum, all, any, sorted, int, float, str, list)
    },
    **{each.__name__: each for each in (math.sqrt, math.sin, math.cos, math.tan, math.atan2, math.hypot)},
    **{each.__name__: each for each in (math.floor, math.ceil, math.degrees, math.radians, math.isfinite)},
    "range": lambda *ends: (
        list(range(*ends)) if len(range(*ends)) <= MOST_ITEMS else _refuse("too long a range")
    ),
    "near": _near,
    "matches": matches,
    "lower": lambda text: text.lower(),
    "upper": lambda text: text.upper(),
    "strip": lambda text: text.strip(),
    "split": lambda text, *by: text.split(*by),
    "join": _joined,
}
"""What a formula may call. Formulas of steps also have ``draw`` and ``choose``."""

_CONSTANTS: Final[Mapping[str, Value]] = {"pi": math.pi, "tau": math.tau}


class Formula:
    """A formula that was read.

    Attributes:
        text: as it was written. names: what it must be given.
    """

    def __init__(self, text: str, names: frozenset[str], tree: ast.expr) -> None:
        self.text = text
        self.names = names
        self._tree = tree

    def value(
        self, names: Mapping[str, Value], functions: Mapping[str, Callable[..., Value]] | None = None
    ) -> Value:
        """Return the formula's value, given values for its names.

        `functions` take the place of `FUNCTIONS` or are added to them.

        Raises FormulaError: there is none, as for a quotient by zero or a field that is missing.
        """
        callables = FUNCTIONS if functions is None else {**FUNCTIONS, **functions}
        try:
            return _Evaluation({**_CONSTANTS, **names}, callables).of(self._tree)
        except FormulaError:
            raise
        except (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
            raise FormulaError(f"{self.text}: {error}") from None


@lru_cache(maxsize=4_096)
def formula(text: str) -> Formula:
    """Read a formula. Raises FormulaError: it is none; the message says what of Python it must not have."""
    if len(text) > MOST_CHARACTERS:
        raise FormulaError(f"longer than {MOST_CHARACTERS} characters")
    try:
        tree = ast.parse(_IN.sub("in_", text.strip()), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise FormulaError(f"cannot be read: {error}") from None
    names, bound = set[str](), set[str]()
    for node in ast.walk(tree):
        if type(node).__name__ not in _ALLOWED:
            raise FormulaError(f"{type(node).__name__} is not possible in a formula")
        _check(node)
        if isinstance(node, ast.Name):
            (names if isinstance(node.ctx, ast.Load) else bound).add(node.id)
    called = {
        node.func.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    for name in sorted(called - {*FUNCTIONS, "draw", "choose"}):
        raise FormulaError(f"there is no function {name}")
    return Formula(text, frozenset(names - bound - called - _CONSTANTS.keys()), tree)


def _check(node: ast.AST) -> None:
    """Refuse what the kinds of nodes allow, and a formula does not."""
    if isinstance(node, ast.Call) and (not isinstance(node.func, ast.Name) or node.keywords):
        raise FormulaError("only functions can be called, without named arguments")
    if isinstance(node, ast.Constant) and not isinstance(node.value, bool | int | float | str | type(None)):
        raise FormulaError(f"{node.value!r} is not possible in a formula")
    if isinstance(node, ast.comprehension) and (node.is_async or not isinstance(node.target, ast.Name)):
        raise FormulaError("a loop has one plain variable")
    if isinstance(node, ast.FormattedValue) and node.format_spec is not None:
        parts = [part.value for part in ast.walk(node.format_spec) if isinstance(part, ast.Constant)]
        written = "".join(map(str, parts))
        if not _FORMAT.fullmatch(written):
            raise FormulaError(f"the format {written!r} is not possible")


def _refuse(why: str) -> Value:
    raise FormulaError(why)


_ALLOWED: Final = frozenset(
    each.__name__
    for each in (
        *(
            ast.Constant,
            ast.Name,
            ast.Load,
            ast.Store,
            ast.Attribute,
            ast.Subscript,
            ast.Slice,
            ast.IfExp,
            ast.Call,
        ),
        *(ast.BinOp, ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod, ast.Pow),
        *(ast.UnaryOp, ast.UAdd, ast.USub, ast.Not, ast.BoolOp, ast.And, ast.Or),
        *(
            ast.Compare,
            ast.Eq,
            ast.NotEq,
            ast.Lt,
            ast.LtE,
            ast.Gt,
            ast.GtE,
            ast.In,
            ast.NotIn,
            ast.Is,
            ast.IsNot,
        ),
        *(
            ast.List,
            ast.Tuple,
            ast.ListComp,
            ast.GeneratorExp,
            ast.comprehension,
            ast.JoinedStr,
            ast.FormattedValue,
        ),
    )
)

_OPERATIONS: Final[Mapping[type, Callable[[Any, Any], Value]]] = {
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
    ast.FloorDiv: lambda a, b: a // b,
    ast.Mod: lambda a, b: a % b,
}
_COMPARISONS: Final[Mapping[type, Callable[[Any, Any], bool]]] = {
    ast.Eq: lambda a, b: bool(a == b),
    ast.NotEq: lambda a, b: bool(a != b),
    ast.Lt: lambda a, b: bool(a < b),
    ast.LtE: lambda a, b: bool(a <= b),
    ast.Gt: lambda a, b: bool(a > b),
    ast.GtE: lambda a, b: bool(a >= b),
    ast.In: lambda a, b: a in b,
    ast.NotIn: lambda a, b: a not in b,
    ast.Is: lambda a, b: a is b,
    ast.IsNot: lambda a, b: a is not b,
}


class _Evaluation:
    """One computation of a formula's value."""

    def __init__(self, names: dict[str, Value], functions: Mapping[str, Callable[..., Value]]) -> None:
        self._names = names
        self._functions = functions
        self._work = 0

    def of(self, node: ast.AST) -> Value:
        """Return the value of a node."""
        self._work += 1
        if self._work > MOST_WORK:
            raise FormulaError("takes too long")
        value: Value = _METHODS[type(node)](self, node)
        return value if type(value) in _PLAIN else _bounded(value)

    def _constant(self, node: ast.Constant) -> Value:
        return node.value

    def _name(self, node: ast.Name) -> Value:
        if node.id not in self._names:
            raise FormulaError(f"{'in' if node.id == 'in_' else node.id} is not known here")
        return self._names[node.id]

    def _attribute(self, node: ast.Attribute) -> Value:
        owner = self.of(node.value)
        if not isinstance(owner, Mapping) or node.attr not in owner:
            raise FormulaError(f"there is no field {node.attr}")
        return owner[node.attr]

    def _subscript(self, node: ast.Subscript) -> Value:
        owner = self.of(node.value)
        if not isinstance(node.slice, ast.Slice):
            return owner[self.of(node.slice)]
        ends = (node.slice.lower, node.slice.upper, node.slice.step)
        return owner[slice(*(None if end is None else self.of(end) for end in ends))]

    def _binop(self, node: ast.BinOp) -> Value:
        left, right = self.of(node.left), self.of(node.right)
        if isinstance(node.op, ast.Add):
            return left + right
        if not isinstance(left, int | float) or not isinstance(right, int | float):
            raise FormulaError("only numbers can be subtracted, multiplied and divided")
        if isinstance(node.op, ast.Pow):
            return float(left) ** right if abs(right) > 64 or isinstance(right, float) else left**right
        return _OPERATIONS[type(node.op)](left, right)

    def _unaryop(self, node: ast.UnaryOp) -> Value:
        value = self.of(node.operand)
        if isinstance(node.op, ast.Not):
            return not value
        return -value if isinstance(node.op, ast.USub) else value

    def _boolop(self, node: ast.BoolOp) -> Value:
        stops = isinstance(node.op, ast.Or)
        value: Value = None
        for operand in node.values:
            value = self.of(operand)
            if bool(value) is stops:
                break
        return value

    def _compare(self, node: ast.Compare) -> bool:
        left = self.of(node.left)
        for operation, right_node in zip(node.ops, node.comparators, strict=True):
            right = self.of(right_node)
            if not _COMPARISONS[type(operation)](left, right):
                return False
            left = right
        return True

    def _ifexp(self, node: ast.IfExp) -> Value:
        return self.of(node.body if self.of(node.test) else node.orelse)

    def _call(self, node: ast.Call) -> Value:
        assert isinstance(node.func, ast.Name)
        arguments = [self.of(arg) for arg in node.args]
        if node.func.id not in self._functions:
            raise FormulaError(f"{node.func.id} is only for the values of steps")
        self._work += sum(len(argument) for argument in arguments if isinstance(argument, list | str)) // 8
        return self._functions[node.func.id](*arguments)

    def _list(self, node: ast.List) -> list[Value]:
        return [self.of(element) for element in node.elts]

    def _tuple(self, node: ast.Tuple) -> list[Value]:
        return [self.of(element) for element in node.elts]

    def _listcomp(self, node: ast.ListComp | ast.GeneratorExp) -> list[Value]:
        return list(self._loop(node.elt, node.generators))

    _generatorexp = _listcomp

    def _loop(self, wanted: ast.expr, loops: list[ast.comprehension]) -> Iterator[Value]:
        if not loops:
            yield self.of(wanted)
            return
        first, *others = loops
        assert isinstance(first.target, ast.Name)
        outer = dict(self._names)
        for value in self.of(first.iter):
            self._names[first.target.id] = value
            if all(self.of(condition) for condition in first.ifs):
                yield from self._loop(wanted, others)
        self._names = outer

    def _joinedstr(self, node: ast.JoinedStr) -> str:
        return "".join(self.of(part) for part in node.values)

    def _formattedvalue(self, node: ast.FormattedValue) -> str:
        value = self.of(node.value)
        return format(value, "" if node.format_spec is None else self.of(node.format_spec))


_METHODS: Final[Mapping[type, Callable[[_Evaluation, Any], Value]]] = {
    kind: getattr(_Evaluation, f"_{kind.__name__.lower()}")
    for kind in (
        *(
            ast.Constant,
            ast.Name,
            ast.Attribute,
            ast.Subscript,
            ast.BinOp,
            ast.UnaryOp,
            ast.BoolOp,
            ast.Compare,
        ),
        *(ast.IfExp, ast.Call, ast.List, ast.Tuple, ast.ListComp, ast.GeneratorExp, ast.JoinedStr),
        ast.FormattedValue,
    )
}
_PLAIN: Final = frozenset({bool, float, type(None)})
"""Types whose values need no bound."""


def _bounded(value: Value) -> Value:
    """Return a value; bytes, as the fields of messages have them, as a list of numbers."""
    if isinstance(value, bytes):
        return list(value)
    if isinstance(value, int) and not -LARGEST < value < LARGEST:
        raise FormulaError("too large a number")
    if isinstance(value, list | str) and len(value) > 8 * MOST_ITEMS:
        raise FormulaError("too long a text or list")
    if isinstance(value, complex):
        raise FormulaError("no real number")
    return value
