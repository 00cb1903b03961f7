"""Subscriptions."""

from __future__ import annotations

from rclpy._forwarding import passed_on

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy._rcl.endpoints import SubscriptionHandle
    from rclpy.callback_groups import CallbackGroup
    from rclpy.qos import QoSProfile
    from rclpy.qos_event import QoSEventHandler, SubscriptionEventCallbacks

__getattr__ = passed_on(__name__)

MsgType = "MsgType"


class Subscription:
    """Calls back with each message of a topic; made by `Node.create_subscription`."""

    def __init__(
        self,
        subscription_impl: SubscriptionHandle,
        msg_type: Any,
        topic: str,
        callback: Callable[[Any], Any],
        callback_group: CallbackGroup,
        qos_profile: QoSProfile,
        raw: bool,
        event_callbacks: SubscriptionEventCallbacks,
    ) -> None:
        self.__subscription = subscription_impl
        self.msg_type = msg_type
        self.topic = topic
        self.callback = callback
        self.callback_group = callback_group
        self._executor_event = False
        self.qos_profile = qos_profile
        self.raw = raw
        self.event_handlers: list[QoSEventHandler] = event_callbacks.create_event_handlers(
            callback_group, subscription_impl, topic
        )

    @property
    def handle(self) -> SubscriptionHandle:
        return self.__subscription

    def destroy(self) -> None:
        """Destroy the handle; `Node.destroy_subscription` does it."""
        for handler in self.event_handlers:
            handler.destroy()
        self.__subscription.destroy_when_not_in_use()

    @property
    def topic_name(self) -> str:
        self.__subscription.require()
        return self.__subscription.get_topic_name()
