"""Expansion of relative and private names."""

from rclpy._rcl.names import expand


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """Return the absolute form of a name; ValueError when one of the arguments is invalid."""
    return expand(topic_name, node_name, node_namespace)
