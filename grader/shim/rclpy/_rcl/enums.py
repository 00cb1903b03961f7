"""Enumerations of upstream's C module, and an int enumeration that prints as it does on Python 3.10."""

from enum import Enum, IntEnum


class PrintedIntEnum(IntEnum):
    """IntEnum whose ``str`` names the member (Python 3.10, Humble's) and whose format is the number."""

    __str__ = Enum.__str__

    def __format__(self, spec: str) -> str:
        """Format as the plain integer, as Python 3.10 does."""
        return format(int(self), spec)


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
