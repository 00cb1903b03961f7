"""Events of publishers and subscriptions: those of incompatible QoS and of partners that come and go."""

from __future__ import annotations

from rclpy import qos_event
from rclpy._jazzy.matching import matches_of
from rclpy._rcl.enums import NativeEnum
from rclpy._rcl.errors import UnsupportedEventTypeError as UnsupportedEventTypeError
from rclpy.logging import get_logger
from rclpy.qos_event import QoSLivelinessChangedInfo as QoSLivelinessChangedInfo
from rclpy.qos_event import QoSLivelinessLostInfo as QoSLivelinessLostInfo
from rclpy.qos_event import QoSMessageLostInfo as QoSMessageLostInfo
from rclpy.qos_event import QoSOfferedDeadlineMissedInfo as QoSOfferedDeadlineMissedInfo
from rclpy.qos_event import QoSOfferedIncompatibleQoSInfo as QoSOfferedIncompatibleQoSInfo
from rclpy.qos_event import QoSRequestedDeadlineMissedInfo as QoSRequestedDeadlineMissedInfo
from rclpy.qos_event import QoSRequestedIncompatibleQoSInfo as QoSRequestedIncompatibleQoSInfo

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy._rcl.endpoints import EndpointHandle

    Callback = Callable[[Any], Any]


class QoSPublisherEventType(NativeEnum):
    """Events of publishers."""

    RCL_PUBLISHER_OFFERED_DEADLINE_MISSED = 0
    RCL_PUBLISHER_LIVELINESS_LOST = 1
    RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS = 2
    RCL_PUBLISHER_INCOMPATIBLE_TYPE = 3
    RCL_PUBLISHER_MATCHED = 4


class QoSSubscriptionEventType(NativeEnum):
    """Events of subscriptions."""

    RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED = 0
    RCL_SUBSCRIPTION_LIVELINESS_CHANGED = 1
    RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS = 2
    RCL_SUBSCRIPTION_MESSAGE_LOST = 3
    RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE = 4
    RCL_SUBSCRIPTION_MATCHED = 5


class QoSPublisherMatchedInfo:
    """Partners came or went."""

    def __init__(self) -> None:
        self.total_count = 0
        self.total_count_change = 0
        self.current_count = 0
        self.current_count_change = 0


QoSSubscriptionMatchedInfo = QoSPublisherMatchedInfo


class IncompatibleTypeInfo:
    """An endpoint of the other side has another type; Fast DDS never tells."""

    def __init__(self) -> None:
        self.total_count_change = 0


_MATCHED = (
    QoSPublisherEventType.RCL_PUBLISHER_MATCHED,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_MATCHED,
)
_INCOMPATIBLE_TYPE = (
    QoSPublisherEventType.RCL_PUBLISHER_INCOMPATIBLE_TYPE,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE,
)
_ON_HUMBLE = {
    "PublisherHandle": qos_event.QoSPublisherEventType,
    "SubscriptionHandle": qos_event.QoSSubscriptionEventType,
}


class EventHandle(qos_event.QoSEventHandle):
    """One kind of event of one publisher or subscription."""

    def __init__(self, parent: EndpointHandle, event_type: Any) -> None:
        kinds = _ON_HUMBLE[type(parent).__name__].__members__
        super().__init__(parent, kinds.get(event_type.name))
        self._event_type = event_type if event_type.name not in kinds else self._event_type
        self._matches = matches_of(parent)
        self._seen = (0, 0)
        if event_type in _MATCHED:
            self.backlog.extend([1] * self._matches.now)
            self._matches.watchers.append(self.backlog)

    def take_event(self) -> Any:
        """Return what happened since the last take."""
        if self._event_type in _INCOMPATIBLE_TYPE:
            return IncompatibleTypeInfo()
        if self._event_type not in _MATCHED:
            return super().take_event()
        info = QoSPublisherMatchedInfo()
        info.total_count, info.current_count = self._matches.total, self._matches.now
        info.total_count_change = info.total_count - self._seen[0]
        info.current_count_change = info.current_count - self._seen[1]
        self._seen = info.total_count, info.current_count
        self.backlog.clear()
        return info

    def _dispose(self) -> None:
        super()._dispose()
        watchers = self._matches.watchers
        self._matches.watchers = [backlog for backlog in watchers if backlog is not self.backlog]


class EventHandler(qos_event.QoSEventHandler):
    """Calls back when an event occurs."""

    _handle_class = EventHandle


_DEPRECATED = "QoSEventHandler is deprecated, use EventHandler instead."


class QoSEventHandler(EventHandler):
    """Old name of `EventHandler`; it warns."""

    def __init_subclass__(cls, **kwargs: Any) -> None:
        import warnings

        text = "QoSEventHandler foo is deprecated, use EventHandler instead."
        warnings.warn(text, DeprecationWarning, stacklevel=2)
        super().__init_subclass__(**kwargs)

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        import warnings

        warnings.warn(_DEPRECATED, DeprecationWarning, stacklevel=2)
        super().__init__(*args, **kwargs)


def _or_type_warning(callbacks: Any, handle: EndpointHandle, topic_name: str) -> Callback | None:
    """Return the callback for another type; without one a warning is logged."""
    callback: Callback | None = callbacks.incompatible_type
    if callback or not callbacks.use_default_callbacks:
        return callback
    logger = get_logger(handle.get_logger_name())

    def warn(_: Any) -> None:
        logger.warn(f"Incompatible type on topic '{topic_name}', no messages will be sent to it.")

    return warn


class _WithPartners(qos_event._EventCallbacks):
    """What Jazzy adds to both: callbacks for partners that are matched and for those of another type."""

    _handler_class = EventHandler
    _kinds: Any
    _prefix: str

    def __init__(
        self, *, incompatible_type: Callback | None = None, matched: Callback | None = None, **humble: Any
    ) -> None:
        super().__init__(**humble)
        self.incompatible_type = incompatible_type
        self.matched = matched

    def _callbacks(self, endpoint: EndpointHandle, topic_name: str) -> list[tuple[Any, Callback | None]]:
        kinds = self._kinds
        return [
            *((kinds[kind.name], callback) for kind, callback in super()._callbacks(endpoint, topic_name)),
            (kinds[f"{self._prefix}_INCOMPATIBLE_TYPE"], _or_type_warning(self, endpoint, topic_name)),
            (kinds[f"{self._prefix}_MATCHED"], self.matched),
        ]


class SubscriptionEventCallbacks(_WithPartners, qos_event.SubscriptionEventCallbacks):
    """Callbacks for events of a subscription."""

    _kinds, _prefix = QoSSubscriptionEventType, "RCL_SUBSCRIPTION"


class PublisherEventCallbacks(_WithPartners, qos_event.PublisherEventCallbacks):
    """Callbacks for events of a publisher."""

    _kinds, _prefix = QoSPublisherEventType, "RCL_PUBLISHER"
