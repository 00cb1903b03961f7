"""Validation of topic and service names as scripts give them."""

from rclpy._rcl.names import topic_name_fault
from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException

TOPIC_SEPARATOR_STRING = "/"


def validate_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Return True, or raise InvalidTopicNameException (InvalidServiceNameException for a service)."""
    fault = topic_name_fault(name)
    if fault is None:
        return True
    if is_service:
        raise InvalidServiceNameException(name, *fault)
    raise InvalidTopicNameException(name, *fault)
