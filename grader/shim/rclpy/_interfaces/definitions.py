"""The interface definitions, read from the generated data file.

The file is read once; an interface's text is parsed when its module is first imported. See
`tools/generate_interfaces.py` for the form of the file.
"""

from __future__ import annotations

import os

_SHIM = os.path.dirname(os.path.dirname(os.path.dirname(__file__)))

SITE_PACKAGES = "/opt/ros/humble/local/lib/python3.10/dist-packages/"
"""Where Humble's Debian packages put the interfaces: shown in ImportError texts and in tracebacks."""


class Field:
    """One field of a structure.

    Attributes:
        base: IDL name of the (element's) type, e.g. ``double``, ``string``, ``geometry_msgs/msg/Vector3``.
        bound: most characters of a bounded string, else None.
        size: number of elements of a fixed array, else None.
        is_sequence: whether it is a sequence; `maximum` is then its bound, or None.
        default: Python literal of the default, or None.
    """

    __slots__ = ("base", "bound", "default", "is_sequence", "maximum", "name", "size")

    def __init__(self, name: str, type_text: str, default: str | None) -> None:
        self.name = name
        self.default = default
        base, bracket, count = type_text.partition("[")
        count = count[:-1]
        self.is_sequence = bool(bracket) and (not count or count.startswith("<="))
        self.maximum = int(count[2:]) if count.startswith("<=") else None
        self.size = int(count) if count and not self.is_sequence else None
        base, _, bound = base.partition("<")
        self.base = base
        self.bound = int(bound[:-1]) if bound else None

    @property
    def is_nested(self) -> bool:
        """Whether it holds several elements."""
        return self.is_sequence or self.size is not None

    @property
    def is_message(self) -> bool:
        """Whether its (element's) type is another structure."""
        return "/" in self.base


class Structure:
    """A structure: what becomes one message class.

    Attributes:
        full_name: e.g. ``turtlesim/srv/Spawn_Request``.
        constants: (name, Python literal) in order of definition.
    """

    __slots__ = ("constants", "fields", "full_name")

    def __init__(self, full_name: str) -> None:
        self.full_name = full_name
        self.fields: list[Field] = []
        self.constants: list[tuple[str, str]] = []

    @property
    def name(self) -> str:
        """Its name without package and kind."""
        return self.full_name.rpartition("/")[2]


class Interface:
    """A message, service or action: what becomes one module.

    Most are never asked for anything, so what they are made of is taken apart when it is.

    Attributes:
        full_name: e.g. ``geometry_msgs/msg/Twist``.
    """

    __slots__ = ("_entry", "full_name")

    def __init__(self, full_name: str, entry: str) -> None:
        self.full_name = full_name
        self._entry = entry

    @property
    def package(self) -> str:
        return self.full_name.split("/")[0]

    @property
    def kind(self) -> str:
        return self.full_name.split("/")[1]

    @property
    def name(self) -> str:
        return self.full_name.split("/")[2]

    @property
    def module(self) -> str:
        """Dotted name of its module, e.g. ``geometry_msgs.msg._twist``."""
        head = self._entry.partition("\n")[0]
        return f"{self.package}.{self.kind}._{head.partition(' ')[2]}"

    def structures(self) -> list[Structure]:
        """Parse the structures it consists of, in order of definition."""
        structures: list[Structure] = []
        for line in self._entry.splitlines()[1:]:
            if line.startswith("="):
                structures.append(Structure(f"{self.package}/{self.kind}/{line[1:]}"))
                continue
            name, type_text, *literal = line.split(" ", 2)
            if name.startswith("!"):
                structures[-1].constants.append((name[1:], literal[0]))
            else:
                structures[-1].fields.append(Field(name, type_text, literal[0] if literal else None))
        return structures


def load(distro: str) -> dict[str, Interface]:
    """Return the interfaces of a data file: all of Humble's, or what another distro has new or different."""
    with open(os.path.join(_SHIM, "rosidl_data", f"{distro}.txt"), encoding="utf-8") as file:
        return parsed(file.read().split("\n@")[1:])


def parsed(entries: list[str]) -> dict[str, Interface]:
    """Return the interfaces of the data file's entries by their full names."""
    interfaces = {}
    for entry in entries:
        full_name = entry[: entry.index(" ")]
        interfaces[full_name] = Interface(full_name, entry)
    return interfaces


INTERFACES = load("humble")
"""Every interface by its full name, e.g. ``geometry_msgs/msg/Twist``."""
