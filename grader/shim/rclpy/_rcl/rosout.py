"""The log publisher of each node: what rcl's logging_rosout does."""

from __future__ import annotations

from rclpy._interfaces.own import LazyType
from rclpy._rcl import logs
from rclpy._rcl.endpoints import PublisherHandle
from rclpy._rcl.qos import NativeQos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from rclpy._rcl.node_handle import NodeHandle


class RosoutHandle(PublisherHandle):
    """Publisher on /rosout that a node's logger uses while the node lives."""

    def __init__(self, node: NodeHandle) -> None:
        qos = NativeQos(1, 1000, 1, 1, lifespan=10_000_000_000)
        super().__init__(node, LazyType("rcl_interfaces/msg/Log"), "/rosout", qos)
        logs.attach_rosout(node.logger_name(), self)

    def _dispose(self) -> None:
        logs.detach_rosout(self.node.logger_name(), self)
        super()._dispose()


def open_rosout(node: NodeHandle) -> None:
    """Create the log publisher of a node; it is destroyed with the node."""
    node.rosout = RosoutHandle(node)
