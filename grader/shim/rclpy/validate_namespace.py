"""Validation of namespaces."""

from rclpy._rcl.names import namespace_fault
from rclpy.exceptions import InvalidNamespaceException


def validate_namespace(namespace: str) -> bool:
    """Return True, or raise InvalidNamespaceException."""
    fault = namespace_fault(namespace)
    if fault is not None:
        raise InvalidNamespaceException(namespace, *fault)
    return True
