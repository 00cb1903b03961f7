"""Events of the world that wait for the script, and the script's subscriptions to the world's topics."""

from collections import deque
from collections.abc import Iterable
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
        """Forget a subscription, if it is known."""
        for topic, listeners in tuple(self._listeners.items()):
            if identity in listeners:
                listeners.remove(identity)
                if not listeners:
                    del self._listeners[topic]

    def has_listeners(self, topic: str) -> bool:
        """Return whether a message on `topic` would reach anyone."""
        return topic in self._listeners

    def has_listener_of(self, topics: Iterable[str]) -> bool:
        """Return whether a message on one of `topics` would reach anyone."""
        return not self._listeners.keys().isdisjoint(topics)

    def publish(self, topic: str, t_ns: int, payload: bytes) -> None:
        """Queue one message for everyone who listens."""
        for identity in self._listeners.get(topic, ()):
            self.add(Event(MESSAGE_EVENT, identity, 0, t_ns, payload))

    def reply(self, request: Request, t_ns: int, payload: bytes) -> None:
        """Queue the answer to `request`."""
        self.add(Event(RESPONSE_EVENT, request.id, request.sequence, t_ns, payload))

    def add(self, event: Event) -> None:
        """Queue `event`. Drop it if the queue is full: then the script never fetches what is due."""
        if len(self._queue) < MAX_QUEUED:
            self._queue.append(event)

    @property
    def full(self) -> bool:
        """Whether the queued events fill one answer."""
        return len(self._queue) >= MAX_EVENTS

    @property
    def first_ns(self) -> int | None:
        """Instant of the first queued event, None when nothing is queued."""
        return self._queue[0].t_ns if self._queue else None

    def take(self, together_ns: int = 0) -> tuple[int, list[Event]]:
        """Return an instant and the events queued up to it: the first event's, or `together_ns` if that is later.

        These are at most `MAX_EVENTS`. The instant is that of the last event if some are left for the next answer.
        """
        now_ns = max(self._queue[0].t_ns, together_ns)
        events: list[Event] = []
        while self._queue and self._queue[0].t_ns <= now_ns:
            if len(events) == MAX_EVENTS:
                return events[-1].t_ns, events
            events.append(self._queue.popleft())
        return now_ns, events
