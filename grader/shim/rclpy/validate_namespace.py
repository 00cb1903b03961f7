"""Validation of namespaces."""

from rclpy._rcl.errors import RMWError
from rclpy._rcl.names import named, namespace_fault
from rclpy.exceptions import InvalidNamespaceException


def validate_namespace(namespace: str) -> bool:
    """Return True, or raise InvalidNamespaceException."""
    null = RMWError("failed to validate namespace: error not set")
    fault = namespace_fault(named(namespace, "namespace", null))
    if fault is not None:
        raise InvalidNamespaceException(namespace, *fault)
    return True
