"""Publishing fixed frames on ``/tf_static``."""

from __future__ import annotations

from typing import Any

from rclpy._forwarding import forwarding
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

from tf2_ros.transform_broadcaster import as_list

__getattr__ = forwarding(__name__, {"geometry_msgs.msg": "TransformStamped", "rclpy.node": "Node"})


class StaticTransformBroadcaster:
    """Publishes transforms of fixed frames; late subscribers get the last one.

    Args:
        node: on which the publisher is made.
        qos: profile or depth of the publisher.
    """

    def __init__(self, node: Any, qos: Any = None) -> None:
        if qos is None:
            qos = QoSProfile(
                depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, history=HistoryPolicy.KEEP_LAST
            )
        self.pub_tf = node.create_publisher(TFMessage, "/tf_static", qos)

    def sendTransform(self, transform: Any) -> None:
        """Publish one TransformStamped or several."""
        self.pub_tf.publish(TFMessage(transforms=as_list(transform)))
