"""Validation of node names."""

from rclpy._rcl.errors import RMWError
from rclpy._rcl.names import named, node_name_fault
from rclpy.exceptions import InvalidNodeNameException


def validate_node_name(node_name: str) -> bool:
    """Return True, or raise InvalidNodeNameException."""
    null = RMWError("failed to validate node name: error not set")
    fault = node_name_fault(named(node_name, "node_name", null))
    if fault is not None:
        raise InvalidNodeNameException(node_name, *fault)
    return True
