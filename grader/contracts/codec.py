"""Frozen contract dataclasses to plain JSON-ready data and back, strictly and with the standard library only.

For data the grader wrote itself (between parent and grading process, in the store). Instructors' files are
validated by pydantic in `grader.catalog`, students' processes never get here.
"""

import types
import typing
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any, TypeVar, cast

T = TypeVar("T")
_Reader = Callable[[Any], Any]


def to_plain(value: object) -> dict[str, Any]:
    """Return the fields of a contract dataclass as they are: what `json.dumps` takes as its `default`.

    So JSON is made as it goes: `dataclasses.asdict` would take three times as long to copy everything before.

    Raises:
        TypeError: `value` is something else.
    """
    kind: Any = type(value)
    return {name: getattr(value, name) for name in _names(kind)}


@cache
def _names(kind: Any) -> tuple[str, ...]:
    if not is_dataclass(kind):
        raise TypeError(f"no contract: {kind!r}")
    return tuple(one.name for one in fields(kind))


def from_plain(cls: type[T], data: Mapping[str, Any]) -> T:
    """Return the `cls` that was written as JSON with `to_plain`.

    Raises:
        ValueError: a field is missing, unknown or of the wrong type; the message names it.
    """
    result: T = _reader(cast(Any, cls))(data)
    return result


@cache
def _reader(kind: Any) -> _Reader:
    if is_dataclass(kind):
        return _dataclass_reader(kind)
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin in (typing.Union, types.UnionType):
        return _union_reader(arguments)
    if origin is typing.Literal:
        return lambda value: _one_of(arguments, value)
    if origin is tuple:
        return _sequence_reader(arguments[0])
    if origin in (dict, Mapping):
        return _mapping_reader(arguments[1])
    if isinstance(kind, type) and issubclass(kind, Enum):
        return kind
    return _scalar_reader(kind)


def _dataclass_reader(cls: Any) -> _Reader:
    hints = typing.get_type_hints(cls)
    readers = {item.name: _reader(hints[item.name]) for item in fields(cls)}
    required = {
        item.name for item in fields(cls) if item.default is MISSING and item.default_factory is MISSING
    }

    def read(data: Any) -> Any:
        if isinstance(data, cls):
            return data
        if not isinstance(data, Mapping):
            raise ValueError(f"{cls.__name__}: expected an object, got {type(data).__name__}")
        if unknown := set(data) - set(readers):
            raise ValueError(f"{cls.__name__}: unknown field {sorted(unknown)[0]}")
        if missing := required - set(data):
            raise ValueError(f"{cls.__name__}: field {sorted(missing)[0]} is missing")
        return cls(**{name: _field(cls, name, readers[name], value) for name, value in data.items()})

    return read


def _field(cls: Any, name: str, reader: _Reader, value: Any) -> Any:
    try:
        return reader(value)
    except ValueError as error:
        raise ValueError(f"{cls.__name__}.{name}: {error}") from None


def _union_reader(choices: tuple[Any, ...]) -> _Reader:
    readers = [_reader(choice) for choice in choices]

    def read(value: Any) -> Any:
        if type(value) in choices:  # an int stays an int where a float would do as well
            return value
        for reader in readers:
            try:
                return reader(value)
            except ValueError:
                continue
        raise ValueError(f"{value!r} fits none of {', '.join(map(str, choices))}")

    return read


def _sequence_reader(kind: Any) -> _Reader:
    reader = _reader(kind)

    def read(value: Any) -> tuple[Any, ...]:
        if not isinstance(value, list | tuple):
            raise ValueError(f"expected a list, got {type(value).__name__}")
        return tuple(reader(item) for item in value)

    return read


def _mapping_reader(kind: Any) -> _Reader:
    reader = _reader(kind)

    def read(value: Any) -> dict[str, Any]:
        if not isinstance(value, Mapping):
            raise ValueError(f"expected an object, got {type(value).__name__}")
        return {str(key): reader(item) for key, item in value.items()}

    return read


def _one_of(choices: tuple[Any, ...], value: Any) -> Any:
    if value not in choices:
        raise ValueError(f"{value!r} is not one of {', '.join(map(repr, choices))}")
    return value


def _scalar_reader(kind: Any) -> _Reader:
    def read(value: Any) -> Any:
        if kind is float and type(value) is int:
            return float(value)
        if type(value) is not kind:  # exact: a bool is no int here
            raise ValueError(f"expected {getattr(kind, '__name__', kind)}, got {type(value).__name__}")
        return value

    return read
