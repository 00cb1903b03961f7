"""Strict reader and writer of CDR for the interfaces in `grader.sim.interfaces`.

The jailed process writes what is read here, so nothing is believed: every length is checked against the bytes
that are left before anything is allocated, text is strict UTF-8 without NUL, a bool is 0 or 1, and a message
ends exactly where its bytes end. Floats may be NaN or infinite; what they mean is the caller's decision.

Format: the four bytes ``00 01 00 00`` (little-endian XCDR1), then the fields, each primitive aligned to its
own size relative to the first byte after the header (OMG DDSI-RTPS, section 10; the dialect is Fast CDR's,
which pads nothing before the elements of an empty sequence). An empty structure is one zero byte.
"""

import struct
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any, Final, TypeAlias

from grader.contracts.errors import ProtocolError
from grader.sim.interfaces import DEFAULTS, FIELDS

Values: TypeAlias = dict[str, Any]
"""A message as plain data: nested dicts, lists, str, int, float, bool; ``uint8`` sequences are bytes."""

HEADER: Final = b"\x00\x01\x00\x00"
MAX_MESSAGE_BYTES: Final = 65_536
MAX_SEQUENCE_LENGTH: Final = 4_096

_FORMATS: Final = {
    "bool": "B",
    "int8": "b",
    "uint8": "B",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
_SCALARS: Final = {name: struct.Struct("<" + code) for name, code in _FORMATS.items()}
_LENGTH: Final = _SCALARS["uint32"]


def decode(type_name: str, data: bytes) -> Values:
    """Read one message.

    Args:
        type_name: key of `grader.sim.interfaces.FIELDS`, e.g. ``geometry_msgs/msg/Twist``.
        data: CDR with its encapsulation header.

    Raises:
        ProtocolError: the bytes are not exactly one message of that type.
    """
    if len(data) > MAX_MESSAGE_BYTES:
        raise ProtocolError(f"{type_name}: message of {len(data)} bytes")
    if data[:4] != HEADER:
        raise ProtocolError(f"{type_name}: not little-endian CDR")
    body = memoryview(data)[4:]
    flat = _flat_layout(type_name)
    try:
        if flat is not None:
            return _nest(type_name, iter(flat.unpack(body)))
        reader = _Reader(body)
        values = reader.structure(type_name)
    except (struct.error, UnicodeDecodeError) as error:
        raise ProtocolError(f"{type_name}: malformed CDR: {error}") from None
    if reader.position != len(body):
        raise ProtocolError(f"{type_name}: {len(body) - reader.position} bytes too many")
    return values


def encode(type_name: str, values: Mapping[str, Any] | None = None) -> bytes:
    """Write one message; fields left out have their ROS default.

    Raises:
        ProtocolError: an unknown field, or a value that its field cannot hold.
    """
    writer = _Writer()
    try:
        writer.structure(type_name, values or {})
    except (struct.error, UnicodeEncodeError, TypeError, OverflowError, AttributeError) as error:
        raise ProtocolError(f"{type_name}: cannot be encoded: {error}") from None
    return HEADER + bytes(writer.data)


class _Reader:
    """A position in the body of a message."""

    def __init__(self, body: memoryview) -> None:
        self._body = body
        self.position = 0

    def structure(self, type_name: str) -> Values:
        fields = _fields(type_name)
        if not fields:
            self._take(1)
        return {name: self._field(*_parse(text)) for name, text in fields}

    def _field(self, base: str, count: int | None) -> Any:
        if count is None:
            return self._value(base)
        if count < 0:
            count = self._scalar(_LENGTH)
            if count > MAX_SEQUENCE_LENGTH:
                raise ProtocolError(f"sequence of {count} elements")
        if base == "uint8":
            return bytes(self._take(count))
        return [self._value(base) for _ in range(count)]

    def _value(self, base: str) -> Any:
        scalar = _SCALARS.get(base)
        if scalar is None:
            return self._text() if base == "string" else self.structure(base)
        value = self._scalar(scalar)
        return _to_bool(value) if base == "bool" else value

    def _text(self) -> str:
        length = self._scalar(_LENGTH)
        if length == 0:
            raise ProtocolError("string without its terminator")
        raw = bytes(self._take(length))
        if raw.find(0) != length - 1:
            raise ProtocolError("string with a NUL in the middle or none at the end")
        return raw[:-1].decode("utf-8")

    def _scalar(self, scalar: struct.Struct) -> Any:
        size = scalar.size
        start = self.position + -self.position % size
        (value,) = scalar.unpack_from(self._body, start)
        self.position = start + size
        return value

    def _take(self, length: int) -> memoryview:
        end = self.position + length
        if end > len(self._body):
            raise ProtocolError(f"{length} bytes announced, {len(self._body) - self.position} left")
        taken = self._body[self.position : end]
        self.position = end
        return taken


class _Writer:
    """The growing body of a message."""

    def __init__(self) -> None:
        self.data = bytearray()

    def structure(self, type_name: str, values: Mapping[str, Any]) -> None:
        fields = _fields(type_name)
        unknown = values.keys() - {name for name, _ in fields}
        if unknown:
            raise ProtocolError(f"{type_name} has no field {min(unknown)!r}")
        if not fields:
            self.data.append(0)
        for name, text in fields:
            base, count = _parse(text)
            value = values[name] if name in values else _default(type_name, name, base, count)
            self._field(base, count, value)

    def _field(self, base: str, count: int | None, value: Any) -> None:
        if count is None:
            self._value(base, value)
            return
        if count < 0:
            self._scalar(_LENGTH, len(value))
        elif len(value) != count:
            raise ProtocolError(f"{len(value)} elements instead of {count}")
        for element in value:
            self._value(base, element)

    def _value(self, base: str, value: Any) -> None:
        scalar = _SCALARS.get(base)
        if scalar is not None:
            self._scalar(scalar, value)
        elif base == "string":
            self._text(value)
        else:
            self.structure(base, value)

    def _text(self, value: str) -> None:
        raw = value.encode("utf-8")
        if 0 in raw:
            raise ProtocolError("string with a NUL")
        self._scalar(_LENGTH, len(raw) + 1)
        self.data += raw
        self.data.append(0)

    def _scalar(self, scalar: struct.Struct, value: Any) -> None:
        self.data += bytes(-len(self.data) % scalar.size)
        self.data += scalar.pack(value)


def _fields(type_name: str) -> tuple[tuple[str, str], ...]:
    try:
        return FIELDS[type_name]
    except KeyError:
        raise ProtocolError(f"unknown type {type_name!r}") from None


@cache
def _parse(text: str) -> tuple[str, int | None]:
    """Split ``float64[36]`` into base and count: None for a single value, -1 for any number."""
    if not text.endswith("]"):
        return text, None
    base, _, count = text[:-1].rpartition("[")
    return base, int(count) if count else -1


def _to_bool(value: int) -> bool:
    if value > 1:
        raise ProtocolError(f"bool of value {value}")
    return value == 1


_ZEROS: Final[dict[str, Callable[[], Any]]] = {
    "bool": bool,
    "float32": float,
    "float64": float,
    "string": str,
}


def _default(type_name: str, name: str, base: str, count: int | None) -> Any:
    if base in _SCALARS or base == "string":
        value = DEFAULTS.get(type_name, {}).get(name, _ZEROS.get(base, int)())
    else:
        value = {}
    return value if count is None else [value] * max(count, 0)


@cache
def _flat_layout(type_name: str) -> struct.Struct | None:
    """Return the one layout of a type made of plain numbers only, or None for any other."""
    layout, size = "<", 0
    for text in _flatten(type_name) or ():
        width = _SCALARS[text].size
        padding = -size % width
        layout += "x" * padding + _FORMATS[text]
        size += padding + width
    return struct.Struct(layout) if size else None


def _flatten(type_name: str) -> list[str] | None:
    """Return the types of all numbers of a message in order, or None when it holds anything else."""
    flat: list[str] = []
    for _, text in _fields(type_name):
        if text in _FORMATS and text != "bool":
            flat.append(text)
            continue
        inner = _flatten(text) if text in FIELDS else None
        if inner is None:
            return None
        flat += inner
    return flat or None


def _nest(type_name: str, values: Iterator[float]) -> Values:
    """Lay the numbers of a flat type out as its nested fields."""
    return {
        name: next(values) if text in _FORMATS else _nest(text, values) for name, text in FIELDS[type_name]
    }
