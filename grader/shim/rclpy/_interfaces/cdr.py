"""Messages to CDR bytes and back, as rmw_fastrtps writes them: XCDR1, little-endian.

A message class's encoder and decoder are compiled when first needed. Decoding is strict: every length is held
against the bytes that are left before anything is allocated, and a message ends where its bytes end.
"""

from __future__ import annotations

import struct
from array import array

from rclpy._interfaces.cdr_source import DecoderSource, EncoderSource
from rclpy._interfaces.field_types import alias
from rclpy._interfaces.messages import CLASSES, STRUCTURES, interface_name
from rclpy._kernel import kernel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, TypeVar

    _MessageT = TypeVar("_MessageT")
    _Pack = Callable[[Any], bytes]
    _Unpack = Callable[[bytes], Any]
    _Write = Callable[[Any, bytearray], None]
    _Read = Callable[[bytes, int], tuple[Any, int]]

HEADER = b"\x00\x01\x00\x00"
PADDING = tuple(bytes(length) for length in range(8))


class CdrError(RuntimeError):
    """Bytes that are not one message of the expected type."""


def serialize(message: Any) -> bytes:
    """Return the CDR form of a message, with its encapsulation header.

    A list inside that holds what its field does not allow ends the process, as does a class derived by the script.

    Raises:
        TypeError: the message was tampered with in another way.
        CdrError: a list or string inside the message is longer than its field allows.
    """
    cls = message.__class__
    try:
        pack = _PACKERS.get(cls) or _packer(cls)
        return pack(message)
    except (struct.error, KeyError, TypeError, AttributeError, ValueError, OverflowError) as error:
        from rclpy._interfaces.conversion import check

        check(message)
        if isinstance(error, UnicodeEncodeError):
            raise
        raise TypeError(f"{interface_name(cls)} cannot be serialized: {error}") from None


def deserialize(data: bytes, message_class: type[_MessageT]) -> _MessageT:
    """Return the message that `data` holds, header included.

    Raises CdrError: the bytes do not begin with a message of that class.
    """
    unpack = _UNPACKERS.get(message_class) or _unpacker(message_class)
    message: _MessageT = unpack(data)
    return message


def _read(message_class: type, data: bytes) -> Any:
    """Do what `deserialize` does, step by step."""
    if data[:4] != HEADER:
        raise CdrError(f"{interface_name(message_class)}: not little-endian CDR")
    body = bytes(data[4:])
    read = _DECODERS.get(message_class) or _decoder(message_class)
    try:
        message, _ = read(body, 0)
    except (struct.error, UnicodeDecodeError) as error:
        raise CdrError(f"{interface_name(message_class)}: {error}") from None
    return message  # what follows is not looked at, as by the middlewares


def _packer(cls: type) -> _Pack:
    """Return what gives a message's bytes: one call of `struct` where all its fields have a fixed size."""
    source = EncoderSource(dict(_WRITE_NAMES), aligned=True)
    source.structure(STRUCTURES[cls], "m")
    if source.is_one_run:
        layout, terms, _ = source.with_header()
        lines = [*source.lines, f"return {layout}.pack(HEADER, {terms})"]
    else:
        source.flush()
        lines = ["out = bytearray(HEADER)", *source.lines, "return bytes(out)"]
    pack: _Pack = _compile(cls, "pack(m)", lines, source.names)
    _PACKERS[cls] = pack
    return pack


def _unpacker(cls: type) -> _Unpack:
    """Return what makes a message of its bytes: one call of `struct` where all its fields have a fixed size."""

    def unpack(data: bytes) -> Any:
        return _read(cls, data)

    source = DecoderSource({**_READ_NAMES, "read_whole": unpack}, aligned=True)
    source.structure(STRUCTURES[cls], "m")
    if source.is_one_run:
        layout, terms, size = source.with_header()
        lines = [
            f"if len(data) != {size}: return read_whole(data)",
            f"m = new({alias(STRUCTURES[cls].full_name)})",
            *source.lines,
            f"header, {terms} = {layout}.unpack(data)",
            "return m if header == HEADER else read_whole(data)",
        ]
        unpack = _compile(cls, "unpack(data)", lines, source.names)
    _UNPACKERS[cls] = unpack
    return unpack


def _encoder(cls: type) -> _Write:
    source = EncoderSource(dict(_WRITE_NAMES), aligned=False)
    source.structure(STRUCTURES[cls], "m")
    source.flush()
    write: _Write = _compile(cls, "write(m, out)", source.lines, source.names)
    _ELEMENT_ENCODERS[cls] = write
    return write


def _decoder(cls: type, aligned: bool = True) -> _Read:
    source = DecoderSource(dict(_READ_NAMES), aligned)
    source.lines.append(f"m = new({alias(STRUCTURES[cls].full_name)})")
    source.structure(STRUCTURES[cls], "m")
    source.flush()
    source.lines.append("return m, pos")
    read: _Read = _compile(cls, "read(data, pos)", source.lines, source.names)
    (_DECODERS if aligned else _ELEMENT_DECODERS)[cls] = read
    return read


def _compile(cls: type, signature: str, lines: list[str], names: dict[str, Any]) -> Any:
    structure = STRUCTURES[cls]
    names[alias(structure.full_name)] = cls
    source = f"def {signature}:\n    " + "\n    ".join(lines)
    exec(compile(source, f"<cdr of {structure.full_name}>", "exec"), names)  # noqa: S102 - our own source
    return names[signature.partition("(")[0]]


_PACKERS: dict[type, _Pack] = {}
_UNPACKERS: dict[type, _Unpack] = {}
_DECODERS: dict[type, _Read] = {}
_ELEMENT_ENCODERS: dict[type, _Write] = {}
_ELEMENT_DECODERS: dict[type, _Read] = {}


def _expect(condition: bool, field: str) -> None:
    if not condition:
        raise CdrError(f"wrong number of elements in {field!r}")


def _text_bytes(value: str, bound: int | None) -> bytes:
    # A C string ends at its first NUL, so what a script puts behind one never leaves the process.
    raw = value.encode().partition(b"\0")[0] + b"\0"
    if bound is not None and len(value) > bound:
        raise CdrError(f"string of {len(value)} characters, {bound} allowed")
    return raw


def _wide_text_bytes(value: str, bound: int | None) -> bytes:
    # Fast CDR: each UTF-16 code unit in four bytes, no terminator.
    if bound is not None and len(value) > bound:
        raise CdrError(f"string of {len(value)} characters, {bound} allowed")
    units = memoryview(value.encode("utf-16-le", "surrogatepass")).cast("H")
    return struct.pack(f"<{len(units)}I", *units)


def _packed_bytes(value: Any, size: int) -> bytes:
    raw: bytes = value if value.__class__ is bytes else value.tobytes()
    if len(raw) != size:
        raise CdrError(f"array of {len(raw)} bytes, {size} expected")
    return raw


def _pad(out: bytearray, width: int) -> None:
    out += PADDING[(4 - len(out)) & (width - 1)]


def _write_numbers(out: bytearray, values: array[Any], code: str) -> None:
    if values:  # Fast CDR aligns for elements only when there are some
        _pad(out, struct.calcsize("<" + code))
        out += values.tobytes()


def _write_booleans(out: bytearray, values: list[bool]) -> None:
    out += bytes(map(bool.__and__, values, values))  # refuses what is no bool


def _write_octets(out: bytearray, values: list[bytes]) -> None:
    out += b"".join(bytes.__add__(value, b"\0")[:1] for value in values)  # the first byte, as in C


def _write_texts(out: bytearray, values: list[str], bound: int | None) -> None:
    for value in values:
        raw = _text_bytes(value, bound)
        _pad(out, 4)
        out += struct.pack("<I", len(raw)) + raw


def _write_wide_texts(out: bytearray, values: list[str], bound: int | None) -> None:
    for value in values:
        raw = _wide_text_bytes(value, bound)
        _pad(out, 4)
        out += struct.pack("<I", len(raw) // 4) + raw


OBJECTS_PER_STEP = 24
"""Of the messages in a list, each with the messages in its fields; as many take up to 15 us."""

_OBJECTS: dict[type, int] = {}


def _count_objects(number: int, cls: type) -> None:
    """Count a list of `number` messages as steps: nothing else would end a script that sends millions."""
    objects = _OBJECTS.get(cls)
    if objects is None:
        objects = _OBJECTS[cls] = _objects(cls)
    kernel.steps += number * objects // OBJECTS_PER_STEP


def _objects(cls: type) -> int:
    fields = STRUCTURES[cls].fields
    return 1 + sum(
        _objects(CLASSES[field.base]) for field in fields if field.is_message and not field.is_nested
    )


def _write_messages(out: bytearray, values: list[Any], cls: type) -> None:
    _count_objects(len(values), cls)
    write = _ELEMENT_ENCODERS.get(cls) or _encoder(cls)
    for value in values:
        if value.__class__ is not cls:
            raise TypeError(f"{type(value).__name__} in a list of {cls.__name__}")
        write(value, out)


def _take(data: bytes, start: int, length: int) -> bytes:
    taken = data[start : start + length]
    if len(taken) != length:
        raise CdrError(f"{length} bytes announced, {len(taken)} left")
    return taken


def _read_text(data: bytes, pos: int, length: int, bound: int | None) -> tuple[str, int]:
    raw = _take(data, pos, length)
    if length == 0 or raw.find(0) != length - 1:
        raise CdrError("string with a NUL in the middle or none at the end")
    text = raw[:-1].decode()
    if bound is not None and len(text) > bound:
        raise CdrError(f"string of {len(text)} characters, {bound} allowed")
    return text, pos + length


def _read_wide_text(data: bytes, pos: int, length: int, bound: int | None) -> tuple[str, int]:
    units = struct.unpack(f"<{length}I", _take(data, pos, 4 * length))
    try:
        text = array("H", units).tobytes().decode("utf-16-le", "surrogatepass")
    except OverflowError:
        raise CdrError("wide string with more than 16 bits in a character") from None
    if bound is not None and len(text) > bound:
        raise CdrError(f"string of {len(text)} characters, {bound} allowed")
    return text, pos + 4 * length


def _read_numbers(data: bytes, pos: int, count: int, code: str) -> tuple[array[Any], int]:
    values: array[Any] = array(code)
    if count:
        pos += -pos % values.itemsize
        values.frombytes(_take(data, pos, count * values.itemsize))
    return values, pos + count * values.itemsize


def _read_booleans(data: bytes, pos: int, count: int) -> tuple[list[bool], int]:
    return [value != 0 for value in _take(data, pos, count)], pos + count


def _read_octets(data: bytes, pos: int, count: int) -> tuple[list[bytes], int]:
    return [bytes((value,)) for value in _take(data, pos, count)], pos + count


def _read_texts(data: bytes, pos: int, count: int, bound: int | None) -> tuple[list[str], int]:
    return _read_each(_read_text, data, pos, count, bound)


def _read_wide_texts(data: bytes, pos: int, count: int, bound: int | None) -> tuple[list[str], int]:
    return _read_each(_read_wide_text, data, pos, count, bound)


def _read_each(
    read: Callable[..., tuple[str, int]], data: bytes, pos: int, count: int, bound: int | None
) -> tuple[list[str], int]:
    values = []
    for _ in range(count):
        pos += -pos & 3
        (length,) = struct.unpack_from("<I", data, pos)
        value, pos = read(data, pos + 4, length, bound)
        values.append(value)
    return values, pos


def _read_messages(data: bytes, pos: int, count: int, cls: type) -> tuple[list[Any], int]:
    if count > len(data) - pos:  # each takes at least one byte
        raise CdrError(f"{count} elements announced, {len(data) - pos} bytes left")
    _count_objects(count, cls)
    read = _ELEMENT_DECODERS.get(cls) or _decoder(cls, aligned=False)
    values = []
    for _ in range(count):
        value, pos = read(data, pos)
        values.append(value)
    return values, pos


_WRITE_NAMES: dict[str, Any] = {
    "HEADER": HEADER,
    "PADDING": PADDING,
    "expect": _expect,
    "text_bytes": _text_bytes,
    "wide_text_bytes": _wide_text_bytes,
    "packed_bytes": _packed_bytes,
    "write_numbers": _write_numbers,
    "write_booleans": _write_booleans,
    "write_octets": _write_octets,
    "write_texts": _write_texts,
    "write_wide_texts": _write_wide_texts,
    "write_messages": _write_messages,
}
_READ_NAMES: dict[str, Any] = {
    "HEADER": HEADER,
    "new": object.__new__,
    "expect": _expect,
    "read_text": _read_text,
    "read_wide_text": _read_wide_text,
    "read_numbers": _read_numbers,
    "read_booleans": _read_booleans,
    "read_octets": _read_octets,
    "read_texts": _read_texts,
    "read_wide_texts": _read_wide_texts,
    "read_messages": _read_messages,
}
