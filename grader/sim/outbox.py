"""What the world has to say to the script: queued events and who listens to which topic."""

from collections import deque
from typing import Final

from grader.sim.frames import MESSAGE_EVENT, RESPONSE_EVENT, Event, Request

MAX_EVENTS: Final = 256  # in one answer; the rest is due in the next one
MAX_QUEUED: Final = 2_000


class Outbox:
    """Events for the jail in order of time, and the subscriptions of the script."""

    def __init__(self) -> None:
        self._queue: deque[Event] = deque()
        self._listeners: dict[str, list[int]] = {}

    def __bool__(self) -> bool:
        return bool(self._queue)

    def subscribe(self, topic: str, identity: int) -> None:
        """Let subscription `identity` hear `topic`."""
        self._listeners.setdefault(topic, []).append(identity)

    def unsubscribe(self, identity: int) -> None:
        """Forget a subscription; one that is not known is no matter."""
        for topic, listeners in tuple(self._listeners.items()):
            if identity in listeners:
                listeners.remove(identity)
                if not listeners:
                    del self._listeners[topic]

    def has_listeners(self, topic: str) -> bool:
        """Return whether a message on `topic` would reach anyone."""
        return topic in self._listeners

    def publish(self, topic: str, t_ns: int, payload: bytes) -> None:
        """Queue one message for everyone who listens."""
        for identity in self._listeners.get(topic, ()):
            self.add(Event(MESSAGE_EVENT, identity, 0, t_ns, payload))

    def reply(self, request: Request, t_ns: int, payload: bytes) -> None:
        """Queue the answer to `request`."""
        self.add(Event(RESPONSE_EVENT, request.id, request.sequence, t_ns, payload))

    def add(self, event: Event) -> None:
        """Queue `event`, or drop it when the queue is full: the script never fetches what is due."""
        if len(self._queue) < MAX_QUEUED:
            self._queue.append(event)

    def take(self) -> tuple[int, list[Event]]:
        """Return the first queued instant and what is queued for it, at most `MAX_EVENTS`."""
        now_ns = self._queue[0].t_ns
        events: list[Event] = []
        while self._queue and self._queue[0].t_ns <= now_ns and len(events) < MAX_EVENTS:
            events.append(self._queue.popleft())
        return now_ns, events
