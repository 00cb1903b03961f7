"""Action handles: three services and two topics under a hidden name, and the state of goals (rcl_action)."""

from __future__ import annotations

from rclpy._interfaces import own
from rclpy._kernel import kernel
from rclpy._rcl.clocks import TimerHandle
from rclpy._rcl.endpoints import PublisherHandle, SubscriptionHandle
from rclpy._rcl.enums import NativeEnum
from rclpy._rcl.errors import RCLError
from rclpy._rcl.handles import Handle
from rclpy._rcl.service_endpoints import ClientHandle, ServiceHandle
from rclpy.constants import S_TO_NS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from rclpy._rcl.clocks import ClockHandle
    from rclpy._rcl.node_handle import NodeHandle
    from rclpy._rcl.qos import NativeQos

ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(1, 7)
_STATE_NAMES = ("UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")
UNKNOWN_GOAL, TERMINATED_GOAL = 2, 3


class GoalEvent(NativeEnum):
    """What can happen to a goal."""

    EXECUTE = 0
    CANCEL_GOAL = 1
    SUCCEED = 2
    ABORT = 3
    CANCELED = 4


_TRANSITIONS = {
    (ACCEPTED, GoalEvent.EXECUTE): EXECUTING,
    (ACCEPTED, GoalEvent.CANCEL_GOAL): CANCELING,
    (EXECUTING, GoalEvent.CANCEL_GOAL): CANCELING,
    (EXECUTING, GoalEvent.SUCCEED): SUCCEEDED,
    (EXECUTING, GoalEvent.ABORT): ABORTED,
    (CANCELING, GoalEvent.SUCCEED): SUCCEEDED,
    (CANCELING, GoalEvent.ABORT): ABORTED,
    (CANCELING, GoalEvent.CANCELED): CANCELED,
}


def uuid_bytes(message: Any) -> bytes:
    """Return the 16 bytes of a unique_identifier_msgs/msg/UUID without importing numpy."""
    return bytes(message._uuid)


def uuid_text(message: Any) -> str:
    """Return the bytes of a UUID as numpy prints an array of them, without importing numpy."""
    numbers = [str(byte) for byte in message._uuid]
    width = max(map(len, numbers))
    return f"[{' '.join(number.rjust(width) for number in numbers)}]"


class _Members(Handle):
    """Handles that live and die together."""

    def __init__(self) -> None:
        super().__init__()
        self.members: list[Any] = []

    def _dispose(self) -> None:
        for member in self.members:
            member.destroy_when_not_in_use()


def _check_name(node: NodeHandle, what: str, name: str) -> None:
    """Raise what upstream's action_client.cpp and action_server.cpp raise for a name that cannot be."""
    if not isinstance(name, str):
        raise TypeError("__init__(): incompatible constructor arguments.")
    is_server = what == "server"
    if not name and not is_server:
        fault = "failed to get goal service name, at ./src/rcl_action/action_client.c:217"
        raise ValueError(f"Failed to create action client: {fault}")
    try:
        if name:
            node.expand_and_remap(f"{name}/_action/send_goal", service=True)
            return
        fault = "invalid empty action name, at ./src/rcl_action/names.c:36"
    except ValueError as error:
        text = str(error)
        fault = text.partition("is invalid: ")[2] or text
    intro = f"Failed to create action {what} due to invalid topic name '{name}' : "
    raise ValueError(f"{intro}{': ' if is_server else ''}{fault}")


def _require_context(node: NodeHandle, failure: str) -> None:
    """Raise what upstream's action_client.cpp and action_server.cpp raise after shutdown: a ValueError."""
    try:
        node.require_context(failure)
    except RCLError as error:
        raise ValueError(str(error)) from None


class ActionClientHandle(_Members):
    """The client's five endpoints, in the order in which their readiness is reported: topics, then services."""

    def __init__(
        self,
        node: NodeHandle,
        action_type: Any,
        name: str,
        goal_qos: NativeQos,
        result_qos: NativeQos,
        cancel_qos: NativeQos,
        feedback_qos: NativeQos,
        status_qos: NativeQos,
    ) -> None:
        super().__init__()
        _require_context(node, "Failed to create action client")
        _check_name(node, "client", name)
        kinds, base = action_type.Impl, f"{name}/_action/"
        self.goal = ClientHandle(node, kinds.SendGoalService, base + "send_goal", goal_qos)
        self.cancel = ClientHandle(node, kinds.CancelGoalService, base + "cancel_goal", cancel_qos)
        self.result = ClientHandle(node, kinds.GetResultService, base + "get_result", result_qos)
        self.feedback = SubscriptionHandle(node, kinds.FeedbackMessage, base + "feedback", feedback_qos)
        self.status = SubscriptionHandle(node, kinds.GoalStatusMessage, base + "status", status_qos)
        self.members = [self.feedback, self.status, self.goal, self.cancel, self.result]

    def send(self, what: str, request: Any) -> int:
        """Send a request to the service for the goal, its result or its cancelling; return its number.

        Raises RCLError: the client was destroyed.
        """
        if self.doomed:
            invalid = "action client pointer is invalid, at ./src/rcl_action/action_client.c:470"
            raise RCLError(f"Failed to send {what} request: {invalid}")
        client: ClientHandle = getattr(self, what)
        return client.send_request(request)

    def is_action_server_available(self) -> bool:
        """Whether a server offers all of the action."""
        failure = "Failed to check if action server is available"
        if self.doomed:
            raise RCLError(f"{failure}: rcl node pointer is invalid, at ./src/rcl/node.c:413")
        self.feedback.node.require_context(failure)
        graph = self.feedback.node.graph
        return all(
            client.service_server_is_available() for client in (self.goal, self.cancel, self.result)
        ) and all(graph.writers.at(topic.name) for topic in (self.feedback, self.status))


class GoalHandleCore:
    """State of one goal on the server."""

    def __init__(self, server: ActionServerHandle, info: Any) -> None:
        self._server = server
        self.info = info
        self.state = ACCEPTED
        self.ended_ns = 0
        server.add_goal(self)

    def is_active(self) -> bool:
        """Whether the goal has not ended yet."""
        return self.state in (ACCEPTED, EXECUTING, CANCELING)

    def get_status(self) -> int:
        """Return the state as in action_msgs/msg/GoalStatus."""
        return self.state

    def update_goal_state(self, event: GoalEvent) -> None:
        """Move on; RCLError when the state does not allow the event."""
        state = _TRANSITIONS.get((self.state, event))
        if state is None:
            raise RCLError(
                "Failed to update goal state: goal_handle attempted invalid transition from state "
                f"{_STATE_NAMES[self.state]} with event {event.name}, at ./src/rcl_action/goal_handle.c:95"
            )
        self.state = state

    def destroy_when_not_in_use(self) -> None:
        """Forget the goal."""


class ActionServerHandle(_Members):
    """The server's five endpoints, its goals, and the timer that lets results expire.

    Args:
        node: node it belongs to. clock: measures the result timeout.
        action_type: class of the action. name: of the action.
        profiles: of the goal, result and cancel services and the feedback and status topics.
        result_timeout: seconds for which results are kept.
    """

    def __init__(
        self,
        node: NodeHandle,
        clock: ClockHandle,
        action_type: Any,
        name: str,
        profiles: Sequence[NativeQos],
        result_timeout: float,
    ) -> None:
        super().__init__()
        _require_context(node, "Failed to create action server")
        _check_name(node, "server", name)
        goal_qos, result_qos, cancel_qos, feedback_qos, status_qos = profiles
        kinds, base = action_type.Impl, f"{name}/_action/"
        self.goal = ServiceHandle(node, kinds.SendGoalService, base + "send_goal", goal_qos)
        self.cancel = ServiceHandle(node, kinds.CancelGoalService, base + "cancel_goal", cancel_qos)
        self.result = ServiceHandle(node, kinds.GetResultService, base + "get_result", result_qos)
        self.feedback = PublisherHandle(node, kinds.FeedbackMessage, base + "feedback", feedback_qos)
        self.status = PublisherHandle(node, kinds.GoalStatusMessage, base + "status", status_qos)
        self._timeout_ns = int(result_timeout * S_TO_NS)
        self._clock = clock
        self.timer = TimerHandle(clock, node.context, self._timeout_ns)
        self.timer.cancel_timer()
        self.services = (self.goal, self.cancel, self.result)
        self.members = [*self.services, self.feedback, self.status, self.timer]
        self.goals: dict[bytes, GoalHandleCore] = {}

    def add_goal(self, goal: GoalHandleCore) -> None:
        """Take over a new goal; RCLError when its id is known."""
        key = uuid_bytes(goal.info.goal_id)
        if key in self.goals:
            raise RCLError(
                "Failed to accept new goal: goal ID already exists, at ./src/rcl_action/action_server.c:410"
            )
        self.goals[key] = goal

    def goal_exists(self, info: Any) -> bool:
        """Whether the goal's id is known."""
        return uuid_bytes(info.goal_id) in self.goals

    def publish_status(self) -> None:
        """Publish the states of all goals."""
        message = own.GoalStatusArray()
        for goal in self.goals.values():
            message.status_list.append(own.GoalStatus(goal_info=goal.info, status=goal.state))
        self.status.publish(message)

    def publish_feedback(self, message: Any) -> None:
        """Publish feedback on a goal."""
        self.feedback.publish(message)

    def notify_goal_done(self) -> None:
        """Have results expire in time."""
        self._plan_expiry()

    def _plan_expiry(self) -> None:
        ended = [_stamp_ns(goal.info.stamp) for goal in self.goals.values() if not goal.is_active()]
        if not ended:
            self.timer.cancel_timer()
            return
        self.timer.reset_timer()
        self.timer.due_ns = max(min(ended) + self._timeout_ns, self._clock.read_ns())

    def expire_goals(self, _most: int) -> list[Any]:
        """Forget ended goals older than the result timeout and return their GoalInfos."""
        now_ns = self._clock.read_ns()
        expired = [
            key
            for key, goal in self.goals.items()
            if not goal.is_active() and now_ns - _stamp_ns(goal.info.stamp) > self._timeout_ns
        ]
        infos = [self.goals.pop(key).info for key in expired]
        self._plan_expiry()
        if not infos and not self.timer.canceled:
            self.timer.due_ns = now_ns + 1
        return infos

    def process_cancel_request(self, request: Any, response_class: Any) -> Any:
        """Return the response that lists the goals a request asks to cancel, by action_msgs' rules."""
        response = response_class()
        key = uuid_bytes(request.goal_info.goal_id)
        before_ns = _stamp_ns(request.goal_info.stamp)
        by_id = any(key)
        if by_id and not before_ns:
            goal = self.goals.get(key)
            if goal is None:
                response.return_code = UNKNOWN_GOAL
            elif not goal.is_active() or goal.state == CANCELING:
                response.return_code = TERMINATED_GOAL
            else:
                response.goals_canceling.append(goal.info)
            return response
        for known, goal in self.goals.items():
            asked = known == key or not before_ns or _stamp_ns(goal.info.stamp) <= before_ns
            if asked and goal.state in (ACCEPTED, EXECUTING):
                response.goals_canceling.append(goal.info)
        return response


def _stamp_ns(stamp: Any) -> int:
    return int(stamp.sec * S_TO_NS + stamp.nanosec)


_issued = 0


def new_goal_id() -> Any:
    """Return a fresh unique_identifier_msgs/msg/UUID; the sequence is the same in every run."""
    global _issued
    _issued += 1
    seed = (kernel.epoch_ns * 0x9E3779B97F4A7C15 + _issued) & ((1 << 64) - 1)
    words = b""
    for _ in range(2):  # splitmix64
        seed = (seed + 0x9E3779B97F4A7C15) & ((1 << 64) - 1)
        mixed = (seed ^ (seed >> 30)) * 0xBF58476D1CE4E5B9 & ((1 << 64) - 1)
        mixed = (mixed ^ (mixed >> 27)) * 0x94D049BB133111EB & ((1 << 64) - 1)
        words += (mixed ^ (mixed >> 31)).to_bytes(8, "big")
    data = bytearray(words)
    data[6] = data[6] & 0x0F | 0x40
    data[8] = data[8] & 0x3F | 0x80
    return own.UUID(uuid=list(data))
