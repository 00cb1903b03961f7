"""Handle of a node: its names after remapping, its log topic and what it can ask of the graph."""

from __future__ import annotations

from rclpy._kernel import kernel
from rclpy._link import link
from rclpy._rcl.errors import NODE_CONTEXT, NodeNameNonExistentError, RCLError
from rclpy._rcl.graph import graph_of
from rclpy._rcl.handles import ContextHandle, Handle, required
from rclpy._rcl.names import expand, full_topic_name_fault, namespace_fault, node_name_fault

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Any

    from rclpy._rcl.graph import Endpoint, EndpointsByName
    from rclpy._rcl.ros_args import RosArgs

    NamesAndTypes = list[tuple[str, list[str]]]


class NodeHandle(Handle):
    """A node in the graph.

    Attributes:
        name, namespace: after remapping. path: fully qualified name.
        context: the node's context handle. graph: of the context's domain.
        at_disposal: called when the node is destroyed.
        rosout: publisher of the node's log records, None when it has none.

    Raises:
        ValueError: the name or namespace is invalid.
    """

    def __init__(
        self,
        name: str,
        namespace: str,
        context: ContextHandle,
        cli_args: list[str] | None,
        use_global_arguments: bool,
    ) -> None:
        super().__init__()
        self.context = required(context)
        from rclpy._rcl.ros_args import parse_ros_args

        local = parse_ros_args(cli_args or (), reject_unknown=True, of_node=True)
        self._args: list[RosArgs] = [local, context.ros_args] if use_global_arguments else [local]
        if node_name_fault(name) is not None:
            raise ValueError("invalid node name")
        namespace = namespace or "/"
        if namespace[0] != "/":
            namespace = "/" + namespace
        if namespace_fault(namespace) is not None:
            raise ValueError("invalid node namespace")
        self.name = self._remapped("node", name, name)
        space = self._remapped("ns", name, namespace)
        self.namespace = space if space[0] == "/" else "/" + space
        self.path = self.namespace.rstrip("/") + "/" + self.name
        self.graph = graph_of(context.domain_id)
        self._identity = (self.name, self.namespace, "/")
        self.graph.nodes.append(self._identity)
        self.link_id = link.register("node", self.path)
        self.at_disposal: Callable[[], None] = _nothing

    def _dispose(self) -> None:
        for i, identity in enumerate(self.graph.nodes):
            if identity is self._identity:
                del self.graph.nodes[i]
                break
        self.at_disposal()
        link.unregister(self.link_id)

    def _remapped(self, kind: str, node: str, default: str) -> str:
        for args in self._args:
            for rule in args.remaps:
                if rule.kind == kind and rule.node in (None, node):
                    return rule.replacement
        return default

    # Names ----------------------------------------------------------------------------------------

    def get_node_name(self) -> str:
        """Return the node's name."""
        return self.name

    def get_namespace(self) -> str:
        """Return the node's namespace."""
        return self.namespace

    def get_fully_qualified_name(self) -> str:
        """Return namespace and name."""
        return self.path

    def logger_name(self) -> str:
        """Return the name of the node's logger: dots instead of slashes."""
        return self.path[1:].replace("/", ".")

    def expand_and_remap(self, name: str, *, service: bool, only_expand: bool = False) -> str:
        """Return the absolute, remapped form of a topic or service name; ValueError when it is invalid."""
        expanded = expand(name, self.name, self.namespace)
        if not only_expand:
            expanded = self.remap(expanded, "service" if service else "topic")
        fault = full_topic_name_fault(expanded)
        if fault is not None:
            raise ValueError(f"{fault[0]}, at ./src/rcl/node_resolve_name.c:105")
        return expanded

    def remap(self, expanded: str, kind: str) -> str:
        """Apply the first remapping rule for an absolute name."""
        for args in self._args:
            for rule in args.remaps:
                concerned = rule.kind in (kind, "any") and rule.node in (None, self.name)
                if concerned and expand(rule.match, self.name, self.namespace) == expanded:
                    return expand(rule.replacement, self.name, self.namespace)
        return expanded

    def resolve(self, name: str, only_expand: bool, service: bool) -> str:
        """Return the absolute, remapped form of a name.

        Raises:
            RCLError: the name is invalid. TypeError: it is none, as when a topic and its type changed places.
        """
        if not isinstance(name, str):
            raise TypeError(
                "rclpy_resolve_name(): incompatible function arguments. The following argument types are "
                "supported:\n    1. (arg0: rclpy::Node, arg1: str, arg2: bool, arg3: bool) -> str\n\n"
                f"Invoked with: <rclpy._rclpy_pybind11.Node object at {id(self):#x}>, {name!r}, "
                f"{only_expand}, {service}"
            )
        try:
            return self.expand_and_remap(name, service=service, only_expand=only_expand)
        except ValueError as fault:
            text = str(fault).partition("is invalid: ")[2] or str(fault)
            raise RCLError(f"failed to resolve name: {text}") from None

    def require_context(self, failure: str) -> None:
        """Raise RCLError, beginning with `failure`, when the context was shut down."""
        if not self.context.valid:
            raise RCLError(f"{failure}: {NODE_CONTEXT}")

    def get_parameters(self, parameter_class: Any) -> dict[str, Any]:
        """Return the parameters given on the command line for this node, by name."""
        found: dict[str, Any] = {}
        for args in reversed(self._args):
            for pattern, values in args.parameters.items():
                if _matches(pattern, self.path):
                    found.update({n: parameter_class(n, value=value.get()) for n, value in values.items()})
        return found

    # Graph ----------------------------------------------------------------------------------------

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Return every node's name and namespace."""
        self.require_context("Failed to get node names")
        return [(name, space) for name, space, _ in self.graph.nodes]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """Return every node's name, namespace and security enclave."""
        self.require_context("Failed to get node names")
        return list(self.graph.nodes)

    def names_and_types(self, failure: str, *kinds: EndpointsByName) -> NamesAndTypes:
        """Return the names and types of endpoints, sorted by name; RCLError after shutdown."""
        self.require_context(failure)
        return _collect(endpoint for kind in kinds for endpoint in kind.all())

    def names_and_types_by_node(
        self, failure: str, kind: EndpointsByName, name: str, namespace: str
    ) -> NamesAndTypes:
        """Return the names and types of one node's endpoints.

        Raises:
            NodeNameNonExistentError: there is no such node. RCLError: the context was shut down.
        """
        self.require_context(failure)
        space = namespace if namespace.startswith("/") else "/" + namespace
        if (name, space, "/") not in self.graph.nodes:
            raise NodeNameNonExistentError(
                f"cannot get names and types for nonexistent node: Unable to find GUID for node: {name}"
                ", at ./src/get_node_info_and_types.cpp:51"
            )
        return _collect(endpoint for endpoint in kind.all() if endpoint.owner == (name, space))

    def get_count_publishers(self, topic: str) -> int:
        """Return how many publishers a topic has."""
        self.require_context("Error in rcl_count_publishers")
        kernel.charge()
        return len(self.graph.writers.at(topic))

    def get_count_subscribers(self, topic: str) -> int:
        """Return how many subscriptions a topic has."""
        self.require_context("Error in rcl_count_subscribers")
        link.note_once("asked_for_listeners")
        kernel.charge()  # a loop that asks must let time pass
        return len(self.graph.readers.at(topic))

    def get_action_client_names_and_types_by_node(self, name: str, namespace: str) -> NamesAndTypes:
        """Return the actions a node has clients of."""
        failure = "Failed to get action client names and type"
        return _actions(self.names_and_types_by_node(failure, self.graph.readers, name, namespace))

    def get_action_server_names_and_types_by_node(self, name: str, namespace: str) -> NamesAndTypes:
        """Return the actions a node serves."""
        failure = "Failed to get action server names and type"
        return _actions(self.names_and_types_by_node(failure, self.graph.writers, name, namespace))

    def get_action_names_and_types(self) -> NamesAndTypes:
        """Return every action."""
        failure = "Failed to get action names and type"
        return _actions(self.names_and_types(failure, self.graph.readers, self.graph.writers))


def _nothing() -> None:
    pass


def _matches(pattern: str, path: str) -> bool:
    """Whether a pattern of a parameter file names a node; ``*`` is one token, ``**`` any number."""
    import re

    expression = ("/" + pattern.lstrip("/")).replace("/*", r"(/\w+)")
    return re.fullmatch(expression, path) is not None


def _collect(endpoints: Iterable[Endpoint]) -> NamesAndTypes:
    found: dict[str, set[str]] = {}
    for endpoint in endpoints:
        found.setdefault(endpoint.name, set()).add(endpoint.type_name)
    return [(name, sorted(found[name])) for name in sorted(found)]


def _actions(topics: NamesAndTypes) -> NamesAndTypes:
    suffix, mark = "/_action/feedback", "_FeedbackMessage"
    return [
        (name.removesuffix(suffix), [kind.removesuffix(mark) for kind in kinds])
        for name, kinds in topics
        if name.endswith(suffix)
    ]
