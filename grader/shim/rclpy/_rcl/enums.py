"""Enumerations of upstream's C module."""

from enum import Enum


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


class QosPolicyKind(NativeEnum):
    """Which policy of two endpoints does not fit; an enumeration of C, so it equals its number."""

    RMW_QOS_POLICY_INVALID = 1
    RMW_QOS_POLICY_DURABILITY = 2
    RMW_QOS_POLICY_DEADLINE = 4
    RMW_QOS_POLICY_LIVELINESS = 8
    RMW_QOS_POLICY_RELIABILITY = 16

    def __eq__(self, other: object) -> bool:
        return isinstance(other, (int, QosPolicyKind)) and int(self) == int(other)

    def __hash__(self) -> int:
        return hash(self.value)


QosPolicyKind.__name__ = QosPolicyKind.__qualname__ = "rmw_qos_policy_kind_t"


class SignalHandlerOptions(NativeEnum):
    """Which signals `rclpy.init` takes over."""

    ALL = 3
    NO = 0
    SIGINT = 1
    SIGTERM = 2
