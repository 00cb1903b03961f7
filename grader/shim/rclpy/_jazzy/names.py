"""Names that modules re-export because they import them, and submodules that ``import rclpy`` loads."""

from __future__ import annotations

import rclpy
from rclpy import _forwarding, _rclpy_pybind11
from rclpy._jazzy.overlay import replace

replace(
    rclpy,
    _WITH_RCLPY=(*rclpy._WITH_RCLPY, "destroyable"),
    _WITH_NODE=(
        *(name for name in rclpy._WITH_NODE if name != "qos_event"),
        *("clock_type", "event_handler", "logging_service", "service_introspection"),
        *("type_description_service", "type_hash"),
    ),
)

_forwarding._HOMES.pop("rclpy.qos_event")
_forwarding._HOMES |= {
    "rclpy.event_handler": "EventHandler PublisherEventCallbacks SubscriptionEventCallbacks",
    "rclpy.logging_service": "LoggingService",
    "rclpy.service_introspection": "ServiceIntrospectionState",
    "rclpy.type_description_service": "TypeDescriptionService",
    "rclpy.type_hash": "TypeHash",
}
_ADDED = {
    "rclpy.client": "Clock Optional ServiceIntrospectionState",
    "rclpy.node": "LoggingService TypeDescriptionService",
    "rclpy.publisher": "EventHandler",
    "rclpy.service": "Clock ServiceIntrospectionState",
    "rclpy.subscription": "EventHandler",
}
for _module, _names in _ADDED.items():
    _forwarding._PASSED_ON[_module] += f" {_names}"

_rclpy_pybind11._HOMES.pop("qos_event")
_rclpy_pybind11._HOMES |= {
    "event_handler": {
        "EventHandle": "EventHandle",
        "rcl_publisher_event_type_t": "QoSPublisherEventType",
        "rcl_subscription_event_type_t": "QoSSubscriptionEventType",
    },
}
