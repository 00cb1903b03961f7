"""`datetime.now`, `utcnow` and `today` in virtual time.

The C classes cannot be changed, so subclasses take their places; a metaclass makes `isinstance` and
`issubclass` see no difference.
"""

from __future__ import annotations

import datetime as _datetime

from rclpy._patches.time import time_ns

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any

_real_datetime = _datetime.datetime
_real_date = _datetime.date


class _DatetimeMeta(type):
    def __instancecheck__(cls, instance: object) -> bool:
        return isinstance(instance, _real_datetime)

    def __subclasscheck__(cls, subclass: type) -> bool:
        return issubclass(subclass, _real_datetime)


class _DateMeta(type):
    def __instancecheck__(cls, instance: object) -> bool:
        return isinstance(instance, _real_date)

    def __subclasscheck__(cls, subclass: type) -> bool:
        return issubclass(subclass, _real_date)


def _named(text: str) -> str:
    return text if text.startswith("datetime.") else f"datetime.{text}"


class VirtualDatetime(_real_datetime, metaclass=_DatetimeMeta):
    """`datetime.datetime` that reads the virtual clock."""

    __slots__ = ()

    @classmethod
    def now(cls, tz: _datetime.tzinfo | None = None) -> Any:
        seconds, microseconds = divmod(time_ns() // 1000, 10**6)
        return cls.fromtimestamp(seconds, tz).replace(microsecond=microseconds)

    @classmethod
    def utcnow(cls) -> Any:
        return cls(1970, 1, 1) + _datetime.timedelta(microseconds=time_ns() // 1000)

    @classmethod
    def today(cls) -> Any:
        return cls.now()

    def __repr__(self) -> str:
        return _named(super().__repr__())


class VirtualDate(_real_date, metaclass=_DateMeta):
    """`datetime.date` that reads the virtual clock."""

    __slots__ = ()

    @classmethod
    def today(cls) -> Any:
        return cls.fromtimestamp(time_ns() // 10**9)

    def __repr__(self) -> str:
        return _named(super().__repr__())


def patch_datetime(datetime: ModuleType) -> None:
    """Replace the classes by their virtual subclasses."""
    module: Any = datetime
    for name, replacement in (("datetime", VirtualDatetime), ("date", VirtualDate)):
        replacement.__name__ = replacement.__qualname__ = name
        replacement.__module__ = "datetime"
        setattr(module, name, replacement)
    for value, cls in ((_real_datetime.min, VirtualDatetime), (_real_datetime.max, VirtualDatetime)):
        setattr(cls, "min" if value.year == 1 else "max", cls(*value.timetuple()[:6], value.microsecond))
