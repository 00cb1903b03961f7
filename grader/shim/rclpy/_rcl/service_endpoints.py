"""Handles of service clients and servers: requests and responses, within the process and with the world."""

from __future__ import annotations

from collections import deque

from rclpy._interfaces.cdr import deserialize, serialize
from rclpy._kernel import kernel
from rclpy._link import link
from rclpy._rcl.endpoints import EndpointHandle
from rclpy._rcl.graph import WorldEndpoint

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from rclpy._rcl.node_handle import NodeHandle
    from rclpy._rcl.qos import NativeQos


class RequestId:
    """Identifies a request: its client, and its number there."""

    def __init__(self, client: ClientHandle | None, sequence: int) -> None:
        self.client = client
        self.sequence_number = sequence


class ServiceInfo:
    """Header that travels with a request and its response."""

    def __init__(self, request_id: RequestId) -> None:
        self.request_id = request_id
        self.source_timestamp = self.received_timestamp = kernel.epoch_ns + kernel.now_ns


class ClientHandle(EndpointHandle):
    """Caller of a service. `backlog`: responses received and not yet taken."""

    what = "client"

    def __init__(self, node: NodeHandle, srv: Any, name: str, qos: NativeQos) -> None:
        super().__init__(node, srv, name, qos, service=True)
        self.backlog: deque[tuple[int, bytes]] = deque(maxlen=qos.kept)
        self._sequence = 0
        node.graph.clients.add(self)
        if self.link_id:
            link.attach(self.link_id, self._from_world)

    def _from_world(self, sequence: int, _t_ns: int, data: bytes) -> None:
        self.backlog.append((sequence, data))

    def send_request(self, request: Any) -> int:
        """Send a request to every matching service and return its sequence number."""
        kernel.charge()
        self._sequence += 1
        data = serialize(request)
        for server in self.node.graph.servers_of(self):
            if isinstance(server, ServiceHandle):
                server.backlog.append((RequestId(self, self._sequence), data))
            elif isinstance(server, WorldEndpoint):
                link.request(self.link_id, self._sequence, data)
        return self._sequence

    def take_response(self, cls: type) -> tuple[ServiceInfo | None, Any]:
        """Return the oldest response with its header, or two Nones."""
        if not self.backlog:
            return None, None
        sequence, data = self.backlog.popleft()
        return ServiceInfo(RequestId(self, sequence)), deserialize(data, cls)

    def service_server_is_available(self) -> bool:
        """Whether some service of this name and type exists."""
        kernel.charge()
        self.node.require_context("failed to check service availability")
        return bool(self.node.graph.servers_of(self))

    def _dispose(self) -> None:
        self.node.graph.clients.remove(self)
        super()._dispose()


class ServiceHandle(EndpointHandle):
    """Server of a service. `backlog`: requests received and not yet taken."""

    what = "service"

    def __init__(self, node: NodeHandle, srv: Any, name: str, qos: NativeQos) -> None:
        super().__init__(node, srv, name, qos, service=True)
        self.backlog: deque[tuple[RequestId, bytes]] = deque(maxlen=qos.kept)
        node.graph.servers.add(self)
        if self.link_id:
            link.attach(self.link_id, self._from_world)

    def _from_world(self, sequence: int, _t_ns: int, data: bytes) -> None:
        self.backlog.append((RequestId(None, sequence), data))

    def service_take_request(self, cls: type) -> tuple[Any, ServiceInfo | None]:
        """Return the oldest request with its header, or two Nones."""
        if not self.backlog:
            return None, None
        request_id, data = self.backlog.popleft()
        return deserialize(data, cls), ServiceInfo(request_id)

    def service_send_response(self, response: Any, request_id: RequestId) -> None:
        """Answer one request."""
        kernel.charge()
        data = serialize(response)
        if request_id.client is None:
            link.respond(self.link_id, request_id.sequence_number, data)
        elif not request_id.client.doomed:
            request_id.client.backlog.append((request_id.sequence_number, data))

    def _dispose(self) -> None:
        self.node.graph.servers.remove(self)
        super()._dispose()
