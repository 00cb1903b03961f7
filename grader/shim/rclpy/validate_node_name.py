"""Validation of node names."""

from rclpy._rcl.names import node_name_fault
from rclpy.exceptions import InvalidNodeNameException


def validate_node_name(node_name: str) -> bool:
    """Return True, or raise InvalidNodeNameException."""
    fault = node_name_fault(node_name)
    if fault is not None:
        raise InvalidNodeNameException(node_name, *fault)
    return True
