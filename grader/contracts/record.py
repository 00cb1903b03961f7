"""Contracts as classes, and their way to plain data and back.

A record is a msgspec `Struct`: made in a fraction of the time of a dataclass, which counts because a cold
`grader check` defines some sixty of them in each of two processes, and read back strictly by compiled code.
"""

import dataclasses
import json
import threading
from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

import msgspec
from msgspec import field

from grader.contracts.python import dataclass_transform

__all__ = ["Record", "canonical", "field", "from_json", "from_plain", "to_plain"]

T = TypeVar("T")


class _RecordType(msgspec.StructMeta):
    """Gives every record the same options, so that no class can forget one of them."""

    def __new__(
        cls, name: str, bases: tuple[type, ...], namespace: dict[str, Any], *, kw_only: bool = True
    ) -> Any:
        return super().__new__(
            cls, name, bases, namespace, kw_only=kw_only, frozen=True, forbid_unknown_fields=True
        )


class _DataclassFields:
    """Lets `dataclasses.replace`, `asdict` and `fields` take records as they take dataclasses."""

    def __get__(self, _: object, owner: Any) -> Mapping[str, dataclasses.Field[Any]]:
        return _dataclass_fields(owner)


@cache
def _dataclass_fields(owner: Any) -> Mapping[str, dataclasses.Field[Any]]:
    values = {}
    for name in owner.__struct_fields__:
        one = values[name] = dataclasses.field()
        one.name = name
        one._field_type = dataclasses._FIELD  # type: ignore[attr-defined] # told from ClassVar and InitVar by it
    return values


if TYPE_CHECKING:  # mypy does not see that the options of `_RecordType` hold for every subclass

    @dataclass_transform(kw_only_default=True, frozen_default=True, field_specifiers=(field,))
    class Record:
        """As below."""

        def __init_subclass__(cls, *, kw_only: bool = True) -> None: ...

else:

    class Record(msgspec.Struct, metaclass=_RecordType):
        """An immutable class with slots, equality and hash by value.

        Its arguments have names, unless a subclass is defined with ``kw_only=False``.
        """

        __dataclass_fields__ = _DataclassFields()


def canonical(value: object) -> bytes:
    """Return the one byte form of a contract as JSON: sorted keys, no spaces, UTF-8, no NaN."""
    return json.dumps(
        value,
        default=to_plain,
        ensure_ascii=False,
        sort_keys=True,
        separators=(",", ":"),
        allow_nan=False,
    ).encode()


def to_plain(value: object) -> dict[str, Any]:
    """Return the fields of a record as they are: what `json.dumps` takes as its `default`.

    Not `msgspec.json.encode`: it would write NaN as null, and other digits than `json` for some numbers, which
    the digests of all stored reports depend on.

    Raises TypeError: `value` is something else.
    """
    return msgspec.structs.asdict(value)  # type: ignore[arg-type] # raises what `json.dumps` expects


def from_plain(cls: type[T], data: object) -> T:
    """Return the `cls` that was written with `to_plain`, read back by `json`.

    For data the grader wrote itself (between parent and grading process, in the store). Instructors' files are
    validated by pydantic in `grader.catalog`; students' processes never get here.

    Raises ValueError: a field is missing, unknown or of the wrong type; the message names it.
    """
    _decoder(cls)
    return msgspec.convert(data, cls)


def from_json(cls: type[T], data: bytes | str) -> T:
    """Return the `cls` that was written as JSON; as `from_plain`, in one step.

    Raises ValueError: it is no JSON, or as `from_plain` does.
    """
    return _decoder(cls).decode(data)


_decoders: dict[Any, msgspec.json.Decoder[Any]] = {}
_describing = threading.Lock()


def _decoder(cls: type[T]) -> msgspec.json.Decoder[T]:
    """Return the decoder of `cls`; only one thread at a time has msgspec look at a class for the first time.

    msgspec 0.22 lets a second thread use a class whose fields it is still looking at, and the process dies: so
    did a service that was asked for two pictures at once before anything else.
    """
    if cls not in _decoders:
        with _describing:
            _decoders[cls] = msgspec.json.Decoder(cls)
    return _decoders[cls]
