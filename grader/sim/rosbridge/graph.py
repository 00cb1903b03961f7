"""The ROS graph that a bridge serves: that of a live car, or that of an exercise's script and car."""

import struct
from collections.abc import Mapping, Sequence
from typing import Final, Protocol

from grader.sim.frames import Request
from grader.sim.interfaces import Types

_TWIST: Final = struct.Struct("<4s6d")


def twist_of(payload: bytes) -> tuple[float, float, float]:
    """Return the forward and sideways speed and the turn of a geometry_msgs/msg/Twist."""
    _, x, y, _, _, _, turn = _TWIST.unpack(payload)
    return x, y, turn


class RosGraph(Protocol):
    """Topics, services and nodes besides what clients bring.

    Messages and answers for the bridge come back as events, under the ids that it gave.

    Attributes:
        types: of messages and services.
        epoch_ns: wall clock at the instant 0.
    """

    types: Types
    epoch_ns: int

    @property
    def topics(self) -> Mapping[str, str]:
        """Types by topic."""

    @property
    def services(self) -> Mapping[str, str]:
        """Types by service, those of actions included."""

    @property
    def nodes(self) -> Sequence[str]:
        """Fully qualified names."""

    def publish(self, topic: str, t_ns: int, payload: bytes) -> None:
        """Publish CDR of the topic's type on one of `topics`."""

    def listen(self, topic: str, identity: int, t_ns: int) -> None:
        """Subscribe `identity` to one of `topics`."""

    def unlisten(self, identity: int) -> None:
        """End the subscription."""

    def request(self, service: str, request: Request) -> bool:
        """Send a request to one of `services`; false when too many wait there."""
