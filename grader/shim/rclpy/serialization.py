"""Messages as bytes."""

from __future__ import annotations

from rclpy._interfaces import cdr
from rclpy.type_support import check_for_type_support

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def serialize_message(message: Any) -> bytes:
    """Return the CDR form of a message."""
    check_for_type_support(type(message))
    return cdr.serialize(message)


def deserialize_message(serialized_message: bytes, message_type: Any) -> Any:
    """Return the message of `message_type` that the bytes hold. Raises RMWError: they hold none."""
    from rclpy._rcl.errors import RMWError, wrong_arguments

    check_for_type_support(message_type)
    if not isinstance(serialized_message, bytes):
        signature = "(arg0: bytes, arg1: object) -> object"
        raise wrong_arguments("rclpy_deserialize", signature, serialized_message, message_type)
    try:
        return cdr.deserialize(serialized_message, message_type)
    except cdr.CdrError:
        raise RMWError("failed to deserialize ROS message: error not set") from None
