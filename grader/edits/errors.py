"""Changes of the line that raised an exception, and of what it takes its values from.

Which of them is meant only the trial knows: an exception says what does not fit, and there are few ways to make it
fit. The sentences name what stood there and what is to stand there.
"""

import ast
import builtins
import re
from collections.abc import Iterator
from typing import Final

from grader.contracts.names import IMPORTS, MODULES, OTHER_LANGUAGES, near_name
from grader.edits.failing import FailingLine
from grader.edits.ros import ROS_OPERATORS
from grader.edits.situation import Proposal, Situation
from grader.edits.slices import (
    Functions,
    callee,
    calls_of,
    classes_of,
    dotted,
    function_around,
    functions_of,
    makes_node,
    number_of,
)
from grader.edits.tree import Edit

_LENT: Final = (".get_logger", ".get_clock")
_CALLED: Final = ("get_logger", "get_clock", "now", "Request", "Response", "super", "input", "time", "random")
_OF_NODE: Final = frozenset(
    [
        "client",
        "clients",
        "clock",
        "context",
        "create_client",
        "create_publisher",
        "create_service",
        "create_subscription",
        "create_timer",
        "destroy_node",
        "executor",
        "get_clock",
        "get_logger",
        "get_parameter",
        "guards",
        "handle",
        "publishers",
        "services",
        "subscriptions",
        "timers",
        "waitables",
        "_timers",
        "_publishers",
        "_subscriptions",
        "_clients",
        "_services",
        "_clock",
        "_logger",
        "_context",
    ]
)
"""Names that break a node where a script gives them to its own."""
_AXES: Final = {"linear": "x", "angular": "z"}
_INDICES: Final = {0: "x", 1: "y", 2: "z", "x": "x", "y": "y", "z": "z"}
_MAKERS: Final = ("create_timer", "create_subscription", "create_service", "create_publisher")
_MOST_PLACES: Final = 8


def error_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield changes of what the exception that ended the script points to."""
    error = seen.failure
    if error is None or error.line is None:
        return
    at = FailingLine(seen, error, error.line)
    for operator in (
        _brackets,
        _orders,
        _arguments,
        _missing_arguments,
        _signatures,
        _own_names,
        _own_classes,
        _copies,
        _fields,
        _vectors,
        _numbers,
        _scopes,
        _objects,
        _blocks,
        _class_bodies,
        _uncalled,
        _words,
        _imports,
        _texts,
        _waits,
        *ROS_OPERATORS,
        _without,
    ):
        for proposal in operator(at):
            yield proposal
            yield from _everywhere(at, proposal)


def _everywhere(at: FailingLine, proposal: Proposal) -> Iterator[Proposal]:
    """Yield the same change wherever the same text stands: who errs on one line errs on the next.

    It comes first where the text is more than a name: then it is as wrong in the other places.
    """
    if len(proposal.edits) != 1 or proposal.code != "mended":
        return
    start, end, new = proposal.edits[0]
    old = at.script.text[start:end]
    nodes = (node for node in ast.walk(at.script.tree) if isinstance(node, ast.expr))
    spans = {at.script.span(node) for node in nodes if at.script.source(node) == old}
    if 1 < len(spans) <= _MOST_PLACES:
        edits = tuple(Edit(*span, new) for span in sorted(spans))
        cost = proposal.cost + (-0.01 if "(" in old else 0.01)
        yield Proposal(proposal.code, cost, edits, proposal.values)


def _is_called(at: FailingLine, node: ast.expr) -> bool:
    parent = at.script.parent(node)
    return isinstance(parent, ast.Call) and parent.func is node


def _brackets(at: FailingLine) -> Iterator[Proposal]:
    """Yield brackets where a function or class itself is used, and none where a value or a callback is called."""
    classes = {one.name for one in classes_of(at.script)}
    callables = {*_CALLED, *classes, *(own_function.name for own_function in functions_of(at.script))}
    for node in at.nodes:
        if isinstance(node, ast.Name | ast.Attribute) and not _is_called(at, node):
            name = dotted(node).rpartition(".")[2] or getattr(node, "attr", "")
            parent = at.script.parent(node)
            handed = callee(parent).endswith(_MAKERS)
            if name in callables and isinstance(parent, ast.Attribute | ast.BinOp | ast.Call) and not handed:
                yield at.mended(0.5, node, f"{at.script.source(node)}()")
        if isinstance(node, ast.Subscript) and hasattr(builtins, dotted(node.value) or "-"):
            yield at.mended(0.4, node, f"{dotted(node.value)}({at.script.source(node.slice)})")
    for one in at.known:
        name = dotted(one.value)
        is_class = name.rpartition(".")[2][:1].isupper() and not name.isupper()
        if name.endswith(_LENT) and any(dotted(node) == one.target for node in at.nodes):
            yield at.mended(0.4, one.value, f"{name}()")
        if is_class and (name in classes or name in IMPORTS or name.endswith((".Request", "Twist"))):
            yield at.mended(0.6, one.value, f"{name}()")
    makers = calls_of(at.script, *_MAKERS)
    for call in (*at.calls, *(arg for maker in makers for arg in maker.args if isinstance(arg, ast.Call))):
        if not call.args and not call.keywords and isinstance(call.func, ast.Name | ast.Attribute):
            yield at.mended(0.7, call, at.script.source(call.func))


def _orders(at: FailingLine) -> Iterator[Proposal]:
    """Yield two arguments of a call exchanged; of what makes publishers and timers also where it failed later."""
    makers = [call for call in calls_of(at.script, *_MAKERS) if call not in at.calls]
    for cost, call in [*((0.8, one) for one in at.calls), *((1.4, maker) for maker in makers)]:
        if not 2 <= len(call.args) <= 4 or dotted(call.func).endswith(("range", "publish")):
            continue
        for i in range(len(call.args) - 1):
            one, other = call.args[i], call.args[i + 1]
            texts = (at.script.source(one), at.script.source(other))
            rest = [at.script.source(arg) for arg in call.args]
            rest[i], rest[i + 1] = texts[1], texts[0]
            yield at.mended(cost + 0.1 * i, call, f"{at.script.source(call.func)}({', '.join(rest)})")


def _arguments(at: FailingLine) -> Iterator[Proposal]:
    """Yield a call with an argument less, with the node, with two numbers as one, or without a keyword."""
    nodes = [one.target for one in at.known if makes_node(at.script, one)]
    for call in at.calls:
        func, given = at.script.source(call.func), [at.script.source(arg) for arg in call.args]
        if given and "positional" in at.error.message and "missing" not in at.error.message:
            yield at.mended(1.5, call, f"{func}()")
            yield at.mended(1.2, call, f"{func}({', '.join(given[:-1])})")
        if len(given) == 2 and all(one.isdigit() for one in given) and "publish" not in func:
            yield at.mended(0.3, call, f"{func}({given[0]}.{given[1]})")
        if func.endswith((".spin", ".spin_once")):
            for name in nodes[:2]:
                if given[:1] != [name] or len(given) > 1:
                    yield at.mended(0.5, call, f"rclpy.{func.rpartition('.')[2]}({name})")
        for keyword in call.keywords:
            if keyword.arg and f"'{keyword.arg}'" in at.error.message:
                value = at.script.source(keyword.value)
                start = at.script.span(keyword.value)[0] - len(keyword.arg) - 1
                edit = Edit(start, at.script.span(keyword.value)[1], value)
                old = f"{keyword.arg}={value}"
                yield at.proposal("mended", 0.5, (edit,), call.lineno, old=old, new=value)


def _missing_arguments(at: FailingLine) -> Iterator[Proposal]:
    """Yield a name of the script's for an argument that a call lacks: one with a word of the function's."""
    match = re.match(
        r"(?:\w+\.)?(\w+)\(\) missing \d+ required positional arguments?: '(\w+)'", at.error.message
    )
    if match is None:
        return
    wanted = _words_of(f"{match[1]}_{match[2]}")
    names = {one.target: len(wanted & _words_of(one.target)) for one in at.known if one.target != match[2]}
    for call in at.calls:
        if dotted(call.func).rpartition(".")[2] == match[1]:
            given = [at.script.source(arg) for arg in call.args]
            for place, name in enumerate(sorted(names, key=lambda one: -names[one])[:2]):
                if names[name]:
                    new = f"{at.script.source(call.func)}({', '.join([*given, name])})"
                    yield at.mended(0.3 + 0.05 * place, call, new)


def _words_of(name: str) -> set[str]:
    return set(re.findall("[a-z]+", name.lower())) - {"self"}


def _signatures(at: FailingLine) -> Iterator[Proposal]:
    """Yield other parameters for a function of the script's own that got too many or too few arguments."""
    match = re.match(r"(?:\w+\.)?(\w+)\(\) (takes|missing)", at.error.message)
    for function in functions_of(at.script):
        if match is None or function.name != match[1]:
            continue
        names = [arg.arg for arg in function.args.args]
        head = at.script.line(function.lineno)
        if not head.rstrip().endswith(":") or function.args.defaults or head.count("(") != 1:
            continue
        in_class = isinstance(at.script.parent(function), ast.ClassDef)
        if in_class and names == ["self"] and "'self'" in at.error.message:
            yield at.headed(0.4, function, f"def {function.name}():")
        ways = [
            [*names, _given_name(at, function)],
            names[:-1],
            [*names, "request", "response"],
            [*names, "response"],
        ]
        if names[-1:] and names[-1].startswith("req"):
            ways.reverse()
        if in_class and names[:1] != ["self"]:
            ways = [["self", *names], ["self", *names[1:]]]
        if names:
            ways.append([*names[:-1], f"{names[-1]}=None"])
        for place, way in enumerate(ways):
            if way[:1] == ["self"] or not in_class:
                yield at.headed(0.5 + 0.2 * place, function, f"def {function.name}({', '.join(way)}):")


def _given_name(at: FailingLine, function: Functions) -> str:
    """Return how a parameter is called that takes what the failing line gives; a callback's is the message."""
    owner = at.script.parent(function)
    names = {function.name, owner.name if isinstance(owner, ast.ClassDef) else ""}
    given = next(
        (call.args[-1] for call in at.calls if call.args and dotted(call.func).rpartition(".")[2] in names),
        None,
    )
    return "msg" if given is None else dotted(given).rpartition(".")[2].lower() or "value"


def _own_names(at: FailingLine) -> Iterator[Proposal]:
    """Yield another name for what has one of Node's, of a builtin, of a module, or of an own method."""
    methods = {own_function.name for own_function in functions_of(at.script)}
    taken = {one.target.removeprefix("self.") for one in at.known} | methods
    for name in sorted(taken & _OF_NODE):
        yield from _renamed(at, 0.6, name, f"my_{name.strip('_')}", calls=True)
    for one in at.known:
        name = one.target.removeprefix("self.")
        is_taken = "." not in one.target and (hasattr(builtins, name) or name in MODULES)
        if (one.target.startswith("self.") and name in methods) or is_taken:
            yield from _renamed(at, 0.6, name, f"{name}_value", calls=False)
    for function in functions_of(at.script):
        for argument in function.args.args:
            if argument.arg in ("time", "math", "rclpy", "random"):
                new = f"{argument.arg}_s" if argument.arg == "time" else f"my_{argument.arg}"
                names = [
                    node
                    for node in ast.walk(function)
                    if isinstance(node, ast.Name) and node.id == argument.arg
                ]
                uses = [one for one in names if not isinstance(at.script.parent(one), ast.Attribute)]
                edits = [at.script.replaced(use, new) for use in uses]
                start = at.script.text.find(
                    argument.arg, at.script.span(function)[0] + len(function.name) + 4
                )
                edits.append(Edit(start, start + len(argument.arg), new))
                yield at.proposal("mended", 0.7, edits, function.lineno, old=argument.arg, new=new)


def _own_classes(at: FailingLine) -> Iterator[Proposal]:
    """Yield another name for an object that has the one of its class."""
    imports = [one for one in ast.walk(at.script.tree) if isinstance(one, ast.ImportFrom)]
    classes = {alias.asname or alias.name for one in imports for alias in one.names}
    for one in at.known:
        if one.target not in classes or not isinstance(one.value, ast.Call):
            continue
        scope: ast.AST = function_around(at.script, one.statement) or at.script.tree
        uses = [
            node
            for node in ast.walk(scope)
            if isinstance(node, ast.Name) and node.id == one.target and _is_object(at, node, one.statement)
        ]
        new = one.target.lower()
        edits = [at.script.replaced(use, new) for use in uses]
        yield at.proposal("mended", 0.15, edits, one.statement.lineno, old=one.target, new=new)


def _is_object(at: FailingLine, name: ast.Name, begin: ast.stmt) -> bool:
    """Whether the name of a class stands for the object that has it since `begin`."""
    parent = at.script.parent(name)
    is_later = name.lineno >= begin.lineno and not isinstance(parent, ast.Call | ast.arg)
    return is_later or callee(parent).endswith("publish")


def _renamed(at: FailingLine, cost: float, old: str, new: str, *, calls: bool) -> Iterator[Proposal]:
    """Yield a name written otherwise wherever it is the script's own; not where it is called, unless `calls`."""
    edits: list[Edit] = []
    line = 0
    for node in ast.walk(at.script.tree):
        if isinstance(node, ast.Attribute) and node.attr == old and dotted(node.value) == "self":
            if calls or not _is_called(at, node):
                end = at.script.span(node)[1]
                edits.append(Edit(end - len(old), end, new))
        elif isinstance(node, ast.Name) and node.id == old and not (calls or _is_called(at, node)):
            if isinstance(at.script.parent(node), ast.Attribute):
                continue  # the module's
            edits.append(at.script.replaced(node, new))
        elif isinstance(node, Functions) and node.name == old and calls:
            start = at.script.text.index(old, at.script.span(node)[0])
            edits.append(Edit(start, start + len(old), new))
        else:
            continue
        line = line or node.lineno
    if edits:
        yield at.proposal("mended", cost, edits, line, old=old, new=new)


def _fields(at: FailingLine) -> Iterator[Proposal]:
    """Yield a field that the message has; the one that takes a number, for a whole vector, an index, or none."""
    for node in at.nodes:
        parent = at.script.parent(node)
        if not isinstance(node, ast.Attribute):
            continue
        function = (
            function_around(at.script, node)
            if f"_Request' object has no attribute '{node.attr}'" in at.error.message
            else None
        )
        for argument in function.args.args if function is not None else ():
            if argument.arg.startswith("res"):
                yield at.mended(0.1, node, f"{argument.arg}.{node.attr}")
        for place, name in enumerate(
            at.seen.fields if f"attribute '{node.attr}'" in at.error.message else ()
        ):
            yield at.mended(0.5 + 0.05 * place, node, f"{at.script.source(node.value)}.{name}")
        if node.attr in _AXES and isinstance(parent, ast.Assign | ast.AugAssign):
            yield at.mended(0.4, node, f"{at.script.source(node)}.{_AXES[node.attr]}")
        if node.attr in _AXES and isinstance(parent, ast.Subscript):
            index = getattr(parent.slice, "value", None)
            if isinstance(index, int | str) and index in _INDICES:
                yield at.mended(0.4, parent, f"{at.script.source(node)}.{_INDICES[index]}")
        if node.attr in ("x", "z") and isinstance(parent, ast.Assign):
            axis = "linear" if node.attr == "x" else "angular"
            yield at.mended(0.6, node, f"{at.script.source(node.value)}.{axis}.{node.attr}")


def _vectors(at: FailingLine) -> Iterator[Proposal]:
    """Yield what stands in a list of one item, attributes for keys, and what there is for an item that is not."""
    for node in at.nodes:
        if isinstance(node, ast.Subscript) and at.error.type == "IndexError":
            index = getattr(node.slice, "value", None)
            if dotted(node.value) == "sys.argv":
                yield at.mended(0.3, node, "input()")
            elif isinstance(index, int) and index > 0:
                yield at.mended(0.4, node, f"{at.script.source(node.value)}[{index - 1}]")
        if isinstance(node, ast.Call) and "not 'list'" in at.error.message:
            owner, _, method = at.script.source(node.func).rpartition(".")
            if method == "split":
                yield at.mended(0.15, node, owner)
        if isinstance(node, ast.List | ast.Tuple) and len(node.elts) == 1:
            yield at.mended(0.6, node, at.script.source(node.elts[0]))
        if isinstance(node, ast.Subscript) and isinstance(getattr(node.slice, "value", None), str):
            whole = re.sub(r"\[['\"](\w+)['\"]\]", r".\1", at.script.source(node))
            yield at.mended(0.5, node, whole)


def _numbers(at: FailingLine) -> Iterator[Proposal]:
    """Yield a number for a tuple that a comma at its end made, and decimals in all fields at once."""
    whole = []
    kind = re.search(r"field must be of type '(int|str)'", at.error.message)
    for value in _given_to_fields(at) if kind else ():
        yield at.mended(0.15, value, f"{kind and kind[1]}({at.script.source(value)})")
    for one in at.known:
        value = one.value
        if isinstance(value, ast.Tuple) and len(value.elts) == 1 and number_of(value.elts[0]) is not None:
            yield at.mended(0.6, value, at.script.source(value.elts[0]).strip("(), "))
        written = at.script.source(value)
        if re.search(r"\.(linear|angular)\.[xyz]$", one.target) and written.lstrip("-").isdigit():
            whole.append(value)
    if len(whole) > 1 and "float" in at.error.message:
        old = at.script.source(whole[0])
        edits = tuple(at.script.replaced(one, f"{at.script.source(one)}.0") for one in whole)
        values = {"line": whole[0].lineno, "old": old, "new": f"{old}.0"}
        yield Proposal("float", 0.15, edits, values)


def _given_to_fields(at: FailingLine) -> Iterator[ast.expr]:
    """Yield what the failing line gives to fields."""
    for statement in at.statements:
        if isinstance(statement, ast.Assign):
            yield statement.value
    yield from (keyword.value for call in at.calls for keyword in call.keywords)


def _scopes(at: FailingLine) -> Iterator[Proposal]:
    """Yield ``self.`` before a name that another method sets for itself, and what is needed set earlier."""
    match = re.search(r"(?:name|attribute|variable) '(\w+)'", at.error.message)
    name = match[1] if match else ""
    for one in at.known:
        if (
            one.target == name
            and isinstance(one.statement, ast.Assign)
            and function_around(at.script, one.statement) is not None
        ):
            start = at.script.span(one.statement)[0]
            edits = [Edit(start, start, "self.")]
            inside = function_around(at.script, one.statement)
            for node in ast.walk(inside) if inside is not None else ():
                if isinstance(node, ast.Name) and node.id == name and at.script.span(node)[0] != start:
                    edits.append(at.script.replaced(node, f"self.{name}"))
            edits += [
                at.script.replaced(node, f"self.{name}")
                for node in at.nodes
                if isinstance(node, ast.Name) and node.id == name
            ]
            yield at.proposal("mended", 0.4, edits, one.statement.lineno, old=name, new=f"self.{name}")
        if one.target == f"self.{name}":
            yield from _sooner(at, one.statement)


def _sooner(at: FailingLine, needed: ast.stmt) -> Iterator[Proposal]:
    """Yield the statement that sets something moved before the first one of its block that needs it."""
    block = at.script.block_of(needed)
    text = at.script.source(needed)
    first = next((one for one in block if not re.search(r"super\(\)|^['\"]", at.script.source(one))), needed)
    if needed not in (first, block[0]) and "\n" not in text:
        edits = (at.script.removed(needed), at.script.inserted_before(first, text))
        yield at.proposal("sooner", 0.6, edits, needed.lineno, old=text, new=text)


def _objects(at: FailingLine) -> Iterator[Proposal]:
    """Yield the publisher for what cannot publish, and the object for the class on which a method is called."""
    made = [(one.target, dotted(one.value.func)) for one in at.known if isinstance(one.value, ast.Call)]
    publishers = [name for name, func in made if func.endswith("create_publisher")]
    objects = [one.target for one in at.known if makes_node(at.script, one)]
    classes = {one.name for one in classes_of(at.script)}
    for call in at.calls:
        owner, _, method = dotted(call.func).rpartition(".")
        others = publishers if method == "publish" else objects if owner in classes else []
        for name in others[:2]:
            if owner != name:
                yield at.mended(0.3, call.func, f"{name}.{method}")


def _words(at: FailingLine) -> Iterator[Proposal]:
    """Yield ``self.`` before a method of Node's, Python's word for one of another language, a key that is near."""
    match = re.match(r"name '(\w+)' is not defined|.*has no attribute '(\w+)'|'(.+)'$", at.error.message)
    name = next((group for group in match.groups() if group), "") if match else ""
    for node in at.nodes:
        if isinstance(node, ast.Name) and node.id == name:
            if name in _OF_NODE:
                yield at.mended(0.2, node, f"self.{name}")
            instead = OTHER_LANGUAGES.get(name, "")
            if instead and "(" not in instead:
                yield at.mended(0.2, node, instead)
        if isinstance(node, ast.Attribute) and node.attr == name and name.startswith("log"):
            level = name.removeprefix("log").replace("err", "error")
            yield at.mended(0.2, node, f"{at.script.source(node.value)}.get_logger().{level}")
        if isinstance(node, ast.Constant) and node.value == name and isinstance(name, str):
            keys = [one.value for one in ast.walk(at.script.tree) if isinstance(one, ast.Constant)]
            near = near_name(name, [key for key in keys if isinstance(key, str) and key != name])
            if near is not None:
                yield at.mended(0.3, node, f"'{near}'")


def _copies(at: FailingLine) -> Iterator[Proposal]:
    """Yield the name that is missing for the second of two functions of one name."""
    match = re.search(r"name '(\w+)' is not defined|has no attribute '(\w+)'", at.error.message)
    if match is None:
        return
    missing, known = match[1] or match[2], set()
    for function in sorted(functions_of(at.script), key=lambda one: one.lineno):
        if (function.name, at.script.parent(function)) in known:
            head = at.script.line(function.lineno).strip().replace(function.name, missing, 1)
            yield at.headed(0.15, function, head)
        known.add((function.name, at.script.parent(function)))


def _blocks(at: FailingLine) -> Iterator[Proposal]:
    """Yield a method that stands outside of its class, or a function within another one or a class, moved out."""
    for function in functions_of(at.script):
        outer = at.script.parent(function)
        names = [arg.arg for arg in function.args.args]
        if f"'{function.name}'" not in at.error.message:
            continue
        end = (function.end_lineno or function.lineno) + 1
        if isinstance(outer, ast.ClassDef) if names[:1] != ["self"] else isinstance(outer, Functions):
            yield _moved(at, function, function.lineno, end, outwards=True)
        elif names[:1] == ["self"]:
            yield _moved(at, function, function.lineno, end)
        if isinstance(outer, Functions) and [arg.arg for arg in outer.args.args][:1] == ["self"]:
            yield _moved(at, outer, outer.lineno, function.lineno)


def _moved(
    at: FailingLine,
    first: Functions,
    start: int,
    end: int,
    *,
    outwards: bool = False,
) -> Proposal:
    """Return the proposal that moves the lines from `start` up to `end` by one step."""
    starts = [at.script.line_start(number) for number in range(start, end) if at.script.line(number).strip()]
    edits = tuple(Edit(one, one + 4, "") if outwards else Edit(one, one, "    ") for one in starts)
    return at.proposal("outdented" if outwards else "indented", 0.3, edits, first.lineno, old=first.name)


def _class_bodies(at: FailingLine) -> Iterator[Proposal]:
    """Yield ``def __init__(self):`` above lines of a class that use ``self``, or them as part of a method."""
    if at.error.message != "name 'self' is not defined" or not at.statements:
        return
    first = at.statements[0]
    block = at.script.block_of(first)
    if not isinstance(at.script.parent(first), ast.ClassDef):
        return
    place = block.index(first)
    until = next((k for k in range(place, len(block)) if isinstance(block[k], Functions)), len(block))
    starts = [
        at.script.line_start(number)
        for number in range(first.lineno, (block[until - 1].end_lineno or first.lineno) + 1)
        if at.script.line(number).strip()
    ]
    inwards = tuple(Edit(one, one, "    ") for one in starts)
    if place and isinstance(method := block[place - 1], ast.FunctionDef):
        yield Proposal("into_method", 0.2, inwards, {"line": first.lineno, "name": method.name})
    head = ("def __init__(self):", "super().__init__('my_node')")
    edit = at.script.inserted_before(first, head[0], f"    {head[1]}")
    yield at.proposal("added", 0.3, (edit, *inwards), first.lineno, new=" ".join(head))


def _imports(at: FailingLine) -> Iterator[Proposal]:
    """Yield the statement that imports what another one did not find, and a module for its function."""
    for statement in at.statements:
        if isinstance(statement, ast.Import | ast.ImportFrom):
            names = [name.name.rpartition(".")[2] for name in statement.names]
            known = [_statement_for(name) for name in names]
            lines = list(dict.fromkeys(one for one in known if one))
            if lines and len(names) == len([one for one in known if one]):
                yield at.mended(0.2, statement, "\n".join(lines))
    for node in ast.walk(at.script.tree):
        if isinstance(node, ast.ImportFrom) and node.module == "time":
            yield at.mended(0.5, node, "import time")


def _statement_for(name: str) -> str:
    """Return the import of a name, whatever its capitals."""
    same = [one for one in IMPORTS if one == name] or [one for one in IMPORTS if one.lower() == name.lower()]
    return IMPORTS[same[0]] if same else ""


def _texts(at: FailingLine) -> Iterator[Proposal]:
    """Yield a text made of a number, where one is added to a text or logged, and a whole number for an index."""
    for node in at.nodes:
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add) and "str" in at.error.message:
            for side in (node.left, node.right):
                if isinstance(side, ast.Name | ast.Attribute | ast.Subscript | ast.Call):
                    yield at.mended(0.4, side, f"str({at.script.source(side)})")
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div) and "integer" in at.error.message:
            text = f"{at.script.source(node.left)} // {at.script.source(node.right)}"
            yield at.mended(0.3, node, text)
            yield at.mended(0.35, node, f"int({at.script.source(node)})")
    for call in at.calls:
        if call.args and at.script.source(call.func).endswith(("info", "warning", "error", "warn", "debug")):
            texts = [at.script.source(arg) for arg in call.args]
            joined = " + ".join(one if one[:1] in "'\"" else f"str({one})" for one in texts)
            yield at.mended(0.4, call, f"{at.script.source(call.func)}({joined})")
    for node in at.nodes:
        if isinstance(node, ast.Constant) and type(node.value) is int and "iterable" in at.error.message:
            yield at.mended(0.3, node, f"range({node.value})")


def _waits(at: FailingLine) -> Iterator[Proposal]:
    """Yield a return until a message has come, where a value of it is used before."""
    if "None" not in at.error.message:
        return
    for statement in at.statements:
        function = function_around(at.script, statement)
        if function is None:
            continue
        for node in at.nodes:
            name = dotted(node)
            if name.startswith("self.") and any(
                one.target == name and getattr(one.value, "value", 0) is None for one in at.known
            ):
                test = f"if {name} is None:"
                edit = at.script.inserted_before(function.body[0], test, "    return")
                yield at.added(0.5, edit, function.lineno + 1, f"{test} return")
                spin = at.script.inserted_before(
                    statement, f"while {name} is None:", "    rclpy.spin_once(self)"
                )
                yield at.added(0.8, spin, statement.lineno, f"while {name} is None: rclpy.spin_once(self)")


def _uncalled(at: FailingLine) -> Iterator[Proposal]:
    """Yield a call of a function that nothing calls.

    Before all else where it sets what has no value yet; in the place of a class where ROS had not begun.
    """
    used = {dotted(node) for node in at.nodes}
    classes = (
        {one.name for one in classes_of(at.script)} if at.error.type == "NotInitializedException" else ()
    )
    makers = [call for call in calls_of(at.script, *classes) if function_around(at.script, call) is None]
    last = at.script.tree.body[-1]
    first = last.body[0] if isinstance(last, ast.If) else last
    for function in at.script.tree.body:
        if not isinstance(function, ast.FunctionDef) or calls_of(at.script, function.name):
            continue
        if not function.args.args and used & {
            one.target for one in at.known if function_around(at.script, one.statement) is function
        }:
            edit = at.script.inserted_before(first, f"{function.name}()")
            yield Proposal("call", 0.3, (edit,), {"line": function.lineno, "name": function.name})
        for call in makers:
            if isinstance(at.script.parent(call), ast.Expr):
                yield at.mended(0.05, call, f"{function.name}()")


def _without(at: FailingLine) -> Iterator[Proposal]:
    """Yield the script without the call that failed, or without what ended ROS before: where nothing needs it."""
    for call in calls_of(at.script, "shutdown", "destroy_node"):
        statement = at.script.parent(call)
        if isinstance(statement, ast.Expr) and call.lineno in at.seen.ledger.ran:
            values = {"line": call.lineno, "old": at.script.source(call)}
            yield Proposal("removed", 1.6, (at.script.removed(statement),), values)
    for statement in at.statements:
        called = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call)
        if called and not re.search(r"log|info|print|publish|spin|INFO", at.script.source(statement)):
            values = {"line": statement.lineno, "old": at.script.source(statement).partition("\n")[0]}
            yield Proposal("removed", 3.0, (at.script.removed(statement),), values)
