"""Changes of which functions run: called, only named, commented out, or defined a second time."""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from typing import Final

from grader.edits.situation import Proposal, Situation, replacing
from grader.edits.slices import (
    Functions,
    assignments,
    callee,
    calls_of,
    classes_of,
    dotted,
    functions_of,
    is_method,
)
from grader.edits.spins import node_name
from grader.edits.tree import Edit, ParsedScript

_COMMENTED: Final = re.compile(
    r"^([ \t]*)# ?(((?:[\w.]|\(\))+)\([^#]*\)|[\w.]+\.(?:linear|angular)\.\w+ *= *[^#]+)$"
)
_WORK: Final = frozenset(("info", "publish", "spin", "start"))
_MOST_COMMENTS: Final = 12
_MOST_ARGUMENTS: Final = 4


def call_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield calls of what is never called, and what keeps a function from being the one that runs."""
    yield from _named_only(seen)
    yield from _lambdas(seen)
    yield from _objects(seen)
    yield from _never_called(seen)
    yield from _defined_twice(seen)
    yield from _commented(seen)


def _named_only(seen: Situation) -> Iterator[Proposal]:
    """Yield the brackets of a call that is only named, with what its function needs."""
    for node in ast.walk(seen.script.tree):
        if not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Name | ast.Attribute)):
            continue
        if not (name := dotted(node.value)):
            continue
        given = {"spin": node_name(seen.script), "publish": "msg"}.get(name.rpartition(".")[2], "")
        for place, arguments in enumerate([given] if given else _arguments(seen, name.rpartition(".")[2])):
            new = f"{name}({arguments})"
            yield replacing(seen.script, "brackets", 0.8 + place * 0.05, node.value, new)


def _arguments(seen: Situation, name: str) -> list[str]:
    """Return what may be given to a function: as elsewhere, nothing, names that nothing asks for, wanted sizes."""
    functions = [one for one in functions_of(seen.script) if one.name == name]
    if not functions:
        return [""]
    arguments = functions[-1].args
    own = is_method(seen.script, functions[-1].body[0])
    needed = len(arguments.args) - len(arguments.defaults) - own
    if needed <= 0:
        return [""]
    known = assignments(seen.script)
    other = [", ".join(map(seen.script.source, call.args)) for call in calls_of(seen.script, name)]
    if other or needed > 1:
        return list(dict.fromkeys(other))[:_MOST_ARGUMENTS]
    places = Counter(dotted(one) for one in ast.walk(seen.script.tree))
    unused = [one.target for one in known if places[one.target] == 1 and one.target.count(".") < 2]
    sizes = [f"{one:g}" for one in (*seen.wanted.turns_deg, *seen.wanted.lengths_m)]
    return list(dict.fromkeys((*unused, *sizes)))[:_MOST_ARGUMENTS]


def _lambdas(seen: Situation) -> Iterator[Proposal]:
    """Yield the call that a lambda only names."""
    for node in ast.walk(seen.script.tree):
        if isinstance(node, ast.Lambda) and dotted(node.body):
            name = dotted(node.body)
            yield replacing(seen.script, "brackets", 0.8, node.body, f"{name}()")


def _objects(seen: Situation) -> Iterator[Proposal]:
    """Yield an object, where a class of the script's own is given to `spin`."""
    classes = {node.name for node in classes_of(seen.script)}
    for call in calls_of(seen.script, "spin"):
        if call.args and dotted(call.args[0]) in classes:
            name = dotted(call.args[0])
            made = next((one.target for one in assignments(seen.script) if callee(one.value) == name), "")
            if made:
                yield replacing(seen.script, "name", 0.4, call.args[0], made)
            yield replacing(seen.script, "brackets", 0.6, call.args[0], f"{name}()")


def _never_called(seen: Situation) -> Iterator[Proposal]:
    """Yield a call of a function that nothing calls: at the end, or behind the call of one of its kind."""
    used = _used_names(seen.script)
    for node in functions_of(seen.script):
        if node.name.startswith("__") or node.name in used:
            continue
        values = {"line": node.lineno, "name": node.name}
        yield from _behind_others(seen, node, values)
        needed = len(node.args.args) - len(node.args.defaults)
        if is_method(seen.script, node.body[0]):
            owner = seen.script.parent(node)
            inits = (one for one in getattr(owner, "body", ()) if getattr(one, "name", "") == "__init__")
            init = next(inits, None)
            if init is not None and needed == 1:
                edit = seen.script.inserted_after(init.body[-1], f"self.{node.name}()")
                yield Proposal("call", 3.0, (edit,), values)
            yield from _on_object(seen, node, values) if needed == 1 else ()
        elif needed == 0 and isinstance(seen.script.parent(node), ast.Module):
            edit = seen.script.inserted_after(seen.script.tree.body[-1], "", f"{node.name}()")
            yield Proposal("call", 1.0, (edit,), values)


def _behind_others(seen: Situation, function: Functions, values: dict[str, object]) -> Iterator[Proposal]:
    """Yield a call behind each one in a loop of another function that stands in the same place as `function`."""
    others = {
        one.name
        for one in seen.script.block_of(function)
        if isinstance(one, Functions)
        and one is not function
        and len(one.args.args) == len(function.args.args)
    }
    for node in ast.walk(seen.script.tree):
        if not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)):
            continue
        prefix, dot, name = dotted(node.value.func).rpartition(".")
        if name in others and isinstance(seen.script.parent(node), ast.For | ast.While):
            for place, arguments in enumerate(_arguments(seen, function.name)):
                edit = seen.script.inserted_after(node, f"{prefix}{dot}{function.name}({arguments})")
                yield Proposal("call", 1.4 + place * 0.05, (edit,), values)


def _on_object(seen: Situation, method: Functions, values: dict[str, object]) -> Iterator[Proposal]:
    """Yield the call of a method behind the line that makes its object."""
    owner = getattr(seen.script.parent(method), "name", "")
    for one in assignments(seen.script):
        if callee(one.value) == owner:
            edit = seen.script.inserted_after(one.statement, f"{one.target}.{method.name}()")
            yield Proposal("call", 1.2, (edit,), values)


def _used_names(script: ParsedScript) -> set[str]:
    nodes = list(ast.walk(script.tree))
    names = {node.id for node in nodes if isinstance(node, ast.Name)}
    return names | {node.attr for node in nodes if isinstance(node, ast.Attribute)}


def _defined_twice(seen: Situation) -> Iterator[Proposal]:
    """Yield the script without a later definition, which replaces the one of the same name before it."""
    for node in ast.walk(seen.script.tree):
        if not isinstance(node, ast.Module | ast.ClassDef):
            continue
        first: dict[str, int] = {}
        for one in node.body:
            if isinstance(one, Functions) and not one.decorator_list:
                if one.name in first:
                    values = {"line": one.lineno, "name": one.name, "before": first[one.name]}
                    yield Proposal("defined_twice", 0.6, (seen.script.removed(one),), values)
                first.setdefault(one.name, one.lineno)


def _commented(seen: Situation) -> Iterator[Proposal]:
    """Yield a call, or a speed, that only stands in a comment."""
    functions = {one.name for one in functions_of(seen.script)} | _WORK
    lines = enumerate(seen.script.text.splitlines(), start=1)
    matches = ((number, match) for number, line in lines if (match := _COMMENTED.match(line)))
    for number, match in list(matches)[:_MOST_COMMENTS]:
        if not match[3] or match[3].rpartition(".")[2] in functions:
            start = seen.script.line_start(number)
            edit = Edit(start, start + len(match[0]), match[1] + match[2])
            yield Proposal("commented", 1.1, (edit,), {"line": number, "new": match[2].strip()})
