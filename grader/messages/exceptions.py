"""What an exception means to a beginner, whether it ended the script or kept it from being compiled.

``exceptions.tsv`` says which code an exception gets by its type, its text and the line that raised it, as the
traceback shows that; the sentence ``mistake.<code>`` says what it means. What in the script must change, a proven
change says (`grader.edits`): here nothing is known of the script but that line.
"""

import builtins
import importlib.resources
import re
from collections.abc import Callable, Mapping
from functools import cache
from typing import Final

from grader.contracts.names import (
    FIELDS,
    IMPORTS,
    LIBRARIES_NOT_HERE,
    MODULES,
    OF_ROS_1,
    OTHER_LANGUAGES,
    STATEMENTS,
    module_of,
    near_name,
)
from grader.contracts.outcome import StudentError
from grader.contracts.text import Text
from grader.messages import say

Closer = tuple[str, dict[str, object]] | None

_PLACES: Final = {
    "{AT}": r"\n(?:.*\n)*  File .*\n(?!(?:.*\n)*  File )",
    "{LINE}": r"(Syntax|Indentation|Tab)Error: .*\n.*\n +",
    "{SHELL}": (
        r"(apt|apt-get|bash|cat|cd|chmod|colcon|cp|export|git|ls|mkdir|mv|nano|pip3?|python3?|rm|ros2|sh|source|"
        r"sudo)"
    ),
}
"""In a pattern: skips to the line that raised the exception, or that Python rejects; a command of a terminal."""
_LONGEST: Final = 200
_MODULE_PATH: Final = re.compile(r" \(/\S+\)$")
_WITHOUT_WORDS: Final = Text(zh="没有更多说明", en="without a word")
_SUGGESTION: Final = re.compile(r"\. Did you mean: '(\w+)'\?\s*$")
_OF_TYPE: Final = {"bool": "True", "int": "int(x)", "str": "str(x)"}
_NODE_LISTS: Final = ("clients", "guards", "publishers", "services", "subscriptions", "timers", "waitables")
"""Python suggests these for `self.publisher` and the like, but the student meant a variable of their own."""


@cache
def signs() -> tuple[tuple[str, str], ...]:
    """Return codes with the patterns of ``Type: message`` and the traceback behind it, the most specific first.

    The more text a pattern needs at least, the more specific it is; a test keeps the file in that order.
    """
    text = (importlib.resources.files("grader.messages") / "exceptions.tsv").read_text(encoding="utf-8")
    rows = (line.partition("\t") for line in text.splitlines())
    return tuple((code, _whole(pattern)) for code, _, pattern in rows)


def _whole(pattern: str) -> str:
    for name, meant in _PLACES.items():
        pattern = pattern.replace(name, meant)
    return pattern


def meaning(error: StudentError, otherwise: str) -> tuple[str, Text]:
    """Return the code of the mistake behind an exception, and the sentence that explains it.

    Args:
        error: the exception.
        otherwise: the code if nothing more precise is known.
    """
    described = described_error(error)
    matches = ((code, re.match(sign, described)) for code, sign in signs())
    code, values = next(((code, match.groupdict()) for code, match in matches if match), (otherwise, {}))
    refine = _REFINED.get(code)
    if refine is not None and (closer := refine(error)) is not None:
        code, values = closer
    values = {name: "" if value is None else value for name, value in values.items()}
    problem = _first_line(error.message) or _WITHOUT_WORDS
    if code == "crashed" and error.line is None:
        return code, say("exception.outside", type=error.type, problem=problem)
    return code, say(
        f"mistake.{code}", **{"line": error.line or "?", "type": error.type, "problem": problem, **values}
    )


def described_error(error: StudentError) -> str:
    """Return what patterns are compared with: type and message, then the traceback without its long lines."""
    shown = "\n".join(line[:_LONGEST] for line in error.traceback.split("\n"))
    # A script may name its exceptions as it likes; only a plain name is one that the signs know.
    kind = error.type if re.fullmatch(r"[\w.]+", error.type) else "Exception"
    return f"{kind}: {error.message}\n{shown}"


def _unknown_name(error: StudentError) -> Closer:
    """Look closer at an unknown name: of another language, not imported, misspelt."""
    match = re.match(r"name '(\w+)' is not defined", error.message)
    name, written = match[1] if match else "", script_line(error)
    if re.fullmatch(_PLACES["{SHELL}"], name) and re.match(rf"{name}([ \t]+[-~/.\w].*)?$", written):
        return "shell_line", {}
    if name == "rospy":
        used = re.search(r"\brospy\.(\w+)", written)
        return _of_ros_1(used[0], used[1]) if used else ("ros_1", {})
    if name in OTHER_LANGUAGES:
        return "other_language", {"name": name, "instead": OTHER_LANGUAGES[name]}
    if name in IMPORTS:
        return "missing_import", {"name": name, "statement": IMPORTS[name]}
    suggestion = _suggested(error)
    is_class = re.search(rf"\b{name}[ \t]*\(|^class\b.*\({name}\b", written) is not None
    if suggestion is None or (not is_class and _is_far(suggestion, name)):
        return None
    return "misspelt", {"suggestion": suggestion}


def _is_far(suggestion: str, name: str) -> bool:
    """Whether Python suggests a function of its own, or a class, for what is the name of a variable."""
    if suggestion in ("True", "False", "None"):
        return False
    return hasattr(builtins, suggestion) or (suggestion[:1].isupper() and name.islower())


def _unknown_attribute(error: StudentError) -> Closer:
    """Look closer at an unknown attribute: of ROS 1, of another module, misspelt."""
    of_module = re.match(r"(?:module|type object) '(\w+)' has no attribute '(\w+)'", error.message)
    of_object = re.match(r"'(\w+)' object has no attribute '(\w+)'", error.message)
    if of_module is not None:
        module, name = of_module.groups()
        if module == "rclpy" and name in OF_ROS_1:
            return _of_ros_1(f"rclpy.{name}", name)
        if f"{module}.{name}" in MODULES:
            return "import_statement", {"statement": f"import {module}.{name}"}
        if module == "rclpy" and IMPORTS.get(name, "").startswith("from rclpy."):
            return "import_statement", {"statement": IMPORTS[name]}
    suggestion = _suggested(error)
    if suggestion is not None and suggestion not in _NODE_LISTS:
        return "misspelt", {"suggestion": suggestion}
    if of_object is not None and of_object[1] in FIELDS:
        kind, name = of_object.groups()
        return "message_fields", {"type": kind, "name": name, "fields": FIELDS[kind]}
    return None


def _of_ros_1(used: str, name: str) -> Closer:
    return "ros_1_habit", {"name": used, "instead": OF_ROS_1.get(name, "rclpy")}


def _suggested(error: StudentError) -> str | None:
    """Return the name that Python suggests instead of an unknown one; None if it suggests none."""
    match = _SUGGESTION.search(error.traceback)
    return None if match is None or re.match(r"_(?!_)", match[1]) else match[1]


def _of_node(error: StudentError) -> Closer:
    """Look closer at a method that rclpy finds in the place of its own `handle`."""
    is_handle = "context manager" in error.message and not script_line(error).startswith("with ")
    return ("name_taken", {"name": "handle"}) if is_handle else None


def _unknown_module(error: StudentError) -> Closer:
    """Look closer at an import that failed."""
    match = re.match(r"No module named '([\w.]+)'", error.message)
    if match is None:
        return _imported_name(error)
    name = match[1]
    root = name.partition(".")[0]
    if root in ("_tkinter", "tkinter", "turtle"):
        return "no_display", {}
    if name.rpartition(".")[2] in IMPORTS and module_of(name.rpartition(".")[2]) == name.rpartition(".")[0]:
        return "import_statement", {"statement": IMPORTS[name.rpartition(".")[2]]}
    if root in LIBRARIES_NOT_HERE:
        return "library_not_here", {"name": root}
    near = near_name(name, MODULES)
    stem, _, ending = root.rpartition("_")
    is_of_interfaces = ending in ("interfaces", "interface", "msgs", "srvs", "actions")
    if is_of_interfaces and near is not None:  # the common ending alone makes score_msgs like sensor_msgs
        near = near if near_name(stem, [near.partition(".")[0].rpartition("_")[0]]) else None
    if near is not None and near.partition(".")[0] != name:
        return "misspelt", {"suggestion": near}
    return ("own_interfaces", {"name": root}) if is_of_interfaces else None


def _imported_name(error: StudentError) -> Closer:
    match = re.match(r"cannot import name '(\w+)' from '([\w.]+)'", error.message)
    if match is None:
        return None
    name, module = match.groups()
    known = [one for one in IMPORTS if one.lower() == name.lower() or module_of(one) == module]
    near = near_name(name, [one for one in known if one == name or module_of(one)])
    return None if near is None else ("import_statement", {"statement": IMPORTS[near]})


def _misspelt_word(error: StudentError) -> Closer:
    """Look closer at a line that Python does not take: its first word may be a misspelt one of Python's."""
    match = re.match(r"([A-Za-z]+)(?=[ \t]+[A-Za-z_(\"']|[ \t]*:)", script_line(error))
    if match is None or match[1] in STATEMENTS:
        return None
    near = near_name(match[1], [statement for statement in STATEMENTS if statement[0] == match[1][0].lower()])
    return None if near is None else ("misspelt_keyword", {"name": match[1], "suggestion": near})


def _field_type(error: StudentError) -> Closer:
    match = re.search(r"'(\w+)' field must be of type '(\w+)'", error.message)
    if match is None or match[2] not in _OF_TYPE:
        return "crashed", {}
    return "wrong_type_in_field", {"field": match[1], "instead": _OF_TYPE[match[2]], "wanted": match[2]}


_REFINED: Final[Mapping[str, Callable[[StudentError], Closer]]] = {
    "function_not_called": _of_node,
    "missing_module": _unknown_module,
    "syntax_error": _misspelt_word,
    "unknown_attribute": _unknown_attribute,
    "unknown_name": _unknown_name,
    "wrong_type_in_field": _field_type,
}
"""For each code, what looks for a more precise one in the message and the line that raised the exception."""


def script_line(error: StudentError) -> str:
    """Return the line that raised the exception, as the traceback shows it."""
    lines = error.traceback.splitlines()
    files = [i for i, line in enumerate(lines) if line.startswith("  File ")]
    return lines[files[-1] + 1].strip() if files and files[-1] + 1 < len(lines) else ""


def _first_line(message: str) -> str:
    """Return the first line of an exception's message, without the mark at its end or the path of a module."""
    line = message.strip().partition("\n")[0].rstrip(":.")
    return _MODULE_PATH.sub("", line)[:_LONGEST]
