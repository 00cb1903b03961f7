"""The script's entities on the ROS graph, checked and bounded."""

from dataclasses import dataclass
from typing import Final

from grader.contracts.errors import ProtocolError
from grader.contracts.outcome import Endpoint
from grader.sim.frames import (
    CLIENT,
    NODE,
    PUBLISHER,
    SERVICE,
    SUBSCRIPTION,
    Entity,
)

# Both as in the shim (`rclpy/_link.py`), which cannot be imported here.
MAX_ENTITIES: Final = 8_192
COUNT_EVERY: Final = 100  # messages for which one PUBLISH is sent on a topic that the world does not hear

_KINDS: Final = {
    NODE: "node",
    PUBLISHER: "publisher",
    SUBSCRIPTION: "subscription",
    SERVICE: "service",
    CLIENT: "client",
}
_OF_EVERY_NODE: Final = {
    "/rosout": "rcl_interfaces/msg/Log",
    "/parameter_events": "rcl_interfaces/msg/ParameterEvent",
}


@dataclass(slots=True)
class _Entry:
    entity: Entity
    alive: bool = True
    count: int = 0


class ScriptGraph:
    """Nodes, publishers, subscriptions, services and clients of the script, by the jail's ids."""

    def __init__(self) -> None:
        self._entries: dict[int, _Entry] = {}
        # Ids of the living services by name and type: each ADVANCE looks for those that the assignment calls.
        self._services: dict[tuple[str, str], list[int]] = {}

    def add(self, entity: Entity) -> None:
        """Take a new entity. Raises ProtocolError: its id was used before, or there are too many."""
        if entity.id in self._entries:
            raise ProtocolError(f"ENTITY.id {entity.id} is used twice")
        if len(self._entries) >= MAX_ENTITIES:
            raise ProtocolError(f"more than {MAX_ENTITIES} entities")
        self._entries[entity.id] = _Entry(entity)
        if entity.what == SERVICE:
            self._services.setdefault((entity.name, entity.type), []).append(entity.id)

    def remove(self, identity: int) -> Entity:
        """Mark an entity as gone; `nodes` and `endpoints` still list it.

        Raises ProtocolError: there is no such entity, or it is gone already.
        """
        entry = self._entries.get(identity)
        if entry is None or not entry.alive:
            raise ProtocolError(f"GONE.id {identity} does not exist")
        entry.alive = False
        if entry.entity.what == SERVICE:
            self._services[entry.entity.name, entry.entity.type].remove(identity)
        return entry.entity

    def get(self, identity: int, what: int, uses: int = 1) -> Entity:
        """Return the living entity of that id and kind, and count its uses.

        Raises ProtocolError: there is none.
        """
        entry = self._entries.get(identity)
        if entry is None or not entry.alive or entry.entity.what != what:
            raise ProtocolError(f"id {identity} is not a {_KINDS[what]}")
        entry.count += uses
        return entry.entity

    def on(self, topics: frozenset[str]) -> list[Entity]:
        """Return the living publishers and subscriptions on these topics."""
        living = (entry.entity for entry in self._entries.values() if entry.alive)
        return [
            entity for entity in living if entity.what in (PUBLISHER, SUBSCRIPTION) and entity.name in topics
        ]

    def service(self, name: str, kind: str) -> int | None:
        """Return the id of the script's living service of that name and type."""
        return next(iter(self._services.get((name, kind), ())), None)

    def services(self) -> dict[str, str]:
        """Return the types of the script's living services by name."""
        return {name: kind for (name, kind), living in self._services.items() if living}

    def nodes(self) -> tuple[str, ...]:
        """Return the nodes' fully qualified names in order of creation."""
        return tuple(entry.entity.node for entry in self._entries.values() if entry.entity.what == NODE)

    def endpoints(self, carried: frozenset[str]) -> tuple[Endpoint, ...]:
        """Return all other entities in order of creation, except the publishers that every node has.

        On topics in `carried` each message was counted. On others each count after the first stands for
        `COUNT_EVERY` messages.
        """
        endpoints = []
        for entry in self._entries.values():
            entity = entry.entity
            if entity.what == NODE or _OF_EVERY_NODE.get(entity.name) == entity.type:
                continue
            count = entry.count if entity.what in (PUBLISHER, CLIENT) else 0
            if entity.what == PUBLISHER and count and entity.name not in carried:
                count = 1 + COUNT_EVERY * (count - 1)
            kind = _KINDS[entity.what]
            endpoints.append(
                Endpoint(kind=kind, node=entity.node, name=entity.name, type=entity.type, count=count)
            )
        return tuple(endpoints)
