"""Coordinate frames on topics, with the public names of tf2_ros (ROS 2 Humble)."""

from __future__ import annotations

from rclpy._forwarding import forwarding
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

_PASSED_ON = {
    "geometry_msgs.msg": "PointStamped PoseStamped PoseWithCovarianceStamped TransformStamped Vector3Stamped",
    "rclpy.callback_groups": "ReentrantCallbackGroup",
    "rclpy.clock": "Clock",
    "rclpy.duration": "Duration",
    "rclpy.executors": "SingleThreadedExecutor",
    "rclpy.node": "Node",
    "rclpy.qos": "DurabilityPolicy HistoryPolicy QoSProfile",
    "rclpy.task": "Future",
    "rclpy.time": "Time",
    "sensor_msgs.msg": "PointCloud2",
    "std_msgs.msg": "Header",
    "tf2_msgs.msg": "TFMessage",
    "tf2_msgs.srv": "FrameGraph",
}
# Upstream's `import *` gives all.
__all__ += [name for names in _PASSED_ON.values() for name in names.split()]

__getattr__ = forwarding(__name__, _PASSED_ON)
