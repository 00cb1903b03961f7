"""turtlesim's action rotate_absolute, as the services and topics an action is made of."""

import struct
from dataclasses import dataclass, field
from typing import Any, Final

from grader.sim.car import fold
from grader.sim.cdr import Values, decode, encode
from grader.sim.feeds import Outbox
from grader.sim.frames import Request
from grader.sim.interfaces import stamp
from grader.sim.turtle import Turtle

TYPE: Final = "turtlesim/action/RotateAbsolute"
_SERVICES: Final = {
    "send_goal": f"{TYPE}_SendGoal",
    "cancel_goal": "action_msgs/srv/CancelGoal",
    "get_result": f"{TYPE}_GetResult",
}
_TOPICS: Final = {"feedback": f"{TYPE}_FeedbackMessage", "status": "action_msgs/msg/GoalStatusArray"}

_FLOAT: Final = struct.Struct("<f")
TURN_RADPS: Final = 1.0
NEAR_RAD: Final = 0.02
MAX_GOALS: Final = 64

_EXECUTING, _CANCELING, _SUCCEEDED, _CANCELED, _ABORTED = 2, 3, 4, 5, 6
_REJECTED, _UNKNOWN_GOAL, _TERMINATED = 1, 2, 3


@dataclass(slots=True)
class Goal:
    """One goal and everybody who waits for its end."""

    uuid: bytes
    t_ns: int
    theta_rad: float
    start_rad: float
    status: int = _EXECUTING
    delta_rad: float = 0.0
    waiting: list[Request] = field(default_factory=list)


class RotateAction:
    """Turns the turtle to an absolute heading at 1 rad/s, tick by tick (`Turtle::update` of turtlesim 1.4).

    It succeeds within 0.02 rad of the goal; a new goal, or any velocity command that is taken, aborts it.
    """

    def __init__(self, name: str, turtle: Turtle, outbox: Outbox, epoch_ns: int) -> None:
        self._prefix = f"/{name}/rotate_absolute/_action"
        self._turtle = turtle
        self._outbox = outbox
        self._epoch_ns = epoch_ns
        self._goals: dict[bytes, Goal] = {}
        self._active: Goal | None = None
        self._changed = False

    @property
    def services(self) -> dict[str, str]:
        """Types by name."""
        return {f"{self._prefix}/{name}": kind for name, kind in _SERVICES.items()}

    @property
    def topics(self) -> dict[str, str]:
        """Types by topic."""
        return {f"{self._prefix}/{name}": kind for name, kind in _TOPICS.items()}

    @property
    def busy(self) -> bool:
        """Whether there is something to do in the next tick."""
        return self._active is not None or self._changed

    def handle(self, service: str, request: Request, t_ns: int) -> None:
        """Serve one request to one of `services`, at the update of `t_ns`.

        Raises ProtocolError: the request cannot be read.
        """
        kind = self.services[service]
        values = decode(f"{kind}_Request", request.payload)
        if service.endswith("send_goal"):
            self._outbox.reply(request, t_ns, encode(f"{kind}_Response", self._accept(values, t_ns)))
        elif service.endswith("cancel_goal"):
            self._outbox.reply(request, t_ns, encode(f"{kind}_Response", self._cancel(values, t_ns)))
        else:
            self._result(values["goal_id"]["uuid"], request, t_ns)

    def interrupt(self) -> None:
        """Abort the present goal: a velocity command was taken, or the turtle is gone."""
        if self._active is not None:
            self._end(self._active, _ABORTED)

    def tick(self, t_ns: int) -> None:
        """Steer towards the goal at the update of `t_ns`, which the turtle has yet to run."""
        goal = self._active
        if goal is not None:
            heading = self._turtle.pose[2]
            remaining = fold(fold(goal.theta_rad) - _in_32_bits(heading))
            if goal.status == _CANCELING:
                self._end(goal, _CANCELED)
            else:
                goal.delta_rad = fold(_in_32_bits(goal.start_rad - heading))
                feedback = {"goal_id": {"uuid": goal.uuid}, "feedback": {"remaining": remaining}}
                self._publish("feedback", t_ns, feedback)
                if abs(remaining) < NEAR_RAD:
                    self._end(goal, _SUCCEEDED)
            turn = 0.0 if self._active is None else -TURN_RADPS if remaining < 0.0 else TURN_RADPS
            self._turtle.drive(0.0, turn)
        if self._changed:
            self._announce(t_ns)

    def _accept(self, values: Values, t_ns: int) -> Values:
        uuid = values["goal_id"]["uuid"]
        if uuid in self._goals or not self._turtle.alive:
            return {"accepted": False}
        self.interrupt()
        if len(self._goals) >= MAX_GOALS:
            self._goals.pop(next(iter(self._goals)))
        start = self._turtle.pose[2]
        self._active = self._goals[uuid] = Goal(uuid, t_ns, values["goal"]["theta"], start)
        self._changed = True
        return {"accepted": True, "stamp": stamp(self._epoch_ns + t_ns)}

    def _cancel(self, values: Values, t_ns: int) -> Values:
        uuid = values["goal_info"]["goal_id"]["uuid"]
        goal = self._goals.get(uuid) if any(uuid) else self._active  # no id: whatever is under way
        if goal is None:
            return {"return_code": _UNKNOWN_GOAL if any(uuid) else _REJECTED}
        if goal is not self._active:
            return {"return_code": _TERMINATED}
        goal.status = _CANCELING
        self._changed = True
        return {"goals_canceling": [self._info(goal)]}

    def _result(self, uuid: bytes, request: Request, t_ns: int) -> None:
        goal = self._goals.get(uuid)
        if goal is None:
            self._outbox.reply(request, t_ns, encode(f"{TYPE}_GetResult_Response"))
        elif len(goal.waiting) < MAX_GOALS:
            goal.waiting.append(request)
            self._changed = True

    def _end(self, goal: Goal, status: int) -> None:
        goal.status = status
        self._active = None
        self._changed = True

    def _announce(self, t_ns: int) -> None:
        """Publish the statuses of all goals, and send results to the clients that wait for them."""
        self._changed = False
        statuses = [{"goal_info": self._info(goal), "status": goal.status} for goal in self._goals.values()]
        self._publish("status", t_ns, {"status_list": statuses})
        for goal in self._goals.values():
            if goal.status < _SUCCEEDED:
                continue
            answer = {"status": goal.status, "result": {"delta": goal.delta_rad}}
            for request in goal.waiting:
                self._outbox.reply(request, t_ns, encode(f"{TYPE}_GetResult_Response", answer))
            goal.waiting.clear()

    def _publish(self, topic: str, t_ns: int, values: dict[str, Any]) -> None:
        name = f"{self._prefix}/{topic}"
        if self._outbox.has_listeners(name):
            self._outbox.publish(name, t_ns, encode(_TOPICS[topic], values))

    def _info(self, goal: Goal) -> dict[str, Any]:
        return {"goal_id": {"uuid": goal.uuid}, "stamp": stamp(self._epoch_ns + goal.t_ns)}


def _in_32_bits(angle_rad: float) -> float:
    value: float = _FLOAT.unpack(_FLOAT.pack(angle_rad))[0]
    return value
