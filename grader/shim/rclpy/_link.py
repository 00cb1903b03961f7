"""Client end of the channel: everything that leaves the student's process passes here.

Without a channel (`connected` is False: the script runs without a simulator) the world is empty, nothing is
sent, and the other calls behave as if nobody listened.
"""

from __future__ import annotations

import os

from rclpy import _wire
from rclpy._kernel import Kernel, kernel
from rclpy._reckoning import Reckoning

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    Deliver = Callable[[int, int, bytes], None]


FLUSH_BYTES = 16_384
RECEIVE_BYTES = 65_536
MAX_ENTITIES = 8_192
"""All that a script ever creates, destroyed or not: a minute of `wait_for_message` on the pose creates 3,750."""
PROMPT_FLUSHES = 200
"""Frames with news (an entity, a command unlike the one before, a log record) that are sent without delay.

So it is known what a script did even if it is killed: only repetitions wait in the buffer. The bound keeps floods
cheap, and scripts that steer by each pose. This depends on the script alone, so it is the same in each run."""

NEWS_WAIT_NS = 250_000_000
REPETITIONS_WAIT_NS = 1_000_000_000
"""Virtual time since the last flush after which the next frame is sent with what is buffered. Each flush costs
both processes some 15 us."""

MOST_REPETITIONS = 1_000
"""Most repetitions of a message in one frame."""

COUNT_EVERY = 100
"""For a topic that the world does not listen to, one empty PUBLISH is sent for so many messages."""

_COMMANDS = "geometry_msgs/msg/Twist"
_WHAT = {
    "node": _wire.NODE,
    "publisher": _wire.PUBLISHER,
    "subscription": _wire.SUBSCRIPTION,
    "service": _wire.SERVICE,
    "client": _wire.CLIENT,
}

_end_process = os._exit
_read, _write = os.read, os.write


class Descriptor:
    """The channel as a plain descriptor: `socket` and its imports would cost each run some milliseconds.

    When the episode has closed its end, nobody wants to know more: the process ends.
    """

    def __init__(self, number: int) -> None:
        self._number = number

    def sendall(self, data: bytes, /) -> None:
        view = memoryview(data)
        try:
            while view:
                view = view[_write(self._number, view) :]
        except OSError:
            _end_process(0)

    def recv(self, size: int, /) -> bytes:
        data = _read(self._number, size)
        if not data:
            _end_process(0)
        return data


class Link:
    """Client end of the channel; use the module's one object `link`.

    Attributes:
        world: START's ``world``: what the world publishes, subscribes to, offers and which nodes it has.
        coupled: whether time may only advance by ADVANCE.
        quiet_ns: nothing can become due before this instant, unless the script subscribes, offers or requests
            something.
        connected: whether there is a world at all.
        reckons: whether a pose is due at `quiet_ns`, and nobody has to be asked for it.
        on_change: called with what the world has got, or lost: the names as in `world`, and ``gone``.
        before_exit: called before EXIT is sent.
    """

    def __init__(self, clock: Kernel) -> None:
        self.world: dict[str, Any] = {"publishes": [], "subscribes": [], "services": [], "nodes": []}
        self.coupled = False
        self.quiet_ns = 0
        self.connected = False
        self.reckons = False
        self.on_change: Callable[[dict[str, Any]], None] = lambda change: None
        self.before_exit: Callable[[], None] = lambda: None
        self._kernel = clock
        self._channel: Descriptor | None = None
        self._buffer = bytearray()
        self._received = b""
        self._flushed_ns = -REPETITIONS_WAIT_NS
        self._prompt = PROMPT_FLUSHES
        self._last: dict[int, bytes] = {}
        self._repeated = 0  # the publisher whose message was the last frame; 0: that was something else
        self._repetitions_ns: list[int] = []  # when that message was published again
        self._reckoning: Reckoning | None = None
        self._reckoned: list[tuple[int, bytes]] = []  # poses that are due, with their times
        self._listeners: tuple[int, ...] = ()  # the subscriptions they are for
        self._next_id = 1
        self._heard: set[int] = set()  # publishers that the world listens to
        self._answered: set[int] = (
            set()
        )  # publishers whose messages are no commands: who reads them may ask for something
        self._counts: dict[int, int] = {}
        self._noted: set[str] = set()
        self._deliver: dict[int, Deliver] = {}
        self._listening: set[int] = set()
        self._services: set[int] = set()
        self._clients: set[int] = set()
        self._requests: set[tuple[int, int]] = set()
        self._names: dict[str, set[tuple[str, str]]] = {}
        self._living: dict[int, tuple[str, tuple[str, str]]] = {}

    def connect_world(self, world: dict[str, Any]) -> None:
        """Take `world`, what START says of the simulator, as the other end of the channel."""
        self.connected = True
        self.world = {**self.world, **world}
        self._names = {
            key: {(name, kind) for name, kind in self.world[key]}
            for key in ("publishes", "subscribes", "services")
        }
        self._names["subscribes"] |= {(name, kind) for name, kind in self.world.get("listens", ())}
        self._names["calls"] = {(name, kind) for name, kind in self.world.get("calls", ())}
        self._kernel.connect(self)

    def register(
        self,
        what: str,
        node: str,
        name: str = "",
        type: str = "",
        reliable: bool = True,
        transient: bool = False,
        depth: int = 10,
    ) -> int:
        """Announce an entity and return its id.

        Args:
            what: ``node``, ``publisher``, ``subscription``, ``service`` or ``client``.
            node: fully qualified name of the node it belongs to (or that it is).
            name: resolved topic or service; empty for a node.
            type: ``geometry_msgs/msg/Twist``; empty for a node.
            reliable: RELIABLE, otherwise BEST_EFFORT.
            transient: TRANSIENT_LOCAL, otherwise VOLATILE.
            depth: of the history.

        Raises:
            RuntimeError: more than `MAX_ENTITIES` were created.
        """
        ident = self._next_id
        if ident > MAX_ENTITIES:
            raise RuntimeError(
                f"more than {MAX_ENTITIES} nodes, publishers, subscriptions, services and clients"
            )
        self._next_id += 1
        self._ask_again()
        quality = (1 if reliable else 2, 1 if transient else 2, depth)
        self._tell(_wire.entity(ident, _WHAT[what], self._kernel.now_ns, (node, name, type), quality))
        self._living[ident] = (what, (name, type))
        self._sort_in(ident, what, (name, type))
        self._expect()
        return ident

    def _sort_in(self, ident: int, what: str, topic: tuple[str, str]) -> None:
        """Remember whether the world has to do with the entity, by its topic or service and type."""
        if what == "publisher" and (topic[0] == "/rosout" or topic in self._names.get("subscribes", ())):
            self._heard.add(ident)
            if topic[0] != "/rosout" and topic[1] != _COMMANDS:
                self._answered.add(ident)
        elif what == "subscription" and topic in self._names.get("publishes", ()):
            self._listening.add(ident)
        elif what == "service" and topic in self._names.get("calls", ()):
            self._services.add(ident)
        elif what == "client" and topic in self._names.get("services", ()):
            self._clients.add(ident)

    def _sort_out(self, ident: int) -> None:
        for members in (self._heard, self._answered, self._listening, self._services, self._clients):
            members.discard(ident)

    def _change_world(self, text: bytes) -> None:
        """Take what the world has got or lost: a turtle was spawned or killed."""
        import json

        change: dict[str, Any] = json.loads(text)
        touched = set()
        for key in ("publishes", "subscribes", "services"):
            names = {(name, kind) for name, kind in change[key]}
            kept = [[name, kind] for name, kind in self.world[key] if (name, kind) not in names]
            self.world[key] = kept if change["gone"] else kept + change[key]
            self._names[key] = self._names[key] - names if change["gone"] else self._names[key] | names
            touched |= names
        for ident, (what, topic) in self._living.items():
            if topic in touched:
                self._sort_out(ident)
                self._sort_in(ident, what, topic)
        self.on_change(change)
        self._expect()

    def unregister(self, ident: int) -> None:
        """Announce that an entity is gone."""
        self._ask_again()
        self._tell(_wire.gone(ident, self._kernel.now_ns))
        self._living.pop(ident, None)
        self._sort_out(ident)
        self._requests = {request for request in self._requests if request[0] != ident}
        self._deliver.pop(ident, None)
        self._couple()

    def wants(self, ident: int) -> bool:
        """Return whether the world listens to this publisher's topic with this type."""
        return ident in self._heard

    def publish(self, ident: int, cdr: bytes) -> None:
        """Send one message at the current time, or only count it when the world does not listen."""
        if ident not in self._heard:
            count = self._counts.get(ident, 0)
            self._counts[ident] = count + 1
            if count % COUNT_EVERY:
                return
            cdr = b""
        now_ns = self._kernel.now_ns
        reckoning = self._reckoning
        if reckoning is not None and ident in reckoning.publishers:
            if reckoning.next_ns <= now_ns:
                self._reckon(now_ns)
            reckoning.command(cdr)
        if self._last.get(ident) != cdr:
            self._last[ident] = cdr
            self._tell(_wire.publish(ident, now_ns, cdr))
        elif self._repeated != ident:
            self._send(_wire.publish(ident, now_ns, cdr))
        else:
            self._repeat(now_ns)
        self._repeated = ident
        if ident in self._answered:
            self._expect()  # who reads it may ask for something then

    def _repeat(self, now_ns: int) -> None:
        """Note the time at which the message of the last frame was published again; `flush` sends these times."""
        if self._channel is None:
            return
        self._repetitions_ns.append(now_ns)
        if now_ns - self._flushed_ns >= REPETITIONS_WAIT_NS or len(self._repetitions_ns) == MOST_REPETITIONS:
            self.flush()

    def request(self, ident: int, sequence: int, cdr: bytes) -> None:
        """Send a request of client `ident` to a service of the world."""
        self._ask_again()
        self._tell(_wire.service(_wire.REQUEST, ident, sequence, self._kernel.now_ns, cdr))
        if ident in self._clients:
            self._requests.add((ident, sequence))
            self._expect()

    def respond(self, ident: int, sequence: int, cdr: bytes) -> None:
        """Answer a request of the world to service `ident`."""
        self._ask_again()
        self._tell(_wire.service(_wire.RESPONSE, ident, sequence, self._kernel.now_ns, cdr))
        self._expect()  # who has got its answer may ask for something else

    def attach(self, ident: int, deliver: Deliver) -> None:
        """Have `deliver(sequence, t_ns, cdr)` called, from the kernel, for each event for `ident`."""
        self._deliver[ident] = deliver

    def calls(self, recorded: bytes) -> None:
        """Send calls of PyBullet that the script has made up to now."""
        self._send(_wire.calls(min(self._kernel.now_ns, self._kernel.horizon_ns), recorded))

    def note(self, code: str, text: str = "") -> None:
        """Send the episode a note for the report."""
        self._tell(_wire.note(code, text))

    def note_once(self, code: str, text: str = "") -> bool:
        """Send a note, unless one with this code was sent before: a loop must not fill the channel.

        Returns:
            Whether it was sent.
        """
        if code in self._noted:
            return False
        self._noted.add(code)
        self.note(code, text)
        return True

    def advance(self, target_ns: int, together_ns: int) -> int:
        """Run the world to the first event up to `target_ns`; deliver it; return the instant reached.

        All events up to `together_ns` are delivered together.
        """
        if self._reckoning is not None or self._reckoned:
            return self._advance_alone(target_ns, together_ns)
        self._send(_wire.advance(target_ns, together_ns))
        self.flush()
        now_ns, self.quiet_ns, events, car = _wire.read_events(self._receive())
        if car is not None:
            self._reckoning = Reckoning(*car)
            self.reckons = True
            self._listeners = self._reckoning.subscriptions
        for event in events:
            if event.what == _wire.TO_GRAPH:
                self._change_world(event.cdr)
                continue
            if event.what == _wire.TO_CLIENT:
                self._requests.discard((event.id, event.sequence))
                self._couple()
            deliver = self._deliver.get(event.id)
            if deliver is not None:
                deliver(event.sequence, event.t_ns, event.cdr)
        return now_ns

    def deliver_pose(self) -> tuple[int, ...]:
        """Deliver the next pose, which is due at `quiet_ns`; only while the link `reckons`.

        Returns:
            The subscriptions that got it.
        """
        reckoning = self._reckoning
        assert reckoning is not None
        if self._reckoned:
            t_ns, cdr = self._reckoned.pop(0)
        else:
            t_ns, cdr = reckoning.next_ns, reckoning.update()
        self.quiet_ns = self._reckoned[0][0] if self._reckoned else reckoning.next_ns
        for ident in self._listeners:
            self._deliver[ident](0, t_ns, cdr)
        return self._listeners

    def _advance_alone(self, target_ns: int, together_ns: int) -> int:
        """Do what ADVANCE asks of the episode, while nothing but poses can become due."""
        due, target_ns = self._due(target_ns, together_ns, min(target_ns, self._kernel.horizon_ns))
        for t_ns, cdr in due:
            for ident in self._listeners:
                deliver = self._deliver.get(ident)
                if deliver is not None:
                    deliver(0, t_ns, cdr)
        return target_ns

    def _due(self, target_ns: int, together_ns: int, limit_ns: int) -> tuple[list[tuple[int, bytes]], int]:
        """Return the poses that come next, and the instant reached."""
        together_ns = min(together_ns, limit_ns)
        reckoned, reckoning = self._reckoned, self._reckoning
        if reckoning is not None:
            if reckoning.next_ns <= together_ns:
                self._reckon(together_ns)
            if not reckoned and reckoning.next_ns <= limit_ns:
                reckoned.append((reckoning.next_ns, reckoning.update()))
        if reckoned:
            target_ns = min(max(reckoned[0][0], together_ns), target_ns)
        due = [pose for pose in reckoned if pose[0] <= target_ns]
        del reckoned[: len(due)]
        next_ns = 0 if reckoning is None else reckoning.next_ns
        self.quiet_ns = reckoned[0][0] if reckoned else next_ns
        return due, target_ns

    def _reckon(self, until_ns: int) -> None:
        """Run the car's updates up to `until_ns`."""
        reckoning, reckoned = self._reckoning, self._reckoned
        assert reckoning is not None
        while reckoning.next_ns <= until_ns:
            t_ns = reckoning.next_ns
            reckoned.append((t_ns, reckoning.update()))

    def _ask_again(self) -> None:
        """Ask the episode from now on: the script is about to do more than drive."""
        if self._reckoning is not None:
            self._reckon(self._kernel.now_ns)
            self._reckoning = None
            self.reckons = False

    def exit(self, end: _wire.Exit) -> None:
        """Send EXIT, the last frame of a run."""
        self.before_exit()
        self._send(end.frame())
        self.flush()
        self._channel = None

    def flush(self) -> None:
        """Send what is buffered."""
        if self._repetitions_ns:
            self._put_repetitions()
        if self._channel is not None and self._buffer:
            data = bytes(self._buffer)
            self._buffer.clear()
            self._flushed_ns = self._kernel.now_ns
            self._channel.sendall(data)

    def send_frame(self, body: bytes) -> None:
        """Send one frame of a kind that only its sender knows, at once."""
        assert self._channel is not None
        self._channel.sendall(len(body).to_bytes(4, "little") + body)

    def receive_frame(self) -> bytes:
        """Return the body of the next frame that is no answer."""
        return self._receive()

    def receive_start(self, channel: Descriptor) -> tuple[str, bytes]:
        """Read START from `channel`: its JSON text and the source."""
        self._channel = channel
        return _wire.read_start(self._receive())

    def _expect(self) -> None:
        """What the world was asked for may become due at any time: it has to be asked when."""
        self.quiet_ns = 0
        self._kernel.replan()
        self._couple()

    def _couple(self) -> None:
        coupled = bool(self._listening or self._services or self._requests) and self.connected
        if coupled != self.coupled:
            self.coupled = coupled
            self._kernel.replan()

    def _tell(self, frame: bytes) -> None:
        """Send news together with what is buffered: at once, or soon where there is much."""
        prompt = self._prompt > 0
        self._send(frame, 0 if prompt else NEWS_WAIT_NS)
        if prompt:
            self._prompt -= 1

    def _send(self, frame: bytes, wait_ns: int = REPETITIONS_WAIT_NS) -> None:
        if self._channel is None:
            return
        if self._repetitions_ns:
            self._put_repetitions()
        self._repeated = 0
        self._buffer += frame
        if len(self._buffer) >= FLUSH_BYTES or self._kernel.now_ns - self._flushed_ns >= wait_ns:
            self.flush()

    def _put_repetitions(self) -> None:
        self._buffer += _wire.repeat(self._repeated, self._repetitions_ns)
        self._repetitions_ns.clear()

    def _receive(self) -> bytes:
        """Return the body of the next frame."""
        assert self._channel is not None
        data = self._received
        while len(data) < 4:
            data += self._channel.recv(RECEIVE_BYTES)
        end = 4 + int.from_bytes(data[:4], "little")
        while len(data) < end:
            data += self._channel.recv(RECEIVE_BYTES)
        self._received = data[end:]
        return data[4:end]


link = Link(kernel)

publish = link.publish
"""See `_kernel.charge`."""
