"""The log publisher of each node: what rcl's logging_rosout.c does."""

from __future__ import annotations

from rclpy._interfaces.own import LazyType
from rclpy._rcl import logs
from rclpy._rcl.endpoints import PublisherHandle
from rclpy._rcl.qos import NativeQos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from rclpy._rcl.node_handle import NodeHandle

SECOND_OF_ITS_NAME = (
    "Publisher already registered for provided node name. If this is due to multiple nodes with the same name "
    "then all logs for that logger name will go out over the existing publisher. As soon as any node with that "
    "name is destructed it will unregister the publisher, preventing any further logs for that name from being "
    "published on the rosout topic."
)


def open_rosout(node: NodeHandle, *, enabled: bool) -> None:
    """Create a node's log publisher, unless a node of that name has one; it goes with either of them."""
    name = node.logger_name()
    if not enabled or not logs.is_rosout_open():
        logs.know_node(name, node.path)
        return
    node.at_disposal = lambda: logs.close_rosout(name)
    if logs.has_rosout(name):
        logs.warn("rcl.logging_rosout", SECOND_OF_ITS_NAME)
    else:
        qos = NativeQos(1, 1000, 1, 1, lifespan=10_000_000_000)
        publisher = PublisherHandle(node, LazyType("rcl_interfaces/msg/Log"), "/rosout", qos)
        logs.attach_rosout(name, node.path, publisher)
