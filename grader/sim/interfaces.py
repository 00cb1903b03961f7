"""The ROS 2 interfaces that the trusted side reads and writes: ROS's own, and those of an assignment.

A field is ``(name, type)``; a type is a primitive, the full name of a message, or either with ``[]``, ``[n]`` or
``[<=n]``; ``string<n>`` has at most n characters. A structure without fields is one byte on the wire.
"""

import ast
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from typing import Any, Final, TypeAlias

from grader.contracts.assignment import InterfaceDefinition
from grader.formats.interfaces import standard_entries, structures_of
from grader.sim.car import NS_PER_S, cos_sin, fold

Fields: TypeAlias = tuple[tuple[str, str], ...]
_ROS_NAMES: Final = {"boolean": "bool", "octet": "uint8", "float": "float32", "double": "float64"}
"""What ROS calls the primitives that have other names in IDL."""


class Types:
    """Structures by their full names, such as ``turtlesim/srv/Spawn_Request``.

    Attributes:
        fields: of each structure, in their order.
        defaults: of each structure, those of its fields that are not zero, empty or False.
        readers: of `grader.sim.cdr`, each made when its type is first read.
    """

    def __init__(self, entries: Iterable[str]) -> None:
        self.fields: dict[str, Fields] = {}
        self.defaults: dict[str, Mapping[str, Any]] = {}
        self.readers: dict[str, Callable[[bytes, int], tuple[Any, int]]] = {}
        for entry in entries:
            for name, members in structures_of(entry):
                self.fields[name] = tuple((member[0], _ros_type(member[1])) for member in members)
                literals = {member[0]: ast.literal_eval(member[2]) for member in members if len(member) > 2}
                if literals:
                    self.defaults[name] = {field: _plain(value) for field, value in literals.items()}


@cache
def ros_types() -> Types:
    """Return ROS's own types."""
    return Types(standard_entries())


def with_interfaces(own: Iterable[InterfaceDefinition]) -> Types:
    """Return the types that an assignment's calls may have: its own interfaces, and all of ROS's."""
    lines = [interface.lines for interface in own]
    return Types((*standard_entries(), *lines)) if lines else ros_types()


def stamp(t_ns: int) -> dict[str, int]:
    """Return `t_ns` as builtin_interfaces/msg/Time."""
    return {"sec": t_ns // NS_PER_S, "nanosec": t_ns % NS_PER_S}


def header(t_ns: int, frame: str) -> dict[str, Any]:
    """Return std_msgs/msg/Header of the instant `t_ns`."""
    return {"stamp": stamp(t_ns), "frame_id": frame}


def quaternion(heading_rad: float) -> dict[str, float]:
    """Return geometry_msgs/msg/Quaternion of a heading in the plane."""
    w, z = cos_sin(fold(heading_rad) / 2.0)
    return {"z": z, "w": w}


def _ros_type(idl: str) -> str:
    """Return what ROS calls a type of IDL: ``double[3]`` -> ``float64[3]``."""
    base, bracket, count = idl.partition("[")
    return _ROS_NAMES.get(base, base) + bracket + count


def _plain(value: Any) -> Any:
    """Return a default as plain data; an octet is a number."""
    if isinstance(value, list):
        return [_plain(element) for element in value]
    return value[0] if isinstance(value, bytes) else value
