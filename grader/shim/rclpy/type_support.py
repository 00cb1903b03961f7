"""Whether a class is a message, service or action class."""

from __future__ import annotations

from rclpy._interfaces.messages import STRUCTURES, class_of
from rclpy.exceptions import NoTypeSupportImportedException

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_HINT = (
    " This might be a ROS 1 message type but it should be a ROS 2 message type."
    " Make sure to source your ROS 2 workspace after your ROS 1 workspace."
)


def check_for_type_support(msg_or_srv_type: Any) -> None:
    """Raise AttributeError unless the argument is an interface class."""
    try:
        support = msg_or_srv_type.__class__._TYPE_SUPPORT
    except AttributeError as error:
        error.args = (error.args[0] + _HINT, *error.args[1:])
        raise
    if support is None:
        msg_or_srv_type.__class__.__import_type_support__()
    if msg_or_srv_type.__class__._TYPE_SUPPORT is None:
        raise NoTypeSupportImportedException()


def check_is_valid_msg_type(msg_type: Any) -> None:
    """Raise AttributeError or RuntimeError unless the argument is a message class, or a message."""
    check_for_type_support(msg_type)
    if class_of(msg_type) not in STRUCTURES:
        raise RuntimeError(
            f"The message type provided is not valid ({msg_type}), this might be a service or action"
        )


def check_is_valid_srv_type(srv_type: Any) -> None:
    """Raise AttributeError or RuntimeError unless the argument is a service class."""
    check_for_type_support(srv_type)
    if getattr(srv_type, "Request", None) is None or getattr(srv_type, "Response", None) is None:
        raise RuntimeError(
            f"The service type provided is not valid ({srv_type}), this might be a message or action"
        )
