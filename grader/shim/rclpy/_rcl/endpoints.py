"""Handles of publishers and subscriptions, and their base, which those of services and clients share."""

from __future__ import annotations

from collections import deque

from rclpy._interfaces.cdr import deserialize, serialize
from rclpy._interfaces.conversion import check, checks_unheard
from rclpy._interfaces.own import type_name
from rclpy._kernel import charge, kernel
from rclpy._link import link, publish
from rclpy._rcl.errors import PUBLISHER_CONTEXT, RCLError
from rclpy._rcl.graph import WorldEndpoint, next_gid
from rclpy._rcl.handles import Handle

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from rclpy._rcl.graph import Reader
    from rclpy._rcl.node_handle import NodeHandle
    from rclpy._rcl.qos import NativeQos

DISCOVERY_NS = 16_000_000
"""The longest that two endpoints took to find each other on one machine (recorded: 0.1 to 16 ms).

What is published sooner after its publisher was created may be lost, as the student is told."""

_BY_ITSELF = ("/rosout", "/parameter_events")  # what rclpy publishes; no student can wait before it
_PRIVATE_TYPES = ("rcl_interfaces/srv/", "rcl_interfaces/msg/ParameterEvent")
"""Types of the endpoints that every node has by itself; the episode is not told of them."""


class EndpointHandle(Handle):
    """What the four kinds of endpoints share.

    Attributes:
        name: resolved name. type_name: ROS name of the type. gid: identity in the graph.
        link_id: identity on the link, 0 if the episode was not told of it.
    """

    what = ""

    def __init__(self, node: NodeHandle, cls: Any, name: str, qos: NativeQos, *, service: bool) -> None:
        super().__init__()
        node.require()
        self.node = node
        node.require_context(f"{'failed' if service else 'Failed'} to create {self.what}")
        self.name = node.expand_and_remap(name, service=service)
        self.type_name = type_name(cls)
        self.qos = qos
        self.gid = next_gid()
        self.link_id = 0
        self.incompatible = 0
        self.last_policy = 0
        self.watchers: list[list[int]] = []
        if not self.type_name.startswith(_PRIVATE_TYPES) or self._meant_for_world():
            self.link_id = link.register(
                self.what,
                node.path,
                self.name,
                self.type_name,
                qos.reliable,
                qos.transient,
                qos.kept or 0xFFFF,
            )

    def _meant_for_world(self) -> bool:
        """Whether the assignment calls this service or listens to this topic, or the world offers the service."""
        key = {"service": "calls", "client": "services", "publisher": "listens"}.get(self.what)
        return key is not None and [self.name, self.type_name] in link.world.get(key, ())

    @property
    def owner(self) -> tuple[str, str]:
        """Name and namespace of the node."""
        return self.node.name, self.node.namespace

    def mismatch(self, policy: int) -> None:
        """Count a peer whose QoS is incompatible, and tell the event handlers."""
        self.incompatible += 1
        self.last_policy = policy
        for backlog in self.watchers:
            backlog.append(policy)
        if self.link_id and self.name in _world_topics():
            link.note("incompatible_qos", self.name)

    def get_logger_name(self) -> str:
        """Return the name of the node's logger."""
        return self.node.logger_name()

    def get_topic_name(self) -> str:
        """Return the resolved topic name."""
        return self.name

    def _dispose(self) -> None:
        if self.link_id:
            link.unregister(self.link_id)


def _world_topics() -> set[str]:
    return {name for key in ("publishes", "subscribes") for name, _ in link.world[key]}


class PublisherHandle(EndpointHandle):
    """Writer of a topic; a message is serialised once, when it is published."""

    what = "publisher"

    def __init__(self, node: NodeHandle, cls: Any, name: str, qos: NativeQos) -> None:
        super().__init__(node, cls, name, qos, service=False)
        self.readers: list[SubscriptionHandle] = []
        self._world: list[WorldEndpoint] = []
        self._kept: deque[bytes] | None = deque(maxlen=qos.kept) if qos.transient else None
        self._context = node.context
        self._carried = self._counted = False
        self._created_ns = kernel.now_ns
        self._fresh = True
        self._unchecked = checks_unheard(self.type_name)
        node.graph.add_writer(self)
        self._meet_world()

    def _meet_world(self) -> None:
        """Decide whether messages are sent to the world, or only counted there."""
        is_wanted = link.wants(self.link_id)
        self._carried = is_wanted and (bool(self._world) or self.name == "/rosout")
        self._counted = bool(self.link_id) and not is_wanted

    @property
    def is_heard(self) -> bool:
        """Whether a message would reach anybody at present."""
        return bool(self.readers) or self._carried

    def match(self, reader: Reader) -> None:
        """Send to `reader` from now on; at once the messages kept for late listeners, if it wants those."""
        if isinstance(reader, SubscriptionHandle):
            self.readers.append(reader)
            if self._kept and reader.qos.transient:
                for data in self._kept:
                    reader.receive(data)
        elif isinstance(reader, WorldEndpoint):
            self._world.append(reader)
            self._meet_world()

    def unmatch(self, reader: Reader) -> None:
        """Stop sending to `reader`."""
        if reader in self.readers:
            self.readers.remove(reader)
        elif reader in self._world:
            self._world.remove(reader)
            self._meet_world()

    def publish(self, message: Any) -> None:
        """Publish a message of the publisher's class; later changes of it have no effect."""
        charge()
        if not self._context.valid:
            self._require_context("Failed to publish")
        if self._carried and not (self.readers or self._fresh or self._kept is not None):
            # a shortcut for what `send` would do with every command but the first
            publish(self.link_id, serialize(message))
        elif self.readers or self._carried or self._kept is not None:
            self.send(serialize(message))
        else:
            if self._unchecked:
                self._unchecked -= 1
                check(message)
            if self._counted:
                link.publish(self.link_id, b"")

    def publish_raw(self, data: bytes) -> None:
        """Publish a serialised message as it is."""
        kernel.charge()
        self._require_context("Failed to publish")
        self.send(data)

    def _require_context(self, failure: str) -> None:
        if not self._context.valid:
            raise RCLError(f"{failure}: {PUBLISHER_CONTEXT}")

    def context_valid(self) -> bool:
        """Whether publishing is possible."""
        return self._context.valid

    def send(self, data: bytes) -> None:
        """Deliver a serialised message. This takes no virtual time."""
        if self._kept is not None:
            self._kept.append(data)
        for reader in self.readers:
            reader.receive(data)
        if self._carried:
            if self._fresh:
                self._fresh = False
                if kernel.now_ns - self._created_ns < DISCOVERY_NS and self.name not in _BY_ITSELF:
                    link.note("discovery", self.name)
            link.publish(self.link_id, data)
        elif self._counted:
            link.publish(self.link_id, b"")

    def get_subscription_count(self) -> int:
        """Return how many subscriptions are matched."""
        self._require_context("failed to get subscription count")
        kernel.charge()
        self.is_looked_for()
        return len(self.readers) + len(self._world)

    def is_looked_for(self) -> None:
        """Note that the script asks who listens: it waits for the first listener, and then loses nothing."""
        self._fresh = False

    def assert_liveliness(self) -> None:
        """Do nothing, as every publisher counts as alive."""
        self._require_context("Failed to assert liveliness on the Publisher")

    def wait_for_all_acked(self, timeout: Any) -> bool:
        """Everything published has arrived already."""
        self._require_context("Failed to wait for all acknowledgements")
        return True

    def _dispose(self) -> None:
        self.node.graph.remove_writer(self)
        super()._dispose()


class SubscriptionHandle(EndpointHandle):
    """Reader of a topic.

    Attributes:
        backlog: samples received and not yet taken; the oldest is dropped when there are too many.
    """

    what = "subscription"

    def __init__(self, node: NodeHandle, cls: Any, name: str, qos: NativeQos) -> None:
        super().__init__(node, cls, name, qos, service=False)
        self.backlog: deque[tuple[bytes, int]] = deque(maxlen=qos.kept)
        node.graph.add_reader(self)
        if self.link_id:
            link.attach(self.link_id, self._from_world)

    def receive(self, data: bytes) -> None:
        """Queue one serialised message."""
        self.backlog.append((data, kernel.now_ns))

    def _from_world(self, _sequence: int, t_ns: int, data: bytes) -> None:
        if not self.incompatible:
            self.backlog.append((data, t_ns))

    def take_message(self, cls: type, raw: bool) -> tuple[Any, dict[str, int]] | None:
        """Return the oldest message (bytes when `raw`) with its times; None when there is none."""
        if not self.backlog:
            return None
        stamp_ns = kernel.epoch_ns + self.backlog[0][1]
        times = {"source_timestamp": stamp_ns, "received_timestamp": stamp_ns}
        return self.take(cls, raw), times

    def take(self, cls: type, raw: bool) -> Any:
        """Return the oldest message (bytes when `raw`); None when there is none."""
        if not self.backlog:
            return None
        data = self.backlog.popleft()[0]
        return data if raw else deserialize(data, cls)

    def _dispose(self) -> None:
        self.node.graph.remove_reader(self)
        super()._dispose()
