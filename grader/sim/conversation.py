"""Carries out the steps of a conversation in virtual time, and keeps what the script said.

The other end of the script's topics, services, actions and parameters: it publishes, calls, sends goals and serves
as the assignment's steps say, and hears the topics that its expectations are about. All that the script sends is
decoded strictly; how much is kept is bounded, the rest is counted.
"""

import hashlib
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from random import Random
from typing import Any, Final, NamedTuple

from grader.contracts.assignment import InterfaceDefinition
from grader.contracts.conversation import (
    FORMULA_MARK,
    Conversation,
    Expectation,
    Message,
    Party,
    PartyKind,
    Sent,
    Served,
    Step,
    TurtleSample,
    Values,
    parameter_value,
    plain_parameter,
)
from grader.contracts.errors import AssignmentError, ProtocolError
from grader.contracts.formula import FormulaError, formula
from grader.sim import frames
from grader.sim.cdr import decode, encode
from grader.sim.interfaces import with_interfaces
from grader.sim.script_graph import ScriptGraph
from grader.sim.simulated_world import SimulatedWorld

FIRST_SEQUENCE: Final = 1_000
"""Numbers of requests from here on are a conversation's."""

MOST_KEPT: Final = 3_000  # messages of a topic: a minute at 50 Hz
MOST_KEPT_BYTES: Final = 2 * 1024 * 1024
MOST_SERVED: Final = 1_000
SAMPLE_NS: Final = 100_000_000
"""Time between two looks at the turtles."""

EVENTS: Final = ("/parameter_events", "rcl_interfaces/msg/ParameterEvent")
_FRAMES: Final = {"/tf": "tf2_msgs/msg/TFMessage", "/tf_static": "tf2_msgs/msg/TFMessage"}
_STATES: Final = ("UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")
_PARTIES: Final[Mapping[int, PartyKind]] = {
    frames.NODE: "node",
    frames.PUBLISHER: "publisher",
    frames.SUBSCRIPTION: "subscription",
    frames.SERVICE: "service",
    frames.CLIENT: "client",
}
_PARAMETERS: Final = {
    name: f"rcl_interfaces/srv/{kind}"
    for name, kind in (
        ("set_parameters", "SetParameters"),
        ("get_parameters", "GetParameters"),
        ("describe_parameters", "DescribeParameters"),
    )
}


@dataclass(slots=True)
class _Heard:
    """What came on one topic: times and bytes of what is kept, and how much is not."""

    type: str
    times_ns: list[int] = field(default_factory=list)
    payloads: list[bytes] = field(default_factory=list)
    parties: list[int] = field(default_factory=list)
    size: int = 0
    lost: int = 0

    def take(self, times_ns: Sequence[int], payload: bytes, party: int) -> None:
        room = MOST_KEPT - len(self.times_ns)
        kept = times_ns[:room] if self.size < MOST_KEPT_BYTES else ()
        self.lost += len(times_ns) - len(kept)
        self.size += len(payload)
        self.times_ns += kept
        self.payloads += [payload] * len(kept)
        self.parties += [party] * len(kept)


@dataclass(slots=True)
class _Course:
    """How far a step has come.

    Attributes:
        sent: how many of it were sent. begun_ns: when the first one was.
        payloads: what is sent, one for each.
    """

    step: Step
    first: int
    payloads: list[bytes]
    sent: int = 0
    begun_ns: int = 0
    kept: bytes | None = None

    @property
    def due_ns(self) -> int:
        """When the next one is to be sent."""
        begun_ns = self.begun_ns if self.sent else self.step.at_ns
        return begun_ns + self.sent * self.step.every_ns


@dataclass(slots=True)
class _Asked:
    """A request under way: for which exchange, and what it asks."""

    exchange: int
    what: str
    name: str = ""


class Plan(NamedTuple):
    """What is to be said and wanted in one run. `seed` is that of the values which are drawn."""

    steps: tuple[Step, ...]
    expectations: tuple[Expectation, ...]
    interfaces: tuple[InterfaceDefinition, ...]
    seed: str


class Talk:
    """The trusted side of a conversation.

    Raises AssignmentError: the values of a step do not fit its type.
    """

    def __init__(
        self,
        plan: Plan,
        world: SimulatedWorld,
        graph: ScriptGraph,
    ) -> None:
        self._types = with_interfaces(plan.interfaces)
        self._world = world
        self._graph = graph
        self._exchanges: list[Sent] = []
        self._courses = [self._course(step, Random(f"{plan.seed}/{step.id}")) for step in plan.steps]  # noqa: S311
        self._offers = {step.target: step for step in plan.steps if step.kind == "serve"}
        self._heard: dict[tuple[str, str], _Heard] = {}
        self._turtles: dict[str, list[TurtleSample]] = {}
        self._look_at(plan.expectations)
        self._feedback: dict[tuple[str, bytes], list[Message]] = {}
        self._asked: dict[int, _Asked] = {}
        self._sequence = FIRST_SEQUENCE
        self._later: list[
            tuple[int, int, str]
        ] = []  # when which exchange is cancelled, or which request answered
        self._waiting: list[tuple[int, frames.Event]] = []
        self._served: list[Served] = []
        self._parties: dict[int, Party] = {}
        self._sampled_ns = -SAMPLE_NS

    def _look_at(self, expectations: Iterable[Expectation]) -> None:
        for expectation in expectations:
            if expectation.kind == "topic" and expectation.type:
                self._heard.setdefault((expectation.target, expectation.type), _Heard(expectation.type))
            elif expectation.kind == "frame":
                for topic, kind in _FRAMES.items():
                    self._heard.setdefault((topic, kind), _Heard(kind))
            elif expectation.kind == "parameter" and not expectation.step:
                self._heard.setdefault(EVENTS, _Heard(EVENTS[1]))
            if expectation.kind in ("turtle", "frame") or _OF_TURTLES.search(str(expectation)):
                self._turtles.setdefault("", [])
        for course in self._courses:
            if course.step.kind == "goal":
                kind = f"{course.step.type}_FeedbackMessage"
                self._heard[f"{course.step.target}/_action/feedback", kind] = _Heard(kind)

    def _course(self, step: Step, source: Random) -> _Course:
        first, payloads = len(self._exchanges), []
        # A type that the script's package should define, and does not: nothing can be sent.
        is_known = step.kind not in _SUFFIXES or f"{step.type}{_SUFFIXES[step.kind]}" in self._types.fields
        for n in range(step.sends):
            values = computed(step.each[n] if step.each else step.values, {"n": n}, source, step.id)
            self._exchanges.append(Sent(step=step.id, n=n, values=values))
            if is_known:
                payloads.append(self._payload(step, n, values))
        return _Course(step, first, payloads)

    def _payload(self, step: Step, n: int, values: Values) -> bytes:
        try:
            match step.kind:
                case "publish":
                    return encode(step.type, values, self._types)
                case "call":
                    return encode(f"{step.type}_Request", values, self._types)
                case "goal":
                    goal = {"goal_id": {"uuid": _uuid(step.id, n)}, "goal": values}
                    return encode(f"{step.type}_SendGoal_Request", goal, self._types)
                case "set":
                    parameters = [
                        {"name": name, "value": parameter_value(value)} for name, value in values.items()
                    ]
                    return encode(
                        "rcl_interfaces/srv/SetParameters_Request", {"parameters": parameters}, self._types
                    )
                case _:
                    return b""
        except (ProtocolError, ValueError) as error:
            raise AssignmentError(f"step {step.id}: {error}") from None

    # What START says.

    def add_to(self, world: dict[str, Any]) -> None:
        """Add to START's ``world`` what the conversation publishes, hears, calls and serves."""
        qos = world.setdefault("qos", {})
        world["listens"] = [list(party) for party in self._heard]
        calls = world.setdefault("calls", [])
        for step in (course.step for course in self._courses):
            if step.kind == "publish" and self._world.type_of(step.target) is None:
                world["publishes"].append([step.target, step.type])
                qos[step.target] = [not step.best_effort, step.latched]
            elif step.kind == "serve":
                world["services"].append([step.target, step.type])
            else:
                calls += [list(service) for service in _services_of(step).items()]

    # What the script does.

    def meet(self, entity: frames.Entity) -> None:
        """Take a new entity of the script, and connect it."""
        self._parties[entity.id] = Party(
            id=entity.id,
            kind=_PARTIES[entity.what],
            node=entity.node,
            name=entity.name,
            type=entity.type,
            reliable=entity.reliable,
            transient_local=entity.transient_local,
            depth=entity.depth,
            since_ns=entity.t_ns,
        )
        if entity.what == frames.SUBSCRIPTION:
            for course in self._courses:
                if self._reaches(course.step, entity):
                    self._world.outbox.subscribe(entity.name, entity.id)
                    if course.kept is not None and entity.transient_local:
                        kept = frames.Event(1, entity.id, 0, entity.t_ns, course.kept)
                        self._world.outbox.add(kept)
                    break

    def _reaches(self, step: Step, entity: frames.Entity) -> bool:
        """Whether a subscription hears what a step publishes; not what the world publishes itself."""
        return (
            step.kind == "publish"
            and (entity.name, entity.type) == (step.target, step.type)
            and not (entity.reliable and step.best_effort)
            and not (entity.transient_local and not step.latched)
            and self._world.type_of(step.target) is None
        )

    def part(self, identity: int, t_ns: int) -> None:
        """Note that an entity has gone."""
        if identity in self._parties:
            self._parties[identity] = replace(self._parties[identity], until_ns=t_ns)

    def hear(self, entity: frames.Entity, times_ns: Sequence[int], payload: bytes) -> None:
        """Take a message that the script published once or several times in a row."""
        heard = self._heard.get((entity.name, entity.type))
        if heard is not None:
            heard.take(times_ns, payload, entity.id)

    def request(self, client: frames.Entity, frame: frames.Request) -> bool:
        """Take a request to a service that a step offers; false if there is none.

        A request for which the answer's formula has no value is never answered.
        """
        step = self._offers.get(client.name)
        if step is None or step.type != client.type:
            return False
        asked = self._decoded(f"{step.type}_Request", frame.payload)
        if asked is None or len(self._served) >= MOST_SERVED:
            return True
        source = Random(f"{step.id}/{len(self._served)}")  # noqa: S311
        try:
            answer = computed(step.values, {"n": len(self._served), "in_": asked}, source, step.id)
            payload = encode(f"{step.type}_Response", answer, self._types)
        except (AssignmentError, ProtocolError):  # what the script sends has no answer, or none that fits
            self._served.append(Served(step=step.id, t_ns=frame.t_ns, values=asked))
            return True
        due_ns = frame.t_ns + step.after_ns
        self._served.append(
            Served(step=step.id, t_ns=frame.t_ns, values=asked, answered_ns=due_ns, answer=answer)
        )
        self._waiting.append((due_ns, frames.Event(2, frame.id, frame.sequence, due_ns, payload)))
        return True

    def answer(self, response: frames.Response) -> None:
        """Take the script's answer to a request.

        Raises ProtocolError: it was not asked, or has answered already.
        """
        asked = self._asked.pop(response.sequence, None)
        if asked is None:
            raise ProtocolError(f"RESPONSE.sequence {response.sequence} is not awaited")
        step = self._step_of(asked.exchange)
        suffix = {"goal": "_SendGoal", "result": "_GetResult"}.get(asked.what, "")
        kind = _PARAMETERS.get(
            asked.what, "action_msgs/srv/CancelGoal" if asked.what == "cancel" else step.type
        )
        values = self._decoded(f"{kind}{suffix}_Response", response.payload)
        getattr(self, f"_take_{asked.what}")(asked, response.t_ns, values)

    def _take_call(self, asked: _Asked, t_ns: int, values: Values | None) -> None:
        self._change(asked.exchange, answered_ns=t_ns, answer=values)

    _take_set_parameters = _take_call

    def _take_get_parameters(self, asked: _Asked, t_ns: int, values: Values | None) -> None:
        before = self._exchanges[asked.exchange].answer or {}
        value = None if values is None or not values["values"] else plain_parameter(values["values"][0])
        parameter = {
            **before.get(asked.name, {}),
            **({} if value is None else {"type": value[0], "value": value[1]}),
        }
        self._change(asked.exchange, answered_ns=t_ns, answer={**before, asked.name: parameter})

    def _take_describe_parameters(self, asked: _Asked, t_ns: int, values: Values | None) -> None:
        before = self._exchanges[asked.exchange].answer or {}
        descriptor = values["descriptors"][0] if values is not None and values["descriptors"] else {}
        parameter = {**before.get(asked.name, {}), **({"descriptor": descriptor} if descriptor else {})}
        self._change(asked.exchange, answered_ns=t_ns, answer={**before, asked.name: parameter})

    def _take_goal(self, asked: _Asked, t_ns: int, values: Values | None) -> None:
        accepted = bool(values and values["accepted"])
        self._change(asked.exchange, accepted=accepted, accepted_ns=t_ns)
        if not accepted:
            return
        step = self._step_of(asked.exchange)
        self._send(asked.exchange, "result", t_ns)
        if step.cancel_after_ns is not None:
            self._later.append((t_ns + step.cancel_after_ns, asked.exchange, "cancel"))

    def _take_result(self, asked: _Asked, t_ns: int, values: Values | None) -> None:
        if values is not None and 0 <= values["status"] < len(_STATES):
            self._change(
                asked.exchange, answered_ns=t_ns, answer=values["result"], status=_STATES[values["status"]]
            )

    def _take_cancel(self, asked: _Asked, t_ns: int, values: Values | None) -> None:
        """The answer to a cancellation says no more than the status that follows."""

    # Time.

    def next_ns(self) -> int | None:
        """Return when there is something to do next, None when never."""
        due = [
            course.due_ns
            for course in self._courses
            if course.sent < len(course.payloads) and self._meets(course)
        ]
        due += [entry[0] for entry in self._later]
        due += [entry[0] for entry in self._waiting]
        if self._turtles:
            due.append(self._sampled_ns + SAMPLE_NS)
        return min(due, default=None)

    def run(self, t_ns: int) -> None:
        """Do what is due at `t_ns`; the world has been advanced until then."""
        for due_ns, event in [entry for entry in self._waiting if entry[0] <= t_ns]:
            self._waiting.remove((due_ns, event))
            self._world.outbox.add(event)
        for due in [entry for entry in self._later if entry[0] <= t_ns]:
            self._later.remove(due)
            if not self._exchanges[due[1]].status:
                self._change(due[1], cancelled_ns=t_ns)
                self._send(due[1], "cancel", t_ns)
        for course in self._courses:
            while course.sent < len(course.payloads) and course.due_ns <= t_ns and self._meets(course):
                self._take_turn(course, t_ns)
        if self._turtles and self._sampled_ns + SAMPLE_NS <= t_ns:
            self._sampled_ns = t_ns
            for name, sample in self._world.turtles(t_ns).items():
                self._turtles.setdefault(name, []).append(sample)

    def _meets(self, course: _Course) -> bool:
        """Whether somebody is there for what a step sends; a message that is kept needs nobody."""
        step = course.step
        if step.kind == "publish":
            ready = course.sent or step.latched or self._world.type_of(step.target) is not None
            return bool(ready) or self._world.outbox.has_listeners(step.target)
        return all(self._graph.service(name, kind) is not None for name, kind in _services_of(step).items())

    def _take_turn(self, course: _Course, t_ns: int) -> None:
        step, index, payload = course.step, course.first + course.sent, course.payloads[course.sent]
        course.begun_ns = course.begun_ns if course.sent else max(t_ns, step.at_ns)
        course.sent += 1
        self._change(index, sent_ns=t_ns)
        match step.kind:
            case "publish":
                course.kept = payload if step.latched else None
                self._world.say(step.target, t_ns, payload)
            case "call" | "goal":
                self._send(index, step.kind, t_ns, payload)
            case "set":
                self._send(index, "set_parameters", t_ns, payload)
            case _:
                for name in step.names:
                    request = encode(
                        "rcl_interfaces/srv/GetParameters_Request", {"names": [name]}, self._types
                    )
                    self._send(index, "get_parameters", t_ns, request, name)
                    self._send(index, "describe_parameters", t_ns, request, name)

    def _send(self, index: int, what: str, t_ns: int, payload: bytes = b"", name: str = "") -> None:
        """Ask one of the script's services."""
        step, exchange = self._step_of(index), self._exchanges[index]
        identifier = {"uuid": _uuid(step.id, exchange.n)}
        if what == "result":
            payload = encode(f"{step.type}_GetResult_Request", {"goal_id": identifier}, self._types)
        elif what == "cancel":
            info = {"goal_info": {"goal_id": identifier}}
            payload = encode("action_msgs/srv/CancelGoal_Request", info, self._types)
        service = step.target if what == "call" else f"{step.target}/{_PATHS.get(what, what)}"
        identity = self._graph.service(service, _services_of(step)[service])
        if identity is None:  # it has gone meanwhile
            return
        self._sequence += 1
        self._asked[self._sequence] = _Asked(index, what, name)
        self._world.outbox.add(frames.Event(frames.REQUEST_EVENT, identity, self._sequence, t_ns, payload))

    # What came of it.

    def result(self) -> Conversation:
        """Return what was said."""
        heard: dict[str, tuple[Message, ...]] = {}
        lost: dict[str, int] = {}
        for (topic, _), each in self._heard.items():
            heard[topic] = (*heard.get(topic, ()), *self._messages(each))
            lost[topic] = lost.get(topic, 0) + each.lost
        return Conversation(
            exchanges=tuple(self._with_feedback(exchange, heard) for exchange in self._exchanges),
            heard={topic: messages for topic, messages in heard.items() if "/_action/" not in topic},
            lost={topic: count for topic, count in lost.items() if count},
            parties=tuple(self._parties.values()),
            served=tuple(self._served),
            turtles={name: tuple(samples) for name, samples in self._turtles.items() if name},
        )

    def _messages(self, heard: _Heard) -> list[Message]:
        decoded: dict[bytes, Values | None] = {}
        for payload in heard.payloads:
            if payload not in decoded:
                decoded[payload] = self._decoded(heard.type, payload)
        return [
            Message(t_ns, decoded[payload], party)
            for t_ns, payload, party in zip(heard.times_ns, heard.payloads, heard.parties, strict=True)
        ]

    def _with_feedback(self, exchange: Sent, heard: Mapping[str, tuple[Message, ...]]) -> Sent:
        course = next(other for other in self._courses if other.step.id == exchange.step)
        if course.step.kind != "goal":
            return exchange
        uuid = _uuid(exchange.step, exchange.n)
        feedback = [
            Message(message.t_ns, message.values["feedback"], message.party)
            for message in heard.get(f"{course.step.target}/_action/feedback", ())
            if message.values is not None and message.values["goal_id"]["uuid"] == uuid
        ]
        return replace(exchange, feedback=tuple(feedback))

    def _decoded(self, kind: str, payload: bytes) -> Values | None:
        """Return a message of the script; None if it cannot be read, or is larger than a message may be."""
        try:
            return decode(kind, payload, self._types)
        except ProtocolError:
            return None

    def _step_of(self, index: int) -> Step:
        return next(course.step for course in self._courses if course.step.id == self._exchanges[index].step)

    def _change(self, index: int, **fields: Any) -> None:
        self._exchanges[index] = replace(self._exchanges[index], **fields)


_OF_TURTLES: Final = re.compile(r"\bturtle\w*\.")  # in a formula
_SUFFIXES: Final = {"publish": "", "call": "_Request", "goal": "_SendGoal_Request"}
_PATHS: Final = {
    "goal": "_action/send_goal",
    "result": "_action/get_result",
    "cancel": "_action/cancel_goal",
}


def _services_of(step: Step) -> dict[str, str]:
    """Return names and types of the script's services that a step needs."""
    match step.kind:
        case "call":
            return {step.target: step.type}
        case "goal":
            base = f"{step.target}/_action"
            return {
                f"{base}/send_goal": f"{step.type}_SendGoal",
                f"{base}/get_result": f"{step.type}_GetResult",
                f"{base}/cancel_goal": "action_msgs/srv/CancelGoal",
            }
        case "set":
            return {f"{step.target}/set_parameters": _PARAMETERS["set_parameters"]}
        case "get":
            names = ("get_parameters", "describe_parameters")
            return {f"{step.target}/{name}": _PARAMETERS[name] for name in names}
        case _:
            return {}


def computed(values: Any, names: Mapping[str, Any], source: Random, step: str) -> Any:
    """Return the values of a step with its formulas carried out.

    Raises AssignmentError: a formula has no value.
    """
    if isinstance(values, dict):
        return {name: computed(each, names, source, step) for name, each in values.items()}
    if isinstance(values, list | tuple):
        return [computed(value, names, source, step) for value in values]
    if not isinstance(values, str) or not values.startswith(FORMULA_MARK):
        return values
    try:
        return formula(values[1:]).value(
            names, {"draw": _draw(source), "choose": lambda *each: source.choice(each)}
        )
    except FormulaError as error:
        raise AssignmentError(f"step {step}: {error}") from None


def _draw(source: Random) -> Any:
    """Return a function that draws a whole number, or one with two decimals if one of the ends is no whole one."""

    def draw(low: float, high: float) -> float:
        if isinstance(low, int) and isinstance(high, int):
            return source.randint(low, high)
        return round(source.uniform(low, high), 2)

    return draw


def _uuid(step: str, n: int) -> bytes:
    return hashlib.sha256(f"{step}/{n}".encode()).digest()[:16]
