"""What leaves a node is converted in C, which asserts the types that no setter has checked.

On Humble that is what stands in a list (``path.poses.append(Pose())``), on Jazzy everything. A wrong type aborts
the process in the middle of `publish`, `call_async` or the response of a service: no exception, no `finally`. The
text is that of glibc's assert for the generated C file, without the number of its line.
"""

from __future__ import annotations

import sys
from types import TracebackType

from rclpy._interfaces.field_types import ARRAY_CODES, alias
from rclpy._interfaces.messages import CLASSES, STRUCTURES
from rclpy._kernel import kernel
from rclpy._patches import tracebacks
from rclpy._rcl import logs

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy._interfaces.definitions import Field, Structure

    Fault = tuple[str, str, str]
    """Class whose conversion finds it, the field, and the condition that does not hold."""

_SCALARS = {
    "boolean": ("bool", "PyBool_Check"),
    "octet": ("bytes", "PyBytes_Check"),
    "string": ("str", "PyUnicode_Check"),
    "wstring": ("str", "PyUnicode_Check"),
    "float": ("float", "PyFloat_Check"),
    "double": ("float", "PyFloat_Check"),
}
_INTEGER = ("int", "PyLong_Check")

CHECKS_UNHEARD = 10
"""Of a publisher's messages with such lists, the first so many are looked at even if nobody listens.

A list that is filled in a wrong way is so from the start; a path that grows at each tick must not take time."""

_finders: dict[type, Callable[[Any], Fault | None]] = {}


class Aborted(BaseException):
    """Stands for the signal in the script's own account of its end; it is never raised."""

    __module__ = "builtins"


def check(message: Any) -> None:
    """End the process as C's assert does if a field of the message has another type than its definition says."""
    fault = _fault(message)
    if fault is not None:
        _abort(*fault)


def checks_unheard(full_name: str) -> int:
    """Return how many messages of a type are looked at if nobody listens."""
    cls = CLASSES.get(full_name)
    return CHECKS_UNHEARD if cls is not None and _holds_anything(STRUCTURES[cls]) else 0


def _holds_anything(structure: Structure) -> bool:
    """Whether there is a list in it that takes what its field does not allow."""
    return any(
        field.base not in ARRAY_CODES if field.is_nested else _holds_anything(STRUCTURES[CLASSES[field.base]])
        for field in structure.fields
        if field.is_nested or field.is_message
    )


def _fault(message: Any) -> Fault | None:
    find = _finders.get(message.__class__)
    if find is None:
        find = _finders[message.__class__] = _finder(message.__class__)
    return find(message)


def _finder(cls: type) -> Callable[[Any], Fault | None]:
    structure = STRUCTURES.get(cls)
    if structure is None:  # a class that the script has derived
        of = next(base for base in cls.__mro__ if base in STRUCTURES)
        wrong = STRUCTURES[of].full_name, "__class__", _is_class(of)
        return lambda _: wrong
    names: dict[str, Any] = {"fault": _fault, "sequence": _sequence}
    lines = []
    for field in structure.fields:
        if field.is_message:
            names[alias(field.base)] = CLASSES[field.base]
        lines += _lines_of(field, structure.full_name)
    source = "def find(m):\n    " + "\n    ".join([*lines, "return None"])
    exec(compile(source, f"<conversion of {structure.full_name}>", "exec"), names)  # noqa: S102 - our own source
    find: Callable[[Any], Fault | None] = names["find"]
    return find


def _lines_of(field: Field, owner: str) -> list[str]:
    """Return the statements that look at one field."""
    value = f"m._{field.name}"
    if field.base in ARRAY_CODES and field.is_nested:
        return []  # the setters make arrays of them
    if field.is_nested:
        inner = _one("v", field, owner, "item")
        return [f"for v in sequence({value}, {field.name!r}):", *(f"    {line}" for line in inner)]
    return _one(value, field, owner, "field")


def _one(value: str, field: Field, owner: str, called: str) -> list[str]:
    if not field.is_message:
        kind, assertion = _SCALARS.get(field.base, _INTEGER)
        wrong = f"{owner!r}, {field.name!r}, '{assertion}({called})'"
        return [f"if not isinstance({value}, {kind}): return {wrong}"]
    wrong = f"{field.base!r}, {field.name!r}, {_is_class(CLASSES[field.base])!r}"
    return [
        f"if {value}.__class__ is not {alias(field.base)}: return {wrong}",
        f"found = fault({value})",
        "if found is not None: return found",
    ]


def _is_class(cls: type) -> str:
    """Return the condition that a message is of a class."""
    name = f"{cls.__module__}.{cls.__name__}"
    return f'strncmp("{name}", full_classname_dest, {len(name)}) == 0'


def _sequence(value: Any, name: str) -> Any:
    """Return what ``PySequence_Fast`` gives."""
    if isinstance(value, (list, tuple)):
        return value
    try:
        return list(value)
    except TypeError:
        raise TypeError(f"expected a sequence in '{name}'") from None


def _abort(owner: str, field: str, condition: str) -> None:
    package, kind, _ = owner.split("/")
    module = CLASSES[owner].__module__.rpartition("._")[2]
    failed = f"Assertion `{condition}' failed."
    text = (
        f"./.obj-x86_64-linux-gnu/rosidl_generator_py/{package}/{kind}/_{module}_s.c: "
        f"{package}__{kind}__{module}__convert_from_py: {failed}"
    )
    logs.write(f"python3: {text}\n")
    frame, trace = sys._getframe(1), None
    while frame is not None:
        trace = TracebackType(trace, frame, frame.f_lasti, frame.f_lineno)
        frame = frame.f_back  # type: ignore[assignment]
    tracebacks.script.aborted = Aborted(f"field '{field}' of {owner}: {failed}").with_traceback(trace)
    kernel.end("signal 6")
