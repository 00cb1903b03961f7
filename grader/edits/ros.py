"""Changes of what rclpy rejects: how a node is made and ended, and what it makes, reads and answers."""

import ast
import re
from collections.abc import Callable, Iterator
from typing import Final

from grader.edits.failing import FailingLine
from grader.edits.situation import Proposal, replacing
from grader.edits.slices import (
    calls_of,
    classes_of,
    dotted,
    function_around,
    functions_of,
    imported,
    makes_node,
    named_in,
    number_of,
    statement_around,
)
from grader.edits.tree import Edit


def _node_parts(at: FailingLine) -> Iterator[Proposal]:
    """Yield what makes a node of a class: its base, `__init__` under its name, the call of Node's, a name."""
    for node in ast.walk(at.script.tree):
        if isinstance(node, ast.Call) and not node.args and "node_name" in at.error.message:
            func = at.script.source(node.func)
            if func.endswith((".__init__", "create_node")) or (func == "Node" and node in at.calls):
                yield at.mended(0.3, node, f"{func}('my_node')")
        if isinstance(node, ast.Attribute) and dotted(node) == "super.__init__":
            yield at.mended(0.3, node, "super().__init__")
    for owner in classes_of(at.script):
        yield from _bases(at, owner)
        for method in owner.body:
            if isinstance(method, ast.FunctionDef):
                yield from _beginnings(at, method)


def _bases(at: FailingLine, owner: ast.ClassDef) -> Iterator[Proposal]:
    if [dotted(base).rpartition(".")[2] for base in owner.bases] != ["Node"]:
        yield at.headed(0.4, owner, f"class {owner.name}(Node):")
    elif dotted(owner.bases[0]) == "rclpy.Node":
        edit = at.script.inserted_before(at.script.tree.body[0], "from rclpy.node import Node")
        yield at.mended(0.3, owner.bases[0], "Node", edit)


def _beginnings(at: FailingLine, method: ast.FunctionDef) -> Iterator[Proposal]:
    letters = method.name.strip("_").lower()
    if method.name != "__init__" and sorted(letters) in (sorted("init"), sorted("int"), sorted("inti")):
        head = at.script.line(method.lineno).strip().replace(method.name, "__init__", 1)
        uses = (one for one in ast.walk(method) if isinstance(one, ast.Attribute) and one.attr == method.name)
        calls = [Edit((end := at.script.span(use)[1]) - len(use.attr), end, "__init__") for use in uses]
        yield at.headed(0.2, method, head, *calls)
    if method.name != "__init__":
        return
    begun = [
        one for one in method.body if "super" in at.script.source(one) and "__init__" in at.script.source(one)
    ]
    if not begun:
        line = "super().__init__('my_node')"
        yield at.added(0.4, at.script.inserted_before(method.body[0], line), method.lineno + 1, line)
    elif begun[0] is not method.body[0]:
        text = at.script.source(begun[0])
        edits = (at.script.removed(begun[0]), at.script.inserted_before(method.body[0], text))
        yield at.proposal("sooner", 0.5, edits, begun[0].lineno, old=text, new=text)


def _parameters_of_ros(at: FailingLine) -> Iterator[Proposal]:
    """Yield the value of a parameter, and its declaration with a default."""
    lengths = [one for one in at.seen.wanted.lengths_m[:2] if one >= 1.0]  # less is what is wanted at least
    values = [*dict.fromkeys((*map(str, lengths), "1.0"))]
    for call in calls_of(at.script, "get_parameter", "declare_parameter"):
        parent = at.script.parent(call)
        if isinstance(parent, ast.Attribute) and parent.attr != "value":
            outer = at.script.parent(parent)
            whole = outer if isinstance(outer, ast.Call) and outer.func is parent else parent
            yield at.mended(0.5, whole, f"{at.script.source(call)}.value")
        elif not isinstance(parent, ast.Attribute | ast.Expr):
            yield at.mended(0.5, call, f"{at.script.source(call)}.value")
        if call.args and "eclar" in at.error.type and "get_" in dotted(call.func):
            statement = statement_around(at.script, call)
            if statement is not None:
                owner = dotted(call.func).removesuffix(".get_parameter")
                for place, value in enumerate(values):
                    line = f"{owner}.declare_parameter({at.script.source(call.args[0])}, {value})"
                    edit = at.script.inserted_before(statement, line)
                    yield at.added(0.3 + 0.01 * place, edit, statement.lineno, line)
    for call in calls_of(at.script, "declare_parameter"):
        given = call.args[1] if len(call.args) > 1 else None
        old = "" if given is None else at.script.source(given)
        if given is not None and old.isdigit() and "'INTEGER'" in at.error.message:
            yield replacing(at.script, "float", 0.1, given, f"{old}.0")
        if given is not None and "ninitialized" in at.error.type:
            yield at.mended(0.3, given, values[-1])


def _durations(at: FailingLine) -> Iterator[Proposal]:
    """Yield seconds for a time or duration of ROS, in ROS 1's words or compared with a number."""
    for node in at.nodes:
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "to_sec":
            yield at.mended(0.2, node, f"({at.script.source(node.func.value)}).nanoseconds / 1e9")
        if isinstance(node, ast.Compare) and "'Duration'" in at.error.message:
            yield at.mended(0.2, node.left, f"({at.script.source(node.left)}).nanoseconds / 1e9")


def _makers(at: FailingLine) -> Iterator[Proposal]:
    """Yield a publisher where a subscription was made, and a class where an object was given for its type."""
    for call in calls_of(at.script, "create_subscription"):
        given = [at.script.source(arg) for arg in call.args]
        if len(given) in (3, 4) and "ubscription" in at.error.message:
            func = at.script.source(call.func).replace("subscription", "publisher")
            yield at.mended(0.6, call, f"{func}({', '.join((*given[:2], given[-1]))})")
    for call in calls_of(at.script, "create_publisher"):
        if call.args and isinstance(call.args[0], ast.Call):
            yield at.mended(0.5, call.args[0], at.script.source(call.args[0].func))


def _answers(at: FailingLine) -> Iterator[Proposal]:
    """Yield the answer that a callback of a service, or of parameters that are set, does not return."""
    makers = [("create_service", 2)] if (at.error.type, at.error.message.strip()) == ("TypeError", "") else []
    makers += [("add_on_set_parameters_callback", 1)] * ("'successful'" in at.error.message)
    for maker, needed in makers:
        names = named_in(calls_of(at.script, maker))
        for function in functions_of(at.script):
            arguments = [arg.arg for arg in function.args.args]
            if function.name not in names or len(arguments) < needed:
                continue
            line = f"return {'SetParametersResult(successful=True)' if needed == 1 else arguments[-1]}"
            last = function.body[-1]
            if isinstance(last, ast.Return):
                yield at.mended(0.4, last, line)
            else:
                end = last.end_lineno or last.lineno
                yield at.added(0.3, at.script.inserted_after(last, line), end + 1, line)


def _older_words(at: FailingLine) -> Iterator[Proposal]:
    """Yield what rclpy has for words of ROS 1 and of C++: a rate, a clock, a parameter, a macro that logs."""
    for one in at.known:
        hertz = number_of(one.value.args[0]) if isinstance(one.value, ast.Call) and one.value.args else None
        if hertz and "'Rate'" in at.error.message and dotted(one.value.func).endswith("Rate"):  # type: ignore[attr-defined]
            waits = [
                call for call in calls_of(at.script, "sleep") if dotted(call.func) == f"{one.target}.sleep"
            ]
            new = f"time.sleep({1.0 / hertz:g})"
            changes = [at.script.removed(one.statement), *(at.script.replaced(call, new) for call in waits)]
            changes += imported(at.script, "time")
            old = at.script.source(one.value)
            yield at.proposal("mended", 0.1, changes, one.statement.lineno, old=old, new=new)
    for call in at.calls:
        owner, _, name = dotted(call.func).rpartition(".")
        given = [at.script.source(arg) for arg in call.args]
        if name == "now" and owner.endswith("Time"):
            yield at.mended(0.1, call, f"{_node_here(at, call)}.get_clock().now()")
        if name == "get_param" and given:
            declared = {
                getattr(one.args[0], "value", "")
                for one in calls_of(at.script, "declare_parameter")
                if one.args
            }
            asked = getattr(call.args[0], "value", None)
            known = asked in declared or len(given) == 1
            new = f"get_parameter({given[0]})" if known else f"declare_parameter({', '.join(given)})"
            yield at.mended(0.1, call, f"{_node_here(at, call)}.{new}.value")
        macro = re.fullmatch(r"(?:RCLCPP|RCLPY|ROS)_(INFO|WARN|ERROR|DEBUG)", name)
        if macro and given:
            logger = given.pop(0) if "logger" in given[0] else f"{_node_here(at, call)}.get_logger()"
            rest = f" % ({', '.join(given[1:])})" if given[1:] else ""
            yield at.mended(0.1, call, f"{logger}.{macro[1].lower()}({''.join(given[:1])}{rest})")


def _node_here(at: FailingLine, node: ast.AST) -> str:
    """Return the name of the node where something stands: ``self`` in a method."""
    function = function_around(at.script, node)
    if function is not None and [one.arg for one in function.args.args][:1] == ["self"]:
        return "self"
    return next((one.target for one in at.known if makes_node(at.script, one)), "node")


def _ends(at: FailingLine) -> Iterator[Proposal]:
    """Yield what ended the node before it was needed, moved to the end of its function."""
    functions: dict[ast.AST, list[ast.stmt]] = {}
    for name in ("destroy_node", "shutdown"):
        for call in calls_of(at.script, name):
            statement = at.script.parent(call)
            if isinstance(statement, ast.Expr) and call.lineno in at.seen.ledger.ran:
                functions.setdefault(function_around(at.script, call) or at.script.tree, []).append(statement)
    for function, statements in functions.items():
        last = function.body[-1]  # type: ignore[attr-defined]
        texts = [at.script.source(one) for one in sorted(statements, key=lambda one: one.lineno)]
        edits = (*(at.script.removed(one) for one in statements), at.script.inserted_after(last, *texts))
        first = min(one.lineno for one in statements)
        yield at.proposal("later", 0.4, edits, first, old=", ".join(texts))


ROS_OPERATORS: Final[tuple[Callable[[FailingLine], Iterator[Proposal]], ...]] = (
    _node_parts,
    _parameters_of_ros,
    _durations,
    _older_words,
    _makers,
    _answers,
    _ends,
)
