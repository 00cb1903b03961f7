"""The part of `rclpy.node.Node` that asks about the graph."""

from __future__ import annotations

from rclpy._names import expand
from rclpy.validate_full_topic_name import validate_full_topic_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from rclpy._graph import Names
    from rclpy._node_handle import NodeHandle
    from rclpy.topic_endpoint_info import TopicEndpointInfo

    NamesAndTypes = list[tuple[str, list[str]]]

_GID_BYTES = 24


class GraphMixin:
    """Looks up nodes, topics and services, the simulated world's included."""

    @property
    def handle(self) -> NodeHandle:
        """Handle of the node; raises AttributeError when assigned."""
        raise NotImplementedError()

    def _graph_handle(self) -> NodeHandle:
        handle = self.handle
        handle.require()
        return handle

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return a topic name made absolute and, unless `only_expand`, remapped; RCLError when invalid."""
        return self._graph_handle().resolve(topic, only_expand, False)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """Return a service name made absolute and, unless `only_expand`, remapped; RCLError when invalid."""
        return self._graph_handle().resolve(service, only_expand, True)

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """Return the topics a node publishes; NodeNameNonExistentError."""
        handle = self._graph_handle()
        return handle.names_and_types_by_node(handle.graph.writers, node_name, node_namespace)

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """Return the topics a node listens to; NodeNameNonExistentError."""
        handle = self._graph_handle()
        return handle.names_and_types_by_node(handle.graph.readers, node_name, node_namespace)

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """Return the services a node offers; NodeNameNonExistentError."""
        handle = self._graph_handle()
        return handle.names_and_types_by_node(handle.graph.servers, node_name, node_namespace)

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """Return the services a node has clients of; NodeNameNonExistentError."""
        handle = self._graph_handle()
        return handle.names_and_types_by_node(handle.graph.clients, node_name, node_namespace)

    def get_topic_names_and_types(self, no_demangle: bool = False) -> NamesAndTypes:
        """Return all topics with their types."""
        handle = self._graph_handle()
        return handle.names_and_types(handle.graph.writers, handle.graph.readers)

    def get_service_names_and_types(self) -> NamesAndTypes:
        """Return all services with their types."""
        handle = self._graph_handle()
        return handle.names_and_types(handle.graph.servers)

    def get_node_names(self) -> list[str]:
        """Return the names of all nodes."""
        return [name for name, _ in self._graph_handle().get_node_names_and_namespaces()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Return the names and namespaces of all nodes."""
        return self._graph_handle().get_node_names_and_namespaces()

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """Return the names, namespaces and security enclaves of all nodes."""
        return self._graph_handle().get_node_names_and_namespaces_with_enclaves()

    def _full_topic_name(self, topic_name: str) -> str:
        handle = self._graph_handle()
        full = expand(topic_name, handle.name, handle.namespace)
        validate_full_topic_name(full)
        return full

    def count_publishers(self, topic_name: str) -> int:
        """Return how many publishers a topic has."""
        return self._graph_handle().get_count_publishers(self._full_topic_name(topic_name))

    def count_subscribers(self, topic_name: str) -> int:
        """Return how many subscriptions a topic has."""
        return self._graph_handle().get_count_subscribers(self._full_topic_name(topic_name))

    def _infos(self, topic_name: str, no_mangle: bool, kind: Names, number: int) -> list[TopicEndpointInfo]:
        from rclpy.topic_endpoint_info import TopicEndpointInfo

        name = topic_name
        if not no_mangle:
            name = self._graph_handle().remap(self._full_topic_name(topic_name), "topic")
        return [
            TopicEndpointInfo(
                node_name=endpoint.owner[0],
                node_namespace=endpoint.owner[1],
                topic_type=endpoint.type_name,
                endpoint_type=number,
                endpoint_gid=list(endpoint.gid.to_bytes(_GID_BYTES, "big")),
                qos_profile={**endpoint.qos.to_dict(), "history": 3, "depth": 0},
            )
            for endpoint in kind.at(name)
        ]

    def get_publishers_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """Return what is known of a topic's publishers."""
        return self._infos(topic_name, no_mangle, self._graph_handle().graph.writers, 1)

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """Return what is known of a topic's subscriptions."""
        return self._infos(topic_name, no_mangle, self._graph_handle().graph.readers, 2)
