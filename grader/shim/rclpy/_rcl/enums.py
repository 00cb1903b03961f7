"""Enumerations of upstream's C module, and how Python 3.10, which is Humble's, prints any enumeration."""

from __future__ import annotations

from enum import Enum, Flag, IntEnum, IntFlag

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def _format(self: Any, spec: str) -> str:
    """Format as the value of the mixed-in type, unless the class has a ``__str__`` of its own."""
    named: Any = (Enum.__str__, Flag.__str__)
    by_name = self._member_type_ is object or type(self).__str__ not in named
    return format(str(self) if by_name else self._value_, spec)


def print_as_python_3_10() -> None:
    """Let ``str`` name the member of an IntEnum, and ``f"{Topic.POSE}"`` be the text where `Topic` is a str.

    Python 3.11 has exchanged the two.
    """
    whole: Any = IntEnum
    flags: Any = IntFlag
    whole.__str__, flags.__str__ = Enum.__str__, Flag.__str__
    _renew_format(Enum)


def _renew_format(cls: Any) -> None:
    """Let a class, and those derived from it so far, format as their values are formatted."""
    if cls is Enum or vars(cls).get("__format__") is cls._member_type_.__format__:
        cls.__format__ = _format
    for derived in cls.__subclasses__():
        _renew_format(derived)


class NativeEnum(Enum):
    """Enumeration of the C module: members convert to int but do not compare with one."""

    def __int__(self) -> int:
        """Return the C value."""
        return int(self.value)

    __index__ = __int__


class ClockType(NativeEnum):
    """Sources of time."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3


class ClockChange(NativeEnum):
    """What a time jump did to the source of ROS time."""

    ROS_TIME_NO_CHANGE = 1
    ROS_TIME_ACTIVATED = 2
    ROS_TIME_DEACTIVATED = 3
    SYSTEM_TIME_NO_CHANGE = 4


class SignalHandlerOptions(NativeEnum):
    """Which signals `rclpy.init` takes over."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3
