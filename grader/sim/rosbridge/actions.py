"""Goals that clients send: each becomes the requests that an action is made of."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import count
from typing import Any, Final, NamedTuple, Protocol

from grader.sim.cdr import Values
from grader.sim.interfaces import Types
from grader.sim.rosbridge.frames import CancelActionGoal, FrameError, Identity, SendActionGoal
from grader.sim.rosbridge.values import in_order

MOST_GOALS: Final = 16
"""Of one client at once."""

_UNKNOWN: Final = 0
_GOAL_SUFFIX: Final = "_SendGoal"


class Reply(NamedTuple):
    """What is done with the values of an answer, and with the reason why there is none."""

    done: Callable[[Any], None]
    failed: Callable[[str], None]


_NOBODY: Final = Reply(lambda _: None, lambda _: None)


class Graph(Protocol):
    """What goals need of the bridge: its graph's services and topics, and a way to their clients."""

    def service_type(self, service: str) -> str | None:
        """Return the type of a service of the graph, None where there is none."""

    def field_types(self) -> Types:
        """Return the table of types."""

    def call(self, client: int, service: str, values: dict[str, Any], reply: Reply, *, waits: bool) -> None:
        """Call a service of the graph for a client."""

    def send(self, client: int, frame: Mapping[str, Any], identity: Identity) -> None:
        """Send a frame to a client, if it is still there."""

    def watch(self, topic: str, key: object, watcher: Callable[[Values], None]) -> None:
        """Pass each message on a topic of the graph to `watcher`."""

    def unwatch(self, topic: str, key: object) -> None:
        """Remove the watcher of that key."""


@dataclass(slots=True)
class _Goal:
    client: int
    id: Identity
    action: str
    name: str
    uuid: bytes
    feedback: bool


class Goals:
    """The goals under way."""

    def __init__(self, bridge: Graph) -> None:
        self._bridge = bridge
        self._numbers = count(1)
        self._under_way: list[_Goal] = []

    def send(self, client: int, frame: SendActionGoal, name: str) -> None:
        """Send a goal to the action `name`.

        Raises FrameError: there is no such action, or its goal does not fit; or the client has too many.
        """
        service = f"{name}/_action/send_goal"
        kind = self._bridge.service_type(service)
        if kind is None or not kind.endswith(_GOAL_SUFFIX):
            self._failed(client, frame.id, frame.action, f"Action {name} does not exist")
            return
        if sum(goal.client == client for goal in self._under_way) >= MOST_GOALS:
            raise FrameError(f"at most {MOST_GOALS} goals of one client at once", frame.id)
        goal = _Goal(client, frame.id, frame.action, name, self._new_uuid(), frame.feedback)
        fields = in_order(kind.removesuffix(_GOAL_SUFFIX) + "_Goal", frame.args, self._bridge.field_types())
        request = {"goal_id": {"uuid": list(goal.uuid)}, "goal": fields}
        self._bridge.call(
            client,
            service,
            request,
            Reply(lambda values: self._answered(goal, values), lambda reason: self._end(goal, reason)),
            waits=False,
        )
        self._under_way.append(goal)
        if goal.feedback:
            topic = f"{name}/_action/feedback"
            self._bridge.watch(topic, goal.uuid, lambda values: self._fed_back(goal, values))

    def cancel(self, client: int, frame: CancelActionGoal, name: str) -> None:
        """Cancel the goal that the client sent under the frame's id; none is no error, as in rosbridge."""
        for goal in self._under_way:
            if (goal.client, goal.id, goal.name) == (client, frame.id, name):
                request = {"goal_info": {"goal_id": {"uuid": list(goal.uuid)}}}
                service = f"{name}/_action/cancel_goal"
                self._bridge.call(client, service, request, _NOBODY, waits=False)
                return

    def forget(self, client: int) -> None:
        """Send nothing more to a client that has gone; its goals go on."""
        for goal in [one for one in self._under_way if one.client == client]:
            self._drop(goal)

    def _answered(self, goal: _Goal, values: Values) -> None:
        if not values.get("accepted"):
            self._end(goal, "Action goal was rejected")
            return
        self._bridge.call(
            goal.client,
            f"{goal.name}/_action/get_result",
            {"goal_id": {"uuid": list(goal.uuid)}},
            Reply(lambda result: self._succeeded(goal, result), lambda reason: self._end(goal, reason)),
            waits=True,
        )

    def _succeeded(self, goal: _Goal, values: Values) -> None:
        message = {"op": "action_result", "action": goal.action, "values": values["result"]}
        self._drop(goal)
        self._bridge.send(goal.client, {**message, "status": values["status"], "result": True}, goal.id)

    def _fed_back(self, goal: _Goal, values: Values) -> None:
        if values["goal_id"]["uuid"] == goal.uuid:
            message = {"op": "action_feedback", "action": goal.action, "values": values["feedback"]}
            self._bridge.send(goal.client, message, goal.id)

    def _end(self, goal: _Goal, reason: str) -> None:
        self._drop(goal)
        self._failed(goal.client, goal.id, goal.action, reason)

    def _failed(self, client: int, identity: Identity, action: str, reason: str) -> None:
        message = {"op": "action_result", "action": action, "values": reason}
        self._bridge.send(client, {**message, "status": _UNKNOWN, "result": False}, identity)

    def _drop(self, goal: _Goal) -> None:
        if goal in self._under_way:
            self._under_way.remove(goal)
            if goal.feedback:
                self._bridge.unwatch(f"{goal.name}/_action/feedback", goal.uuid)

    def _new_uuid(self) -> bytes:
        """Return an id of a goal: the same sequence in each run, so that exercises repeat."""
        return b"rosbridge" + next(self._numbers).to_bytes(7, "big")
