"""Names of upstream's C module that scripts and examples import; nothing here is needed by the shim."""

from __future__ import annotations

from rclpy._clocks import ClockEvent as ClockEvent
from rclpy._clocks import ClockHandle as Clock
from rclpy._clocks import NativeDuration as rcl_duration_t  # noqa: N813
from rclpy._clocks import TimePoint as rcl_time_point_t  # noqa: N813
from rclpy._clocks import TimerHandle as Timer
from rclpy._endpoints import ClientHandle as Client
from rclpy._endpoints import PublisherHandle as Publisher
from rclpy._endpoints import RequestId as rmw_request_id_t  # noqa: N813
from rclpy._endpoints import ServiceHandle as Service
from rclpy._endpoints import ServiceInfo as rmw_service_info_t  # noqa: N813
from rclpy._endpoints import SubscriptionHandle as Subscription
from rclpy._enums import ClockChange as ClockChange
from rclpy._enums import ClockType as ClockType
from rclpy._enums import SignalHandlerOptions as SignalHandlerOptions
from rclpy._errors import InvalidHandle as InvalidHandle
from rclpy._errors import NodeNameNonExistentError as NodeNameNonExistentError
from rclpy._errors import NotImplementedError_ as NotImplementedError  # noqa: A004
from rclpy._errors import RCLError as RCLError
from rclpy._errors import RCLInvalidROSArgsError as RCLInvalidROSArgsError
from rclpy._errors import RCUtilsError as RCUtilsError
from rclpy._errors import RMWError as RMWError
from rclpy._errors import UnknownROSArgsError as UnknownROSArgsError
from rclpy._errors import UnsupportedEventTypeError as UnsupportedEventTypeError
from rclpy._handles import ContextHandle as Context
from rclpy._handles import GuardHandle as GuardCondition
from rclpy._handles import Handle as Destroyable
from rclpy._node_handle import NodeHandle as Node
from rclpy._qos_native import INFINITE_NS as RMW_DURATION_INFINITE
from rclpy._qos_native import NativeQos as rmw_qos_profile_t  # noqa: N813
from rclpy._qos_native import QoSCompatibility as QoSCompatibility
from rclpy._wait_set import WaitSet as WaitSet

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_LATER = {
    "QoSEvent": ("rclpy.qos_event", "QoSEventHandle"),
    "rcl_publisher_event_type_t": ("rclpy.qos_event", "QoSPublisherEventType"),
    "rcl_subscription_event_type_t": ("rclpy.qos_event", "QoSSubscriptionEventType"),
    "GoalEvent": ("rclpy._actions", "GoalEvent"),
    "TransitionCallbackReturnType": ("rclpy._lifecycle_machine", "TransitionCallbackReturnType"),
}


def __getattr__(name: str) -> Any:
    """Import what few scripts need when it is asked for."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    module, attribute = _LATER[name]
    return getattr(import_module(module), attribute)
