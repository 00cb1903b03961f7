"""Strict reader and writer of CDR for the types of `grader.sim.interfaces`.

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
from typing import Any, Final, NamedTuple, TypeAlias

from grader.contracts.errors import ProtocolError
from grader.sim.interfaces import FIELDS, WORLD, Types

Values: TypeAlias = dict[str, Any]
"""A message as plain data: nested dicts, lists, str, int, float, bool; ``uint8`` sequences are bytes."""

HEADER: Final = b"\x00\x01\x00\x00"
MAX_MESSAGE_BYTES: Final = 65_536
MAX_SEQUENCE_LENGTH: Final = 4_096

_FORMATS: Final = {
    "bool": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
_SCALARS: Final = {name: struct.Struct("<" + code) for name, code in _FORMATS.items()}
_LENGTH: Final = _SCALARS["uint32"]
_TEXTS: Final = ("string", "wstring")
_ZEROS: Final[dict[str, Callable[[], Any]]] = {
    "bool": bool,
    "float32": float,
    "float64": float,
    "string": str,
    "wstring": str,
}


def decode(type_name: str, data: bytes, types: Types = WORLD) -> Values:
    """Read one message with its encapsulation header, of a type of `types` such as ``geometry_msgs/msg/Twist``.

    Raises:
        ProtocolError: the bytes are not exactly one message of that type.
    """
    if len(data) > MAX_MESSAGE_BYTES:
        raise ProtocolError(f"{type_name}: message of {len(data)} bytes")
    if data[:4] != HEADER:
        raise ProtocolError(f"{type_name}: not little-endian CDR")
    body = memoryview(data)[4:]
    flat = _flat_layout(type_name) if types is WORLD else None
    try:
        if flat is not None:
            return _nest(type_name, iter(flat.unpack(body)))
        reader = _Reader(body, types)
        values = reader.structure(type_name)
    except (struct.error, UnicodeDecodeError) as error:
        raise ProtocolError(f"{type_name}: malformed CDR: {error}") from None
    if reader.position != len(body):
        raise ProtocolError(f"{type_name}: {len(body) - reader.position} bytes too many")
    return values


def encode(type_name: str, values: Mapping[str, Any] | None = None, types: Types = WORLD) -> bytes:
    """Write one message; fields left out have their ROS default.

    Raises:
        ProtocolError: an unknown field, or a value that its field cannot hold.
    """
    writer = _Writer(types)
    try:
        writer.structure(type_name, values or {})
    except (struct.error, UnicodeEncodeError, TypeError, OverflowError, AttributeError) as error:
        raise ProtocolError(f"{type_name}: cannot be encoded: {error}") from None
    return HEADER + bytes(writer.data)


class _FieldType(NamedTuple):
    """What a field's type says.

    Attributes:
        bound: most characters of a text; infinite without one. What is read is bounded as a whole.
        size: elements of an array, or the most of a sequence; None: it is a single value.
    """

    base: str
    bound: float
    size: int | None
    is_sequence: bool


@cache
def _parse(text: str) -> _FieldType:
    """Take a type apart, e.g. ``float64[36]`` or ``string<10>[<=3]``."""
    base, bracket, number = text.partition("[")
    base, _, bound = base.partition("<")
    count = number.strip("<=]")
    is_sequence = bracket != "" and (not count or number[0] == "<")
    most = min(int(count or MAX_SEQUENCE_LENGTH), MAX_SEQUENCE_LENGTH) if is_sequence else int(count or 0)
    return _FieldType(base, float(bound[:-1] or "inf"), most if bracket else None, is_sequence)


class _Reader:
    """A position in the body of a message."""

    def __init__(self, body: memoryview, types: Types) -> None:
        self._body = body
        self._types = types
        self.position = 0

    def structure(self, type_name: str) -> Values:
        fields = _fields(type_name, self._types)
        if not fields:
            self._take(1)
        return {name: self._field(_parse(text)) for name, text in fields}

    def _field(self, kind: _FieldType) -> Any:
        count = kind.size
        if count is None:
            return self._value(kind)
        if kind.is_sequence:
            most, count = count, self._scalar(_LENGTH)
            if count > most:
                raise ProtocolError(f"sequence of {count} elements, {most} allowed")
        if kind.base == "uint8":
            return bytes(self._take(count))
        return [self._value(kind) for _ in range(count)]

    def _value(self, kind: _FieldType) -> Any:
        scalar = _SCALARS.get(kind.base)
        if scalar is not None:
            value = self._scalar(scalar)
            return _to_bool(value) if kind.base == "bool" else value
        if kind.base not in _TEXTS:
            return self.structure(kind.base)
        text = self._text() if kind.base == "string" else self._wide_text()
        if len(text) > kind.bound:
            raise ProtocolError(f"text of {len(text)} characters, {kind.bound:.0f} allowed")
        return text

    def _wide_text(self) -> str:
        """Read a wide string as Fast CDR writes it: four bytes for each UTF-16 unit, no terminator."""
        count = self._scalar(_LENGTH)
        units = struct.unpack(f"<{count}I", self._take(4 * count))
        return struct.pack(f"<{count}H", *units).decode("utf-16-le")

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

    def __init__(self, types: Types) -> None:
        self.data = bytearray()
        self._types = types

    def structure(self, type_name: str, values: Mapping[str, Any]) -> None:
        fields = _fields(type_name, self._types)
        unknown = values.keys() - {name for name, _ in fields}
        if unknown:
            raise ProtocolError(f"{type_name} has no field {min(unknown)!r}")
        if not fields:
            self.data.append(0)
        for name, text in fields:
            kind = _parse(text)
            if name in values:
                value = values[name]
            else:
                value = self._types.defaults.get(type_name, {}).get(name, _default(kind))
            self._field(kind, value)

    def _field(self, kind: _FieldType, value: Any) -> None:
        if kind.size is None:
            self._value(kind, value)
            return
        if kind.is_sequence:
            if len(value) > kind.size:
                raise ProtocolError(f"{len(value)} elements, {kind.size} allowed")
            self._scalar(_LENGTH, len(value))
        elif len(value) != kind.size:
            raise ProtocolError(f"{len(value)} elements instead of {kind.size}")
        for element in value:
            self._value(kind, element)

    def _value(self, kind: _FieldType, value: Any) -> None:
        scalar = _SCALARS.get(kind.base)
        if scalar is not None:
            self._scalar(scalar, value)
        elif kind.base not in _TEXTS:
            self.structure(kind.base, value)
        elif len(value) > kind.bound:
            raise ProtocolError(f"text of {len(value)} characters, {kind.bound:.0f} allowed")
        elif kind.base == "string":
            self._text(value)
        else:
            units = memoryview(value.encode("utf-16-le")).cast("H")
            self._scalar(_LENGTH, len(units))
            self.data += struct.pack(f"<{len(units)}I", *units)

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


def _fields(type_name: str, types: Types = WORLD) -> tuple[tuple[str, str], ...]:
    try:
        return types.fields[type_name]
    except KeyError:
        raise ProtocolError(f"unknown type {type_name!r}") from None


def _to_bool(value: int) -> bool:
    if value > 1:
        raise ProtocolError(f"bool of value {value}")
    return value == 1


def _default(kind: _FieldType) -> Any:
    is_structure = kind.base not in _SCALARS and kind.base not in _TEXTS
    value = {} if is_structure else _ZEROS.get(kind.base, int)()
    if kind.size is None:
        return value
    return [] if kind.is_sequence else [value] * kind.size


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
