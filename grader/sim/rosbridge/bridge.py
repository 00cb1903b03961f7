"""The bridge between a ROS graph and any number of JSON clients: it takes their frames and returns others.

It has no sockets and no clock. Its caller passes frames and events with the instants at which they came, and sends
what it returns. Everything that clients can make it keep is bounded, each kind by a limit of its own.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import count
from typing import Any, Final, NamedTuple

from grader.contracts.errors import ProtocolError
from grader.sim.cdr import Values, decode
from grader.sim.frames import APART, MESSAGE_EVENT, Event, Request
from grader.sim.interfaces import Types
from grader.sim.rosbridge import frames, rosapi
from grader.sim.rosbridge.actions import Goals, Reply
from grader.sim.rosbridge.graph import RosGraph
from grader.sim.rosbridge.parameters import RosapiParameters
from grader.sim.rosbridge.subscriptions import Subscription
from grader.sim.rosbridge.values import full_type, in_order, message, to_json

FIRST_ID: Final = APART
"""The bridge's ids in the graph begin here."""

BAD_CLIENT: Final = 1008
"""Status of a websocket that is closed because its client goes on to send what cannot be used."""

MOST_TOPICS: Final = 20
"""Subscriptions, and topics advertised, of one client."""
MOST_RELAYS: Final = 32
MOST_SERVICES: Final = 16
MOST_WAITING: Final = 64
MOST_FRAGMENTED: Final = 4
MOST_PARTS: Final = 100
"""Fragments of one message: all must arrive, and a client for which too much waits is let go."""
_LARGE_BYTES: Final = 4_096
_LARGE_PER_S: Final = 262_144.0
_LARGE_AT_ONCE: Final = 1_048_576.0
"""Bytes of a client's large answers: a question that asks for one, is cheap to send."""

_MOST_ERRORS: Final = 20
_ERRORS_PER_S: Final = 1.0
_SERVICE_NS: Final = 60_000_000_000
_NEVER: Final = 1 << 62


class Out(NamedTuple):
    """A frame for a client.

    Attributes:
        slot: 0: it must arrive. Else at most `depth` frames of that slot wait for the client; the oldest go first.
        close: 0, or the status with which the client's connection ends now.
    """

    client: int
    text: bytes
    slot: int = 0
    depth: int = 0
    close: int = 0


@dataclass(slots=True)
class _Client:
    subscriptions: dict[str, Subscription] = field(default_factory=dict)
    advertised: set[str] = field(default_factory=set)
    fragments: dict[frames.Identity, dict[int, str]] = field(default_factory=dict)
    errors: float = 0.0
    erred_ns: int = 0
    large: float = _LARGE_AT_ONCE
    asked_ns: int = 0


@dataclass(slots=True)
class _Heard:
    """A topic that somebody hears."""

    topic: str
    id: int
    kind: str
    watchers: dict[object, Callable[[Values], None]] = field(default_factory=dict)


@dataclass(slots=True)
class _Waiting:
    """A request that has no answer yet. `provider`: the client that must answer; None: the graph."""

    client: int
    provider: int | None
    service: str
    kind: str
    until_ns: int
    reply: Reply


class Bridge:
    """What rosbridge_server and rosapi are to their clients."""

    def __init__(self, graph: RosGraph) -> None:
        self._graph = graph
        self._clients: dict[int, _Client] = {}
        self._heard: dict[str, _Heard] = {}
        self._by_id: dict[int, _Heard] = {}
        self._relays: dict[str, str] = {}
        self._offered: dict[str, tuple[int, str]] = {}
        self._waiting: dict[int, _Waiting] = {}
        self._numbers = count(FIRST_ID)
        self._goals = Goals(self)
        self._parameters = RosapiParameters(self, lambda: self._graph.services)
        self._out: list[Out] = []
        self._now_ns = 0
        self._operations: dict[type[frames.Frame], Callable[[int, Any], None]] = {
            frames.Advertise: self._advertise,
            frames.Unadvertise: self._unadvertise,
            frames.PublishFrame: self._publish,
            frames.Subscribe: self._subscribe,
            frames.Unsubscribe: self._unsubscribe,
            frames.CallService: self._call_service,
            frames.AdvertiseService: self._advertise_service,
            frames.UnadvertiseService: self._unadvertise_service,
            frames.ServiceResponse: self._service_response,
            frames.SendActionGoal: lambda client, frame: self._goals.send(
                client, frame, _full_name(frame.action)
            ),
            frames.CancelActionGoal: lambda client, frame: self._goals.cancel(
                client, frame, _full_name(frame.action)
            ),
            frames.Fragment: self._fragment,
        }

    # ------------------------------------------------------------------------------------- what drives it

    def open(self, client: int) -> None:
        """Take a client under a number of its own."""
        self._clients[client] = _Client()

    def close(self, client: int) -> None:
        """Forget a client and what was kept for it."""
        gone = self._clients.pop(client, None)
        if gone is None:
            return
        self._goals.forget(client)
        for service in [name for name, (provider, _) in self._offered.items() if provider == client]:
            self._withdraw(service)
        self._waiting = {key: one for key, one in self._waiting.items() if one.client != client}
        for topic in gone.subscriptions:
            self._release(topic)
        self._drop_relays()

    def receive(self, client: int, text: str | bytes, t_ns: int) -> None:
        """Act on a frame that came at `t_ns`, which is not earlier than anything before. Never raises."""
        self._now_ns = t_ns
        if client in self._clients:
            try:
                self._act(client, frames.read_frame(text))
            except frames.FrameError as error:
                self._complain(client, error)

    def take_event(self, event: Event) -> None:
        """Take a message or an answer of the graph."""
        self._now_ns = max(self._now_ns, event.t_ns)
        if event.what == MESSAGE_EVENT:
            heard = self._by_id.get(event.id)
            if heard is not None:
                self._deliver(heard, event)
            return
        waiting = self._waiting.pop(event.sequence, None)
        if waiting is None:
            return
        try:
            values = decode(f"{waiting.kind}_Response", event.payload, self._graph.types)
        except ProtocolError as error:
            waiting.reply.failed(str(error))
        else:
            waiting.reply.done(values)

    def awaits(self, sequence: int) -> bool:
        """Return whether the answer to that request of the bridge is still to come."""
        return sequence in self._waiting

    def tick(self, t_ns: int) -> None:
        """Give up requests that have waited too long."""
        self._now_ns = max(self._now_ns, t_ns)
        for key in [key for key, one in self._waiting.items() if one.until_ns <= t_ns]:
            one = self._waiting.pop(key)
            one.reply.failed(f"Timeout exceeded while waiting for service response: {one.service}")

    def next_due(self) -> int | None:
        """Return when `tick` has something to do, None when never."""
        due_ns = min((request.until_ns for request in self._waiting.values()), default=_NEVER)
        return None if due_ns == _NEVER else due_ns

    def take(self) -> list[Out]:
        """Return what is to be sent, in this order."""
        out, self._out = self._out, []
        return out

    # ------------------------------------------------------------------------------------------ frames

    def _act(self, client: int, frame: frames.Frame) -> None:
        operation = self._operations.get(type(frame))
        if operation is None:  # set_level, status: nobody acts on them
            return
        try:
            operation(client, frame)
        except frames.FrameError as error:
            raise frames.FrameError(str(error), frame.id if error.id is None else error.id) from None

    def _complain(self, client: int, error: frames.FrameError) -> None:
        session = self._clients[client]
        passed_s = (self._now_ns - session.erred_ns) / 1e9
        session.errors = max(session.errors - passed_s * _ERRORS_PER_S, 0.0) + 1.0
        session.erred_ns = self._now_ns
        if session.errors > _MOST_ERRORS:
            self._out.append(Out(client, b"too many frames that cannot be used", close=BAD_CLIENT))
            self.close(client)
            return
        self.send(client, {"op": "status", "level": "error", "msg": str(error)}, error.id)

    def _fragment(self, client: int, frame: frames.Fragment) -> None:
        kept = self._clients[client].fragments
        parts = kept.setdefault(frame.id, {})
        parts[int(frame.num)] = frame.data
        if len(kept) > MOST_FRAGMENTED or sum(map(len, parts.values())) > frames.MAX_FRAME_BYTES:
            del kept[frame.id]
            raise frames.FrameError("too many fragments, or too long ones")
        total = int(frame.total)
        if len(parts) < total:
            return
        del kept[frame.id]
        if any(number not in parts for number in range(total)):
            raise frames.FrameError("fragments are missing")
        joined = frames.read_frame("".join(parts[number] for number in range(total)))
        if isinstance(joined, frames.Fragment):
            raise frames.FrameError("a fragment in fragments")
        self._act(client, joined)

    # ------------------------------------------------------------------------------------------ topics

    def _type_of(self, topic: str) -> str | None:
        return self._graph.topics.get(topic) or self._relays.get(topic)

    def _established(self, topic: str, asked: str | None) -> str:
        """Return the topic's type; a topic that is not there yet begins with the type that is asked for.

        Raises FrameError: there is none, it is another one, or there are too many topics.
        """
        established = self._type_of(topic)
        kind = full_type(asked) if asked else established
        if kind is None:
            raise frames.FrameError(f"Cannot infer type of topic {topic} as it is not yet advertised")
        if established is None:
            if kind not in self._graph.types.fields:
                raise frames.FrameError(f"Unable to find the type {kind}")
            if len(self._relays) >= MOST_RELAYS:
                raise frames.FrameError(f"at most {MOST_RELAYS} topics besides those of the car")
            established = self._relays[topic] = kind
        if kind != established:
            raise frames.FrameError(f"Topic {topic} is established with type {established}, not {kind}")
        return established

    def _advertise(self, client: int, frame: frames.Advertise) -> None:
        topic, own = _full_name(frame.topic), self._clients[client].advertised
        if topic not in own and len(own) >= MOST_TOPICS:
            raise frames.FrameError(f"at most {MOST_TOPICS} topics advertised by one client")
        self._established(topic, frame.type)
        own.add(topic)

    def _unadvertise(self, client: int, frame: frames.Unadvertise) -> None:
        self._clients[client].advertised.discard(_full_name(frame.topic))
        self._drop_relays()

    def _publish(self, client: int, frame: frames.PublishFrame) -> None:
        topic = _full_name(frame.topic)
        kind = self._type_of(topic)
        if kind is None:
            raise frames.FrameError(f"Cannot infer type of topic {topic} as it is not yet advertised")
        now_ns = self._graph.epoch_ns + self._now_ns
        self._graph.publish(topic, self._now_ns, message(kind, frame.msg, self._graph.types, now_ns))

    def _subscribe(self, client: int, frame: frames.Subscribe) -> None:
        topic, own = _full_name(frame.topic), self._clients[client].subscriptions
        if topic not in own and len(own) >= MOST_TOPICS:
            raise frames.FrameError(f"at most {MOST_TOPICS} topics subscribed by one client")
        kind = self._established(topic, frame.type)
        subscription = own.get(topic) or Subscription(slot=self._hear(topic, kind).id)
        try:
            subscription.add(frame)
            own[topic] = subscription
        finally:  # a subscription that was refused leaves nothing
            self._release(topic)
            self._drop_relays()
        if frame.compression not in (None, "none"):
            remark = f"compression {frame.compression} is not offered: {topic} is sent as JSON"
            self.send(client, {"op": "status", "level": "warning", "msg": remark}, frame.id)

    def _unsubscribe(self, client: int, frame: frames.Unsubscribe) -> None:
        topic, own = _full_name(frame.topic), self._clients[client].subscriptions
        if topic in own and own[topic].remove(frame.id):
            del own[topic]
            self._release(topic)
            self._drop_relays()

    def _hear(self, topic: str, kind: str) -> _Heard:
        heard = self._heard.get(topic)
        if heard is None:
            heard = self._heard[topic] = _Heard(topic, next(self._numbers), kind)
            self._by_id[heard.id] = heard
            self._graph.listen(topic, heard.id, self._now_ns)
        return heard

    def _release(self, topic: str) -> None:
        """Hear a topic no longer unless somebody else does."""
        heard = self._heard.get(topic)
        is_subscribed = any(topic in client.subscriptions for client in self._clients.values())
        if heard is not None and not is_subscribed and not heard.watchers:
            self._graph.unlisten(heard.id)
            del self._heard[topic], self._by_id[heard.id]

    def _drop_relays(self) -> None:
        used = {
            topic
            for client in self._clients.values()
            for topic in (*client.subscriptions, *client.advertised)
        }
        self._relays = {topic: kind for topic, kind in self._relays.items() if topic in used}

    def _deliver(self, heard: _Heard, event: Event) -> None:
        try:
            values = decode(heard.kind, event.payload, self._graph.types)
        except ProtocolError:
            return
        for watcher in tuple(heard.watchers.values()):
            watcher(values)
        text = b'{"op":"publish","topic":%b,"msg":%b}' % (to_json(heard.topic), to_json(values))
        for client, one in self._clients.items():
            subscription = one.subscriptions.get(heard.topic)
            if subscription is not None and subscription.wants(event.t_ns):
                self._out.extend(_sent(client, text, subscription, event.t_ns))

    # ---------------------------------------------------------------------------------------- services

    def _services(self) -> dict[str, str]:
        offered = {name: kind for name, (_, kind) in self._offered.items()}
        return {**self._graph.services, **offered, **rosapi.types(self._parameters.names)}

    def _call_service(self, client: int, frame: frames.CallService) -> None:
        service = _full_name(frame.service)
        answer: dict[str, Any] = {"op": "service_response", "service": frame.service}

        def done(values: Any) -> None:
            self.send(client, {**answer, "values": values, "result": True}, frame.id)

        def failed(reason: str) -> None:
            self.send(client, {**answer, "values": reason, "result": False}, frame.id)

        try:
            if service in self._offered:
                self._ask_client(client, service, frame, Reply(done, failed))
            elif service.removeprefix(rosapi.PREFIX) in self._parameters.names:
                args = frame.args if isinstance(frame.args, dict) else {}
                self._parameters.ask(client, service.removeprefix(rosapi.PREFIX), args, Reply(done, failed))
            elif service.startswith(rosapi.PREFIX):
                done(self._ask_rosapi(service, frame))
            else:
                fields = in_order(f"{self._required_type(service)}_Request", frame.args, self._graph.types)
                limit_ns = round(frame.timeout * 1e9) if frame.timeout else _SERVICE_NS
                self._request(client, service, fields, Reply(done, failed), limit_ns)
        except frames.FrameError as error:
            failed(str(error))

    def _ask_rosapi(self, service: str, frame: frames.CallService) -> dict[str, Any]:
        args = frame.args if isinstance(frame.args, dict) else {}
        graph = rosapi.KnownGraph(
            topics={**self._graph.topics, **self._relays},
            services=self._services(),
            nodes=(*self._graph.nodes, *rosapi.NODES),
            types=self._graph.types,
            now_ns=self._graph.epoch_ns + self._now_ns,
            node_of=self._node_of,
        )
        answer = rosapi.answer(service.removeprefix(rosapi.PREFIX), args, graph)
        if answer is None:
            raise frames.FrameError(f"Service {service} does not exist")
        return answer

    def _node_of(self, name: str) -> str:
        """Return the node that has a topic or service: the car's, unless clients or rosapi brought it."""
        if name.startswith(rosapi.PREFIX):
            return rosapi.NODES[0]
        brought = name in self._relays or name in self._offered
        return rosapi.NODES[1] if brought or not self._graph.nodes else self._graph.nodes[0]

    def _ask_client(self, client: int, service: str, frame: frames.CallService, reply: Reply) -> None:
        provider, kind = self._offered[service]
        until_ns = self._now_ns + _SERVICE_NS
        number = self._wait(_Waiting(client, provider, service, kind, until_ns, reply))
        request = {"op": "call_service", "service": service, "args": frame.args or {}}
        self.send(provider, request, f"service_request:{service}:{number}")

    def _service_response(self, client: int, frame: frames.ServiceResponse) -> None:
        number = str(frame.id).rpartition(":")[2]
        key = int(number) if number.isascii() and number.isdecimal() and len(number) < 19 else -1
        waiting = self._waiting.get(key)
        if waiting is None or waiting.provider != client:
            raise frames.FrameError("nobody waits for this service_response")
        del self._waiting[key]
        if frame.result:
            waiting.reply.done(frame.values)
        else:
            waiting.reply.failed(str(frame.values)[:1_000])

    def _advertise_service(self, client: int, frame: frames.AdvertiseService) -> None:
        service = _full_name(frame.service)
        offer = self._offered.get(service)
        if (
            service.startswith(rosapi.PREFIX)
            or service in self._graph.services
            or (offer and offer[0] != client)
        ):
            raise frames.FrameError(f"Service {service} exists already")
        if offer is None and len(self._offered) >= MOST_SERVICES:
            raise frames.FrameError(f"at most {MOST_SERVICES} services offered by clients")
        self._offered[service] = client, full_type(frame.type or "", "srv")

    def _unadvertise_service(self, client: int, frame: frames.UnadvertiseService) -> None:
        service = _full_name(frame.service)
        if self._offered.get(service, (None, ""))[0] != client:
            raise frames.FrameError(f"Service {service} is not offered by this client")
        self._withdraw(service)

    def _withdraw(self, service: str) -> None:
        provider, _ = self._offered.pop(service)
        asked = [
            key for key, one in self._waiting.items() if (one.provider, one.service) == (provider, service)
        ]
        for key in asked:
            self._waiting.pop(key).reply.failed(f"Service {service} was withdrawn")

    def _request(
        self,
        client: int,
        service: str,
        values: dict[str, Any],
        reply: Reply,
        limit_ns: int,
    ) -> None:
        """Send a request to a service of the graph."""
        kind = self._required_type(service)
        payload = message(f"{kind}_Request", values, self._graph.types, self._graph.epoch_ns + self._now_ns)
        until_ns = min(self._now_ns + limit_ns, _NEVER)
        number = self._wait(_Waiting(client, None, service, kind, until_ns, reply))
        if not self._graph.request(service, Request(FIRST_ID, number, self._now_ns, payload)):
            del self._waiting[number]
            reply.failed(f"Service {service} has too many requests")

    def _required_type(self, service: str) -> str:
        kind = self.service_type(service)
        if kind is None:
            raise frames.FrameError(f"Service {service} does not exist")
        return kind

    def _wait(self, waiting: _Waiting) -> int:
        if sum(request.client == waiting.client for request in self._waiting.values()) >= MOST_WAITING:
            raise frames.FrameError(f"at most {MOST_WAITING} requests of one client at once")
        number = next(self._numbers)
        self._waiting[number] = waiting
        return number

    # ------------------------------------------------------------------------------------ what goals need

    def service_type(self, service: str) -> str | None:
        """Return the type of a service of the graph, None where there is none."""
        return self._graph.services.get(service)

    def field_types(self) -> Types:
        """Return the table of types."""
        return self._graph.types

    def call(
        self,
        client: int,
        service: str,
        values: dict[str, Any],
        reply: Reply,
        *,
        waits: bool,
    ) -> None:
        """Send a request of a goal. `waits`: for as long as it takes."""
        self._request(client, service, values, reply, _NEVER if waits else _SERVICE_NS)

    def send(self, client: int, frame: Mapping[str, Any], identity: frames.Identity) -> None:
        """Send a frame to a client, if it is still there; it has an id where its cause had one."""
        if client in self._clients:
            message = {**frame, "id": identity} if identity is not None else frame
            try:
                text = to_json(message)
            except RecursionError:
                text = to_json({"op": "status", "level": "error", "msg": "too deep"})
            if len(text) > _LARGE_BYTES and not self._may_be_large(self._clients[client], len(text)):
                text = to_json(
                    {**message, "values": "too many large answers: wait a moment", "result": False}
                )
            self._out.append(Out(client, text))

    def _may_be_large(self, client: _Client, size: int) -> bool:
        gained = (self._now_ns - client.asked_ns) / 1e9 * _LARGE_PER_S
        client.large, client.asked_ns = min(client.large + gained, _LARGE_AT_ONCE), self._now_ns
        if client.large < size:
            return False
        client.large -= size
        return True

    def watch(self, topic: str, key: object, watcher: Callable[[Values], None]) -> None:
        """Pass each message on a topic of the graph to `watcher`."""
        kind = self._type_of(topic)
        if kind is not None:
            self._hear(topic, kind).watchers[key] = watcher

    def unwatch(self, topic: str, key: object) -> None:
        """Remove the watcher of that key."""
        if topic in self._heard:
            self._heard[topic].watchers.pop(key, None)
            self._release(topic)


def _full_name(name: str) -> str:
    """Return a name that begins with a slash: relative ones count from the root."""
    return name if name.startswith("/") else f"/{name}"


def _sent(client: int, text: bytes, subscription: Subscription, t_ns: int) -> Iterator[Out]:
    """Yield a message whole, or in fragments if the client wants that; in larger ones if they were too many."""
    size = subscription.fragment
    if not size or len(text) <= size:
        yield Out(client, text, subscription.slot, subscription.depth)
        return
    told = text.decode()
    size = max(size, math.ceil(len(told) / MOST_PARTS))
    parts = [told[start : start + size] for start in range(0, len(told), size)]
    for number, part in enumerate(parts):
        fragment = {"op": "fragment", "id": f"{t_ns}", "data": part, "num": number, "total": len(parts)}
        yield Out(client, to_json(fragment))
