"""Publishing moving frames on ``/tf``."""

from __future__ import annotations

from typing import Any

from rclpy._forwarding import forwarding
from rclpy.qos import QoSProfile
from tf2_msgs.msg import TFMessage

_DEPTH = 100

__getattr__ = forwarding(__name__, {"geometry_msgs.msg": "TransformStamped", "rclpy.node": "Node"})


class TransformBroadcaster:
    """Publishes transforms of moving frames.

    `qos`: profile or depth of the publisher.
    """

    def __init__(self, node: Any, qos: Any = None) -> None:
        self.pub_tf = node.create_publisher(
            TFMessage, "/tf", QoSProfile(depth=_DEPTH) if qos is None else qos
        )

    def sendTransform(self, transform: Any) -> None:
        """Publish one TransformStamped or several."""
        self.pub_tf.publish(TFMessage(transforms=as_list(transform)))


def as_list(transform: Any) -> list[Any]:
    """Return one or several transforms as a list."""
    if isinstance(transform, list):
        return transform
    return list(transform) if hasattr(transform, "__iter__") else [transform]
