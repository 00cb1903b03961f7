"""A live car and its bridge, driven together along a clock that the caller turns."""

from grader.sim.driving import Car
from grader.sim.rosbridge.bridge import Bridge, Out
from grader.sim.rosbridge.live_world import LiveWorld


class LiveSession:
    """What the clients of one car are connected to. Instants are nanoseconds since its start; none decreases."""

    def __init__(self, car: Car, epoch_ns: int) -> None:
        self._world = LiveWorld(car, epoch_ns)
        self._bridge = Bridge(self._world)

    def open(self, client: int) -> None:
        """Take a client under a number of its own."""
        self._bridge.open(client)

    def close(self, client: int) -> None:
        """Forget a client."""
        self._bridge.close(client)

    def receive(self, client: int, text: str | bytes, t_ns: int) -> None:
        """Act on a frame of a client."""
        self.advance(t_ns)
        self._bridge.receive(client, text, t_ns)

    def advance(self, t_ns: int) -> None:
        """Run until `t_ns`, update by update: a client may answer what it gets with a request."""
        while (due_ns := self._world.next_due()) is not None and due_ns <= t_ns:
            self._run(due_ns)
        self._run(t_ns)

    def next_due(self) -> int | None:
        """Return the next instant at which something may have to be sent, None when never."""
        due = [due_ns for due_ns in (self._world.next_due(), self._bridge.next_due()) if due_ns is not None]
        return min(due, default=None)

    def take(self) -> list[Out]:
        """Return what is to be sent."""
        return self._bridge.take()

    def _run(self, t_ns: int) -> None:
        for event in self._world.advance(t_ns):
            self._bridge.take_event(event)
        self._bridge.tick(t_ns)
