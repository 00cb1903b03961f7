"""Publishers."""

from __future__ import annotations

from rclpy._forwarding import passed_on
from rclpy.duration import Duration

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from rclpy._rcl.endpoints import PublisherHandle
    from rclpy.callback_groups import CallbackGroup
    from rclpy.qos import QoSProfile
    from rclpy.qos_event import PublisherEventCallbacks, QoSEventHandler

__getattr__ = passed_on(__name__)


class Publisher:
    """Publishes messages of one class on one topic; made by `Node.create_publisher`."""

    def __init__(
        self,
        publisher_impl: PublisherHandle,
        msg_type: Any,
        topic: str,
        qos_profile: QoSProfile,
        event_callbacks: PublisherEventCallbacks,
        callback_group: CallbackGroup,
    ) -> None:
        self.__publisher = publisher_impl
        self.msg_type = msg_type
        self.topic = topic
        self.qos_profile = qos_profile
        self.event_handlers: list[QoSEventHandler] = event_callbacks.create_event_handlers(
            callback_group, publisher_impl, topic
        )

    def publish(self, msg: Any) -> None:
        """Publish a message, or bytes that hold a serialised one.

        Raises:
            TypeError: an object of another class. InvalidHandle: the publisher was destroyed.
            RCLError: the context was shut down.
        """
        handle = self.__publisher
        if handle.doomed:
            handle.require()
        if isinstance(msg, self.msg_type):
            handle.publish(msg)
        elif isinstance(msg, bytes):
            handle.publish_raw(msg)
        else:
            raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")

    def get_subscription_count(self) -> int:
        """Return how many subscriptions are matched."""
        self.__publisher.require()
        return self.__publisher.get_subscription_count()

    @property
    def topic_name(self) -> str:
        self.__publisher.require()
        return self.__publisher.get_topic_name()

    @property
    def handle(self) -> PublisherHandle:
        return self.__publisher

    def destroy(self) -> None:
        """Destroy the handle; `Node.destroy_publisher` does it."""
        for handler in self.event_handlers:
            handler.destroy()
        self.__publisher.destroy_when_not_in_use()

    def assert_liveliness(self) -> None:
        """Assert that the publisher is alive, as ``MANUAL_BY_TOPIC`` liveliness wants."""
        self.__publisher.require()
        self.__publisher.assert_liveliness()

    def wait_for_all_acked(self, timeout: Duration = Duration(seconds=-1)) -> bool:  # noqa: B008
        """Return True: a message is received as soon as it is published, so there is nothing to wait for."""
        self.__publisher.require()
        return self.__publisher.wait_for_all_acked(timeout._duration_handle)
