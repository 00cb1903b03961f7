"""Parameter values and files as rcl_yaml_param_parser reads them, with its texts (humble, src/parse.c)."""

from __future__ import annotations

from rclpy._rcl.names import namespace_fault, node_name_fault
from rclpy._rcl.yaml import (
    ALIAS,
    MAPPING,
    MAPPING_END,
    SCALAR,
    SEQUENCE,
    SEQUENCE_END,
    YamlError,
    YamlEvent,
    events,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Any

PARAMETERS = "ros__parameters"

_TRUE = frozenset(("Y", "y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"))
_FALSE = frozenset(("N", "n", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"))
_DOTTED = frozenset(sign + word for word in (".inf", ".Inf", ".INF") for sign in ("", "+", "-")) | frozenset(
    (".nan", ".NaN", ".NAN")
)
_NAMES = {bool: ("bool", 296), int: ("integer", 337), float: ("double", 378), str: ("string", 422)}
"""Type -> its name and the line of parse.c in the text about lists of several types, in order of precedence."""


class Value:
    """What has been given for one parameter. A list of a later rule does not replace a scalar of an earlier one.

    rcl keeps one of each type, and rclpy takes the first there is (node.cpp, _parameter_from_rcl_variant): of
    ``-p x:=1 -p x:=one`` the number.
    """

    def __init__(self) -> None:
        self._scalars: dict[type, Any] = {}
        self._lists: dict[type, list[Any]] = {}
        self._of: type | None = None

    def get(self) -> Any:
        """Return the value; None when there is none, as after ``x:=[]``."""
        for given in (self._scalars, self._lists):
            for kind in _NAMES:
                if kind in given:
                    return given[kind]
        return None

    def begin_list(self) -> None:
        """Take what is added with `to_list` as members of a new list."""
        self._of = None

    def add(self, event: YamlEvent, *, to_list: bool) -> None:
        """Take a scalar. Raises ValueError: it is empty, or of another type than the list it belongs to."""
        if not event.text and not event.quoted:
            raise ValueError(f"No value at line {event.line}, at ./src/parse.c:245")
        value = event.text if event.quoted else scalar(event.text)
        kind = type(value)
        if not to_list:
            self._scalars[kind] = value
            return
        if self._of is None:
            self._of, self._lists[kind] = kind, []
        elif self._of is not kind:
            name, line = _NAMES[kind]
            raise ValueError(
                f"Sequence should be of same type. Value type '{name}' do not belong at line_num {event.line}, "
                f"at ./src/parse.c:{line}"
            )
        self._lists[kind].append(value)


def scalar(text: str) -> Any:
    """Return the value of a plain scalar: a bool by its name, else what strtoll or strtod reads, else the text."""
    if text in _TRUE or text in _FALSE:
        return text in _TRUE
    for read in (_read_int, _read_float):
        value = read(text)
        if value is not None:
            return value
    return text


def _read_int(text: str) -> int | None:
    """Read as ``strtoll(text, &end, 0)`` does; None for a rest or a number of more than 64 bits."""
    digits = text.removeprefix(text[:1] if text[:1] in ("+", "-") else "")
    base = 16 if digits[:2].lower() == "0x" else 8 if digits[:1] == "0" else 10
    if not digits.isascii() or not digits.isalnum():
        return None
    try:
        number = int(digits, base) if base != 8 else int("0o" + digits, 8)
    except ValueError:
        return None
    value = -number if text.startswith("-") else number
    return value if -(1 << 63) <= value < 1 << 63 else None


def _read_float(text: str) -> float | None:
    """Read as strtod does; None where it says ERANGE, so that ``1e400`` stays a text."""
    if text in _DOTTED:
        return float(text.replace(".", ""))
    unsigned = text.lstrip("+-").lower()
    if "_" in text or not text.isascii():
        return None
    try:
        value = float.fromhex(text) if unsigned.startswith("0x") else float(text)
    except (ValueError, OverflowError):
        return None
    overflows = value in (float("inf"), float("-inf")) and not unsigned.startswith("inf")
    underflows = abs(value) < 2.2250738585072014e-308 and any(
        c in "123456789" for c in unsigned.split("e")[0]
    )
    return None if overflows or underflows else value


def read_value(text: str, value: Value) -> None:
    """Read what follows ``:=`` on a command line.

    Raises ValueError: the text is empty, no YAML, or more than a scalar or a list.
    """
    if not text:
        raise ValueError("error not set")
    in_list = False
    try:
        for event in events(text):
            if event.kind == SCALAR:
                value.add(event, to_list=in_list)
            elif event.kind in (SEQUENCE, SEQUENCE_END):
                in_list = event.kind == SEQUENCE
                value.begin_list()
            else:
                raise ValueError("Unknown YAML event, at ./src/parse.c:952")
    except YamlError:
        raise ValueError("Error parsing an event, at ./src/parse.c:922") from None


def read_file(text: str, value_of: Callable[[str, str], Value]) -> None:
    """Read a parameter file.

    `value_of` is called with a pattern of node names and the name of a parameter; it returns what to fill.

    Raises ValueError: the file is no YAML, or has not the form ``node: {ros__parameters: {name: value}}``.
    """
    _File(text, value_of).read()


class _File:
    def __init__(self, text: str, value_of: Callable[[str, str], Value]) -> None:
        self._value_of = value_of
        self._line = 1
        self._events = self._noting_lines(events(text))
        self._found = 0

    def _noting_lines(self, stream: Iterator[YamlEvent]) -> Iterator[YamlEvent]:
        for event in stream:
            self._line = event.line
            if event.kind == ALIAS:
                raise ValueError(f"Will not support aliasing at line {event.line}\n, at ./src/parse.c:880")
            yield event

    def read(self) -> None:
        try:
            for event in self._events:
                if event.kind == SEQUENCE:
                    raise ValueError(f"Sequences cannot be key at line {event.line}, at ./src/parse.c:822")
                if event.kind == MAPPING:
                    self._read_nodes([])
        except YamlError:
            text = f"Error parsing a event near line {self._line}, at ./src/parse.c:769"
            raise ValueError(text) from None

    def _keys(self) -> Iterator[tuple[YamlEvent, YamlEvent]]:
        """Yield each key of the mapping that has begun, with the event its value begins with."""
        for key in self._events:
            if key.kind == MAPPING_END:
                return
            if not key.text:
                raise ValueError(f"No key at line {key.line}, at ./src/parse.c:606")
            yield key, next(self._events)

    def _read_nodes(self, names: list[str]) -> None:
        for key, value in self._keys():
            if key.text.startswith(PARAMETERS):
                self._read_node(names, key, value)
                names = []  # read: the parser has left the node
            elif value.kind == MAPPING:
                self._read_nodes([*names, key.text])
            elif value.kind == SEQUENCE:
                raise ValueError(
                    f"Sequences can only be values and not keys in params. Error at line {value.line}\n, "
                    "at ./src/parse.c:828"
                )
            else:
                self._refuse_value(value, 793)

    def _refuse_value(self, value: YamlEvent, line: int) -> None:
        raise ValueError(
            f"Cannot have a value before {PARAMETERS} at line {value.line}, at ./src/parse.c:{line}"
        )

    def _read_node(self, names: list[str], key: YamlEvent, value: YamlEvent) -> None:
        if not names:
            raise ValueError(
                f"There are no node names before {PARAMETERS} at line {key.line}, at ./src/parse.c:629"
            )
        pattern = "/".join(names)
        _check_pattern(pattern)
        if value.kind != MAPPING:
            self._refuse_value(value, 805)
        self._read_parameters("/" + pattern.lstrip("/"), "")

    def _read_parameters(self, pattern: str, prefix: str) -> None:
        for key, value in self._keys():
            name = prefix + key.text
            if value.kind == MAPPING:
                self._read_parameters(pattern, f"{name}.")
            elif value.kind == SCALAR:
                self._value_of(pattern, name).add(value, to_list=False)
            else:
                self._read_list(self._value_of(pattern, name))

    def _read_list(self, value: Value) -> None:
        value.begin_list()
        for event in self._events:
            if event.kind == SEQUENCE_END:
                return
            if event.kind == SEQUENCE:
                raise ValueError(f"Sequences cannot be key at line {event.line}, at ./src/parse.c:822")
            if event.kind != SCALAR:
                raise YamlError("a mapping in a list")
            value.add(event, to_list=True)


def _check_pattern(pattern: str) -> None:
    """Refuse what is no name of a node; ``*`` and ``**`` stand for one token and for any number of them."""
    *spaces, name = pattern.split("/")
    for space in spaces:
        fault = None if space in ("", "*", "**") else namespace_fault("/" + space)
        if fault is not None:
            raise ValueError(f"{fault[0]}, at ./src/parse.c:459")
    fault = None if name in ("*", "**") else node_name_fault(name)
    if fault is not None:
        raise ValueError(f"{fault[0]}, at ./src/parse.c:477")
