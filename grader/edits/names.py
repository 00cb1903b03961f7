"""Changes of names, imports, types and topics: what an exception, or a command that never came, says is wrong."""

import ast
import builtins
import difflib
import re
from collections.abc import Iterator
from typing import Final

from grader.contracts.outcome import StudentError
from grader.edits.situation import Proposal, Situation, replacing
from grader.edits.slices import (
    assignments,
    at_top,
    callee,
    calls_of,
    classes_of,
    dotted,
    expressions_behind,
    functions_of,
    number_of,
    set_once,
)
from grader.edits.tree import Edit, ParsedScript

MODULES: Final = ("math", "os", "random", "rclpy", "sys", "threading", "time")
CLASSES: Final = {
    "Duration": "rclpy.duration",
    "Float64": "std_msgs.msg",
    "Node": "rclpy.node",
    "Pose": "turtlesim.msg",
    "String": "std_msgs.msg",
    "Twist": "geometry_msgs.msg",
    "pi": "math",
    "radians": "math",
    "sleep": "time",
}
_FIELDS: Final = ("linear", "angular", "x", "y", "z", "theta", "linear_velocity", "angular_velocity", "data")
_METHODS: Final = (
    "create_publisher",
    "create_subscription",
    "create_timer",
    "create_client",
    "create_service",
    "get_logger",
    "get_clock",
    "destroy_node",
    "publish",
    "info",
    "nanoseconds",
    "now",
    "shutdown",
    "spin",
    "spin_once",
    "init",
    "sleep",
    "ok",
)
_PACKAGES: Final = ("geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs", "std_srvs", "turtlesim")
_NAMES: Final = (*_PACKAGES, *MODULES, *CLASSES, *_FIELDS, *_METHODS)
_NODE_MAKERS: Final = ("__init__", "create_node", "Node")
_QUOTED: Final = re.compile(r"'([A-Za-z_][\w.]*)'")
_MEANT: Final = re.compile(r"Did you mean: '([^']+)'")


def name_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield changes of what the exception that ended the script names, and of what no command came through."""
    error = seen.failure
    if error is not None and error.line is not None:
        yield from _of_error(seen, error, error.line)
    if seen.outcome.command_count == 0:
        yield from _topics(seen)
    yield from _packages(seen)
    yield from _qualities(seen)


def _of_error(seen: Situation, error: StudentError, line: int) -> Iterator[Proposal]:
    quoted = _QUOTED.findall(error.message)
    if error.type in (
        "NameError",
        "UnboundLocalError",
        "AttributeError",
        "ImportError",
        "ModuleNotFoundError",
    ):
        for wrong in quoted[:2] if error.type == "NameError" else quoted[-1:] + quoted[:1]:
            yield from _near(seen, error, line, wrong)
    if error.type == "NameError" and quoted:
        yield from _imported(seen, quoted[0])
        yield from _of_self(seen, line, quoted[0])
        yield from _quoted(seen, line, quoted[0])
    if error.type == "InvalidNodeNameException":
        yield from _node_names(seen)
    if error.type in ("AssertionError", "TypeError"):
        yield from _floats(seen, line)
        yield from _parameters(seen, error, line)
    if error.type == "ValueError":
        for call in calls_of(seen.script, "int"):
            old = seen.script.source(call)
            new = f"float{old.removeprefix('int')}"
            yield replacing(seen.script, "float", 0.4, call, new)
    if error.type == "UnboundLocalError" and quoted:
        yield from _globals(seen, line, quoted[0])
    if error.type == "NotInitializedException":
        yield from _init(seen, line)


def _near(seen: Situation, error: StudentError, line: int, wrong: str) -> Iterator[Proposal]:
    """Yield the names that are nearly the one that does not exist, what Python means first."""
    meant = _MEANT.findall(error.traceback)
    wrong = wrong.rpartition(".")[2]
    known = {*_all_names(seen.script), *seen.fields, *_NAMES, *dir(builtins)} - {wrong}
    near = difflib.get_close_matches(wrong, sorted(known), 4, 0.6)
    alike = [name for name in sorted(known) if name.lower() == wrong.lower()]
    for place, name in enumerate(dict.fromkeys((*meant, *alike, *near))):
        edits = tuple(_renamed(seen.script, line, wrong, name))
        if edits:
            values = {"line": line, "old": wrong, "new": name}
            yield Proposal("name", 0.2 + place * 0.1, edits, values)
        yield from _renamed_everywhere(seen.script, wrong, name, 0.15 + place * 0.1)


def _renamed_everywhere(script: ParsedScript, wrong: str, near: str, cost: float) -> Iterator[Proposal]:
    """Yield the rarer of two names of the script's own written as the other one, wherever it stands."""
    places = {name: _lines_with(script, name) for name in (wrong, near)}
    if not places[near] and near not in MODULES:
        return
    is_rarer = near in MODULES or len(places[wrong]) < len(places[near])
    old, new = (wrong, near) if is_rarer else (near, wrong)
    edits = tuple(edit for line in places[old] for edit in _renamed(script, line, old, new))
    if edits:
        yield Proposal("name", cost, edits, {"line": places[old][0], "old": old, "new": new})


def _lines_with(script: ParsedScript, name: str) -> list[int]:
    """Return the lines on which a name or attribute stands."""
    lines = (
        node.end_lineno or node.lineno
        for node in ast.walk(script.tree)
        if (isinstance(node, ast.Name) and node.id == name)
        or (isinstance(node, ast.Attribute) and node.attr == name)
        or (isinstance(node, ast.Import | ast.ImportFrom) and re.search(rf"\b{name}\b", script.source(node)))
    )
    return sorted(set(lines))


def _all_names(script: ParsedScript) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(script.tree):
        if isinstance(node, ast.Name) and isinstance(script.parent(node), ast.Assign | ast.For | ast.With):
            names.add(node.id)
        elif isinstance(node, ast.Attribute):
            names.add(node.attr)
        elif isinstance(node, ast.FunctionDef | ast.ClassDef | ast.AsyncFunctionDef):
            names.add(node.name)
        elif isinstance(node, ast.arg):
            names.add(node.arg)
        elif isinstance(node, ast.alias):
            names.add((node.asname or node.name).partition(".")[0])
    return names


def _renamed(script: ParsedScript, line: int, wrong: str, right: str) -> Iterator[Edit]:
    """Yield the edits that put one name in the place of another on a line, whatever stands around it."""
    for statement in script.statements_on(line):
        for node in ast.walk(statement):
            if isinstance(node, ast.Name) and node.id == wrong and node.lineno == line:
                yield script.replaced(node, right)
            elif isinstance(node, ast.Attribute) and node.attr == wrong and node.end_lineno == line:
                _, end = script.span(node)
                yield Edit(end - len(wrong), end, right)
        if isinstance(statement, ast.Import | ast.ImportFrom):
            start, end = script.span(statement)
            found = re.search(rf"\b{re.escape(wrong)}\b", script.text[start:end])
            if found is not None:
                yield Edit(start + found.start(), start + found.end(), right)


def _imported(seen: Situation, name: str) -> Iterator[Proposal]:
    """Yield the import of a module or class that everybody means by that name."""
    if name in MODULES:
        line = f"import {name}"
    elif name in CLASSES:
        line = f"from {CLASSES[name]} import {name}"
    elif name == "np":
        line = "import numpy as np"
    else:
        return
    yield Proposal("import", 0.1, (at_top(seen.script, line),), {"line": 1, "new": line, "name": name})


def _of_self(seen: Situation, line: int, name: str) -> Iterator[Proposal]:
    """Yield ``self.`` before a name that only the object has."""
    own = {
        assignment.target.partition(".")[2]
        for assignment in assignments(seen.script)
        if assignment.target.startswith("self.")
    }
    own |= {node.name for node in functions_of(seen.script)}
    if name in own:
        edits = tuple(_renamed(seen.script, line, name, f"self.{name}"))
        yield Proposal("own", 0.1, edits, {"line": line, "old": name, "new": f"self.{name}"})


def _floats(seen: Situation, line: int) -> Iterator[Proposal]:
    """Yield a float for a whole number or a text, on the line of the error."""
    for statement in seen.script.statements_on(line):
        value = getattr(statement, "value", None)
        if isinstance(statement, ast.Assign) and isinstance(value, ast.expr):
            old = seen.script.source(value)
            whole = number_of(value)
            new = f"{old}.0" if whole is not None and old.lstrip("-").isdigit() else f"float({old})"
            if isinstance(value, ast.Tuple) and old.replace(",", "").replace(" ", "").strip("()").isdigit():
                new = old.strip("()").replace(" ", "").replace(",", ".")
            yield replacing(seen.script, "float", 0.2, value, new)
    for node, _ in expressions_behind(seen.script, [line]):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and _is_decimal(node.value):
            yield replacing(seen.script, "float", 0.25, node, node.value.strip())
    for call in calls_of(seen.script, "input"):
        old = seen.script.source(call)
        yield replacing(seen.script, "float", 0.5, call, f"float({old})")


def _is_decimal(text: str) -> bool:
    return re.fullmatch(r"\s*-?\d+(\.\d*)?\s*", text) is not None


def _quoted(seen: Situation, line: int, name: str) -> Iterator[Proposal]:
    """Yield a text for a name that does not exist, where it is given to a call."""
    for statement in seen.script.statements_on(line):
        for node in ast.walk(statement):
            if (
                isinstance(node, ast.Name)
                and node.id == name
                and isinstance(seen.script.parent(node), ast.Call)
            ):
                yield replacing(seen.script, "quotes", 0.4, node, f"'{name}'")


def _node_names(seen: Situation) -> Iterator[Proposal]:
    """Yield a name that a node may have."""
    for node in ast.walk(seen.script.tree):
        if not (
            isinstance(node, ast.Call) and node.args and seen.script.source(node.func).endswith(_NODE_MAKERS)
        ):
            continue
        given = node.args[0]
        old = given.value if isinstance(given, ast.Constant) else None
        if isinstance(old, str):
            new = re.sub(r"\W+", "_", old.strip(), flags=re.ASCII).strip("_0123456789") or "my_node"
            yield replacing(seen.script, "node_name", 0.3, given, f"'{new}'", old=old, new=new)


def _parameters(seen: Situation, error: StudentError, line: int) -> Iterator[Proposal]:
    """Yield ``self`` for a method without it, and the depth of the queue that a publisher needs."""
    for node in functions_of(seen.script):
        if f"{node.name}()" in error.message:
            first = node.args.args[0].arg if node.args.args else ""
            if first != "self" and isinstance(seen.script.parent(node), ast.ClassDef):
                at = seen.script.text.index("(", seen.script.span(node)[0]) + 1
                edit = Edit(at, at, "self, " if first else "self")
                yield Proposal("self", 0.1, (edit,), {"line": node.lineno, "name": node.name})
    for name in ("create_publisher", "create_subscription"):
        for call in calls_of(seen.script, name):
            if call.lineno == line and name in error.message and "qos_profile" in error.message:
                end = seen.script.span(call)[1] - 1
                yield Proposal("depth", 0.1, (Edit(end, end, ", 10"),), {"line": line, "name": name})


def _globals(seen: Situation, line: int, name: str) -> Iterator[Proposal]:
    """Yield the statement that lets a function change a name of the whole script."""
    for statement in seen.script.statements_on(line):
        for node in seen.script.around(statement):
            if isinstance(node, ast.FunctionDef):
                edit = seen.script.inserted_before(node.body[0], f"global {name}")
                yield Proposal("global", 0.3, (edit,), {"line": node.lineno, "name": name})
                return


def _init(seen: Situation, line: int) -> Iterator[Proposal]:
    """Yield ``rclpy.init()`` before the node that needs it."""
    places = [
        statement
        for statement in (*seen.script.statements_on(line), *_makers(seen.script))
        if not any(isinstance(one, ast.ClassDef) for one in seen.script.around(statement))
    ]
    for place, statement in enumerate(places[:2]):
        edit = seen.script.inserted_before(statement, "rclpy.init()")
        yield Proposal("init", 0.1 + place * 0.1, (edit,), {"line": statement.lineno})


def _makers(script: ParsedScript) -> Iterator[ast.stmt]:
    classes = {node.name for node in classes_of(script)}
    for assignment in assignments(script):
        if callee(assignment.value) in classes:
            yield assignment.statement


def _topics(seen: Situation) -> Iterator[Proposal]:
    """Yield the topic, the type and the message that move the car, for a publisher that does not."""
    for call in calls_of(seen.script, "create_publisher"):
        given = dict(zip(("msg_type", "topic"), call.args, strict=False))
        given |= {one.arg: one.value for one in call.keywords if one.arg}
        topic, kind = given.get("topic"), given.get("msg_type")
        if topic is not None:
            place = set_once(seen.script, topic)
            old = place.value if isinstance(place, ast.Constant) else seen.script.source(place)
            if old != seen.topic:
                yield replacing(seen.script, "topic", 1.0, place, f"'{seen.topic}'", old=old, new=seen.topic)
        if kind is not None and dotted(kind) and dotted(kind) != seen.twist:
            yield from _of_type(seen, kind)


def _qualities(seen: Situation) -> Iterator[Proposal]:
    """Yield the quality of service that fits a topic: that of sensors, or the usual queue."""
    for note in seen.outcome.notes:
        if note.code not in ("incompatible_qos", "sensor_qos"):
            continue
        for call in calls_of(seen.script, "create_publisher", "create_subscription"):
            given = {one.arg: one.value for one in call.keywords}
            quality = given.get("qos_profile") or (call.args[-1] if len(call.args) >= 3 else None)
            topic = seen.script.source(given.get("topic") or call.args[1] if len(call.args) > 1 else call)
            is_meant = not topic.startswith(("'", '"')) or topic.strip("'\"/").endswith(note.text.strip("/"))
            if quality is None or not is_meant:
                continue
            new = "10" if note.code == "incompatible_qos" else "qos_profile_sensor_data"
            is_imported = new == "10" or new in _all_names(seen.script)
            others = () if is_imported else (at_top(seen.script, f"from rclpy.qos import {new}"),)
            yield replacing(seen.script, "quality", 0.5, quality, new, *others, topic=note.text)


def _packages(seen: Situation) -> Iterator[Proposal]:
    """Yield the package that has the type of a topic, for one that has another type of the same name."""
    if not any(note.code == "type_mismatch" for note in seen.outcome.notes):
        return
    for node in ast.walk(seen.script.tree):
        if not isinstance(node, ast.ImportFrom) or node.level or node.module != "geometry_msgs.msg":
            continue
        others = [one for one in node.names if one.name != "Pose"]
        if len(others) == len(node.names):
            continue
        new = "from turtlesim.msg import Pose"
        edits = [seen.script.replaced(node, new)]
        if others:
            rest = ", ".join(f"{one.name} as {one.asname}" if one.asname else one.name for one in others)
            edits = [
                seen.script.replaced(node, f"from geometry_msgs.msg import {rest}"),
                seen.script.inserted_after(node, new),
            ]
        values = {"line": node.lineno, "old": "geometry_msgs.msg.Pose", "new": "turtlesim.msg.Pose"}
        yield Proposal("name", 0.3, tuple(edits), values)


_MEANT_FIELDS: Final = {
    "twist.linear.x": "linear.x",
    "twist.angular.z": "angular.z",
    "linear_velocity": "linear.x",
    "angular_velocity": "angular.z",
    "x": "linear.x",
    "z": "angular.z",
}
"""Fields of other messages that beginners take for a command, and those of a Twist that are meant."""


def _of_type(seen: Situation, kind: ast.expr) -> Iterator[Proposal]:
    """Yield Twist for another type, with its import, and with the fields that are meant."""
    old = dotted(kind)
    edits = [seen.script.replaced(kind, seen.twist)]
    for call in calls_of(seen.script, old):
        edits.append(seen.script.replaced(call.func, seen.twist))
    if seen.twist not in _all_names(seen.script):
        edits.append(at_top(seen.script, f"from geometry_msgs.msg import {seen.twist}"))
    values = {"line": kind.lineno, "old": old, "new": seen.twist}
    if fields := _meant_fields(seen, old):
        yield Proposal("type", 0.7, tuple(dict.fromkeys((*edits, *fields))), values)
    yield Proposal("type", 0.9, tuple(dict.fromkeys(edits)), values)
    yield Proposal("type", 0.8, (edits[0], *edits[2:][-1:]), values)


def _meant_fields(seen: Situation, kind: str) -> list[Edit]:
    """Return the edits of the fields that are set on messages of a type, if all can be those of a Twist."""
    known = assignments(seen.script)
    messages = {one.target for one in known if callee(one.value) == kind}
    edits: list[Edit] = []
    for one in known:
        for message in messages:
            field = one.target.removeprefix(f"{message}.")
            if field == one.target or not isinstance(one.statement, ast.Assign):
                continue
            if field.startswith("header"):
                edits.append(seen.script.removed(one.statement))
            elif field in _MEANT_FIELDS:
                new = f"{message}.{_MEANT_FIELDS[field]}"
                edits.append(seen.script.replaced(one.statement.targets[0], new))
    return edits
