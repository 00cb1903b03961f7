"""Best available policies and profiles, which match as many endpoints as they can; a warning for a zero depth."""

from __future__ import annotations

from enum import Enum

from rclpy import qos
from rclpy._jazzy.overlay import extends, replace
from rclpy._rcl import qos as native
from rclpy.duration import Duration

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# Values of rmw/types.h.
BEST_AVAILABLE = 4
BEST_AVAILABLE_LIVELINESS = 5  # liveliness has one policy more than the others
BEST_AVAILABLE_NS = 9223372036854775806  # RMW_DURATION_INFINITE less one nanosecond

_ZERO_DEPTH_WARNING = (
    "A zero depth with KEEP_LAST doesn't make sense; no data could be stored. "
    "This will be interpreted as SYSTEM_DEFAULT"
)


def _policy(humble: Any, value: int) -> Any:
    """Return a copy of Humble's enumeration that has the member BEST_AVAILABLE as well."""
    members = {name: int(member) for name, member in humble.__members__.items()} | {"BEST_AVAILABLE": value}
    base: Any = qos.QoSPolicyEnum
    policy: Any = base(humble.__name__, members, module=humble.__module__)
    policy.__doc__ = humble.__doc__
    return qos._with_aliases(humble.__name__.removesuffix("Policy").upper())(policy)


ReliabilityPolicy = _policy(qos.ReliabilityPolicy, BEST_AVAILABLE)
DurabilityPolicy = _policy(qos.DurabilityPolicy, BEST_AVAILABLE)
LivelinessPolicy = _policy(qos.LivelinessPolicy, BEST_AVAILABLE_LIVELINESS)

# Before any profile is made: each value is converted by the enumeration of its policy.
replace(
    qos,
    ReliabilityPolicy=ReliabilityPolicy,
    QoSReliabilityPolicy=ReliabilityPolicy,
    DurabilityPolicy=DurabilityPolicy,
    QoSDurabilityPolicy=DurabilityPolicy,
    LivelinessPolicy=LivelinessPolicy,
    QoSLivelinessPolicy=LivelinessPolicy,
)


def _set_depth(self: qos.QoSProfile, value: int) -> None:
    assert isinstance(value, int)
    if self.history == qos.QoSHistoryPolicy.KEEP_LAST and value == 0:
        import warnings

        warnings.warn(_ZERO_DEPTH_WARNING, stacklevel=2)
    self._depth = value  # type: ignore[attr-defined]


@extends(qos.QoSProfile)
class QoSProfile(qos.QoSProfile):
    """Humble's profile, with best available values and a warning for a zero depth."""

    __slots__ = ()

    reliability = qos._checked("reliability", int, ReliabilityPolicy)
    durability = qos._checked("durability", int, DurabilityPolicy)
    liveliness = qos._checked("liveliness", int, LivelinessPolicy)
    depth = property(lambda self: self._depth, _set_depth)


# Kept under a name, because `extends` leaves no `super()` to call.
_humble_predefined = native.NativeQos.predefined.__func__  # type: ignore[attr-defined]


@extends(native.NativeQos)
class NativeQos(native.NativeQos):
    """Humble's profile of the middleware, with the one that matches as many endpoints as it can."""

    __slots__ = ()

    @classmethod
    def predefined(cls, name: str) -> native.NativeQos:
        """Return the profile that the middleware knows under `name`."""
        if name != "qos_profile_best_available":
            return _humble_predefined(cls, name)  # type: ignore[no-any-return]
        return cls(
            native.KEEP_LAST,
            10,
            BEST_AVAILABLE,
            BEST_AVAILABLE,
            deadline=BEST_AVAILABLE_NS,
            liveliness=BEST_AVAILABLE_LIVELINESS,
            liveliness_lease_duration=BEST_AVAILABLE_NS,
        )


class _PresetLookup:
    """Methods that the enumeration of presets has besides its members, taken from Humble's."""

    short_keys: Any = classmethod(vars(qos.QoSPresetProfiles)["short_keys"].__func__)
    get_from_short_key: Any = classmethod(vars(qos.QoSPresetProfiles)["get_from_short_key"].__func__)


# In upstream's order, which iterating over the enumeration shows.
_PRESET_NAMES = (
    *("unknown", "default", "system_default", "sensor_data", "services_default", "parameters"),
    *("parameter_events", "action_status_default", "best_available"),
)


def _profile(name: str) -> qos.QoSProfile:
    of_actions = name == "action_status_default"
    return qos._preset("rcl_action_qos_profile_status_default" if of_actions else f"qos_profile_{name}")


_profiles = {name: _profile(name) for name in _PRESET_NAMES}
_best_available = Duration(nanoseconds=BEST_AVAILABLE_NS)
replace(
    qos,
    QoSPresetProfiles=Enum(
        "QoSPresetProfiles",
        {name.upper(): profile for name, profile in _profiles.items()},
        module="rclpy.qos",
        type=_PresetLookup,
    ),
    DeadlineBestAvailable=_best_available,
    # sic: the spelling is upstream's
    LivelinessLeaseDurationeBestAvailable=_best_available,
    **{f"qos_profile_{name}": profile for name, profile in _profiles.items()},
)
