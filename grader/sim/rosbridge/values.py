"""Messages as JSON clients write them, to plain data for `grader.sim.cdr` and back.

As rosbridge_library's message_conversion: fields left out have their defaults, an unknown field is an error, a
whole number may stand for a float, ``null`` for NaN, base64 text for bytes, and a time may be ``{sec, nanosec}``,
``{secs, nsecs}`` or the word ``now``.
"""

import base64
import binascii
import math
import re
import sys
from typing import Any, Final, NoReturn

import msgspec

from grader.contracts.errors import ProtocolError
from grader.sim.cdr import MAX_SEQUENCE_LENGTH, Values, encode
from grader.sim.interfaces import Types, stamp
from grader.sim.rosbridge.frames import FrameError

_TIME: Final = "builtin_interfaces/msg/Time"
_DURATION: Final = "builtin_interfaces/msg/Duration"
_HEADER: Final = "std_msgs/msg/Header"
_OTHER_TIME: Final = {"secs": "sec", "nsecs": "nanosec"}
_FIELD: Final = re.compile(r"([^<\[]+)(?:<=?(\d+)>)?(?:\[(<=)?(\d*)\])?")
_FLOATS: Final = ("float32", "float64")
_TEXTS: Final = ("string", "wstring")
_INTEGERS: Final = {
    f"{sign}int{bits}": (0 if sign else -(1 << (bits - 1)), (1 << (bits if sign else bits - 1)) - 1)
    for sign in ("", "u")
    for bits in (8, 16, 32, 64)
}
_MOST_FLOAT32: Final = math.nextafter(3.4028235677973366e38, 0.0)  # struct cannot round more to a float32


def full_type(name: str, kind: str = "msg") -> str:
    """Return the full name of a type: ``geometry_msgs/Twist`` -> ``geometry_msgs/msg/Twist``."""
    package, slash, rest = name.partition("/")
    return f"{package}/{kind}/{rest}" if slash and "/" not in rest else name


def message(type_name: str, values: Any, types: Types, now_ns: int) -> bytes:
    """Return the CDR of a message from what JSON said of it; `now_ns` is the wall clock, for times.

    Raises FrameError: it does not fit the type.
    """
    if type_name not in types.fields:
        raise FrameError(f"unknown type {type_name}")
    plain = _Reader(types, now_ns).structure(type_name, values, "msg")
    header = next((name for name, kind in types.fields[type_name] if kind == _HEADER), None)
    if header is not None and isinstance(values, dict) and "stamp" not in (values.get(header) or ()):
        plain.setdefault(header, {})["stamp"] = stamp(now_ns)
    try:
        return encode(type_name, plain, types)
    except ProtocolError as error:
        raise FrameError(str(error)) from None


def in_order(type_name: str, args: dict[str, Any] | list[Any] | None, types: Types) -> dict[str, Any]:
    """Return a request's fields by name, also where they came in their order.

    Raises FrameError: there are more than the type has, or the type is unknown.
    """
    if args is None or isinstance(args, dict):
        return args or {}
    fields = types.fields.get(type_name)
    if fields is None:
        raise FrameError(f"unknown type {type_name}")
    if len(args) > len(fields):
        raise FrameError(f"{type_name} has {len(fields)} fields, not {len(args)}")
    return {name: value for (name, _), value in zip(fields, args, strict=False)}


def to_json(values: Any) -> bytes:
    """Return JSON: NaN and infinity as null, bytes as base64."""
    return msgspec.json.encode(values)


class _Reader:
    """Reads by the type; what the type does not know is refused with the path of the field."""

    def __init__(self, types: Types, now_ns: int) -> None:
        self._types = types
        self._now_ns = now_ns

    def structure(self, type_name: str, values: Any, path: str) -> Values:
        if type_name in (_TIME, _DURATION):
            values = self._time(values)
        if not isinstance(values, dict):
            _refuse(path, type_name, values)
        fields = dict(self._types.fields[type_name])
        unknown = next((name for name in values if name not in fields), None)
        if unknown is not None:
            raise FrameError(f"{type_name} has no field {unknown[:64]!r} ({path})")
        return {name: self._field(fields[name], value, f"{path}.{name}") for name, value in values.items()}

    def _time(self, values: Any) -> Any:
        if values == "now":
            return stamp(self._now_ns)
        if isinstance(values, dict) and _OTHER_TIME.keys() & values.keys():
            return {_OTHER_TIME.get(name, name): value for name, value in values.items()}
        return values

    def _field(self, text: str, value: Any, path: str) -> Any:
        base, bound, upper, count = _taken_apart(text)
        if count is None:
            return self._value(base, bound, value, path)
        if base == "uint8" and isinstance(value, str):
            value = _bytes(value, path)
        if not isinstance(value, list):
            _refuse(path, text, value)
        most = int(count) if count else MAX_SEQUENCE_LENGTH
        if len(value) > most or (count and not upper and len(value) != most):
            raise FrameError(f"{path}: {text} cannot hold {len(value)} elements")
        read = [self._value(base, bound, element, path) for element in value]
        return bytes(read) if base == "uint8" else read

    def _value(self, base: str, bound: int | None, value: Any, path: str) -> Any:
        if base in _FLOATS:
            return _float(base, value, path)
        if base in _TEXTS:
            if not isinstance(value, str) or "\0" in value or (bound is not None and len(value) > bound):
                _refuse(path, base, value)
            return value
        if base == "bool":
            if not isinstance(value, bool) and value not in (0, 1):
                _refuse(path, base, value)
            return bool(value)
        if base in _INTEGERS:
            return _integer(base, value, path)
        return self.structure(base, value, path)


def _float(base: str, value: Any, path: str) -> float:
    if value is None:
        return math.nan
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        _refuse(path, base, value)
    most = _MOST_FLOAT32 if base == "float32" else sys.float_info.max
    if not -most <= value <= most:  # JSON's whole numbers have no bound
        _refuse(path, base, value)
    return float(value)


def _integer(base: str, value: Any, path: str) -> int:
    low, high = _INTEGERS[base]
    if isinstance(value, float) and value.is_integer():  # JavaScript has one kind of number
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        _refuse(path, base, value)
    return int(value)


def _bytes(text: str, path: str) -> list[int]:
    try:
        return list(base64.b64decode(text, validate=True))
    except (binascii.Error, ValueError):
        raise FrameError(f"{path}: not base64") from None


def _taken_apart(text: str) -> tuple[str, int | None, bool, str | None]:
    """Return a field's base type, the bound of its text, whether its size is an upper one, and its size."""
    match = _FIELD.fullmatch(text)
    if match is None:
        raise FrameError(f"unknown type {text}")
    base, bound, upper, count = match.groups()
    return base, None if bound is None else int(bound), upper is not None, count


def _refuse(path: str, form: str, value: Any) -> NoReturn:
    raise FrameError(f"{path}: {form} expected, not {str(value)[:60]!r}")
