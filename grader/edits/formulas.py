"""Changes of the formulas behind a motion, where another operator or operand makes up for just what it was off.

A formula is computed from the numbers in the text. A change is proposed only if the formula's value, so changed,
differs by the factor between what the motion came to and what was wanted.
"""

import ast
import math
import re
from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

from grader.edits.situation import OFF_SHARE, Driven, Proposal, Situation, replacing
from grader.edits.slices import (
    Functions,
    NameSet,
    assignments,
    calls_of,
    dotted,
    expressions_behind,
    function_around,
    number_of,
)
from grader.edits.tree import ParsedScript

_CONVERSIONS: Final[dict[str, Callable[[float], float]]] = {
    "radians": math.radians,
    "deg2rad": math.radians,
    "degrees": math.degrees,
    "float": float,
    "abs": abs,
    "sqrt": math.sqrt,
}
_PI: Final = frozenset({"pi", "π"})
_TURNING: Final = re.compile(
    "turn|ang|rot|omega|yaw|theta|corner|zhuan|jiao|guai|转|角|(?:^|[_.])[wW]$", re.IGNORECASE
)
"""What a script calls the rate, the angle or the time of a turn."""
_ROLES: Final = {
    "time": re.compile(r"time|dur|sec|shi|时|(?:^|[_.])t(?:_|$)", re.IGNORECASE),
    "rate": re.compile(r"speed|vel|rate|omega|su|速|(?:^|[_.])[vw]$", re.IGNORECASE),
}
"""What a name of a time or a rate is made of."""
_MOST_DEPTH: Final = 30
_MOST_NAMES: Final = 12
_MOST_OFF: Final = 0.15
_SAME: Final = 1e-9
_STEP: Final = 0.1  # of cost, for each assignment between a formula and the motion


class _Rewritten(NamedTuple):
    """A formula as it might be meant: its text, its value against the present one, and how implausible that is."""

    text: str
    ratio: float
    cost: float
    kind: str = ""  # the same mistake in other formulas of the motion is of the same kind


def formula_changes(
    seen: Situation, driven: Driven, lines: tuple[int, ...], targets: list[tuple[float, float]]
) -> Iterator[Proposal]:
    """Yield the changes of formulas that explain a motion's size. `targets`: what it came to, and wanted."""
    if not targets:
        return
    values = Values(seen.script, driven)
    off = tolerance(driven)
    alike: dict[str, list[Proposal]] = {}
    for node, steps in expressions_behind(seen.script, lines):
        for new in (
            *_calculations(values, node),
            *_names(values, node),
            *_as_time(values, node, targets),
            *_turned(values, node, targets),
        ):
            for size, wanted in targets:
                if not any(abs(one * size / wanted - 1.0) <= off for one in (new.ratio, 1.0 / new.ratio)):
                    continue
                sizes = {"unit": "deg" if driven.is_turn else "m", "size": size, "wanted": wanted}
                cost = new.cost + steps * _STEP
                one = replacing(seen.script, "scaled", cost, node, new.text, **sizes)
                alike.setdefault(new.kind, []).append(one)
                yield one
    for kind, row in alike.items():
        if kind and len(row) > 1:
            edits = tuple(dict.fromkeys(edit for one in row for edit in one.edits))
            yield Proposal("scaled", row[0].cost + _STEP, edits, row[0].values)


def stale_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield a formula computed anew where one of its names is set later, as a length is that the user gives."""
    script, known = seen.script, assignments(seen.script)
    targets = {one.target for one in known}
    for one in known:
        base, _, attribute = one.target.rpartition(".")
        if base in ("", "self") or one.statement.lineno not in seen.ledger.ran:
            continue
        for other in known:
            names = {dotted(node) for node in ast.walk(other.value)}
            name = other.target.removeprefix("self.")
            if f"self.{attribute}" not in names or name == other.target or f"{base}.{name}" in targets:
                continue
            new = f"{base}.{name} = {script.source(other.value).replace('self.', f'{base}.')}"
            told = {"line": other.statement.lineno, "old": other.target, "name": one.target, "new": new}
            yield Proposal("stale", 1.0, (script.inserted_after(one.statement, new),), told)


def tolerance(driven: Driven) -> float:
    """Return by which share a motion may differ from its formula: one wait more or less."""
    step_ns = max((ns // times for times, ns in driven.motion.waits.values() if times), default=0)
    return min(OFF_SHARE + step_ns / 1e9 / max(driven.seconds, 1e-9), _MOST_OFF)


def _calculations(values: "Values", node: ast.expr) -> Iterator[_Rewritten]:
    """Yield a product for a quotient and the reverse, a quotient turned round, and one operand alone."""
    if not isinstance(node, ast.BinOp) or not isinstance(node.op, ast.Mult | ast.Div):
        return
    script, left, right = values.script, values.of(node.left), values.of(node.right)
    if not right:
        return
    is_product = isinstance(node.op, ast.Mult)
    motion = values.driven.motion
    if not is_product and abs(right) == abs(motion.w or motion.v):
        return  # a time is an angle or a length divided by its rate
    start, first, second = script.span(node)[0], script.span(node.left)[1], script.span(node.right)[0]
    between = script.text[first:second]
    old, new = "*/" if is_product else "/*"
    if between.count(old) == 1 and "#" not in between:
        rest = script.source(node)[second - start :]
        text = script.text[start:first] + between.replace(old, new) + rest
        kind = old + script.source(node.right)
        yield _Rewritten(text, right**-2 if is_product else right**2, 0.8, kind)
    if left and not is_product and not isinstance(node.right, ast.BinOp):
        turned = f"{script.source(node.right)} / {_operand(script, node.left)}"
        yield _Rewritten(turned, (right / left) ** 2, 0.9)
    is_factor = number_of(node.right) is not None or isinstance(node.right, ast.Call)
    if is_factor and not any(map(is_pi, ast.walk(node))):
        yield _Rewritten(_operand(script, node.left), 1.0 / right if is_product else right, 1.3)


def _operand(script: ParsedScript, node: ast.expr) -> str:
    source = script.source(node)
    return f"({source})" if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub) else source


def _parts(node: ast.expr) -> list[ast.expr]:
    return [one for one in ast.walk(node) if isinstance(one, ast.expr)]


def _names(values: "Values", node: ast.expr) -> Iterator[_Rewritten]:
    """Yield names of turning for one of driving that stands behind a turn, and the reverse."""
    name, now = dotted(node), values.of(node)
    turns = values.driven.is_turn
    if not name or not now or values.is_parameter(node) or bool(_TURNING.search(name)) is turns:
        return
    for other, value in values.names_at(node):
        if bool(_TURNING.search(other)) is turns and role_of(other) == role_of(name) != "":
            yield _Rewritten(other, value / now, 1.0)


def role_of(name: str) -> str:
    """Return whether a name is one of a time or of a rate; empty: of neither."""
    return next((role for role, words in _ROLES.items() if words.search(name)), "")


def _as_time(values: "Values", node: ast.expr, targets: list[tuple[float, float]]) -> Iterator[_Rewritten]:
    """Yield an angle or a length, which the motion lasted for so many seconds, divided by its rate."""
    script, driven = values.script, values.driven
    now, rate = values.of(node), abs(driven.motion.w or driven.motion.v)
    if now is None or not rate or isinstance(script.parent(node), ast.BinOp | ast.UnaryOp):
        return
    amounts = [math.radians(wanted) if driven.is_turn else wanted for _, wanted in targets]
    lasted = abs(driven.seconds - now) <= tolerance(driven) * now
    if lasted and any(abs(now - one) <= OFF_SHARE * one for one in amounts):
        names = [name for name, value in values.names_at(node) if abs(abs(value) - rate) <= _SAME]
        origin = values.origin(node)
        if any(
            isinstance(one, ast.BinOp)
            and (abs(values.of(one.right) or 0.0) == rate or role_of(dotted(one.right)) == "rate")
            for one in ast.walk(origin)
        ):
            return  # it is divided by its rate already
        by = next(iter(names), f"{rate:g}")
        text = "1.0" if dotted(node) in names else f"{_operand(script, node)} / {by}"
        yield _Rewritten(text, 1.0 / rate, 1.1 if dotted(node) else 0.8, by)


def _turned(values: "Values", node: ast.expr, targets: list[tuple[float, float]]) -> Iterator[_Rewritten]:
    """Yield a turn by the number of sides, for another formula of it that the motion came to."""
    now = values.of(node) if isinstance(node, ast.BinOp) and values.driven.is_turn else None
    size, wanted = targets[0]
    names = {dotted(one): values.of(one) for one in _parts(node) if dotted(one)}
    pi = next((dotted(one) for one in _parts(node) if is_pi(one)), "")
    degrees = math.degrees(abs(now or 0.0)) if pi else abs(now or 0.0)
    if not now or abs(degrees - size) > tolerance(values.driven) * size:
        return
    for name, value in names.items():
        if value and math.isclose(360.0 / value, wanted, rel_tol=1e-4):
            yield _Rewritten(f"2 * {pi} / {name}" if pi else f"360 / {name}", wanted / size, 0.6)


class Values:
    """What the names of a script stood for in one motion, as far as its text and the ledger say."""

    def __init__(self, script: ParsedScript, driven: Driven) -> None:
        self.script = script
        self.driven = driven
        self._known: dict[int, float | None] = {}
        self._read: dict[int, dict[str, float | None]] = {}

    def of(self, node: ast.expr, depth: int = 0) -> float | None:
        """Return the value of an expression; None if it has several, or is not computed of numbers alone."""
        if id(node) not in self._known:
            self._known[id(node)] = None  # for a name that is set from itself
            self._known[id(node)] = self._computed(node, depth) if depth < _MOST_DEPTH else None
        return self._known[id(node)]

    def names_at(self, node: ast.expr) -> list[tuple[str, float]]:
        """Return the names that stand for one number and that can be read where `node` stands."""
        function = function_around(self.script, node)
        rows = dict(self._read_in(function))
        is_method = function is not None and [one.arg for one in function.args.args[:1]] == ["self"]
        base = dotted(node).rpartition(".")[0] or ("self" if is_method else "")
        for one in assignments(self.script):
            set_in = function_around(self.script, one.statement)
            in_class = isinstance(self.script.parent(one.statement), ast.ClassDef)
            is_attribute = in_class or one.target.startswith("self.")
            name = f"{base}.{one.target.removeprefix('self.')}" if is_attribute else one.target
            is_reached = bool(base) if is_attribute else set_in is None
            if is_reached and (set_in is not function or one.statement.lineno < node.lineno):
                rows.setdefault(name, self.of(one.value))
        return [(name, value) for name, value in rows.items() if name and value][:_MOST_NAMES]

    def _read_in(self, function: Functions | None) -> dict[str, float | None]:
        if id(function) not in self._read:
            names = (one for one in ast.walk(function or self.script.tree) if isinstance(one, ast.expr))
            inside = (one for one in names if function_around(self.script, one) is function)
            self._read[id(function)] = {dotted(one): self.of(one) for one in inside if dotted(one)}
        return self._read[id(function)]

    def is_parameter(self, node: ast.expr) -> bool:
        """Whether a name is a parameter of the function that it stands in."""
        function = function_around(self.script, node)
        return function is not None and dotted(node) in [one.arg for one in function.args.args]

    def _computed(self, node: ast.expr, depth: int) -> float | None:
        if (value := math.pi if is_pi(node) else number_of(node)) is not None:
            return value
        if isinstance(node, ast.BinOp):
            return _calculated(node.op, self.of(node.left, depth + 1), self.of(node.right, depth + 1))
        if isinstance(node, ast.Call) and len(node.args) == 1:
            convert = _CONVERSIONS.get(dotted(node.func).rpartition(".")[2])
            given = None if convert is None else self.of(node.args[0], depth + 1)
            return None if convert is None or given is None else convert(given)
        name = dotted(node)
        if not name:
            return None
        return self._named(node, name, depth + 1)

    def _named(self, node: ast.expr, name: str, depth: int) -> float | None:
        if (value := self.definition(node)) is not None:
            return self.of(value, depth)
        here = (row[2] for row in self.driven.motion.stack if row[0] == node.lineno)
        return next((row[name] for row in here if name in row), None)

    def definition(self, node: ast.expr) -> ast.expr | None:
        """Return what a name is set to or given; None for what is no name, or is set at several places."""
        name, function = dotted(node), function_around(self.script, node)
        if function is not None and self.is_parameter(node):
            return self._given(function, name)
        rows = [one for one in assignments(self.script) if _is_same(self.script, one, name)]
        if "." not in name:
            local = [one for one in rows if function_around(self.script, one.statement) is function]
            rows = local or [one for one in rows if function_around(self.script, one.statement) is None]
        is_one = len(rows) == 1 and not isinstance(rows[0].statement, ast.AugAssign)
        return rows[0].value if name and is_one else None

    def origin(self, node: ast.expr) -> ast.expr:
        """Return what a name comes from in the end, through other names."""
        for _ in range(_MOST_DEPTH):
            if (value := self.definition(node)) is None:
                break
            node = value
        return node

    def _given(self, function: Functions, name: str) -> ast.expr | None:
        """Return what the caller that led to the motion gave for a parameter, or its default."""
        owner = self.script.parent(function)
        called = (
            owner.name if function.name == "__init__" and isinstance(owner, ast.ClassDef) else function.name
        )
        lines = {row[0] for row in self.driven.motion.stack}
        calls = list(calls_of(self.script, called))
        calls = [one for one in calls if one.lineno in lines] if len(calls) > 1 else calls
        if len(calls) != 1:
            return None
        names = [one.arg for one in function.args.args]
        place = names.index(name) - (names[:1] == ["self"])
        if 0 <= place < len(calls[0].args):
            return calls[0].args[place]
        by_name = next((one.value for one in calls[0].keywords if one.arg == name), None)
        defaults = dict(zip(reversed(names), reversed(function.args.defaults), strict=False))
        return by_name or defaults.get(name)


def _is_same(script: ParsedScript, one: NameSet, name: str) -> bool:
    """Whether an assignment sets what a name stands for; ``node.X`` is ``self.X``, or ``X`` in its class."""
    attribute = name.rpartition(".")[2]
    in_class = one.target == attribute and isinstance(script.parent(one.statement), ast.ClassDef)
    return one.target == name or (name.count(".") == 1 and (in_class or one.target == f"self.{attribute}"))


def is_pi(node: ast.AST) -> bool:
    """Whether a name is that of π."""
    return dotted(node).rpartition(".")[2].casefold() in _PI


def constant(node: ast.expr) -> float | None:
    """Return the value of a number, of π, or of what is computed of them alone; None for anything else."""
    if isinstance(node, ast.BinOp):
        return _calculated(node.op, constant(node.left), constant(node.right))
    return math.pi if is_pi(node) else number_of(node)


def _calculated(operator: ast.operator, left: float | None, right: float | None) -> float | None:
    if left is None or right is None:
        return None
    if isinstance(operator, ast.Mult):
        return left * right
    if isinstance(operator, ast.Add):
        return left + right
    if isinstance(operator, ast.Sub):
        return left - right
    return left / right if isinstance(operator, ast.Div) and right else None
