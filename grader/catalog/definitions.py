"""One interface definition (``.msg``, ``.srv``, ``.action``), translated into the lines that the shim reads.

As in rosidl_adapter and rosidl_parser (Humble), types get their IDL names, and services and actions their derived
structures. Defaults and constants become Python literals. What rosidl refuses is refused here as well.
`tools/generate_interfaces.py` describes the forms of a line; it translates ROS's own definitions with this module.
"""

import ast
import math
import re
from collections.abc import Iterator
from keyword import iskeyword
from typing import Final

from grader.contracts.text import Text

PARTS: Final = {"msg": 1, "srv": 2, "action": 3}
"""Kind of definition -> number of its structures, which lines of ``---`` separate."""

# The patterns of rosidl_adapter.parser; it has one for packages and fields alike.
PACKAGE: Final = re.compile(r"(?!.*__)(?!.*_$)[a-z][a-z0-9_]*")
INTERFACE: Final = re.compile(r"[A-Z][A-Za-z0-9]*")
MAX_FIELDS: Final = 200
"""Most fields and constants of one structure. ROS's largest message for robots, BatteryState, has 39."""

_CONSTANT: Final = re.compile(r"[A-Z](_?[A-Z0-9])*")  # matches what rosidl's does, without its backtracking
_INTEGERS: Final = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")
_IDL_NAMES: Final = {
    "bool": "boolean",
    "byte": "octet",
    "char": "uint8",
    "float32": "float",
    "float64": "double",
    "string": "string",
    "wstring": "wstring",
    **{name: name for name in _INTEGERS},
}
# Names that a type does not have, and the type that their author probably means.
_LIKELY_TYPES: Final = {
    "float": "float64",
    "double": "float64",
    "int": "int32",
    "str": "string",
    "boolean": "bool",
    "Header": "std_msgs/Header",
    "time": "builtin_interfaces/Time",
    "Time": "builtin_interfaces/Time",
    "duration": "builtin_interfaces/Duration",
    "Duration": "builtin_interfaces/Duration",
}
_TYPE: Final = re.compile(
    r"(?P<base>[A-Za-z][\w/]*)(?:<=(?P<bound>\d{1,9}))?(?P<array>\[(?:(?:<=)?\d{1,9})?\])?"
)
_LINE: Final = re.compile(r"(?P<type>\S+)\s+(?P<name>\w+)\s*(?:=\s*(?P<constant>.+)|(?P<default>[^\s=].*))?")
_LARGEST: Final = {"float": 3.402823466e38, "double": math.inf}  # as rosidl_generator_py checks a value
_RESERVED: Final = ("get_fields_and_field_types",)  # a method of each generated class
_SUFFIXES: Final = {
    "msg": ("",),
    "srv": ("_Request", "_Response"),
    "action": ("_Goal", "_Result", "_Feedback"),
}
_UUID: Final = "unique_identifier_msgs/UUID"
_DERIVED: Final = (
    ("_SendGoal_Request", (f"{_UUID} goal_id", "{name}_Goal goal")),
    ("_SendGoal_Response", ("bool accepted", "builtin_interfaces/Time stamp")),
    ("_GetResult_Request", (f"{_UUID} goal_id",)),
    ("_GetResult_Response", ("int8 status", "{name}_Result result")),
    ("_FeedbackMessage", (f"{_UUID} goal_id", "{name}_Feedback feedback")),
)
_Lines = list[tuple[int, str]]
"""Lines of one structure, each with its number in the file."""


class DefinitionError(Exception):
    """A line of a definition is not understood, or not allowed.

    Attributes:
        line: the line's number, from 1.
        told: what is wrong, and what to do.
    """

    def __init__(self, line: int, told: Text) -> None:
        super().__init__(f"line {line}: {told.en}")
        self.line = line
        self.told = told


class _RefusedError(ValueError):
    """A `DefinitionError` whose line number is still to be added."""

    def __init__(self, zh: str, en: str) -> None:
        super().__init__(en)
        self.told = Text(zh=zh, en=en)


def translated(package: str, kind: str, name: str, text: str) -> str:
    """Return the lines of one interface, of which the first is ``package/kind/Name module_name``.

    `kind` is ``msg``, ``srv`` or ``action``, `text` the content of the file.

    Raises DefinitionError: for the first line that is refused.
    """
    lines = [f"{package}/{kind}/{name} {module_name(name)}"]
    for suffix, part in zip(_SUFFIXES[kind], _parts(kind, text), strict=True):
        lines += _structure(name + suffix, part, package)
    if kind == "action":
        for suffix, fields in _DERIVED:
            part = [(0, line.format(name=name)) for line in fields]
            lines += _structure(name + suffix, part, package)
    return "\n".join(lines)


def module_name(name: str) -> str:
    """Return the name of an interface's Python module without the leading underscore: ``twist_stamped``."""
    name = re.sub("(.)([A-Z][a-z]+)", r"\1_\2", name)
    return re.sub("([a-z0-9])([A-Z])", r"\1_\2", name).lower()


def _parts(kind: str, text: str) -> list[_Lines]:
    """Split a definition into the numbered lines of its structures, without comments and blank lines."""
    parts: list[_Lines] = [[]]
    for number, raw in enumerate(text.splitlines(), 1):
        if raw.rstrip() == "---":
            parts.append([])
        elif line := _without_comment(raw).strip():
            parts[-1].append((number, line))
        if len(parts) > PARTS[kind]:
            zh = f".{kind} 文件最多 {PARTS[kind]} 段：删掉多余的 ---"
            raise DefinitionError(
                number, Text(zh=zh, en=f"a .{kind} file has {PARTS[kind]} parts; remove this ---")
            )
    if len(parts) < PARTS[kind]:
        zh = f".{kind} 文件要有 {PARTS[kind]} 段，中间用单独一行 --- 隔开：补上"
        en = f"a .{kind} file has {PARTS[kind]} parts with a line of --- between them; add what is missing"
        raise DefinitionError(max(len(text.splitlines()), 1), Text(zh=zh, en=en))
    return parts


def _without_comment(line: str) -> str:
    """Return a line up to its first ``#`` that is not inside a quoted text."""
    quote, before = "", " "
    for i, char in enumerate(line):
        if quote:
            quote = "" if char == quote and before != "\\" else quote
        elif char == "#":
            return line[:i]
        elif char in "\"'" and before in " \t=[,":  # inside a word, as in don't, it quotes nothing
            quote = char
        before = char
    return line


def _structure(name: str, lines: _Lines, package: str) -> Iterator[str]:
    """Yield the lines of one structure."""
    yield f"={name}"
    if len(lines) > MAX_FIELDS:
        zh = f"{name} 超过 {MAX_FIELDS} 个字段：分成几个消息"
        en = f"{name} has more than {MAX_FIELDS} fields; divide it"
        raise DefinitionError(lines[MAX_FIELDS][0], Text(zh=zh, en=en))
    names: set[str] = set()
    for number, line in lines:
        try:
            yield _member(line, package, names)
        except _RefusedError as refusal:
            raise DefinitionError(number, refusal.told) from None


def _member(line: str, package: str, seen: set[str]) -> str:
    """Return the line of one field or constant."""
    match = _LINE.fullmatch(line)
    if match is None:
        raise _RefusedError(
            f"看不懂 {line[:60]!r}：写成“类型 名字”，例如 float64 x",
            f"{line[:60]!r} is not understood; write a type and a name, such as float64 x",
        )
    name, constant, default = match["name"], match["constant"], match["default"]
    idl = _idl_type(match["type"], package)
    if name in seen:
        raise _RefusedError(
            f"名字 {name!r} 用了两次：改一个", f"the name {name!r} is given twice; rename one"
        )
    seen.add(name)
    if constant is not None:
        return _constant(name, idl, constant)
    if not PACKAGE.fullmatch(name) or iskeyword(name) or name in _RESERVED:
        raise _RefusedError(
            f"{name!r} 不能作字段名：用小写字母、数字和单个 _，以字母开头，不以 _ 结尾，不用 Python 关键字",
            f"{name!r} cannot be the name of a field; use small letters, digits and single _, beginning with a "
            "letter, not ending in _, and no word of Python",
        )
    return f"{name} {idl}" if default is None else f"{name} {idl} {_literal(idl, default)}"


def _constant(name: str, idl: str, text: str) -> str:
    if not _CONSTANT.fullmatch(name):
        raise _RefusedError(
            f"{name!r} 不能作常量名：用大写字母、数字和单个 _",
            f"{name!r} cannot be the name of a constant; use capital letters, digits and single _",
        )
    if "[" in idl or "/" in idl:
        raise _RefusedError(
            "常量只能是数、真假或文字：换一个类型",
            "a constant is one number, text or truth value; change its type",
        )
    return f"!{name} {idl} {_literal(idl, text)}"


def _idl_type(text: str, package: str) -> str:
    """Translate a type as a definition writes it, e.g. ``string<=22[<=3]`` -> ``string<22>[<=3]``."""
    match = _TYPE.fullmatch(text)
    if match is None or match["array"] in ("[0]", "[<=0]") or match["bound"] == "0":
        raise _RefusedError(
            f"看不懂类型 {text[:60]!r}：检查拼写", f"the type {text[:60]!r} is not understood; check it"
        )
    base, bound, array = match["base"], match["bound"], match["array"] or ""
    if bound and base not in ("string", "wstring"):
        raise _RefusedError(
            f"只有 string 和 wstring 才能限制长度：把 <={bound} 去掉，或写成 {base}[<={bound}]",
            f"only string and wstring have a bound; remove <={bound} or write {base}[<={bound}]",
        )
    if base in _IDL_NAMES:
        return _IDL_NAMES[base] + (f"<{bound}>" if bound else "") + array
    owner, _, name = base.rpartition("/")
    # the derived structures of an action use its own, which have these names and stand in the same file
    of_action = name.endswith(_SUFFIXES["action"]) and not owner
    if not of_action and not (INTERFACE.fullmatch(name) and (not owner or PACKAGE.fullmatch(owner))):
        raise _unknown_type(base)
    return f"{owner or package}/{'action' if of_action else 'msg'}/{name}{array}"


def _unknown_type(base: str) -> _RefusedError:
    owner, _, name = base.partition("/msg/")
    meant = f"{owner}/{name}" if name else _LIKELY_TYPES.get(base, "")
    if meant:
        return _RefusedError(f"没有类型 {base!r}：写成 {meant}", f"there is no type {base!r}; write {meant}")
    return _RefusedError(
        f"没有类型 {base[:60]!r}：检查拼写", f"there is no type {base[:60]!r}; check its spelling"
    )


def meant_type(full_name: str) -> str:
    """Return what an unknown message probably is: ``std_msgs/Header`` for ``here/msg/Header``; or nothing."""
    return _LIKELY_TYPES.get(full_name.rpartition("/")[2], "")


def _literal(idl: str, text: str) -> str:
    """Translate a default or constant into the Python literal that rosidl_generator_py writes."""
    base, bracket, count = idl.partition("[")
    if "/" in base:
        raise _RefusedError(
            "消息类型的字段不能有默认值：删掉", "a field that is a message has no default; remove it"
        )
    if not bracket:
        return _scalar(base, _parsed(text, base))
    elements = _parsed(text, "array")
    if not isinstance(elements, list):
        raise _RefusedError("数组的默认值写成 [1, 2, 3]", "write the default of an array as [1, 2, 3]")
    most = int(count.strip("<=]") or len(elements))
    if len(elements) > most or (len(elements) < most and not count.startswith("<")):
        raise _RefusedError(f"要有 {most} 个元素：改正", f"there are to be {most} elements; correct this")
    return "[" + ", ".join(_scalar(base, element) for element in elements) + "]"


def _parsed(text: str, base: str) -> object:
    """Return the Python value of a default or constant as a definition writes it."""
    if base.startswith(("string", "wstring")) and text[0] not in "\"'":
        return text
    if base == "array":
        text = re.sub(r"\b(true|false)\b", lambda found: found[0].capitalize(), text)
    elif text.lower() in ("true", "false"):
        return text.lower() == "true"
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError, MemoryError, RecursionError):
        raise _RefusedError(
            f"看不懂值 {text[:60]!r}：改正", f"the value {text[:60]!r} is not understood; correct it"
        ) from None


def _scalar(idl: str, value: object) -> str:
    """Return the literal of one value of a primitive type."""
    base, _, bound = idl.partition("<")
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if base == "boolean" and value in (0, 1):
        return repr(bool(value))
    if base in ("float", "double") and number and abs(float(str(value))) <= _LARGEST[base]:
        return repr(float(str(value)))
    if (
        base in ("string", "wstring")
        and isinstance(value, str)
        and len(value) <= int(bound[:-1] or len(value))
    ):
        return repr(value)
    if base == "octet" and type(value) is int and 0 <= value <= 255:
        return repr(bytes([value]))
    if base in _INTEGERS and type(value) is int:
        bits = int(base.strip("uint"))
        low, high = (0, 2**bits) if base.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1))
        if low <= value < high:
            return repr(value)
    raise _RefusedError(
        f"{str(value)[:40]!r} 不是 {idl} 类型的值：改正",
        f"{str(value)[:40]!r} is no value of type {idl}; correct it",
    )
