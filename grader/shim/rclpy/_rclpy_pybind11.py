"""Names of upstream's C module, for scripts and examples that import it; the shim itself needs none of them."""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_HOMES = {
    "action._native": {"GoalEvent": "GoalEvent"},
    "_rcl.clocks": {
        "Clock": "ClockHandle",
        "ClockEvent": "ClockEvent",
        "Timer": "TimerHandle",
        "rcl_duration_t": "NativeDuration",
        "rcl_time_point_t": "TimePoint",
    },
    "_rcl.endpoints": {"Publisher": "PublisherHandle", "Subscription": "SubscriptionHandle"},
    "_rcl.enums": {
        "ClockChange": "ClockChange",
        "ClockType": "ClockType",
        "SignalHandlerOptions": "SignalHandlerOptions",
    },
    "_rcl.errors": {
        "InvalidHandle": "InvalidHandle",
        "NodeNameNonExistentError": "NodeNameNonExistentError",
        "NotImplementedError": "NativeNotImplementedError",
        "RCLError": "RCLError",
        "RCLInvalidROSArgsError": "RCLInvalidROSArgsError",
        "RCUtilsError": "RCUtilsError",
        "RMWError": "RMWError",
        "UnknownROSArgsError": "UnknownROSArgsError",
        "UnsupportedEventTypeError": "UnsupportedEventTypeError",
    },
    "_rcl.handles": {"Context": "ContextHandle", "Destroyable": "Handle", "GuardCondition": "GuardHandle"},
    "lifecycle._machine": {
        "LifecycleStateMachine": "LifecycleStateMachine",
        "TransitionCallbackReturnType": "TransitionCallbackReturnType",
    },
    "_rcl.node_handle": {"Node": "NodeHandle"},
    "_rcl.qos": {
        "QoSCompatibility": "QoSCompatibility",
        "RMW_DURATION_INFINITE": "INFINITE_NS",
        "rmw_qos_profile_t": "NativeQos",
    },
    "_rcl.service_endpoints": {
        "Client": "ClientHandle",
        "Service": "ServiceHandle",
        "rmw_request_id_t": "RequestId",
        "rmw_service_info_t": "ServiceInfo",
    },
    "_rcl.wait_set": {"WaitSet": "WaitSet"},
    "qos_event": {
        "QoSEvent": "QoSEventHandle",
        "rcl_publisher_event_type_t": "QoSPublisherEventType",
        "rcl_subscription_event_type_t": "QoSSubscriptionEventType",
    },
}
"""Module of the shim -> names of the C module and the classes that stand for them."""


def __getattr__(name: str) -> Any:
    """Import what stands for a name of the C module."""
    for home, names in _HOMES.items():
        if name in names:
            value = getattr(import_module(f"rclpy.{home}"), names[name])
            globals()[name] = value
            return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
