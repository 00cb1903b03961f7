"""QoS settings as the middleware sees them, and which offers meet which requests."""

from __future__ import annotations

from rclpy._rcl.clocks import INFINITE_NS, NativeDuration
from rclpy._rcl.enums import NativeEnum
from rclpy._rcl.errors import native

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


# numbers of rmw/types.h
SYSTEM_DEFAULT = 0  # of every policy
RELIABLE = 1
BEST_EFFORT = 2
TRANSIENT_LOCAL = 1
VOLATILE = 2
KEEP_LAST = 1
KEEP_ALL = 2
UNKNOWN = 3  # of reliability, durability and history
AUTOMATIC = 1
MANUAL_BY_TOPIC = 3
UNKNOWN_LIVELINESS = 4

# bits of rmw/qos_policy_kind.h
DURABILITY_KIND = 1 << 1
DEADLINE_KIND = 1 << 2
LIVELINESS_KIND = 1 << 3
RELIABILITY_KIND = 1 << 4

_FIELDS = (
    "history",
    "depth",
    "reliability",
    "durability",
    "lifespan",
    "deadline",
    "liveliness",
    "liveliness_lease_duration",
    "avoid_ros_namespace_conventions",
)

_PREDEFINED = {
    "qos_profile_default": (KEEP_LAST, 10, RELIABLE, VOLATILE),
    "qos_profile_unknown": (UNKNOWN, 0, UNKNOWN, UNKNOWN),
    "qos_profile_system_default": (SYSTEM_DEFAULT, 0, SYSTEM_DEFAULT, SYSTEM_DEFAULT),
    "qos_profile_sensor_data": (KEEP_LAST, 5, BEST_EFFORT, VOLATILE),
    "qos_profile_services_default": (KEEP_LAST, 10, RELIABLE, VOLATILE),
    "qos_profile_parameters": (KEEP_LAST, 1000, RELIABLE, VOLATILE),
    "qos_profile_parameter_events": (KEEP_LAST, 1000, RELIABLE, VOLATILE),
    "rcl_action_qos_profile_status_default": (KEEP_LAST, 1, RELIABLE, TRANSIENT_LOCAL),
}
"""Name -> history, depth, reliability and durability (rmw/qos_profiles.h, rcl_action/default_qos.h)."""


@native("rmw_qos_profile_t")
class NativeQos:
    """One QoS profile; enumerations are held as their numbers, durations in nanoseconds (0: default)."""

    __slots__ = (*_FIELDS,)

    def __init__(
        self,
        history: int,
        depth: int,
        reliability: int,
        durability: int,
        lifespan: NativeDuration | int = 0,
        deadline: NativeDuration | int = 0,
        liveliness: int = SYSTEM_DEFAULT,
        liveliness_lease_duration: NativeDuration | int = 0,
        avoid_ros_namespace_conventions: bool = False,
    ) -> None:
        self.history = int(history)
        self.depth = depth
        self.reliability = int(reliability)
        self.durability = int(durability)
        self.lifespan = _nanoseconds(lifespan)
        self.deadline = _nanoseconds(deadline)
        self.liveliness = int(liveliness)
        self.liveliness_lease_duration = _nanoseconds(liveliness_lease_duration)
        self.avoid_ros_namespace_conventions = avoid_ros_namespace_conventions

    @classmethod
    def predefined(cls, name: str) -> NativeQos:
        """Return the profile the middleware knows under `name`."""
        profile = cls(*_PREDEFINED[name])
        if name == "qos_profile_unknown":
            profile.liveliness = UNKNOWN_LIVELINESS
        return profile

    def to_dict(self) -> dict[str, Any]:
        """Return keyword arguments for `rclpy.qos.QoSProfile`."""
        from rclpy.duration import Duration

        values = {name: getattr(self, name) for name in _FIELDS}
        for name in ("lifespan", "deadline", "liveliness_lease_duration"):
            values[name] = Duration(nanoseconds=values[name])
        return values

    def discovered(self, *, writer: bool) -> dict[str, Any]:
        """Return what other nodes discover of an endpoint with this profile, in the form of `to_dict`.

        rmw_fastrtps' discovery does not carry history and depth (qos.hpp, rtps_qos_to_rmw_qos). A policy that the
        profile leaves to the system has the default of a DDS DataWriter or, unless `writer`, of a DataReader
        (qos.cpp, fill_entity_qos_from_profile).
        """
        return NativeQos(
            UNKNOWN,
            0,
            self.reliability or (RELIABLE if writer else BEST_EFFORT),
            self.durability or (TRANSIENT_LOCAL if writer else VOLATILE),
            _bound_ns(self.lifespan),
            _bound_ns(self.deadline),
            self.liveliness or AUTOMATIC,
            _bound_ns(self.liveliness_lease_duration),
        ).to_dict()

    @property
    def kept(self) -> int | None:
        """Most samples a queue of this profile holds; None: no bound."""
        if self.history == KEEP_ALL:
            return None
        return max(1, self.depth)

    @property
    def reliable(self) -> bool:
        """Whether the profile asks for reliable delivery."""
        return self.reliability != BEST_EFFORT

    @property
    def transient(self) -> bool:
        """Whether the profile asks for samples published earlier."""
        return self.durability == TRANSIENT_LOCAL


def _nanoseconds(duration: NativeDuration | int) -> int:
    return duration if isinstance(duration, int) else duration.nanoseconds


def _bound_ns(duration_ns: int) -> int:
    """Return the period that a setting stands for: 0 stands for an infinite one."""
    return duration_ns or INFINITE_NS


def incompatible_policy(offered: NativeQos, requested: NativeQos) -> int:
    """Return the kind of the last policy by which an offer does not satisfy a request; 0: it satisfies all.

    The rules are those of DDS (requested/offered), as Fast DDS applies them: a reader that leaves
    reliability to the system is a best-effort one.
    """
    kind = 0
    if offered.durability != TRANSIENT_LOCAL and requested.durability == TRANSIENT_LOCAL:
        kind = DURABILITY_KIND
    if _bound_ns(offered.deadline) > _bound_ns(requested.deadline):
        kind = DEADLINE_KIND
    if offered.liveliness < requested.liveliness == MANUAL_BY_TOPIC or (
        _bound_ns(offered.liveliness_lease_duration) > _bound_ns(requested.liveliness_lease_duration)
    ):
        kind = LIVELINESS_KIND
    if offered.reliability == BEST_EFFORT and requested.reliability == RELIABLE:
        kind = RELIABILITY_KIND
    return kind


class QoSCompatibility(NativeEnum):
    """Result of comparing two profiles."""

    OK = 0
    WARNING = 1
    ERROR = 2


class CompatibilityResult:
    """Result of comparing two profiles, with its reasons, each ended by a semicolon."""

    def __init__(self) -> None:
        self.compatibility = QoSCompatibility.OK
        self.reason = ""

    def add(self, found: QoSCompatibility, text: str) -> None:
        """Add one reason; an error outweighs warnings and hides their texts."""
        if found.value < self.compatibility.value:
            return
        if found.value > self.compatibility.value:
            self.reason = ""
        self.compatibility = found
        self.reason += f"{found.name}: {text};"


def check_compatible(offered: NativeQos, requested: NativeQos) -> CompatibilityResult:
    """Compare two profiles as rmw_dds_common's qos.cpp does: errors first, otherwise warnings."""
    result = CompatibilityResult()
    error = QoSCompatibility.ERROR
    if offered.reliability == BEST_EFFORT and requested.reliability == RELIABLE:
        result.add(error, "Best effort publisher and reliable subscription")
    if offered.durability == VOLATILE and requested.durability == TRANSIENT_LOCAL:
        result.add(error, "Volatile publisher and transient local subscription")
    _check_periods(offered, requested, result)
    if result.compatibility is error:
        return result
    _warn_of_defaults(offered, requested, result)
    return result


def _check_periods(offered: NativeQos, requested: NativeQos, result: CompatibilityResult) -> None:
    error = QoSCompatibility.ERROR
    if requested.deadline and not offered.deadline:
        result.add(error, "Subscription has a deadline, but publisher does not")
    elif requested.deadline and offered.deadline > requested.deadline:
        result.add(error, "Subscription deadline is less than publisher deadline")
    if offered.liveliness == AUTOMATIC and requested.liveliness == MANUAL_BY_TOPIC:
        result.add(error, "Publisher's liveliness is automatic and subscription's is manual by topic")
    lease_ns, wanted_ns = offered.liveliness_lease_duration, requested.liveliness_lease_duration
    if wanted_ns and not lease_ns:
        result.add(error, "Subscription has a liveliness lease duration, but publisher does not")
    elif wanted_ns and lease_ns > wanted_ns:
        result.add(error, "Subscription liveliness lease duration is less than publisher")


_WARNINGS = (
    (
        *(
            "reliability",
            RELIABLE,
            BEST_EFFORT,
            "Publisher reliability is {} and subscription reliability is {}",
        ),
        *("Reliable subscription, but publisher is {}", "Best effort publisher, but subscription is {}"),
    ),
    (
        *("durability", TRANSIENT_LOCAL, VOLATILE),
        "Publisher durabilty is {} and subscription durability is {}",
        *("Transient local subscription, but publisher is {}", "Volatile publisher, but subscription is {}"),
    ),
    (
        *("liveliness", MANUAL_BY_TOPIC, AUTOMATIC),
        "Publisher liveliness is {} and subscription liveliness is {}",
        "Subscription's liveliness is manual by topic, but publisher's is {}",
        "Publisher's liveliness is automatic, but subscription's is {}",
    ),
)
"""Policy, value of a subscription and of a publisher that an undecided other end may not suit, and texts."""


def _warn_of_defaults(offered: NativeQos, requested: NativeQos, result: CompatibilityResult) -> None:
    for field, demanding, lax, neither, of_publisher, of_subscription in _WARNINGS:
        publisher, subscription = getattr(offered, field), getattr(requested, field)
        unknown = UNKNOWN_LIVELINESS if field == "liveliness" else UNKNOWN
        undecided = {SYSTEM_DEFAULT: "system_default", unknown: "unknown"}
        names = undecided.get(publisher), undecided.get(subscription)
        if names[0] and names[1]:
            result.add(QoSCompatibility.WARNING, neither.format(*names))
        elif names[0] and subscription == demanding:
            result.add(QoSCompatibility.WARNING, of_publisher.format(names[0]))
        elif names[1] and publisher == lax:
            result.add(QoSCompatibility.WARNING, of_subscription.format(names[1]))
