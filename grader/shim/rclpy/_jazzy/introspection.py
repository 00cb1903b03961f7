"""Events of a service's traffic on ``<service>/_service_event``: what rcl's service_introspection.c does."""

from __future__ import annotations

from rclpy._interfaces.messages import interface_class
from rclpy._rcl.endpoints import PublisherHandle

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

OFF, METADATA, CONTENTS = range(3)
REQUEST_SENT, REQUEST_RECEIVED, RESPONSE_SENT, RESPONSE_RECEIVED = range(4)

_GID_BYTES = 16
_SUFFIX = "/_service_event"


class Introspection:
    """Publishes what a client or service (`end`) sends and takes."""

    def __init__(self, end: Any, clock: Any, qos: Any, state: Any) -> None:
        self._clock = clock
        self._contents = int(state) == CONTENTS
        service: Any = interface_class(end.type_name)
        self._event = service.Event
        self._publisher = PublisherHandle(end.node, self._event, end.name + _SUFFIX, qos)

    def tell(self, what: int, client: Any, sequence: int, **content: Any) -> None:
        """Publish one event; `content` is the request or response."""
        seconds, nanoseconds = divmod(self._clock.read_ns(), 1_000_000_000)
        event = self._event()
        event.info.event_type = what
        event.info.stamp.sec, event.info.stamp.nanosec = seconds, nanoseconds
        gid = 0 if client is None else client.gid
        event.info.client_gid = list(gid.to_bytes(_GID_BYTES, "big"))
        event.info.sequence_number = sequence
        if self._contents:
            for name, message in content.items():
                setattr(event, name, [message])
        self._publisher.publish(event)

    def end(self) -> None:
        """Publish no more."""
        self._publisher.destroy_when_not_in_use()
