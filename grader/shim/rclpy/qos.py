"""Quality of service: profiles, policies, presets."""

from __future__ import annotations

from enum import Enum, IntEnum

from rclpy._forwarding import passed_on
from rclpy._rcl.qos import NativeQos, check_compatible
from rclpy._rcl.qos import QoSCompatibility as QoSCompatibility
from rclpy.duration import Duration

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, SupportsInt

__getattr__ = passed_on(__name__)


class QoSPolicyKind(IntEnum):
    """Kinds of policies."""

    INVALID = 1 << 0
    DURABILITY = 1 << 1
    DEADLINE = 1 << 2
    LIVELINESS = 1 << 3
    RELIABILITY = 1 << 4
    HISTORY = 1 << 5
    LIFESPAN = 1 << 6
    DEPTH = 1 << 7
    LIVELINESS_LEASE_DURATION = 1 << 8
    AVOID_ROS_NAMESPACE_CONVENTIONS = 1 << 9


def qos_policy_name_from_kind(policy_kind: SupportsInt) -> str:
    """Return the name of a kind of policy."""
    return QoSPolicyKind(int(policy_kind)).name


class InvalidQoSProfileException(Exception):
    """A profile lacks a setting."""

    def __init__(self, *args: Any) -> None:
        Exception.__init__(self, "Invalid QoSProfile", *args)


class QoSPolicyEnum(IntEnum):
    """Base of the policies' values."""

    @classmethod
    def short_keys(cls) -> list[str]:
        """Return the members' names in lower case."""
        return [key.lower() for key in cls.__members__ if not key.startswith("RMW")]

    @classmethod
    def get_from_short_key(cls, name: str) -> Any:
        """Return the value of the member of that name in any case."""
        return cls[name.upper()].value

    @property
    def short_key(self) -> str:
        return self.name.lower()


class _Alias:
    """Deprecated name of a policy's value: it warns and gives the member."""

    def __init__(self, replacement_name: str, deprecated_name: str) -> None:
        self.replacement_name = replacement_name
        self.deprecated_name = deprecated_name

    def __get__(self, obj: object, policy: type[QoSPolicyEnum]) -> QoSPolicyEnum:
        import warnings

        warnings.warn(
            f"{policy.__name__}.{self.deprecated_name} is deprecated. "
            f"Use {policy.__name__}.{self.replacement_name} instead.",
            stacklevel=2,
        )
        return policy[self.replacement_name]


def _with_aliases(policy: str) -> Callable[[Any], Any]:
    def decorate(cls: Any) -> Any:
        for name in tuple(cls.__members__):
            old = f"RMW_QOS_POLICY_{policy}_{name}"
            if (policy, name) == ("LIVELINESS", "UNKNOWN"):
                old = "RMW_QOS_POLICY_DURABILITY_UNKNOWN"  # upstream's own slip
            setattr(cls, old, _Alias(name, old))
        return cls

    return decorate


@_with_aliases("HISTORY")
class HistoryPolicy(QoSPolicyEnum):
    """How many samples are kept."""

    SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    KEEP_ALL = 2
    UNKNOWN = 3


@_with_aliases("RELIABILITY")
class ReliabilityPolicy(QoSPolicyEnum):
    """Whether samples may be lost."""

    SYSTEM_DEFAULT = 0
    RELIABLE = 1
    BEST_EFFORT = 2
    UNKNOWN = 3


@_with_aliases("DURABILITY")
class DurabilityPolicy(QoSPolicyEnum):
    """Whether late joiners get earlier samples."""

    SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    VOLATILE = 2
    UNKNOWN = 3


@_with_aliases("LIVELINESS")
class LivelinessPolicy(QoSPolicyEnum):
    """Who tells that a publisher is alive."""

    SYSTEM_DEFAULT = 0
    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3
    UNKNOWN = 4


QoSHistoryPolicy = HistoryPolicy
QoSReliabilityPolicy = ReliabilityPolicy
QoSDurabilityPolicy = DurabilityPolicy
QoSLivelinessPolicy = LivelinessPolicy


def _checked(name: str, kind: Any, convert: Callable[[Any], Any]) -> property:
    """Return a property that asserts the type of what it is given, as upstream's setters do."""
    slot = "_" + name

    def get(self: QoSProfile) -> Any:
        return getattr(self, slot)

    def set_(self: QoSProfile, value: Any) -> None:
        assert isinstance(value, kind)
        setattr(self, slot, convert(value))

    return property(get, set_)


def _same(value: Any) -> Any:
    return value


class QoSProfile:
    """A set of policies.

    Raises:
        AssertionError: an unknown keyword or a value of a wrong type.
        InvalidQoSProfileException: neither history nor depth, or KEEP_LAST without depth.
    """

    __slots__ = [  # noqa: RUF023 - the order of upstream's str()
        "_history",
        "_depth",
        "_reliability",
        "_durability",
        "_lifespan",
        "_deadline",
        "_liveliness",
        "_liveliness_lease_duration",
        "_avoid_ros_namespace_conventions",
    ]

    def __init__(self, **kwargs: Any) -> None:
        assert all("_" + key in self.__slots__ for key in kwargs), (
            f"Invalid arguments passed to constructor: {kwargs.keys()!r}"
        )
        if "history" not in kwargs:
            if "depth" not in kwargs:
                raise InvalidQoSProfileException("History and/or depth settings are required.")
            kwargs["history"] = QoSHistoryPolicy.KEEP_LAST
        self.history = kwargs["history"]  # noqa: PLE0237 - a property
        if self.history == QoSHistoryPolicy.KEEP_LAST and "depth" not in kwargs:
            raise InvalidQoSProfileException("History set to KEEP_LAST without a depth setting.")
        for slot in self.__slots__[1:]:
            name = slot[1:]
            setattr(self, name, kwargs[name] if name in kwargs else _default(name))

    history = _checked("history", int, QoSHistoryPolicy)
    reliability = _checked("reliability", int, QoSReliabilityPolicy)
    durability = _checked("durability", int, QoSDurabilityPolicy)
    depth = _checked("depth", int, _same)
    lifespan = _checked("lifespan", Duration, _same)
    deadline = _checked("deadline", Duration, _same)
    liveliness = _checked("liveliness", int, QoSLivelinessPolicy)
    liveliness_lease_duration = _checked("liveliness_lease_duration", Duration, _same)
    avoid_ros_namespace_conventions = _checked("avoid_ros_namespace_conventions", bool, _same)

    def get_c_qos_profile(self) -> NativeQos:
        """Return the profile as the middleware takes it."""
        return NativeQos(
            self.history,
            self.depth,
            self.reliability,
            self.durability,
            self.lifespan.get_c_duration(),
            self.deadline.get_c_duration(),
            self.liveliness,
            self.liveliness_lease_duration.get_c_duration(),
            self.avoid_ros_namespace_conventions,
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, QoSProfile):
            return False
        return all(getattr(self, slot) == getattr(other, slot) for slot in self.__slots__)

    __hash__ = None  # type: ignore[assignment]

    def __str__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{s[1:]}={getattr(self, s)!s}' for s in self.__slots__)})"


_defaults: dict[str, Any] = NativeQos.predefined("qos_profile_default").to_dict()


def _default(name: str) -> Any:
    return _defaults[name]


def _preset(name: str) -> QoSProfile:
    return QoSProfile(**NativeQos.predefined(name).to_dict())


qos_profile_unknown = _preset("qos_profile_unknown")
qos_profile_system_default = _preset("qos_profile_system_default")
qos_profile_sensor_data = _preset("qos_profile_sensor_data")
qos_profile_services_default = _preset("qos_profile_services_default")
qos_profile_parameters = _preset("qos_profile_parameters")
qos_profile_parameter_events = _preset("qos_profile_parameter_events")
qos_profile_action_status_default = _preset("rcl_action_qos_profile_status_default")


class QoSPresetProfiles(Enum):
    """The presets by name."""

    UNKNOWN = qos_profile_unknown
    SYSTEM_DEFAULT = qos_profile_system_default
    SENSOR_DATA = qos_profile_sensor_data
    SERVICES_DEFAULT = qos_profile_services_default
    PARAMETERS = qos_profile_parameters
    PARAMETER_EVENTS = qos_profile_parameter_events
    ACTION_STATUS_DEFAULT = qos_profile_action_status_default

    @classmethod
    def short_keys(cls) -> list[str]:
        """Return the members' names in lower case."""
        return [key.lower() for key in cls.__members__ if not key.startswith("RMW")]

    @classmethod
    def get_from_short_key(cls, name: str) -> QoSProfile:
        """Return the profile of that name in any case."""
        return cls[name.upper()].value


def qos_check_compatible(
    publisher_qos: QoSProfile, subscription_qos: QoSProfile
) -> tuple[QoSCompatibility, str]:
    """Return whether a publisher's profile meets a subscription's, and why not."""
    result = check_compatible(publisher_qos.get_c_qos_profile(), subscription_qos.get_c_qos_profile())
    return result.compatibility, result.reason
