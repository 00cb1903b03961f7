"""Validation of topic and service names as scripts give them."""

from rclpy._rcl.errors import RCLError
from rclpy._rcl.names import named, topic_name_fault
from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException

TOPIC_SEPARATOR_STRING = "/"


def validate_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Return True, or raise InvalidTopicNameException (InvalidServiceNameException for a service)."""
    at = "at ./src/rcl/validate_topic_name.c:35"
    null = RCLError(f"failed to validate name: topic_name argument is null, {at}")
    fault = topic_name_fault(named(name, "topic_name", null))
    if fault is None:
        return True
    if is_service:
        raise InvalidServiceNameException(name, *fault)
    raise InvalidTopicNameException(name, *fault)
