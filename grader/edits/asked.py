"""Changes of what a script offers, answers and drives to: where the assignment itself names what is right."""

import ast
import difflib
import itertools
import math
from collections.abc import Iterator
from typing import Final

from grader.contracts.assignment import Assignment
from grader.contracts.conversation import Expectation, Step
from grader.edits.situation import Proposal, Situation, Stated, replacing
from grader.edits.slices import (
    assignments,
    callee,
    calls_of,
    dotted,
    expressions_behind,
    function_around,
    functions_of,
    is_read,
    makes_node,
    named_in,
    number_of,
    set_once,
)
from grader.edits.tree import Edit, ParsedScript

_NAMED_BY: Final = {
    "create_publisher": "topic",
    "create_subscription": "topic",
    "create_service": "service",
    "create_client": "service",
    "ActionServer": "action",
    "ActionClient": "action",
    "declare_parameter": "parameter",
    "get_parameter": "parameter",
    "__init__": "node",
    "create_node": "node",
}
"""Of what the first text that is given to a call is the name."""
_GROUPS: Final = {
    "topic": "topic",
    "listener": "topic",
    "publish": "topic",
    "service": "service",
    "client": "service",
    "call": "service",
    "serve": "service",
    "action": "action",
    "goal": "action",
    "node": "node",
    "set": "node",
    "get": "node",
    "parameter": "parameter",
}
_OPERATORS: Final = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}
_GROWING: Final = ("append", "extend", "insert")
_MOST_NUMBER: Final = 20.0
_MOST_RATIO: Final = 100.0  # centimetres for metres
_SAME: Final = 0.02
_ALIKE: Final = 0.6
_GOAL_WORDS: Final = ("goal", "target", "dest", "end", "aim", "wanted")


def asked_of(assignment: Assignment, lost: frozenset[str]) -> Stated:
    """Return what an assignment names: in its expectations and steps, its cases, bands and places."""
    expected = [one for item in assignment.items if item.measure in lost for one in item.expect]
    names: dict[str, list[str]] = {}
    named: list[Expectation | Step] = [*assignment.expectations, *assignment.steps]
    for one in named:
        for group, name in _names_in(one):
            names.setdefault(group, []).append(name)
    given = (arg.partition(":=") for case in assignment.cases for arg in case.args)
    names.setdefault("parameter", []).extend(name for name, mark, _ in given if mark and "__" not in name)
    values = [table for one in expected for table in (one.values, one.feedback) if table]
    bands = [(assignment.options.get("band_low_m"), assignment.options.get("band_high_m"))]
    bands += [(item.low, item.high) for item in assignment.items if item.measure == "ahead_m"]
    places = assignment.places
    return Stated(
        names={group: tuple(dict.fromkeys(found)) for group, found in names.items()},
        kinds=frozenset(one.type.rpartition("/")[2] for one in expected if one.type),
        fields=frozenset(key for table in values for key in table),
        inputs=tuple(
            dict.fromkeys(key for step in assignment.steps if step.kind != "set" for key in step.values)
        ),
        rates_hz=tuple(dict.fromkeys(one.rate_hz for one in expected if one.rate_hz and one.kind == "topic")),
        levels=tuple(
            round((low + high) / 2.0, 4)
            for low, high in bands
            if isinstance(low, int | float) and isinstance(high, int | float)
        )[:1],
        goals=() if places is None else tuple((goal.region.x_m, goal.region.y_m) for goal in places.visit),
        slips=assignment.world.profile == "rough",
        logs="info_logs" in lost or any(one.kind == "log" for one in expected),
    )


def _names_in(one: Expectation | Step) -> Iterator[tuple[str, str]]:
    group = _GROUPS.get(one.kind)
    if group is not None and not (isinstance(one, Expectation) and one.kind in ("goal", "set")):  # a step's
        yield group, one.target
    if isinstance(one, Expectation) and one.node:
        yield "node", one.node
    if isinstance(one, Step) and one.kind in ("set", "get"):
        yield from (("parameter", name) for name in (*one.names, *one.values))


def asked_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield what the assignment names, in the place of what the script has instead."""
    yield from _names(seen)
    yield from _kinds(seen)
    yield from _answers(seen)
    yield from _rates(seen)
    yield from _uncounted(seen)
    yield from _left_out(seen)
    yield from _ends_of_goals(seen)
    yield from _read_once(seen)
    yield from _logged(seen)
    yield from _levels(seen)
    yield from _goals(seen)


def _names(seen: Situation) -> Iterator[Proposal]:
    """Yield a name that is asked for and that nothing in the script has, for another one."""
    written: dict[str, list[ast.Constant]] = {}
    for maker, group in _NAMED_BY.items():
        for call in calls_of(seen.script, maker):
            text = next((one for one in call.args if isinstance(getattr(one, "value", None), str)), None)
            if isinstance(text, ast.Constant):
                written.setdefault(group, []).append(text)
    for group, constants in written.items():
        has = {str(one.value).strip("/") for one in constants}
        asked = seen.asked.names.get(group, ())
        for old in sorted(has - {one.strip("/") for one in (*asked, seen.topic)}):
            alike = {one: difflib.SequenceMatcher(None, old, one.strip("/")).ratio() for one in asked}
            near = [one for one in asked if one.strip("/") not in has or alike[one] >= _ALIKE]
            places = [one for one in constants if str(one.value).strip("/") == old]
            for place, name in enumerate(sorted(near, key=alike.__getitem__, reverse=True)[:2]):
                yield _renamed(seen, places, name, place)


def _renamed(seen: Situation, constants: list[ast.Constant], name: str, place: int) -> Proposal:
    first = constants[0]
    keeps_mark = str(first.value).startswith("/")
    new = repr(name if keeps_mark else name.strip("/"))
    others = [seen.script.replaced(one, new) for one in constants[1:]]
    return replacing(seen.script, "name", 0.8 + 0.2 * place, first, new, *others)


def _missing(cost: float, edit: Edit, line: int, new: str) -> Proposal:
    return Proposal("missing", cost, (edit,), {"line": line, "new": new})


def _kinds(seen: Situation) -> Iterator[Proposal]:
    """Yield the type that is asked for and imported, for another one."""
    imported = {
        one.asname or one.name
        for node in ast.walk(seen.script.tree)
        if isinstance(node, ast.ImportFrom)
        for one in node.names
    }
    for maker, group in _NAMED_BY.items():
        for call in calls_of(seen.script, maker) if group != "node" else ():
            kind = next((one for one in call.args if dotted(one) in imported), None)
            for new in sorted(seen.asked.kinds & imported) if kind is not None else ():
                if kind is not None and dotted(kind) != new and dotted(kind) not in seen.asked.kinds:
                    yield replacing(seen.script, "name", 0.7, kind, new)


def _answers(seen: Situation) -> Iterator[Proposal]:
    """Yield other operators, operands and numbers in what is computed for a field that is asked for."""
    script, fields = seen.script, seen.asked.fields
    lines = [one.statement.lineno for one in assignments(script) if one.target.rpartition(".")[2] in fields]
    for call in calls_of(script, *_GROWING):
        if fields & set(dotted(call.func).split(".")):
            lines.append(call.lineno)
    lines += [
        one.value.lineno
        for one in ast.walk(script.tree)
        if isinstance(one, ast.keyword) and one.arg in fields
    ]
    for node, steps in expressions_behind(script, dict.fromkeys(lines)) if lines else ():
        cost = 2.0 + 0.2 * steps
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            yield from _calculations(script, node, cost)
        elif isinstance(node, ast.Constant) and type(node.value) is int and node.value <= _MOST_NUMBER:
            yield from (
                replacing(script, "name", cost + 0.3 + 0.05 * abs(near), node, str(near))
                for near in (node.value - 1, node.value + 1)
                if near >= 0
            )
        elif isinstance(node, ast.Attribute) and node.attr in seen.asked.inputs and dotted(node.value):
            others = (one for one in seen.asked.inputs if one != node.attr)
            yield from (
                replacing(script, "name", cost, node, f"{dotted(node.value)}.{one}") for one in others
            )


def _calculations(script: ParsedScript, node: ast.BinOp, cost: float) -> Iterator[Proposal]:
    left, right = script.source(node.left), script.source(node.right)
    for place, sign in enumerate(_OPERATORS.values()):
        if sign != _OPERATORS[type(node.op)]:
            yield replacing(script, "name", cost + 0.1 * place, node, f"{left} {sign} {right}")
    for other, kept in ((node.left, right), (node.right, left)):
        if number_of(other) is not None:
            yield replacing(script, "name", cost - 0.1, node, kept)
    if isinstance(node.op, ast.Sub):
        yield replacing(script, "name", cost, node, f"{right} - {left}")


def _rates(seen: Situation) -> Iterator[Proposal]:
    """Yield the period of the rate that is asked for, for another one of a timer."""
    for call in calls_of(seen.script, "create_timer"):
        number = set_once(seen.script, call.args[0]) if call.args else None
        period = None if number is None else number_of(number)
        for rate_hz in seen.asked.rates_hz:
            if number is not None and period is not None and period != 1.0 / rate_hz:
                yield replacing(seen.script, "name", 0.8, number, f"{1.0 / rate_hz:g}")


def _uncounted(seen: Situation) -> Iterator[Proposal]:
    """Yield a count for a number that is published again and again and never changes."""
    known = assignments(seen.script)
    for one in known:
        sent = {dotted(node) for node in ast.walk(one.value)} - {""}
        if one.target.rpartition(".")[2] not in seen.asked.fields:
            continue
        for name in sorted(sent):
            begun = [each for each in known if each.target == name]
            if len(begun) == 1 and number_of(begun[0].value) is not None:
                edit = seen.script.inserted_after(one.statement, f"{name} += 1")
                yield _missing(1.6, edit, one.statement.lineno, f"{name} += 1")


def _left_out(seen: Situation) -> Iterator[Proposal]:
    """Yield a node for the executor that was given others, or none."""
    given = [dotted(call.args[0]) for call in calls_of(seen.script, "add_node") if call.args]
    executors = [one for one in assignments(seen.script) if callee(one.value).endswith("Executor")]
    for one in assignments(seen.script) if executors else ():
        if makes_node(seen.script, one) and one.target not in given:
            last = max((one.statement, executors[0].statement), key=lambda each: each.lineno)
            new = f"{executors[0].target}.add_node({one.target})"
            yield _missing(0.9, seen.script.inserted_after(last, new), last.lineno, new)


def _ends_of_goals(seen: Situation) -> Iterator[Proposal]:
    """Yield what ends a goal of an action: that it succeeded, and its result."""
    script = seen.script
    callbacks = named_in(calls_of(script, "ActionServer"))
    for function in (one for one in functions_of(script) if one.name in callbacks):
        last, inside = function.body[-1], list(ast.walk(function))
        results = [
            one.target
            for one in assignments(script)
            if one.statement in inside and callee(one.value).endswith(".Result")
        ]
        handle = function.args.args[-1].arg if function.args.args else ""
        ends = any(isinstance(one, ast.Attribute) and one.attr == "succeed" for one in inside)
        if results and not ends:
            new = f"{handle}.succeed()"
            edit = (
                script.inserted_before(last, new)
                if isinstance(last, ast.Return)
                else script.inserted_after(last, new)
            )
            yield _missing(0.8, edit, last.lineno - isinstance(last, ast.Return), new)
        if results and not isinstance(last, ast.Return):
            new = f"return {results[-1]}"
            yield _missing(0.7, script.inserted_after(last, new), last.lineno, new)


def _read_once(seen: Situation) -> Iterator[Proposal]:
    """Yield a parameter that is read where it is used, for one that was read once and may have been set since."""
    for one in assignments(seen.script) if seen.asked.names.get("parameter") else ():
        value = one.value
        if not (isinstance(value, ast.Attribute) and value.attr == "value"):
            continue
        if not callee(value.value).endswith("get_parameter"):
            continue
        own = function_around(seen.script, one.statement)
        for node in ast.walk(seen.script.tree):
            if not isinstance(node, ast.Attribute | ast.Name) or dotted(node) != one.target:
                continue
            if is_read(seen.script, node) and not any(each is own for each in seen.script.around(node)):
                yield replacing(seen.script, "name", 1.4, node, seen.script.source(value))


def _logged(seen: Situation) -> Iterator[Proposal]:
    """Yield a field of a message, for the whole message in a log."""
    for call in ast.walk(seen.script.tree) if seen.asked.logs else ():
        if not isinstance(call, ast.Call) or getattr(call.func, "attr", "") != "info":
            continue
        function = function_around(seen.script, call)
        message = function.args.args[-1].arg if function is not None and function.args.args else "self"
        for name in seen.asked.inputs if message != "self" else ():
            for given in call.args:
                old = seen.script.source(given)
                braces = isinstance(given, ast.JoinedStr)
                before, after = (
                    (f"{{{message}}}", f"{{{message}.{name}}}") if braces else (message, f"{message}.{name}")
                )
                if before in old and after not in old:
                    yield replacing(seen.script, "name", 1.0, given, old.replace(before, after))


def _levels(seen: Situation) -> Iterator[Proposal]:
    """Yield the distance that is to be kept, for another number that is given a name, compared or taken off."""
    speeds = (one for one in assignments(seen.script) if one.target.endswith((".x", ".z")))
    rates = {dotted(one.value) for one in speeds} - {""}
    for node in ast.walk(seen.script.tree) if seen.asked.levels else ():
        value, parent = number_of(node), seen.script.parent(node)
        if value is None or value <= 0.0 or not isinstance(node, ast.Constant):
            continue
        name = dotted(parent.targets[0]) if isinstance(parent, ast.Assign) else ""
        is_difference = isinstance(parent, ast.BinOp) and isinstance(parent.op, ast.Add | ast.Sub)
        if (
            name in rates
            or name.endswith((".x", ".z"))
            or not (name or is_difference or isinstance(parent, ast.Compare))
        ):
            continue
        for level in seen.asked.levels:
            ratio = abs(math.log(value / level))
            if _SAME < ratio <= math.log(_MOST_RATIO) * 1.01:
                yield replacing(seen.script, "name", 1.0 + 0.1 * ratio + 0.4 * (not name), node, f"{level:g}")


def _goals(seen: Situation) -> Iterator[Proposal]:
    """Yield a place that is to be reached, for another pair of numbers, or of goal's names."""
    goals = seen.asked.goals
    pairs = {
        id(node): (number_of(node.elts[0]), number_of(node.elts[1]))
        for node in ast.walk(seen.script.tree)
        if isinstance(node, ast.Tuple | ast.List) and len(node.elts) == 2
    }
    missing = [goal for goal in goals if goal not in pairs.values()]
    for node in ast.walk(seen.script.tree) if missing else ():
        pair = pairs.get(id(node))
        if isinstance(node, ast.Tuple | ast.List) and pair and None not in pair and pair not in goals:
            for place, (x_m, y_m) in enumerate(sorted(missing, key=lambda goal: -len({*goal} & {*pair}))[:2]):
                open_, close = ("(", ")") if isinstance(node, ast.Tuple) else ("[", "]")
                yield replacing(
                    seen.script, "name", 0.9 + 0.2 * place, node, f"{open_}{x_m:g}, {y_m:g}{close}"
                )
    if len(goals) == 1:
        yield from _named_goals(seen, goals[0])


def _named_goals(seen: Situation, goal: tuple[float, float]) -> Iterator[Proposal]:
    wrong = []
    for one, (axis, wanted) in itertools.product(assignments(seen.script), zip("xy", goal, strict=True)):
        name = one.target.rpartition(".")[2].casefold()
        value = number_of(one.value)
        is_goal = name.endswith(axis) and any(word in name for word in _GOAL_WORDS)
        if is_goal and value is not None and value != wanted:
            wrong.append((one.value, f"{wanted:g}" if wanted % 1 else f"{wanted:.1f}"))
    for node, new in wrong:
        yield replacing(seen.script, "name", 1.0, node, new)
    if len(wrong) > 1:
        others = (seen.script.replaced(node, new) for node, new in wrong[1:])
        yield replacing(seen.script, "name", 0.95, *wrong[0], *others)
