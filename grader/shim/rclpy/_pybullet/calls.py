"""A call of PyBullet as bytes; the format is described in docs/design.md, "Wire".

`Writer` takes what a script passes, whatever it is; `read` only what a writer wrote and the episode let through.
"""

from __future__ import annotations

import os
import struct

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from typing import Any

RECORDED_KINDS = ("step", "motor", "world", "trick")


def _functions() -> Iterator[tuple[str, str, str]]:
    """Yield name, kind and parameters (of a refused function: what it would need) of each function of PyBullet."""
    path = os.path.join(os.path.dirname(__file__), "functions.txt")
    with open(path, encoding="ascii") as file:
        for line in file:
            if not line.startswith("#"):
                name, kind, detail = (*line.rstrip("\n").split(" ", 2), "")[:3]
                yield name, kind, detail


_TABLE = tuple(_functions())
KINDS = {name: kind for name, kind, _ in _TABLE}
REFUSED = {name: needs for name, kind, needs in _TABLE if kind == "refused"}
PARAMETERS = {name: tuple(names.split(",")) for name, kind, names in _TABLE if kind in RECORDED_KINDS}
RECORDED = tuple(PARAMETERS)
"""Functions whose calls are recorded, by their numbers on the wire; the trusted side reads the same file. The last
two only where they recompute the links' places, which the physics then starts from."""

MAX_CALL_BYTES = 32_768
"""A longer call does not fit into a frame with others."""

_NONE, _FALSE, _TRUE, _INTEGER, _NUMBER, _TEXT, _LIST, _NUMBERS = range(8)
_MOST_DEPTH = 4
_MOST_TEXT_BYTES = 1_024

_TAGGED_INTEGER = struct.Struct("<Bq")
_TAGGED_NUMBER = struct.Struct("<Bd")
_TAGGED_COUNT = struct.Struct("<BH")
_HEAD = struct.Struct("<BB")
_LEAST_INTEGER, _MOST_INTEGER = -(1 << 63), (1 << 63) - 1


class UnreadableError(ValueError):
    """An argument cannot be put on the wire."""


def plain(value: Any, depth: int = 0) -> Any:
    """Return `value` as None, a truth value, a number, a text or a list of these, as PyBullet reads it.

    Raises UnreadableError: it is something else.
    """
    kind = type(value)
    if kind is float or kind is int or value is None or kind is bool or kind is str:
        return value
    if kind is list or kind is tuple:
        if depth == _MOST_DEPTH:
            raise UnreadableError("nested too deeply")
        return [plain(element, depth + 1) for element in value]
    return _plain_object(value, depth)


def _plain_object(value: Any, depth: int) -> Any:
    """Return what an object of another type is to PyBullet: an array, a number of numpy's, a subclass."""
    if isinstance(value, str):
        return str(value)
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if hasattr(value, "tolist"):  # arrays and numbers of numpy
        return plain(value.tolist(), depth)
    if hasattr(value, "__index__"):
        return int(value)
    if hasattr(value, "__float__"):
        return float(value)
    if hasattr(value, "__len__") and hasattr(value, "__getitem__") and not hasattr(value, "keys"):
        return plain(list(value), depth)
    raise UnreadableError(f"{type(value).__name__} is neither a number nor a text nor a list of these")


def client_of(name: str, args: Sequence[Any], options: Mapping[str, Any]) -> Any:
    """Return the physics client that a call addresses, by its place or by name; PyBullet takes integers alone."""
    names = PARAMETERS[name]
    if "physicsClientId" in options or "physicsClientId" not in names:
        return options.get("physicsClientId", 0)
    place = names.index("physicsClientId")
    if place >= len(args) or (name == "loadURDF" and isinstance(args[1], int | float)):
        return 0  # the second: loadURDF of old takes place and quaternion as seven numbers, and no client
    return args[place]


def encode(number: int, args: Sequence[Any], options: Mapping[str, Any]) -> bytes:
    """Return one call; `args` and `options` are `plain`.

    Raises UnreadableError: it is too long, or an integer too large.
    """
    parts = [_HEAD.pack(number, len(args))]
    for value in args:
        _put(parts, value)
    parts.append(bytes((len(options),)))
    for name, value in options.items():
        key = name.encode()
        parts += (bytes((len(key),)), key)
        _put(parts, value)
    call = b"".join(parts)
    if len(call) > MAX_CALL_BYTES:
        raise UnreadableError("the arguments of one call are too long")
    return call


def _put(parts: list[bytes], value: Any) -> None:
    kind = type(value)
    if kind is float:
        parts.append(_TAGGED_NUMBER.pack(_NUMBER, value))
    elif kind is int:
        if not _LEAST_INTEGER <= value <= _MOST_INTEGER:
            raise UnreadableError("an integer has more than 64 bits")
        parts.append(_TAGGED_INTEGER.pack(_INTEGER, value))
    elif kind is list:
        if len(value) > 0xFFFF:
            raise UnreadableError("a list has more than 65,535 elements")
        if value and all(type(element) is float for element in value):
            parts += (_TAGGED_COUNT.pack(_NUMBERS, len(value)), struct.pack(f"<{len(value)}d", *value))
            return
        parts.append(_TAGGED_COUNT.pack(_LIST, len(value)))
        for element in value:
            _put(parts, element)
    elif kind is str:
        text = value.encode("utf-8", "replace")
        if len(text) > _MOST_TEXT_BYTES:
            raise UnreadableError("a text is too long")
        parts += (_TAGGED_COUNT.pack(_TEXT, len(text)), text)
    else:
        parts.append(bytes(({None: _NONE, False: _FALSE, True: _TRUE}[value],)))


def read(body: bytes, offset: int) -> Iterator[tuple[int, list[Any], dict[str, Any]]]:
    """Yield number, arguments and named arguments of each call in a frame from `offset` on.

    Raises:
        ValueError, LookupError, struct.error: these are not calls.
    """
    while offset < len(body):
        number, count = _HEAD.unpack_from(body, offset)
        offset += _HEAD.size
        args = []
        for _ in range(count):
            value, offset = _get(body, offset)
            args.append(value)
        named = body[offset]
        offset += 1
        options = {}
        for _ in range(named):
            end = offset + 1 + body[offset]
            name = body[offset + 1 : end].decode("ascii")
            options[name], offset = _get(body, end)
        yield number, args, options


def _get(body: bytes, offset: int) -> tuple[Any, int]:
    kind = body[offset]
    if kind == _NUMBER:
        return _TAGGED_NUMBER.unpack_from(body, offset)[1], offset + _TAGGED_NUMBER.size
    if kind == _INTEGER:
        return _TAGGED_INTEGER.unpack_from(body, offset)[1], offset + _TAGGED_INTEGER.size
    if kind in (_NONE, _FALSE, _TRUE):
        return (None, False, True)[kind], offset + 1
    _, count = _TAGGED_COUNT.unpack_from(body, offset)
    offset += _TAGGED_COUNT.size
    if kind == _NUMBERS:
        return list(struct.unpack_from(f"<{count}d", body, offset)), offset + 8 * count
    if kind == _TEXT:
        return body[offset : offset + count].decode("utf-8"), offset + count
    values = []
    for _ in range(count):
        value, offset = _get(body, offset)
        values.append(value)
    return values, offset
