"""Contracts as classes: what `dataclass(frozen=True, slots=True, kw_only=True)` makes, for a third of its cost.

A cold `grader check` defines some sixty of them in each of two processes. `dataclass` compiles six functions
for each class; here only `__init__` is compiled, and all classes share the rest.
"""

from dataclasses import MISSING, Field, FrozenInstanceError, dataclass, field
from typing import Any, Final, TypeVar, dataclass_transform

T = TypeVar("T")

_put: Final = object.__setattr__
_NOT_GIVEN: Final = object()


@dataclass_transform(kw_only_default=True, frozen_default=True, field_specifiers=(field,))
def record(cls: type[T]) -> type[T]:
    """Make `cls` an immutable dataclass with slots, equality and hash by value, and keyword arguments only."""
    return _make(cls, kw_only=True)


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def positional_record(cls: type[T]) -> type[T]:
    """As `record`, but arguments may be given by position as well."""
    return _make(cls, kw_only=False)


def _make(cls: type[T], *, kw_only: bool) -> type[T]:
    made: Any = dataclass(init=False, repr=False, eq=False, slots=True, kw_only=kw_only)(cls)
    made.__init__ = _initializer(made.__dataclass_fields__, "*, " if kw_only else "")
    for method in (_eq, _hash, _repr, _setattr, _delattr, _getstate, _setstate):
        setattr(made, f"_{method.__name__}__", method)
    return made  # type: ignore[no-any-return]


def _initializer(fields: dict[str, Field[Any]], marker: str) -> Any:
    """Compile ``__init__``, as `dataclass` does; `marker` stands before the parameters."""
    names: dict[str, Any] = {"_put": _put, "_NOT_GIVEN": _NOT_GIVEN}
    parameters, body = [], []
    for name, each in fields.items():
        value = name
        if each.default is not MISSING:
            names[f"_default_{name}"] = each.default
            parameters.append(f"{name}=_default_{name}")
        elif each.default_factory is not MISSING:
            names[f"_make_{name}"] = each.default_factory
            parameters.append(f"{name}=_NOT_GIVEN")
            value = f"_make_{name}() if {name} is _NOT_GIVEN else {name}"
        else:
            parameters.append(name)
        body.append(f"    _put(self, {name!r}, {value})\n")
    exec(f"def __init__(self, {marker}{', '.join(parameters)}):\n{''.join(body)}", names)  # noqa: S102 - our own
    return names["__init__"]


def _values(self: Any) -> tuple[Any, ...]:
    return tuple(getattr(self, name) for name in self.__dataclass_fields__)


def _eq(self: Any, other: object) -> bool:
    return _values(self) == _values(other) if other.__class__ is self.__class__ else NotImplemented


def _hash(self: Any) -> int:
    return hash(_values(self))


def _repr(self: Any) -> str:
    values = ", ".join(f"{name}={getattr(self, name)!r}" for name in self.__dataclass_fields__)
    return f"{self.__class__.__qualname__}({values})"


def _setattr(self: Any, name: str, value: object) -> None:
    raise FrozenInstanceError(f"cannot assign to field {name!r}")


def _delattr(self: Any, name: str) -> None:
    raise FrozenInstanceError(f"cannot delete field {name!r}")


def _getstate(self: Any) -> tuple[Any, ...]:
    return _values(self)


def _setstate(self: Any, state: tuple[Any, ...]) -> None:
    for name, value in zip(self.__dataclass_fields__, state, strict=True):
        _put(self, name, value)
