"""Handle of a node: its names after remapping, its log topic and what it can ask of the graph."""

from __future__ import annotations

import gc
from _weakref import ref
from sys import getrefcount

from rclpy import _distro
from rclpy._kernel import kernel
from rclpy._link import link
from rclpy._rcl.errors import (
    NO_TOPIC_NAME,
    NODE_CONTEXT,
    NodeNameNonExistentError,
    RCLError,
    native,
    text_or_null,
    wrong_arguments,
)
from rclpy._rcl.graph import graph_of
from rclpy._rcl.handles import ContextHandle, Handle, required
from rclpy._rcl.names import (
    NAMESPACE_FAULTS,
    NODE_FAULTS,
    expand,
    full_topic_name_fault,
    namespace_fault,
    node_name_fault,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Any

    from rclpy._rcl.graph import Endpoint, EndpointsByName
    from rclpy._rcl.names import Fault
    from rclpy._rcl.ros_args import RosArgs

    NamesAndTypes = list[tuple[str, list[str]]]


collecting: list[bool] = []
"""Not empty while the garbage collector works."""


def _on_collection(phase: str, _: Any) -> None:
    if phase == "start":
        collecting.append(True)
    else:
        collecting.clear()


gc.callbacks.append(_on_collection)


@native("Node")
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
        namespace = _checked(name, namespace or "/")
        self.name = self._remapped("node", name, name)
        space = self._remapped("ns", name, namespace)
        self.namespace = space if space[0] == "/" else "/" + space
        if namespace_fault(self.namespace) is not None:
            raise RCLError("error creating node: rcl node's rmw handle is invalid, at ./src/rcl/node.c:415")
        self.path = self.namespace.rstrip("/") + "/" + self.name
        self.graph = graph_of(context.domain_id)
        self._identity = (self.name, self.namespace, "/")
        self.graph.nodes.append(self._identity)
        self.link_id = link.register("node", self.path)
        self.at_disposal: Callable[[], None] = _nothing
        self._wrapper: Any = None

    def _dispose(self) -> None:
        for i, identity in enumerate(self.graph.nodes):
            if identity is self._identity:
                del self.graph.nodes[i]
                break
        self.at_disposal()
        link.unregister(self.link_id)

    def leave_with(self, node: Any, entities: tuple[list[Any], ...]) -> None:
        """Leave the graph as soon as nothing refers to the node or to one of its entities any more.

        Upstream's destructors do. A node that only the garbage collector can free stays: at home nobody knows when
        that comes, and here it may come in the middle of anything.
        """
        attributes = vars(node)

        def leave(_: object) -> None:
            if not collecting:
                self._abandon(attributes, entities)

        self._wrapper = ref(node, leave)

    def _abandon(self, attributes: dict[str, Any], entities: tuple[list[Any], ...]) -> None:
        held = [id(value) for value in attributes.values()]
        kept = False
        for members in entities:
            for entity in members:
                # the list of members, the loop's variable and the argument refer to it as well
                if getrefcount(entity) > 3 + held.count(id(entity)):
                    kept = True
                else:
                    entity.handle.destroy_when_not_in_use()
        if not kept:
            self.destroy_when_not_in_use()

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
            raise ValueError(f"{fault[0]}, at ./src/rcl/node_resolve_name.c:102")
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

        Raises RCLError: the name is invalid. TypeError: it is none, as when a topic and its type changed places.
        """
        text = text_or_null(
            name,
            lambda: wrong_arguments(
                "rclpy_resolve_name",
                "(arg0: rclpy::Node, arg1: str, arg2: bool, arg3: bool) -> str",
                *(self, name, only_expand, service),
            ),
        )
        if text is None:
            raise RCLError(f"failed to resolve name: {NO_TOPIC_NAME}")
        try:
            return self.expand_and_remap(text, service=service, only_expand=only_expand)
        except ValueError as fault:
            text = str(fault).partition("is invalid: ")[2] or str(fault)
            raise RCLError(f"failed to resolve name: {text}") from None

    def require_context(self, failure: str) -> None:
        """Raise RCLError, beginning with `failure`, when the context was shut down."""
        if not self.context.valid:
            raise RCLError(f"{failure}: {NODE_CONTEXT}")

    def get_parameters(self, parameter_class: Any) -> dict[str, Any]:
        """Return the parameters given on the command line for this node, by name."""
        parameters: dict[str, Any] = {}
        for args in reversed(self._args):
            for pattern, values in args.parameters.items():
                if _matches(pattern, self.path):
                    parameters.update(
                        {n: parameter_class(n, value=value.get()) for n, value in values.items()}
                    )
        return parameters

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

        Raises NodeNameNonExistentError: there is no such node. RCLError: the context was shut down.
        """
        self.require_context(failure)
        if not namespace:
            namespace = "/"
        fault, line = namespace_fault(namespace), 57
        if fault is None:
            fault, line = node_name_fault(name), 69
        if fault is not None:
            raise RCLError(f"{failure}: {_numbered(fault, of_node=line == 69)}, at ./src/rcl/graph.c:{line}")
        if (name, namespace, "/") not in self.graph.nodes:
            if failure[0] == "F":  # of an action
                raise RCLError(f"{failure}: error not set")
            what = failure.removeprefix("failed to ")
            raise NodeNameNonExistentError(f"cannot {what} for nonexistent node: error not set")
        return _collect(endpoint for endpoint in kind.all() if endpoint.owner == (name, namespace))

    def get_count_publishers(self, topic: str) -> int:
        """Return how many publishers a topic has."""
        self.require_context("Error in rcl_count_publishers")
        kernel.charge()
        return len(self.graph.writers.at(topic))

    def get_count_subscribers(self, topic: str) -> int:
        """Return how many subscriptions a topic has."""
        self.require_context("Error in rcl_count_subscribers")
        for writer in self.graph.writers.at(topic):
            writer.is_looked_for()  # type: ignore[attr-defined]
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


def _checked(name: str, namespace: str) -> str:
    """Return the namespace made absolute. Raises ValueError: the name or the namespace is invalid."""
    lines = (163, 195) if _distro.chosen == _distro.HUMBLE else (156, 184)
    fault = node_name_fault(name)
    if fault is not None:
        raise ValueError(f"invalid node name: {fault[0]}, at ./src/rcl/node.c:{lines[0]}")
    space = namespace if namespace[0] == "/" else "/" + namespace
    fault = namespace_fault(space)
    if fault is not None:
        raise ValueError(f"invalid node namespace: {_numbered(fault)}, at ./src/rcl/node.c:{lines[1]}")
    return space


def _numbered(fault: Fault, *, of_node: bool = False) -> str:
    """Return rmw's text for a bad namespace, or a node's bad name, with its number."""
    number = next(
        i for i, text in enumerate(NODE_FAULTS if of_node else NAMESPACE_FAULTS, 1) if text in fault[0]
    )
    return f"{fault[0]}, result: {number}"


def _matches(pattern: str, path: str) -> bool:
    """Whether a pattern of a parameter file names a node; ``*`` is one token, ``**`` any number."""
    import re

    expression = ("/" + pattern.lstrip("/")).replace("/*", r"(/\w+)")
    return re.fullmatch(expression, path) is not None


def _collect(endpoints: Iterable[Endpoint]) -> NamesAndTypes:
    types: dict[str, set[str]] = {}
    for endpoint in endpoints:
        types.setdefault(endpoint.name, set()).add(endpoint.type_name)
    return [(name, sorted(types[name])) for name in sorted(types)]


def _actions(topics: NamesAndTypes) -> NamesAndTypes:
    suffix, mark = "/_action/feedback", "_FeedbackMessage"
    return [
        (name.removesuffix(suffix), [kind.removesuffix(mark) for kind in kinds])
        for name, kinds in topics
        if name.endswith(suffix)
    ]
