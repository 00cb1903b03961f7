"""The message types that rclpy itself speaks, e.g. ``rclpy._interfaces.ParameterValue``.

Each is imported when first asked for, so that a script pays only for what it uses. Importing this module
makes all interface packages importable (see `rclpy._importer`).
"""

from __future__ import annotations

import rclpy._importer  # noqa: F401 - installs the finder
from rclpy._definitions import INTERFACES
from rclpy._messages import interface_class, interface_name

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

type_name = interface_name
"""``type_name(cls)`` is the ROS name of an interface class, e.g. ``geometry_msgs/msg/Twist``."""


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
    wanted = "Log" if name == "LogType" else name
    for package in _PACKAGES:
        for kind in ("msg", "srv"):
            if f"{package}/{kind}/{wanted}" in INTERFACES:
                found = interface_class(f"{package}/{kind}/{wanted}")
                globals()[name] = found
                return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
