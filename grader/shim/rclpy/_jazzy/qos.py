"""Policies and profiles that match as much as they can, and a warning for a queue of no length."""

from __future__ import annotations

from enum import Enum

from rclpy import qos
from rclpy._jazzy.overlay import extends, replace
from rclpy._rcl import qos as native
from rclpy.duration import Duration

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

BEST_AVAILABLE = 4
BEST_AVAILABLE_LIVELINESS = 5
BEST_AVAILABLE_NS = 9223372036854775806  # RMW_DURATION_INFINITE less one nanosecond (rmw/types.h)

_NO_DEPTH = (
    "A zero depth with KEEP_LAST doesn't make sense; no data could be stored. "
    "This will be interpreted as SYSTEM_DEFAULT"
)


def _policy(humble: Any, value: int) -> Any:
    """Return an enumeration of Humble with the member BEST_AVAILABLE."""
    members = {name: int(member) for name, member in humble.__members__.items()} | {"BEST_AVAILABLE": value}
    base: Any = qos.QoSPolicyEnum
    policy: Any = base(humble.__name__, members, module=humble.__module__)
    policy.__doc__ = humble.__doc__
    return qos._with_aliases(humble.__name__.removesuffix("Policy").upper())(policy)


ReliabilityPolicy = _policy(qos.ReliabilityPolicy, BEST_AVAILABLE)
DurabilityPolicy = _policy(qos.DurabilityPolicy, BEST_AVAILABLE)
LivelinessPolicy = _policy(qos.LivelinessPolicy, BEST_AVAILABLE_LIVELINESS)

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

        warnings.warn(_NO_DEPTH, stacklevel=2)
    self._depth = value  # type: ignore[attr-defined]


@extends(qos.QoSProfile)
class QoSProfile(qos.QoSProfile):
    """A set of policies."""

    __slots__ = ()

    reliability = qos._checked("reliability", int, ReliabilityPolicy)
    durability = qos._checked("durability", int, DurabilityPolicy)
    liveliness = qos._checked("liveliness", int, LivelinessPolicy)
    depth = property(lambda self: self._depth, _set_depth)


_humble_predefined = native.NativeQos.predefined.__func__  # type: ignore[attr-defined]


@extends(native.NativeQos)
class NativeQos(native.NativeQos):
    """One QoS profile."""

    __slots__ = ()

    @classmethod
    def predefined(cls, name: str) -> native.NativeQos:
        """Return the profile the middleware knows under `name`."""
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


class _ByName:
    """What the enumeration of presets offers besides its members."""

    short_keys: Any = classmethod(vars(qos.QoSPresetProfiles)["short_keys"].__func__)
    get_from_short_key: Any = classmethod(vars(qos.QoSPresetProfiles)["get_from_short_key"].__func__)


_NAMES = (
    *("unknown", "default", "system_default", "sensor_data", "services_default", "parameters"),
    *("parameter_events", "action_status_default", "best_available"),
)


def _profile(name: str) -> qos.QoSProfile:
    of_actions = name == "action_status_default"
    return qos._preset("rcl_action_qos_profile_status_default" if of_actions else f"qos_profile_{name}")


_profiles = {name: _profile(name) for name in _NAMES}
_best_available = Duration(nanoseconds=BEST_AVAILABLE_NS)
replace(
    qos,
    QoSPresetProfiles=Enum(
        "QoSPresetProfiles",
        {name.upper(): profile for name, profile in _profiles.items()},
        module="rclpy.qos",
        type=_ByName,
    ),
    DeadlineBestAvailable=_best_available,
    LivelinessLeaseDurationeBestAvailable=_best_available,
    **{f"qos_profile_{name}": profile for name, profile in _profiles.items()},
)
