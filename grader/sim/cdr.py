"""Strict reader and writer of CDR for the types of `grader.sim.interfaces`.

The jailed process writes what is read here, so nothing is believed: every length is checked against the bytes
that are left before anything is allocated, text is strict UTF-8 without NUL, a bool is 0 or 1, and a message
ends exactly where its bytes end. Floats may be NaN or infinite; what they mean is the caller's decision.

Format: the four bytes ``00 01 00 00`` (little-endian XCDR1), then the fields, each primitive aligned to its
own size relative to the first byte after the header (OMG DDSI-RTPS, section 10; the dialect is Fast CDR's,
which pads nothing before the elements of an empty sequence). An empty structure is one zero byte.
"""

import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from typing import Any, Final, NamedTuple, TypeAlias

from grader.contracts.errors import ProtocolError
from grader.sim.interfaces import Types, ros_types

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


def decode(type_name: str, data: bytes, types: Types | None = None) -> Values:
    """Read one message with its encapsulation header, of a type such as ``geometry_msgs/msg/Twist``.

    `types`: where the type is to be found; ROS's own by default.

    Raises ProtocolError: the bytes are not exactly one message of that type.
    """
    if len(data) > MAX_MESSAGE_BYTES:
        raise ProtocolError(f"{type_name}: message of {len(data)} bytes")
    if data[:4] != HEADER:
        raise ProtocolError(f"{type_name}: not little-endian CDR")
    body = data[4:]
    flat = _flat_layout(type_name) if types is None else None
    try:
        if flat is not None:
            return _nest(type_name, iter(flat.unpack(body)))
        values: Values
        values, end = _structure_reader(type_name, types or ros_types())(body, 0)
    except (struct.error, UnicodeDecodeError) as error:
        raise ProtocolError(f"{type_name}: malformed CDR: {error}") from None
    if end != len(body):
        raise ProtocolError(f"{type_name}: {len(body) - end} bytes too many")
    return values


def encode(type_name: str, values: Mapping[str, Any] | None = None, types: Types | None = None) -> bytes:
    """Write one message; fields left out have their ROS default. `types` as in `decode`.

    Raises ProtocolError: an unknown field, or a value that its field cannot hold.
    """
    writer = _Writer(types or ros_types())
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


Read: TypeAlias = Callable[[bytes, int], tuple[Any, int]]
"""Reads a value in a message's body from a position on; returns it, and where the next one begins."""


def _structure_reader(type_name: str, types: Types) -> Read:
    """Return what reads a structure; it is made once, because messages of one type come by the thousand."""
    if type_name not in types.readers:
        fields = [(name, _reader(_parse(text), types)) for name, text in _fields(type_name, types)]
        types.readers[type_name] = _of_fields(fields) if fields else _read_nothing
    return types.readers[type_name]


def _of_fields(fields: Sequence[tuple[str, Read]]) -> Read:
    def read(body: bytes, at: int) -> tuple[Values, int]:
        values = {}
        for name, read_field in fields:
            values[name], at = read_field(body, at)
        return values, at

    return read


def _read_nothing(body: bytes, at: int) -> tuple[Values, int]:
    _taken(body, at, 1)
    return {}, at + 1


def _reader(kind: _FieldType, types: Types) -> Read:
    read_one = _reader_of_one(kind, types)
    if kind.size is None:
        return read_one
    size, is_sequence, is_raw = kind.size, kind.is_sequence, kind.base == "uint8"

    def read(body: bytes, at: int) -> tuple[Any, int]:
        count = size
        if is_sequence:
            count, at = _read_length(body, at)
            if count > size:
                raise ProtocolError(f"sequence of {count} elements, {size} allowed")
        if is_raw:
            return _taken(body, at, count), at + count
        values = []
        for _ in range(count):
            value, at = read_one(body, at)
            values.append(value)
        return values, at

    return read


def _reader_of_one(kind: _FieldType, types: Types) -> Read:
    if kind.base == "bool":
        return _read_bool
    if kind.base in _SCALARS:
        return _scalar_reader(_SCALARS[kind.base])
    if kind.base not in _TEXTS:
        return _structure_reader(kind.base, types)
    read_text, bound = _read_text if kind.base == "string" else _read_wide_text, kind.bound

    def read(body: bytes, at: int) -> tuple[str, int]:
        text, end = read_text(body, at)
        if len(text) > bound:
            raise ProtocolError(f"text of {len(text)} characters, {bound:.0f} allowed")
        return text, end

    return read


def _scalar_reader(scalar: struct.Struct) -> Read:
    size, unpack_from = scalar.size, scalar.unpack_from

    def read(body: bytes, at: int) -> tuple[Any, int]:
        at += -at % size
        return unpack_from(body, at)[0], at + size

    return read


_read_length: Final = _scalar_reader(_LENGTH)
_read_byte: Final = _scalar_reader(_SCALARS["bool"])


def _read_bool(body: bytes, at: int) -> tuple[bool, int]:
    value, end = _read_byte(body, at)
    if value > 1:
        raise ProtocolError(f"bool of value {value}")
    return value == 1, end


def _read_text(body: bytes, at: int) -> tuple[str, int]:
    length, at = _read_length(body, at)
    if length == 0:
        raise ProtocolError("string without its terminator")
    raw = _taken(body, at, length)
    if raw.find(0) != length - 1:
        raise ProtocolError("string with a NUL in the middle or none at the end")
    return raw[:-1].decode("utf-8"), at + length


def _read_wide_text(body: bytes, at: int) -> tuple[str, int]:
    """Read a wide string as Fast CDR writes it: four bytes for each UTF-16 unit, no terminator."""
    count, at = _read_length(body, at)
    units = struct.unpack(f"<{count}I", _taken(body, at, 4 * count))
    return struct.pack(f"<{count}H", *units).decode("utf-16-le"), at + 4 * count


def _taken(body: bytes, at: int, length: int) -> bytes:
    if at + length > len(body):
        raise ProtocolError(f"{length} bytes announced, {len(body) - at} left")
    return body[at : at + length]


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


def _fields(type_name: str, types: Types) -> tuple[tuple[str, str], ...]:
    try:
        return types.fields[type_name]
    except KeyError:
        raise ProtocolError(f"unknown type {type_name!r}") from None


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
    types = ros_types()
    for _, text in _fields(type_name, types):
        if text in _FORMATS and text != "bool":
            flat.append(text)
            continue
        inner = _flatten(text) if text in types.fields else None
        if inner is None:
            return None
        flat += inner
    return flat or None


def _nest(type_name: str, values: Iterator[float]) -> Values:
    """Lay the numbers of a flat type out as its nested fields."""
    fields = ros_types().fields[type_name]
    return {name: next(values) if text in _FORMATS else _nest(text, values) for name, text in fields}
