"""Coordinate frames on topics, with the public names of tf2_ros (ROS 2 Humble)."""

from __future__ import annotations

from tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

from tf2_ros.buffer_interface import (
    BufferInterface,
    ConvertRegistration,
    NotImplementedException,
    Stamped,
    TransformRegistration,
    TypeException,
    convert,
)

from tf2_ros.buffer import Buffer  # isort: skip - builds on the interface
from tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster
from tf2_ros.transform_broadcaster import TransformBroadcaster
from tf2_ros.transform_listener import TransformListener

__all__ = [
    "Buffer",
    "BufferCore",
    "BufferInterface",
    "ConnectivityException",
    "ConvertRegistration",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "NotImplementedException",
    "Stamped",
    "StaticTransformBroadcaster",
    "TimeoutException",
    "TransformBroadcaster",
    "TransformException",
    "TransformListener",
    "TransformRegistration",
    "TypeException",
    "convert",
]

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_PASSED_ON = {
    **dict.fromkeys(
        (
            "PointStamped",
            "PoseStamped",
            "PoseWithCovarianceStamped",
            "TransformStamped",
            "Vector3Stamped",
        ),
        "geometry_msgs.msg",
    ),
    "DurabilityPolicy": "rclpy.qos",
    "Duration": "rclpy.duration",
    "FrameGraph": "tf2_msgs.srv",
    "Future": "rclpy.task",
    "Header": "std_msgs.msg",
    "HistoryPolicy": "rclpy.qos",
    "Node": "rclpy.node",
    "PointCloud2": "sensor_msgs.msg",
    "QoSProfile": "rclpy.qos",
    "ReentrantCallbackGroup": "rclpy.callback_groups",
    "SingleThreadedExecutor": "rclpy.executors",
    "TFMessage": "tf2_msgs.msg",
    "Time": "rclpy.time",
}
"""Upstream's modules import these and the package passes them on; tutorials take them from here."""


def __getattr__(name: str) -> Any:
    """Import a name that upstream's package passes on."""
    if name not in _PASSED_ON:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_PASSED_ON[name]), name)
