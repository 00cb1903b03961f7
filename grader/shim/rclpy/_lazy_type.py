"""Interface classes by name: every node has endpoints of types that most scripts never use."""

from __future__ import annotations

from rclpy import _interfaces
from rclpy._messages import interface_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class LazyType:
    """Stands for an interface class of the client library until a message of it is used."""

    def __init__(self, full_name: str) -> None:
        self.full_name = full_name

    def _class(self) -> Any:
        return getattr(_interfaces, self.full_name.rpartition("/")[2])

    def __getattr__(self, name: str) -> Any:
        return getattr(self._class(), name)

    def __instancecheck__(self, candidate: object) -> bool:
        return isinstance(candidate, self._class())


def type_name(cls: Any) -> str:
    """Return the ROS name of an interface class, e.g. ``geometry_msgs/msg/Twist``."""
    return cls.full_name if type(cls) is LazyType else interface_name(cls)
