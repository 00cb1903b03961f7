"""Causes of exceptions that show in the script's text, but not in type and message: which line must be changed.

Each function takes the exception, the line that raised it, and the script; it returns a code with the values of
its sentence ``mistake.<code>``, or None where the script does not show the cause for certain.
"""

import builtins
import difflib
import re
from collections.abc import Callable, Mapping
from typing import Final

from grader.contracts.outcome import StudentError
from grader.messages.script import ScriptText

Closer = tuple[str, dict[str, object]] | None

_PRIVATE_OF_NODE: Final = (
    r"_(publishers|subscriptions|timers|clients|services|guards|waitables|parameters|descriptors|clock|logger|"
    r"default_callback_group|rate_group|context|time_source|parameter_overrides)"
)
_CALLBACKS: Final = {
    "timer": ("timer_callback", "self"),
    "subscription": ("subscription_callback", "self, msg"),
    "service": ("service_callback", "self, request, response"),
}
_ENDPOINTS: Final = {
    "publisher": "self.create_publisher(Twist, '/turtle1/cmd_vel', 10)",
    "subscription": "self.create_subscription(Pose, '/turtle1/pose', self.callback, 10)",
}
_NEAR: Final = 0.75
_MOST: Final = 50  # names that are compared, which takes the square of their lengths
_KNOWN_ROOT: Final = re.compile(
    r"rcl|ros|geometry|turtle|std|sensor|nav|tf|launch|ament|_|(\w+_)?(msgs?|srvs?)$", re.I
)
_Look = Callable[[StudentError, str, ScriptText], Closer]
_GENERAL: Final = frozenset(
    ("crashed", "unknown_attribute", "not_callable", "not_iterable", "function_not_called", "still_none")
)
"""Codes of exceptions that say little by themselves, as those that rise inside of Node do."""


def missing_global(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find a name of the module that a function assigns without ``global``."""
    found = re.search(r"'(\w+)'", error.message)
    name = found[1] if found else ""
    outer = script.lines_with(rf"^{re.escape(name)} ?=(?!=)") if name else []
    function = script.function_around(error.line or 0) if outer and error.line else ""
    made = script.definition(function) if function else None
    return ("missing_global", {"name": name, "function": function, "begins": made.line}) if made else None


def calls_itself(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find the call of the function around the failed line in its own body."""
    function = script.function_around(error.line or 0) if error.line else ""
    calls = _own_calls(function, script)
    return ("calls_itself", {"name": function, "again": calls[0]}) if calls else None


def _own_calls(function: str, script: ScriptText) -> list[int]:
    """Return the lines on which a function calls itself."""
    made = script.definition(function) if function else None
    inside = range(0) if made is None else script.span(made.line)[1:]
    calls = script.lines_with(rf"(?<![\w.])(self\.)?{function} ?\(") if inside else []
    return [number for number in calls if number in inside]


def recursion(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find the line on which a function calls itself, which is not the one that found it too deep."""
    calls = _own_calls(script.function_around(error.line or 0), script)
    return ("recursion", {"line": calls[0]}) if calls else None


def main_needs_args(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise ``main()``, called as usual, of a function that wants its arguments."""
    found = re.match(r"(\w+)\(\) missing 1 required positional argument: '(args|argv)'", error.message)
    made = script.definition(found[1]) if found else None
    if found is None or made is None or not re.search(rf"\b{found[1]}\( ?\)", written):
        return None
    return "main_needs_args", {"name": found[1], "argument": found[2], "begins": made.line}


def bare_class(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a method that is called on a class, as that was assigned without brackets."""
    found = re.match(r"(\w+)\.(\w+)\(\) missing ", error.message)
    called = re.search(rf"(\w+)\.{found[2]}\(", written) if found else None
    kept = script.assigned(called[1]) if called else None
    return ("class_for_object", {}) if found and kept and kept.value == found[1] else None


def signature(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Return how the ``def`` should read if a method lacks self or a callback has wrong parameters."""
    found = re.match(r"(?:(\w+)\.)?(\w+)\(\) (takes (\d+) .* but (\d+)|missing (\d+) )", error.message)
    made = script.definition(found[2]) if found else None
    if found is None or made is None:
        return None
    if script.owner_of(made.line) is None:
        return _plain_callback(found[2], made.line, written, script)
    name, given = found[2], _parameters(script.lines[made.line - 1])
    values: dict[str, object] = {"name": name, "begins": made.line}
    if given[:1] in (["cls"], ["this"]) or script.is_decorated(made.line):
        return None
    if not made.takes_self and "self" not in given:
        fits = found[5] is None or int(found[5]) == len(given) + 1
        inner = ", ".join(["self", *given])
        return ("lacks_self", {**values, "written": f"def {name}({inner}):"}) if fits else None
    for kind, (code, parameters) in _CALLBACKS.items():
        wanted = parameters.replace("msg", _read_there(made.line, script))
        right = ", ".join(given) == wanted
        if any(callback.name == name for callback in script.callbacks(kind)) and f"{name}(" not in written:
            return None if right else (code, {**values, "written": f"def {name}({wanted}):"})
    return None


def _read_there(begins: int, script: ScriptText) -> str:
    """Return what a subscription's callback calls the message that it reads, but does not receive."""
    body = "\n".join(script.block(begins)[1:])
    known = re.compile(r"(?:msg|data|pose|scan|image|odom|message|twist)$")
    names = [
        name
        for name in re.findall(r"(?<![\w.])([a-z]\w*)(?=\.\w|$)", body, re.MULTILINE)
        if known.match(name)
    ]
    return next((name for name in names if not re.search(rf"(?<![\w.]){name} ?=(?!=)", body)), "msg")


def _plain_callback(name: str, begins: int, written: str, script: ScriptText) -> Closer:
    """Say how the ``def`` of a callback that is no method should read."""
    given = ", ".join(_parameters(script.lines[begins - 1]))
    for kind, (code, parameters) in _CALLBACKS.items():
        right = parameters.removeprefix("self").removeprefix(", ")
        if any(callback.name == name for callback in script.callbacks(kind)) and f"{name}(" not in written:
            return None if given == right else (code, {"begins": begins, "written": f"def {name}({right}):"})
    return None


def _names(line: str) -> list[str]:
    """Return what the parameters of a ``def`` are called, without self."""
    found = (re.match(r"\w+", part) for part in _parameters(line))
    return [one[0] for one in found if one is not None and one[0] != "self"]


def _parameters(line: str) -> list[str]:
    inside = line.partition("(")[2].rpartition(")")[0]
    return [part.strip()[:40] for part in inside.split(",") if part.strip()]


def private_taken(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find one of Node's own attributes that the script has overwritten, which broke a call of Node's."""
    if not re.search(
        r"\b(destroy_\w+|spin\w*|create_\w+|declare_\w+|get_\w+|publish|shutdown|add_node)\(", written
    ):
        return None
    for number in script.lines_with(rf"\bself\.{_PRIVATE_OF_NODE} ?(:[^=]*)?=(?!=)(?! ?self\.get_)"):
        name = script.lines[number - 1].strip().removeprefix("self.").split("=")[0].split(":")[0].strip()
        return "private_taken", {"name": name, "given": number, "instead": name.strip("_") + "_1"}
    return None


def list_too_short(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Name the list, its length and how often the loop around asks for an item."""
    for owner, name, index in re.findall(r"(self\.)?\b(\w+)\[(\w+)\]", written):
        made = script.assigned(name)
        inside = None if made is None else re.fullmatch(r"[\[(](.*)[\])]", made.value)
        if made is None or inside is None or re.search(r"[\[({]", inside[1]):
            continue
        if script.lines_with(rf"\b{name}\.(append|extend|insert|pop|remove|clear)\(|\b{name} ?\+="):
            continue
        length = len([part for part in inside[1].split(",") if part.strip()])
        around = script.outwards(error.line or 0)
        number = next((at for at, head in around if re.match(rf"[ \t]*for {index} in\b", head)), None)
        turns = re.search(r"range\( ?(\d+) ?\)", script.lines[number - 1]) if number else None
        if number and length and turns is not None and int(turns[1]) > length:
            values = {"length": length, "turns": turns[1], "loop": number, "given": made.line}
            return "list_too_short", {"name": f"{owner}{name}", "last": f"{name}[{length}]", **values}
    return None


def none_in_init(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a value of a message that ``__init__`` uses, where none can have come yet."""
    used = re.search(r"\bself\.(\w+)\.\w+", written)
    if used is None or not error.line or script.function_around(error.line) != "__init__":
        return None
    name = used[1]
    empty = script.lines_with(rf"\bself\.{name} ?(:[^=]*)?= ?None\b")
    heard = [
        one.name for one in script.callbacks("subscription") if name in script.attributes_set_in(one.name)
    ]
    return ("none_in_init", {"name": name, "callback": heard[0]}) if empty and heard else None


def none_before_spin(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a value of a message that a method uses before anything has spun, in a script without timers."""
    heard = [one.name for one in script.callbacks("subscription")]
    if script.lines_with(r"\bThread\(|Executor\("):
        return None  # something spins; a second spin would take the node away from it
    if not heard or script.callbacks("timer") or script.function_around(error.line or 0) in heard:
        return None
    used = [
        name
        for name in re.findall(r"\bself\.(\w+)\.\w+", written)
        if script.lines_with(rf"\bself\.{name} ?= ?None\b")
    ]
    kept = [name for name in used if any(name in script.attributes_set_in(one) for one in heard)]
    return ("none_before_spin", {"name": kept[0]}) if kept else None


def set_without_global(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find the function that assigns a variable of its own instead of the module's, which stays None."""
    for name in re.findall(r"(?<![\w.])(\w+)\.\w", written):
        outer = script.lines_with(rf"^{name} ?= ?None$")
        for line in script.lines_with(rf"^[ \t]+{name} ?=(?!=)") if outer else []:
            function = script.function_around(line)
            made = script.definition(function)
            if made is None:
                continue
            if not any(re.search(rf"\bglobal\b.*\b{name}\b", one) for one in script.block(made.line)):
                return "kept_global", {"name": name, "callback": function, "begins": made.line}
            if not script.calls(function):
                return "never_called", {"name": function, "begins": made.line}
    return None


def no_return(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find the function of the script whose result a variable keeps, and that returns nothing."""
    around = script.function_around(error.line or 0)
    for name in re.findall(r"(?<![\w.])((?:self\.)?\w+)\.\w", written):
        for line, kept in script.matches(rf"^[ \t]*{re.escape(name)} ?= ?(\w+\.)?(\w+)\("):
            made = script.definition(kept[2])
            is_own = name.startswith("self.") or script.function_around(line) == around
            is_own = is_own and made is not None and made.takes_self is bool(kept[1])
            block = script.block(made.line) if made is not None and is_own else ["return x"]
            if made is not None and not any(re.search(r"\b(return|yield) ?\S", one) for one in block):
                return "no_return", {"name": name, "function": kept[2], "begins": made.line}
    return None


def future_not_done(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise the result of a future that is taken before the answer has come."""
    found = re.search(r"(?<![\w.])([\w.]{1,60})\.result\( ?\)\.", written)
    return ("future_not_done", {"name": found[1]}) if found else None


def copied(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find the copy of a function that still has the name of the first one, where another name is called."""
    found = re.search(r"name '(\w+)' is not defined|has no attribute '(\w+)'", error.message)
    name = (found[1] or found[2]) if found else ""
    begins: dict[str, list[int]] = {}
    for number, made in script.matches(r"^[ \t]*def (\w+)"):
        begins.setdefault(made[1], []).append(number)
    twice = [(one, lines) for one, lines in begins.items() if len(lines) == 2 and one != "__init__"]
    if not name or not re.search(rf"\b{name}\(", written) or len(twice) != 1:
        return None
    function, (first, second) = twice[0]
    if script.owner_of(first) != script.owner_of(second) or script.is_decorated(second):
        return None  # methods of two classes, or a property's
    return "copied", {"name": name, "function": function, "first": first, "second": second}


def constructor(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find what keeps the node's name from Node: a misspelt ``__init__``, or empty brackets."""
    if re.search(r"\bsuper\(\)\.__init__\( ?\)", written):
        return "no_node_name", {}
    for number in script.lines_with(r"^[ \t]+def _*[inIt1]{3,5}_*\b ?\( ?self\b"):
        name = script.lines[number - 1].split("def ")[1].partition("(")[0].strip()
        if name != "__init__" and sorted(name.strip("_").lower()) in (
            sorted("init"),
            sorted("int"),
            sorted("inti"),
        ):
            return "misspelt_init", {"name": name, "begins": number}
    return None


def other_file(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a package's file that is no node: setup.py, or a launch file. In a package both are in place."""
    if "/" in error.file:
        return None
    if script.lines_with(r"^setup ?\(") and script.lines_with(r"^(from|import) (setuptools|distutils)\b"):
        return "other_file", {"name": "setup.py"}
    if script.lines_with(r"^def generate_launch_description\b"):
        return "other_file", {"name": "launch"}
    return None


def old_keyword(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise the names that Node's arguments had before ROS 2 Foxy."""
    found = re.search(r"unexpected keyword argument 'node_(executable|namespace|name)'", error.message)
    if found is not None:
        return "launch_old_keyword", {"name": f"node_{found[1]}", "right": found[1]}
    if "missing" in error.message and script.lines_with(r"\bnode_executable ?="):
        return "launch_old_keyword", {"name": "node_executable", "right": "executable"}
    return None


def only_shell(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a file that holds a command of the terminal and no Python."""
    code = [line for line in script.lines if line.strip()]
    python = script.lines_with(r"^[ \t]*(import|from|def|class|for|while|if)\b|=")
    return ("only_shell", {}) if 0 < len(code) <= 3 and not python else None


def dash(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a word processor's dash instead of a minus sign; not one in prose that lacks its ``#``."""
    found = re.search(r"U\+(2010|2011|2012|2013|2014|2015|2212|FF0D)", error.message)
    minus = re.search(r"([=(\[,:]|\breturn|[+*/<>]|[\w.)\]]) ?[\u2010-\u2015\u2212\uff0d] ?[\w.(]", written)
    code = re.search(r"[=()]|^(return|if|while|elif)\b", written)
    return ("dash_for_minus", {}) if found and minus and code else None


def overwritten(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find the number that has taken the name of the method that was called."""
    for name in re.findall(r"\b\w+\.(\w+)\(", written):
        made = script.definition(name)
        given = script.lines_with(rf"\bself\.{re.escape(name)} ?=(?!=)")
        if made is not None and given:
            return "method_overwritten", {"name": name, "given": given[0], "begins": made.line}
    for name in re.findall(r"(?<![\w.])([a-z]+)\(", written):
        given = script.lines_with(rf"^[ \t]*{name} ?=(?!=)") if hasattr(builtins, name) else []
        here = ("", script.function_around(error.line or 0))
        given = [line for line in given if script.function_around(line) in here]
        if given:
            return "builtin_overwritten", {"name": name, "given": given[0]}
    return None


def too_early(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a method called before the line of the same function that assigns what it needs."""
    found = re.search(r"has no attribute '(\w+)'", error.message)
    given = [] if found is None else [line for line, _ in script.attributes_set.get(found[1], ())]
    given = [line for line in given if script.function_around(line) == "__init__"]
    around = script.function_around(error.line or 0) if error.line else ""
    calls = script.lines_with(rf"\bself\.{re.escape(around)}\(") if around else []
    early = [n for n in calls if given and n < given[0] and script.function_around(n) == "__init__"]
    if found is None or not early or around == "__init__":
        return None
    if script.calls_its_callback(early[0], around):
        return called_here(error, written, script)
    return "called_too_early", {"name": found[1], "given": given[0], "called": early[0], "method": around}


def imported_as(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find the other name under which the script has imported a module."""
    found = re.match(r"name '(\w+)' is not defined", error.message)
    lines = script.lines_with(rf"^[ \t]*import {found[1]} as \w+") if found else []
    if found is None or not lines:
        return None
    other = script.lines[lines[0] - 1].split()[-1]
    return "imported_as", {"name": found[1], "other": other, "given": lines[0]}


def backslash(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a topic that is written with the slashes of Windows."""
    return ("backslash", {}) if "\\" in error.message else None


def text_plus_number(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a number that is put behind a text with a plus sign, in a script that asks for no input."""
    plus = re.search(r"(['\"] ?\+)|(\+ ?f?['\"])", written)
    asked = script.lines_with(r"\binput\(|\bargv\b")
    return ("text_plus_number", {}) if plus and not asked else None


def rate_of_ros_1(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise ROS 1's Rate, whose ``sleep`` has to go as well."""
    return ("rate_of_ros_1", {}) if "'rclpy' has no attribute 'Rate'" in error.message else None


def open_docstring(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a text in three quotes that nothing ends."""
    return ("open_docstring", {}) if "unterminated triple-quoted" in error.message else None


def class_body(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise statements that stand in a class without a method around them."""
    owner = script.owner_of(error.line) if error.line else None
    if owner is None or not re.match(r"[ \t]*class\b", script.lines[owner - 1]):
        return None
    return ("class_body", {"begins": owner}) if script.definition("__init__") is None else None


def called_here(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Name the callback that stands with brackets where it is handed over."""
    text = " ".join(script.lines)
    for kind in ("timer", "service", "subscription"):
        found = re.search(rf"\bcreate_{kind}\([^()]*?\b(self\.\w+|\w+)\( ?\)", text)
        if found is not None and script.definition(found[1].removeprefix("self.")) is not None:
            return "callback_called_here", {"name": found[1], "kind": f"create_{kind}"}
    return None


def called_in_its_place(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a callback that failed because it was called where it is to be handed over."""
    name = script.function_around(error.line or 0)
    lines = script.lines_with(rf"\b{name}\( ?\)") if name else []
    return (
        called_here(error, written, script)
        if any(script.calls_its_callback(at, name) for at in lines)
        else None
    )


def wanted_field(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Take Python's own suggestion of a field."""
    found = re.search(r"'(\w+)' object has no attribute '(\w+)'\. Did you mean: '(\w+)'\?", error.traceback)
    if found is None:
        return None
    return "misspelt_field", {"owner": found[1], "name": found[2], "suggestion": found[3]}


def handler_order(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a service's handler whose parameters are in the wrong order."""
    name = script.function_around(error.line or 0)
    made = script.definition(name)
    if made is None or not re.search(r"_(Request|Response)' object has no", error.message):
        return None
    exchanged = re.search(r"\( ?(?:self ?, ?)?(res\w*) ?, ?(req\w*) ?\)", script.lines[made.line - 1])
    if exchanged is None:
        return None
    right = f"{exchanged[2]}, {exchanged[1]}"
    return "handler_order", {"line": made.line, "name": name, "right": right}


def called_on_class(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a method that is called on the class by its name, outside of the class: no object is given."""
    found = re.match(r"(\w+)\.(\w+)\(\) missing ", error.message)
    node = script.node_name_at(error.line or 0)
    if found is None or node == "self" or not script.class_line(found[1]):
        return None
    if f"{found[1]}.{found[2]}(" not in written or found[2] == "main":
        return None
    return "missing_object", {"name": found[2], "object": node, "call": "(...)"}


def class_for_self(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a method that gets no object, as it is taken from the class or marked as static."""
    found = re.match(r"(\w+)\.(\w+)\(\) missing \d+ required", error.message)
    made = script.definition(found[2]) if found else None
    if found is None:
        return None
    if made and script.is_decorated(made.line) and "@staticmethod" in script.lines[made.line - 2]:
        return "static_with_self", {"line": made.line - 1, "name": found[2]}
    if made and found[2] == "main":
        return "function_inside", {"name": "main", "begins": made.line}
    used = script.lines_with(rf"\b{found[1]}\.{found[2]}\b")
    line = error.line if error.line in used else next(iter(used), None)
    if line is None or script.node_name_at(line) != "self":
        return None
    return "class_for_self", {"line": line, "name": found[2], "owner": found[1]}


def endpoint_arguments(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a publisher or subscription that lacks something else than the queue size, which comes last."""
    found = re.search(r"create_(publisher|subscription)\(\) missing (\d+)", error.message)
    if found is None:
        return None
    given = script.arguments(error.line or 0, f"create_{found[1]}")
    if found[2] == "1" and not (given and re.fullmatch(r"\d+", given[-1])):
        return None
    return "endpoint_arguments", {"kind": f"create_{found[1]}", "example": _ENDPOINTS[found[1]]}


def message_replaced(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find the new message that has taken the name of the one that a callback received, or keeps."""
    field = re.search(r"has no attribute '(\w+)'", error.message)
    base = re.search(rf"(self\.)?\b(\w+)\.{field[1]}\b", written) if field else None
    if field is None or base is None:
        return None
    heard = [one.name for one in script.callbacks("subscription")]
    keeping = [one for one in heard if base[2] in script.attributes_set_in(one)]
    for function in keeping if base[1] else [script.function_around(error.line or 0)]:
        made = script.definition(function)
        inside = range(0) if made is None else script.span(made.line)
        for name in [] if made is None else _names(script.lines[made.line - 1]):
            given = script.lines_with(rf"^[ \t]*{name} ?= ?\w+\( ?\)$") if base[1] or name == base[2] else []
            if replaced := [number for number in given if number in inside]:
                return "message_replaced", {"given": replaced[0], "name": name, "field": field[1]}
    return None


def parameter_called(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a subscription's callback that uses what it receives under another name."""
    found = re.match(r"name '(\w+)' is not defined", error.message)
    name = script.function_around(error.line or 0)
    made = script.definition(name)
    heard = [one.name for one in script.callbacks("subscription")]
    if found is None or made is None or name not in heard:
        return None
    if not found[1].islower() or not re.search(rf"\b{found[1]}\.\w|= ?{found[1]}$", written):
        return None  # it may be a constant
    given = _names(script.lines[made.line - 1])
    if len(given) != 1:
        return None
    uses = [text for text in script.block(made.line)[1:] if re.search(rf"\b{given[0]}\b", text)]
    if uses and not re.match(rf"[ \t]*{given[0]} ?=(?!=)", uses[0]):
        return None
    values = {"function": name, "begins": made.line, "name": found[1], "parameter": given[0]}
    return "parameter_called", values


def callback_as_text(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find a callback whose name stands in quotes."""
    if "'str' object" not in error.message:
        return None
    for kind, place in (("timer", 1), ("subscription", 2), ("service", 2)):
        for line in script.lines_with(rf"\bcreate_{kind}\("):
            if script.arguments(line, f"create_{kind}")[place : place + 1] == ['""']:
                return "callback_as_text", {"line": line, "kind": f"create_{kind}"}
    return None


def node_needs_name(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a plain node that was made without a name."""
    return ("node_needs_name", {}) if re.search(r"\bNode\( ?\)", written) else None


def time_to_sleep(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a number for the Duration that a clock's sleep wants."""
    return ("sleeps_duration", {}) if re.search(r"\.sleep_for\(", written) else None


def declared_name(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Find the parameter that is declared later, or under nearly the same name."""
    found = re.search(r"'([\w.]{1,60})'\)$", error.message)
    known: dict[str, int] = {}
    for number in script.lines_with(r"\bdeclare_parameter\("):
        name = re.search(r"declare_parameter\( *[\"']([\w.]{1,60})[\"']", script.written(number))
        if name is not None:
            known.setdefault(name[1], number)
    if found is None:
        return None
    if found[1] in known:
        return "defined_below", {"name": found[1], "begins": known[found[1]]}
    near = [one for one in known if one.lower() == found[1].lower()]
    near = near or difflib.get_close_matches(found[1], list(known)[:_MOST], 1, _NEAR)
    return ("misspelt", {"suggestion": near[0]}) if near else None


def own_module(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise an unknown module, which is most likely another file of the student's."""
    found = re.match(r"No module named '(\w+)'", error.message)
    return ("own_module", {"name": found[1]}) if found and not _KNOWN_ROOT.match(found[1]) else None


def real_package(error: StudentError, written: str, script: ScriptText) -> Closer:
    """Recognise a package of ROS that a launch file asks for, and that is not carried here."""
    found = re.search(r"'(\w+)'", error.message)
    if found is None or not _REAL_PACKAGE.match(found[1]):
        return None
    return "package_not_here", {"name": found[1]}


_REAL_PACKAGE: Final = re.compile(
    r"(moveit|nav2|slam_toolbox|cartographer|turtlebot[34]|gazebo|ros_gz|rviz|rqt|joint_state|robot_state|"
    r"robot_localization|urdf|xacro|controller_manager|ros2_control|image_|v4l2|usb_cam|teleop_)"
)
"""How packages begin that courses use in launch files: navigation, arms, simulators, displays."""

_BY_CODE: Final[Mapping[str, tuple[_Look, ...]]] = {
    "assigned_later": (missing_global,),
    "bad_name": (backslash,),
    "callback_called": (called_here,),
    "class_for_object": (called_on_class, class_for_self),
    "call_mismatch": (main_needs_args, called_on_class, bare_class, signature),
    "foreign_character": (dash,),
    "index_range": (list_too_short,),
    "crashed": (signature,),
    "init_twice": (calls_itself,),
    "launch_keyword": (old_keyword,),
    "launch_no_executable": (old_keyword,),
    "library_not_here": (other_file,),
    "missing_import": (imported_as,),
    "missing_module": (other_file, own_module),
    "missing_qos": (class_for_self, endpoint_arguments),
    "no_super_init": (node_needs_name, constructor),
    "not_callable": (overwritten, callback_as_text),
    "not_yet_assigned": (too_early,),
    "open_string": (open_docstring,),
    "parameter_not_declared": (declared_name,),
    "recursion": (recursion,),
    "ros_1_habit": (rate_of_ros_1,),
    "self_outside": (class_body,),
    "shell_line": (only_shell,),
    "still_none": (no_return, future_not_done, none_in_init, none_before_spin, set_without_global),
    "text_for_number": (text_plus_number,),
    "time_and_number": (time_to_sleep,),
    "unknown_field": (message_replaced,),
    "unknown_package": (real_package,),
    "unknown_attribute": (called_in_its_place, too_early, copied),
    "unknown_name": (parameter_called, copied),
    "unknown_part": (handler_order, wanted_field),
    "wrong_parameters": (main_needs_args, signature),
}
"""By the code that an exception has without the script's text: what to look for, in this order."""


def looked_closer(code: str, error: StudentError, written: str, script: ScriptText) -> Closer:
    """Return the cause that the script shows for an exception known as `code`, or None."""
    if not script.is_short:
        return None
    looks: tuple[_Look, ...] = _BY_CODE.get(code, ())
    for look in (*looks, private_taken) if code in _GENERAL else looks:
        found = look(error, written, script)
        if found is not None:
            return found
    return None
