"""Kinds of fields: what a value is, its unit and its bounds.

A contract that people write (the rules of an assignment) names the kind beside each field, once. From that follow
its JSON body over HTTP, its form, its command line and how the audit log tells it. What a field is called on pages
stands among the messages, under the field's name.
"""

import typing
from collections.abc import Hashable, Mapping
from dataclasses import KW_ONLY, dataclass
from functools import cache


@dataclass(frozen=True, slots=True)
class FieldKind:
    """What a field holds.

    Attributes:
        meaning: one sentence for the OpenAPI document. example: a value for it.
    """

    meaning: str = ""
    _: KW_ONLY
    example: object = None


@dataclass(frozen=True, slots=True)
class Instant(FieldKind):
    """A date and time. Written without an offset it is meant in the course's time zone."""


@dataclass(frozen=True, slots=True)
class Number(FieldKind):
    """A number from `low` to `high`, both included.

    Attributes:
        positive: what needs the number needs more than 0, which stands where nothing does.
    """

    _: KW_ONLY
    low: float = 0
    high: float = 1
    positive: bool = False


@dataclass(frozen=True, slots=True)
class Count(Number):
    """How many: a whole number."""


@dataclass(frozen=True, slots=True)
class Seconds(Number):
    """A duration in whole seconds. People type it in hours, or in minutes: ``0.5``, ``30 min``."""


@dataclass(frozen=True, slots=True)
class Share(Number):
    """A share of the whole, from 0 to 1. People type it in per cent."""


@dataclass(frozen=True, slots=True)
class Choice(FieldKind):
    """One of a few names: `options` are all of them."""

    _: KW_ONLY
    options: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Name(FieldKind):
    """The name of something, not longer than `longest`."""

    _: KW_ONLY
    longest: int = 128


@dataclass(frozen=True, slots=True)
class Names(FieldKind):
    """Names of things, `most` of them at most, none longer than `longest`."""

    _: KW_ONLY
    most: int = 1
    longest: int = 128


@dataclass(frozen=True, slots=True)
class Nested(FieldKind):
    """The fields of another contract."""

    _: KW_ONLY
    of: type = object


@dataclass(frozen=True, slots=True)
class Table(FieldKind):
    """Lines of the same fields, those of another contract; `most` of them at most."""

    _: KW_ONLY
    of: type = object
    most: int = 1


@cache
def kinds_of(contract: Hashable) -> Mapping[str, FieldKind]:
    """Return the fields of a contract that have a kind, by name, in their order."""
    hints = typing.get_type_hints(contract, include_extras=True).items()
    told = {name: getattr(hint, "__metadata__", ()) for name, hint in hints}
    return {name: one for name, metadata in told.items() for one in metadata if isinstance(one, FieldKind)}
