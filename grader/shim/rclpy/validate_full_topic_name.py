"""Validation of fully qualified topic and service names."""

from rclpy._rcl.errors import RMWError
from rclpy._rcl.names import full_topic_name_fault, named
from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException


def validate_full_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Return True, or raise InvalidTopicNameException (InvalidServiceNameException for a service)."""
    null = RMWError("failed to validate name: error not set")
    fault = full_topic_name_fault(named(name, "full_topic_name", null))
    if fault is None:
        return True
    if is_service:
        raise InvalidServiceNameException(name, *fault)
    raise InvalidTopicNameException(name, *fault)
