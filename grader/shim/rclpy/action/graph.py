"""Which actions there are."""

from __future__ import annotations

from rclpy._forwarding import passed_on

TYPE_CHECKING = False
if TYPE_CHECKING:
    from rclpy.node import Node

    NamesAndTypes = list[tuple[str, list[str]]]

__getattr__ = passed_on(__name__)


def get_action_client_names_and_types_by_node(
    node: Node, remote_node_name: str, remote_node_namespace: str
) -> NamesAndTypes:
    """Return the actions a node has clients of; NodeNameNonExistentError."""
    node.handle.require()
    return node.handle.get_action_client_names_and_types_by_node(remote_node_name, remote_node_namespace)


def get_action_server_names_and_types_by_node(
    node: Node, remote_node_name: str, remote_node_namespace: str
) -> NamesAndTypes:
    """Return the actions a node serves; NodeNameNonExistentError."""
    node.handle.require()
    return node.handle.get_action_server_names_and_types_by_node(remote_node_name, remote_node_namespace)


def get_action_names_and_types(node: Node) -> NamesAndTypes:
    """Return all actions."""
    node.handle.require()
    return node.handle.get_action_names_and_types()
