"""Waiting for one message of a topic."""

from __future__ import annotations

from rclpy._forwarding import passed_on
from rclpy._kernel import kernel
from rclpy.utilities import timeout_sec_to_nsec

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from rclpy.node import Node
    from rclpy.qos import QoSProfile

__getattr__ = passed_on(__name__)


def wait_for_message(
    msg_type: Any,
    node: Node,
    topic: str,
    *,
    qos_profile: QoSProfile | int = 1,
    time_to_wait: float = -1,
) -> tuple[bool, Any]:
    """Wait for the next message of a topic, without an executor.

    Returns:
        True and the message, or False and None when `time_to_wait` seconds (negative: no limit) passed.
    """
    subscription = node.create_subscription(msg_type, topic, lambda _: None, qos_profile=qos_profile)
    try:
        timeout_ns = timeout_sec_to_nsec(time_to_wait)
        backlog = subscription.handle.backlog
        kernel.wait(
            lambda: bool(backlog),
            None if timeout_ns < 0 else kernel.now_ns + timeout_ns,
            f"wait_for_message() waits for a message on {subscription.topic_name!r}",
        )
        taken = subscription.handle.take_message(msg_type, subscription.raw)
        return (False, None) if taken is None else (True, taken[0])
    finally:
        node.destroy_subscription(subscription)
