"""Which endpoints are matched, for matched events and for the counts of publishers that subscriptions return."""

from __future__ import annotations

from rclpy._jazzy.overlay import extends, replace
from rclpy._rcl import graph
from rclpy._rcl.qos import incompatible_policy

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_humble_try_match = graph._try_match
_humble_remove_writer = graph.Graph.remove_writer
_humble_remove_reader = graph.Graph.remove_reader


class Matches:
    """The partners of one endpoint.

    Attributes:
        total: how many there have ever been. now: how many there are.
        watchers: lists that get an entry at each change.
    """

    def __init__(self) -> None:
        self.total = 0
        self.now = 0
        self.watchers: list[list[int]] = []

    def change(self, by: int) -> None:
        """Note that a partner came (1) or went (-1)."""
        self.total += max(by, 0)
        self.now += by
        for backlog in self.watchers:
            backlog.append(by)


def matches_of(endpoint: Any) -> Matches:
    """Return the partners of an endpoint."""
    matches: Matches | None = getattr(endpoint, "_matches", None)
    if matches is None:
        matches = endpoint._matches = Matches()
    return matches


def _fits(writer: Any, reader: Any) -> bool:
    return writer.type_name == reader.type_name and not incompatible_policy(writer.qos, reader.qos)


def _try_match(writer: Any, reader: Any) -> None:
    _humble_try_match(writer, reader)
    if _fits(writer, reader):
        matches_of(writer).change(1)
        matches_of(reader).change(1)


@extends(graph.Graph)
class Graph(graph.Graph):
    """Everything of one DDS domain."""

    def remove_writer(self, writer: Any) -> None:
        """Remove a publisher."""
        _humble_remove_writer(self, writer)
        for reader in self.readers.at(writer.name):
            if _fits(writer, reader):
                matches_of(reader).change(-1)

    def remove_reader(self, reader: Any) -> None:
        """Remove a subscription."""
        _humble_remove_reader(self, reader)
        for writer in self.writers.at(reader.name):
            if _fits(writer, reader):
                matches_of(writer).change(-1)


replace(graph, _try_match=_try_match)
