"""The ROS graph of the process: who publishes, listens and serves, with the simulated world among them.

Discovery is instant: two endpoints match the moment the second one exists. At home, on one machine, that takes 0.1
to 16 ms (recorded: c28 to c31), and what is published before may be lost.
"""

from __future__ import annotations

from rclpy._link import link
from rclpy._rcl.qos import (
    BEST_EFFORT,
    KEEP_LAST,
    RELIABLE,
    TRANSIENT_LOCAL,
    VOLATILE,
    NativeQos,
    incompatible_policy,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Any, Protocol

    class Endpoint(Protocol):
        """One end of a topic or service.

        Attributes:
            name: resolved topic or service name.
            type_name: e.g. ``geometry_msgs/msg/Twist``.
        """

        name: str
        type_name: str
        qos: NativeQos
        gid: int

        @property
        def owner(self) -> tuple[str, str]: ...

    class Writer(Endpoint, Protocol):
        """An end that publishes."""

        def match(self, reader: Reader) -> None: ...
        def unmatch(self, reader: Reader) -> None: ...
        def mismatch(self, policy: int) -> None: ...
        def is_looked_for(self) -> None: ...

    class Reader(Endpoint, Protocol):
        """An end that listens."""

        def mismatch(self, policy: int) -> None: ...


DEFAULT_DOMAIN = 0
_last_gid = 0


def next_gid() -> int:
    """Return a number no other endpoint of this process has."""
    global _last_gid
    _last_gid += 1
    return _last_gid


class WorldEndpoint:
    """A topic end or service of the simulated world: reliable, volatile, depth 7, as turtlesim's are.

    The status of an action is kept for late listeners (rcl_action/default_qos.h). A world that offers something
    else says so: whether it is reliable, and whether it is kept.
    """

    def __init__(
        self, name: str, type_name: str, owner: tuple[str, str], offered: list[bool] | None = None
    ) -> None:
        self.name = name
        self.type_name = type_name
        self.owner = owner
        keeps_last = offered[1] if offered else name.endswith("/_action/status")
        self.qos = NativeQos(
            KEEP_LAST,
            1 if keeps_last else 7,
            BEST_EFFORT if offered and not offered[0] else RELIABLE,
            TRANSIENT_LOCAL if keeps_last else VOLATILE,
        )
        self.gid = next_gid()

    def match(self, reader: Reader) -> None:
        """The link delivers: nothing to do here."""

    def unmatch(self, reader: Reader) -> None:
        """The link stops delivering when the reader is unregistered."""

    def mismatch(self, policy: int) -> None:
        """The world does not mind."""

    def is_looked_for(self) -> None:
        """The world publishes whoever asks."""


class EndpointsByName:
    """Endpoints of one kind by name, in order of creation."""

    def __init__(self) -> None:
        self._by_name: dict[str, list[Endpoint]] = {}

    def at(self, name: str) -> list[Endpoint]:
        """Return the endpoints of that name."""
        return self._by_name.get(name, [])

    def add(self, endpoint: Endpoint) -> None:
        """Add one."""
        self._by_name.setdefault(endpoint.name, []).append(endpoint)

    def remove(self, endpoint: Endpoint) -> None:
        """Remove one; not being there is no error."""
        members = self._by_name.get(endpoint.name, [])
        if endpoint in members:
            members.remove(endpoint)
            if not members:
                del self._by_name[endpoint.name]

    def all(self) -> Iterable[Endpoint]:
        """Return every endpoint."""
        return [endpoint for members in self._by_name.values() for endpoint in members]


class Graph:
    """Everything of one DDS domain; the world lives in the default one."""

    def __init__(self, domain: int) -> None:
        self.nodes: list[tuple[str, str, str]] = []
        self.writers = EndpointsByName()
        self.readers = EndpointsByName()
        self.servers = EndpointsByName()
        self.clients = EndpointsByName()
        if domain == DEFAULT_DOMAIN:
            self._settle_world()

    def _settle_world(self) -> None:
        for path in link.world["nodes"]:
            space, _, name = path.rpartition("/")
            self.nodes.append((name, space or "/", "/"))
        self._owner = self.nodes[0][:2] if self.nodes else ("turtlesim", "/")
        for _ in self.nodes:  # what every node has; nobody hears turtlesim's
            kind = "rcl_interfaces/msg/ParameterEvent"
            self.add_writer(WorldEndpoint("/parameter_events", kind, self._owner))
            self.add_reader(WorldEndpoint("/parameter_events", kind, self._owner))
            self.add_writer(WorldEndpoint("/rosout", "rcl_interfaces/msg/Log", self._owner, [True, True]))
        self._add_world(link.world)
        link.on_change = self._change_world

    def _change_world(self, change: dict[str, Any]) -> None:
        if change["gone"]:
            self._remove_world(change)
        else:
            self._add_world(change)

    def _add_world(self, world: dict[str, Any]) -> None:
        offered = world.get("qos", {})
        for name, kind in world["publishes"]:
            self.add_writer(WorldEndpoint(name, kind, self._owner, offered.get(name)))
        for name, kind in world["subscribes"]:
            self.add_reader(WorldEndpoint(name, kind, self._owner))
        for name, kind in world.get("listens", ()):
            self.add_reader(WorldEndpoint(name, kind, self._owner, [False, False]))
        for members, key in ((self.servers, "services"), (self.clients, "calls")):
            for name, kind in world.get(key, ()):
                members.add(WorldEndpoint(name, kind, self._owner))

    def _remove_world(self, world: dict[str, Any]) -> None:
        for remove, members, key in (
            (self.remove_writer, self.writers, "publishes"),
            (self.remove_reader, self.readers, "subscribes"),
            (self.servers.remove, self.servers, "services"),
        ):
            for name, _ in world[key]:
                for endpoint in [member for member in members.at(name) if isinstance(member, WorldEndpoint)]:
                    remove(endpoint)

    def add_writer(self, writer: Writer) -> None:
        """Add a publisher and match it with the subscriptions there are."""
        self.writers.add(writer)
        for reader in self.readers.at(writer.name):
            _try_match(writer, reader)  # type: ignore[arg-type]

    def add_reader(self, reader: Reader) -> None:
        """Add a subscription and match it with the publishers there are."""
        self.readers.add(reader)
        for writer in self.writers.at(reader.name):
            _try_match(writer, reader)  # type: ignore[arg-type]

    def remove_writer(self, writer: Writer) -> None:
        """Remove a publisher."""
        self.writers.remove(writer)

    def remove_reader(self, reader: Reader) -> None:
        """Remove a subscription."""
        self.readers.remove(reader)
        for writer in self.writers.at(reader.name):
            writer.unmatch(reader)  # type: ignore[attr-defined]

    def servers_of(self, client: Endpoint) -> list[Endpoint]:
        """Return the services a client's request reaches."""
        return [s for s in self.servers.at(client.name) if s.type_name == client.type_name]


def _try_match(writer: Writer, reader: Reader) -> None:
    if writer.type_name != reader.type_name:
        return
    policy = incompatible_policy(writer.qos, reader.qos)
    if policy:
        writer.mismatch(policy)
        reader.mismatch(policy)
    else:
        writer.match(reader)


_graphs: dict[int, Graph] = {}


def graph_of(domain: int) -> Graph:
    """Return the graph of a domain."""
    graph = _graphs.get(domain)
    if graph is None:
        graph = _graphs[domain] = Graph(domain)
    return graph
