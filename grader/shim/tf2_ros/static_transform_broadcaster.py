"""Publishing fixed frames on ``/tf_static``."""

from __future__ import annotations

from typing import Any

from rclpy import _distro
from rclpy._forwarding import forwarding
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

from tf2_ros.transform_broadcaster import as_list

__getattr__ = forwarding(__name__, {"geometry_msgs.msg": "TransformStamped", "rclpy.node": "Node"})


class StaticTransformBroadcaster:
    """Publishes transforms of fixed frames; late subscribers get the last message.

    On Humble that has the transforms of one call. On Jazzy (tf2_ros_py 0.36) it has those of all calls, of each
    child frame the first that was sent: a frame that is sent again does not move.

    `qos`: profile or depth of the publisher.
    """

    def __init__(self, node: Any, qos: Any = None) -> None:
        if qos is None:
            qos = QoSProfile(
                depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, history=HistoryPolicy.KEEP_LAST
            )
        self.pub_tf = node.create_publisher(TFMessage, "/tf_static", qos)
        if _distro.chosen == _distro.JAZZY:
            self.net_message = TFMessage()
            self._child_frame_ids: set[str] = set()

    def sendTransform(self, transform: Any) -> None:
        """Publish one TransformStamped or several."""
        transforms = as_list(transform)
        if _distro.chosen == _distro.HUMBLE:
            self.pub_tf.publish(TFMessage(transforms=transforms))
            return
        for each in transforms:
            if each.child_frame_id not in self._child_frame_ids:
                self._child_frame_ids.add(each.child_frame_id)
                self.net_message.transforms.append(each)
        self.pub_tf.publish(self.net_message)
