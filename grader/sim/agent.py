"""A chat agent's tool calls as an assignment lists them, sent through the rosbridge core in virtual time.

The steps are taken one after the other, in the frames that agents really send: each at its time at the earliest,
and not before the one before it has been answered or given up. The agent sees the graph of the car and the script.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

import msgspec

from grader.contracts.assignment import AgentStep, InterfaceDefinition
from grader.contracts.errors import ProtocolError
from grader.contracts.outcome import AgentResult
from grader.sim.frames import REQUEST_EVENT, RESPONSE_EVENT, Event, Request, Response
from grader.sim.interfaces import with_interfaces
from grader.sim.rosbridge.bridge import FIRST_ID, Bridge
from grader.sim.rosbridge.graph import twist_of
from grader.sim.script_graph import ScriptGraph
from grader.sim.turtle_world import NODE_NAME, TurtleWorld

OFFER_NS: Final = 3_000_000_000
"""How long a step waits for a service or topic that is not there at its time."""

_LIMITS_NS: Final = {"publish": 0, "read": 5_000_000_000, "call": 30_000_000_000, "goal": 120_000_000_000}
"""How long RosClaw waits for an answer."""

_CLIENT: Final = 1
_NEVER: Final = 1 << 62


class ScriptedGraph:
    """The graph of an episode as a bridge sees it: the car's world, the script's services, the agent's topics."""

    def __init__(
        self,
        world: TurtleWorld,
        script: ScriptGraph,
        interfaces: Iterable[InterfaceDefinition],
        topics: Mapping[str, str],
        epoch_ns: int,
    ) -> None:
        self.types = with_interfaces(interfaces)
        self.epoch_ns = epoch_ns
        self._world = world
        self._script = script
        self._topics = topics

    @property
    def topics(self) -> Mapping[str, str]:
        """Types by topic."""
        return {**self._topics, **self._world.topics}

    @property
    def services(self) -> Mapping[str, str]:
        """Types by service."""
        return {**self._script.services(), **self._world.services}

    @property
    def nodes(self) -> Sequence[str]:
        """Fully qualified names."""
        return (NODE_NAME, *self._script.nodes())

    def publish(self, topic: str, t_ns: int, payload: bytes) -> None:
        """Publish to the car and to the script."""
        if topic in self._world.command_topics:
            self._world.command(topic, (t_ns,), *twist_of(payload))
        self._world.outbox.publish(topic, t_ns, payload)

    def listen(self, topic: str, identity: int, t_ns: int) -> None:
        """Subscribe `identity` to a topic."""
        self._world.listen(topic, identity, t_ns)

    def unlisten(self, identity: int) -> None:
        """End the subscription."""
        self._world.outbox.unsubscribe(identity)

    def request(self, service: str, request: Request) -> bool:
        """Send a request to the car or to the script."""
        if service in self._world.services:
            return self._world.request(service, request)
        identity = self._script.service(service, self._script.services()[service])
        if identity is None:
            return False
        asked = Event(REQUEST_EVENT, identity, request.sequence, request.t_ns, request.payload)
        self._world.outbox.add(asked)
        return True


class Agent:
    """Takes the steps.

    Attributes:
        topics: types of the topics between agent and script, which the car's world does not have.
        services: names and types of the script's services that are going to be called.
    """

    def __init__(
        self,
        steps: tuple[AgentStep, ...],
        world: TurtleWorld,
        script: ScriptGraph,
        interfaces: Iterable[InterfaceDefinition],
        epoch_ns: int,
    ) -> None:
        own = [step for step in steps if step.tool in ("publish", "read") and step.target not in world.topics]
        self.topics = {step.target: step.type for step in own}
        self.published = {step.target for step in own if step.tool == "publish"}
        self.services = {
            step.target: step.type
            for step in steps
            if step.tool == "call" and step.target not in world.services
        }
        self._results = [AgentResult(step=step) for step in steps]
        self._world = world
        self._graph = ScriptedGraph(world, script, interfaces, self.topics, epoch_ns)
        self._bridge = Bridge(self._graph)
        self._bridge.open(_CLIENT)
        self._index = 0
        self._free_ns = 0  # when the step before was done
        self._until_ns: int | None = None  # when the step that was sent is given up
        self._now_ns = 0
        self._asked: set[int] = set()

    @property
    def results(self) -> tuple[AgentResult, ...]:
        """One result for each step, in the assignment's order."""
        return tuple(self._results)

    def next_ns(self) -> int | None:
        """Return when the agent has something to do next, None when never."""
        if self._index >= len(self._results):
            return None
        if self._until_ns is not None:
            due = (self._until_ns, self._bridge.next_due(), self._world.next_due())
            return max(min(each for each in due if each is not None), self._now_ns)
        due_ns = max(self._results[self._index].step.at_ns, self._free_ns)
        return max(due_ns if self._is_there() else due_ns + OFFER_NS, self._now_ns)

    def run(self, t_ns: int) -> None:
        """Do what is due at `t_ns`; the world has been advanced until then."""
        self._now_ns = max(self._now_ns, t_ns)
        for event in self._world.outbox.take_apart():
            self._bridge.take_event(event)
        self._bridge.tick(self._now_ns)
        self._read()
        if self._until_ns is not None and self._until_ns <= self._now_ns:
            self._done(reason="no answer")
        while self._until_ns is None and (due_ns := self.next_ns()) is not None and due_ns <= self._now_ns:
            self._send(self._results[self._index].step)

    def reach(self, t_ns: int) -> None:
        """Move the agent's clock to `t_ns`, up to which nothing was due."""
        self._now_ns = max(self._now_ns, t_ns)

    def answer(self, response: Response) -> None:
        """Take the script's answer to a request of the agent.

        Raises:
            ProtocolError: it was not asked, or has answered already.
        """
        event = Event(RESPONSE_EVENT, FIRST_ID, response.sequence, response.t_ns, response.payload)
        if not self._bridge.awaits(response.sequence):
            raise ProtocolError(f"RESPONSE.sequence {response.sequence} is not awaited")
        self._now_ns = max(self._now_ns, response.t_ns)
        self._bridge.take_event(event)
        self._read()

    def heard(self, topic: str, times_ns: Sequence[int], payload: bytes) -> None:
        """Take a message that the script published on one of `topics`, and go on with what waited for it."""
        for t_ns in times_ns:
            self._world.outbox.publish(topic, t_ns, payload)
            self.run(t_ns)

    def _is_there(self) -> bool:
        """Whether what the present step speaks to exists."""
        step = self._results[self._index].step
        return step.tool != "call" or step.target in self._graph.services

    def _send(self, step: AgentStep) -> None:
        offered = self._is_there()
        self._results[self._index] = AgentResult(step=step, sent_ns=self._now_ns if offered else None)
        self._until_ns = self._now_ns + _LIMITS_NS[step.tool]
        self._bridge.receive(_CLIENT, msgspec.json.encode(_frame(step, self._index)), self._now_ns)
        self._read()
        if step.tool == "publish" and self._until_ns is not None:
            self._done()

    def _read(self) -> None:
        """Look through what the bridge has for the agent."""
        for out in self._bridge.take():
            told = msgspec.json.decode(out.text)
            if self._until_ns is None or not self._is_about(told):
                continue
            good = told["op"] != "status" and told.get("result", True)
            values = told["msg"] if told["op"] == "publish" else told.get("values", told.get("msg"))
            if good:
                self._done(values=values if isinstance(values, dict) else {})
            else:
                self._done(reason=str(values))

    def _is_about(self, told: Mapping[str, Any]) -> bool:
        if told["op"] == "publish":
            return bool(told["topic"] == self._results[self._index].step.target)
        return told.get("id") == _identity(self._index) and told["op"] != "action_feedback"

    def _done(self, values: Mapping[str, Any] | None = None, reason: str = "") -> None:
        before = self._results[self._index]
        self._results[self._index] = AgentResult(
            step=before.step,
            sent_ns=before.sent_ns,
            answered_ns=None if reason else self._now_ns,
            values=values,
            reason=reason,
        )
        self._until_ns = None
        self._free_ns = self._now_ns
        self._index += 1
        if before.step.tool == "read":
            unsubscribe = {"op": "unsubscribe", "topic": before.step.target}
            self._bridge.receive(_CLIENT, msgspec.json.encode(unsubscribe), self._now_ns)


def _identity(index: int) -> str:
    return f"tool_{index + 1}"


def _frame(step: AgentStep, index: int) -> dict[str, Any]:
    """Return the frame of a tool call, with the fields that RosClaw's plugin sends."""
    common: dict[str, Any] = {"id": _identity(index)}
    kind = {"type": step.type} if step.type else {}
    match step.tool:
        case "publish":
            return {"op": "publish", **common, "topic": step.target, **kind, "msg": step.values}
        case "read":
            return {"op": "subscribe", **common, "topic": step.target, **kind}
        case "call":
            return {"op": "call_service", **common, "service": step.target, **kind, "args": step.values}
        case _:
            goal = {"action": step.target, "action_type": step.type, "args": step.values}
            return {"op": "send_action_goal", **common, **goal}
