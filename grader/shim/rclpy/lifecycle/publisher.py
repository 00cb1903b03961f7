"""Publishers of managed nodes."""

from __future__ import annotations

from rclpy._forwarding import passed_on
from rclpy.lifecycle.managed_entity import SimpleManagedEntity
from rclpy.publisher import Publisher

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__getattr__ = passed_on(__name__)


class LifecyclePublisher(SimpleManagedEntity, Publisher):
    """Publishes only while its node is active."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        SimpleManagedEntity.__init__(self)
        Publisher.__init__(self, *args, **kwargs)

    @SimpleManagedEntity.when_enabled
    def publish(self, msg: Any) -> None:
        """Publish while the node is active, else do nothing."""
        Publisher.publish(self, msg)
