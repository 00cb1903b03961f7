"""The message types that rclpy itself speaks, e.g. ``rclpy._interfaces.own.ParameterValue``.

Each is imported when first asked for, so that a script pays only for what it uses. Importing this module
makes all interface packages importable (see `rclpy._interfaces.importer`).
"""

from __future__ import annotations

import rclpy._interfaces.importer  # noqa: F401 - installs the finder
from rclpy._interfaces.definitions import INTERFACES
from rclpy._interfaces.messages import interface_class, interface_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_PACKAGES = (
    "builtin_interfaces",
    "rcl_interfaces",
    "rosgraph_msgs",
    "action_msgs",
    "unique_identifier_msgs",
    "lifecycle_msgs",
)


Clock: Any
DescribeParameters: Any
Duration: Any
GetParameterTypes: Any
GetParameters: Any
ListParameters: Any
LogType: Any
Parameter: Any
ParameterDescriptor: Any
ParameterEvent: Any
ParameterValue: Any
SetParameters: Any
SetParametersAtomically: Any
SetParametersResult: Any
Time: Any


def __getattr__(name: str) -> Any:
    upstream_name = "Log" if name == "LogType" else name
    for package in _PACKAGES:
        for kind in ("msg", "srv"):
            if f"{package}/{kind}/{upstream_name}" in INTERFACES:
                cls = interface_class(f"{package}/{kind}/{upstream_name}")
                globals()[name] = cls
                return cls
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


class LazyType:
    """Stands for an interface class of the client library until a message of it is used."""

    def __init__(self, full_name: str) -> None:
        self.full_name = full_name

    def _class(self) -> Any:
        return __getattr__(self.full_name.rpartition("/")[2])

    def __getattr__(self, name: str) -> Any:
        return getattr(self._class(), name)

    def __instancecheck__(self, candidate: object) -> bool:
        return isinstance(candidate, self._class())


def type_name(cls: Any) -> str:
    """Return the ROS name of an interface class, e.g. ``geometry_msgs/msg/Twist``."""
    return cls.full_name if type(cls) is LazyType else interface_name(cls)
