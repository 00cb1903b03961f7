"""Action clients."""

from __future__ import annotations

import weakref

from rclpy._forwarding import passed_on
from rclpy._interfaces.own import CancelGoal
from rclpy._interfaces.own import GoalStatus as GoalStatus  # courses import it from here
from rclpy._kernel import kernel
from rclpy.action._native import (
    ABORTED,
    CANCELED,
    SUCCEEDED,
    ActionClientHandle,
    new_goal_id,
    uuid_bytes,
    uuid_text,
)
from rclpy.client import POLL_NS, block_on
from rclpy.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from rclpy.task import Future, await_or_execute
from rclpy.type_support import check_for_type_support
from rclpy.waitable import NumberOfEntities, Waitable

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy._rcl.wait_set import WaitSet
    from rclpy.callback_groups import CallbackGroup
    from rclpy.node import Node

__getattr__ = passed_on(__name__)


class ClientGoalHandle:
    """A goal that was sent: accepted or not, with ways to cancel it and to get its result."""

    def __init__(self, action_client: ActionClient, goal_id: Any, goal_response: Any) -> None:
        self._action_client = action_client
        self._goal_id = goal_id
        self._goal_response = goal_response
        self._status: int = GoalStatus.STATUS_UNKNOWN

    def __eq__(self, other: object) -> bool:
        return bool(self._goal_id == other.goal_id)  # type: ignore[attr-defined]

    __hash__ = None  # type: ignore[assignment]

    def __ne__(self, other: object) -> bool:
        return bool(self._goal_id != other.goal_id)  # type: ignore[attr-defined]

    def __repr__(self) -> str:
        return (
            f"ClientGoalHandle <id={uuid_text(self.goal_id)}, accepted={self.accepted}, status={self.status}>"
        )

    @property
    def goal_id(self) -> Any:
        return self._goal_id

    @property
    def stamp(self) -> Any:
        return self._goal_response.stamp

    @property
    def accepted(self) -> bool:
        return bool(self._goal_response.accepted)

    @property
    def status(self) -> int:
        return self._status

    def cancel_goal(self) -> Any:
        """Ask to cancel and block until the response; another thread has to spin the node."""
        return self._action_client._cancel_goal(self)

    def cancel_goal_async(self) -> Future:
        """Ask to cancel; the future gets the response."""
        return self._action_client._cancel_goal_async(self)

    def get_result(self) -> Any:
        """Block until the result; another thread has to spin the node."""
        return self._action_client._get_result(self)

    def get_result_async(self) -> Future:
        """Ask for the result; the future gets it."""
        return self._action_client._get_result_async(self)


class PendingRequests:
    """Requests of one kind under way: sequence number -> future and goal id."""

    def __init__(self, client: ActionClient, kind: str) -> None:
        self._client = client
        self._kind = kind
        self.futures: dict[int, Future] = {}
        self.goals: dict[int, Any] = {}

    def add(self, sequence: int, goal_id: Any) -> Future:
        """Note a request and return its future."""
        if sequence in self.futures:
            raise RuntimeError(f"Sequence ({sequence}) conflicts with pending {self._kind} request")
        future = Future()
        self.futures[sequence] = future
        self.goals[sequence] = goal_id
        future.add_done_callback(self._forget)
        self._client.add_future(future)
        return future

    def _forget(self, future: Future) -> None:
        for sequence, pending in list(self.futures.items()):
            if pending is future:
                del self.futures[sequence]
                goal_id = self.goals.pop(sequence)
                self._client.remove_future(future)
                if self._kind == "result":
                    self._client._feedback_callbacks.pop(uuid_bytes(goal_id), None)


class ActionClient(Waitable):
    """Sends goals to an action server."""

    def __init__(
        self,
        node: Node,
        action_type: Any,
        action_name: str,
        *,
        callback_group: CallbackGroup | None = None,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_sub_qos_profile: QoSProfile = QoSProfile(depth=10),  # noqa: B008
        status_sub_qos_profile: QoSProfile = qos_profile_action_status_default,
    ) -> None:
        super().__init__(node.default_callback_group if callback_group is None else callback_group)
        check_for_type_support(action_type)
        self._node = node
        self._logger = node.get_logger()
        self._action_type = action_type
        self._action_name = action_name
        node.handle.require()
        self._client_handle = ActionClientHandle(
            node.handle,
            action_type,
            action_name,
            goal_service_qos_profile.get_c_qos_profile(),
            result_service_qos_profile.get_c_qos_profile(),
            cancel_service_qos_profile.get_c_qos_profile(),
            feedback_sub_qos_profile.get_c_qos_profile(),
            status_sub_qos_profile.get_c_qos_profile(),
        )
        self._goal_handles: dict[bytes, Callable[[], ClientGoalHandle | None]] = {}
        self._goals = PendingRequests(self, "goal")
        self._cancels = PendingRequests(self, "cancel")
        self._results = PendingRequests(self, "result")
        self._feedback_callbacks: dict[bytes, Callable[[Any], Any]] = {}
        self._backlogs = tuple(member.backlog for member in self._client_handle.members)
        # At the last wait: what comes after it waits for the next.
        self._ready = [False] * len(self._backlogs)
        self._node.add_waitable(self)

    # Waitable ------------------------------------------------------------------------------------

    def _doomed(self) -> bool:
        return self._client_handle.doomed

    def _poll(self) -> bool:
        self._ready = list(map(bool, self._backlogs))
        return any(self._ready)

    def is_ready(self, wait_set: WaitSet) -> bool:
        return self._poll()

    def take_data(self) -> dict[str, Any]:
        handle, impl = self._client_handle, self._action_type.Impl
        feedback, status, goal, cancel, result = self._ready
        data: dict[str, Any] = {}
        for key, ready, client, kind in (
            ("goal", goal, handle.goal, impl.SendGoalService),
            ("cancel", cancel, handle.cancel, impl.CancelGoalService),
            ("result", result, handle.result, impl.GetResultService),
        ):
            header, response = client.take_response(kind.Response) if ready else (None, None)
            if header is not None:
                data[key] = (header.request_id.sequence_number, response)
        for key, ready, topic, kind in (
            ("feedback", feedback, handle.feedback, impl.FeedbackMessage),
            ("status", status, handle.status, impl.GoalStatusMessage),
        ):
            taken = topic.take_message(kind, False) if ready else None
            if taken is not None:
                data[key] = taken[0]
        return data

    async def execute(self, taken_data: dict[str, Any]) -> None:
        if "goal" in taken_data:
            self._on_goal_response(*taken_data["goal"])
        if "cancel" in taken_data:
            self._on_response(self._cancels, "cancel", *taken_data["cancel"])
        if "result" in taken_data:
            self._on_response(self._results, "result", *taken_data["result"])
        if "feedback" in taken_data:
            message = taken_data["feedback"]
            callback = self._feedback_callbacks.get(uuid_bytes(message.goal_id))
            if callback is not None:
                await await_or_execute(callback, message)
        if "status" in taken_data:
            self._on_status(taken_data["status"])

    def _on_goal_response(self, sequence: int, response: Any) -> None:
        if sequence not in self._goals.goals:
            self._ignore("goal")
            return
        goal_handle = ClientGoalHandle(self, self._goals.goals[sequence], response)
        if goal_handle.accepted:
            key = uuid_bytes(goal_handle.goal_id)
            if key in self._goal_handles:
                raise RuntimeError(f"Two goals were accepted with the same ID ({goal_handle})")
            self._goal_handles[key] = weakref.ref(goal_handle)
        self._goals.futures[sequence].set_result(goal_handle)

    def _on_response(self, pending: PendingRequests, kind: str, sequence: int, response: Any) -> None:
        if sequence in pending.futures:
            pending.futures[sequence].set_result(response)
        else:
            self._ignore(kind)

    def _ignore(self, kind: str) -> None:
        self._logger.warning(
            f"Ignoring unexpected {kind} response. There may be more than "
            f"one action server for the action '{self._action_name}'"
        )

    def _on_status(self, message: Any) -> None:
        for item in message.status_list:
            key = uuid_bytes(item.goal_info.goal_id)
            reference = self._goal_handles.get(key)
            if reference is None:
                continue
            goal_handle = reference()
            if goal_handle is not None:
                goal_handle._status = item.status
            if goal_handle is None or item.status in (SUCCEEDED, CANCELED, ABORTED):
                del self._goal_handles[key]

    def get_num_entities(self) -> NumberOfEntities:
        return NumberOfEntities(2, 0, 0, 3, 0)

    def add_to_wait_set(self, wait_set: WaitSet) -> None:
        for member in self._client_handle.members:
            add = wait_set.add_client if member.what == "client" else wait_set.add_subscription
            add(member)

    def __enter__(self) -> None:
        self._client_handle.__enter__()

    def __exit__(self, *details: object) -> None:
        self._client_handle.__exit__(*details)

    # Goals ---------------------------------------------------------------------------------------

    def send_goal(self, goal: Any, **kwargs: Any) -> Any:
        """Send a goal and block until its result; another thread has to spin the node.

        Raises TypeError: `goal` is no Goal of this action.
        """
        call = f"send_goal() of {self._action_name!r}"
        goal_handle = block_on(self.send_goal_async(goal, **kwargs), call)
        return self._get_result(goal_handle)

    def send_goal_async(
        self, goal: Any, feedback_callback: Callable[[Any], Any] | None = None, goal_uuid: Any = None
    ) -> Future:
        """Send a goal; the future gets its ClientGoalHandle.

        `feedback_callback` is called with each feedback message. The goal has the id `goal_uuid`, or a new one.

        Raises TypeError: `goal` is no Goal of this action.
        """
        if not isinstance(goal, self._action_type.Goal):
            raise TypeError()
        request = self._action_type.Impl.SendGoalService.Request()
        request.goal_id = new_goal_id() if goal_uuid is None else goal_uuid
        request.goal = goal
        sequence = self._client_handle.send("goal", request)
        if feedback_callback is not None:
            self._feedback_callbacks[uuid_bytes(request.goal_id)] = feedback_callback
        return self._goals.add(sequence, request.goal_id)

    def _cancel_goal(self, goal_handle: ClientGoalHandle) -> Any:
        return block_on(self._cancel_goal_async(goal_handle), f"cancel_goal() of {self._action_name!r}")

    def _cancel_goal_async(self, goal_handle: ClientGoalHandle) -> Future:
        if not isinstance(goal_handle, ClientGoalHandle):
            raise TypeError(f"Expected type ClientGoalHandle but received {type(goal_handle)}")
        request = CancelGoal.Request()
        request.goal_info.goal_id = goal_handle.goal_id
        return self._cancels.add(self._client_handle.send("cancel", request), goal_handle.goal_id)

    def _get_result(self, goal_handle: ClientGoalHandle) -> Any:
        return block_on(self._get_result_async(goal_handle), f"get_result() of {self._action_name!r}")

    def _get_result_async(self, goal_handle: ClientGoalHandle) -> Future:
        if not isinstance(goal_handle, ClientGoalHandle):
            raise TypeError(f"Expected type ClientGoalHandle but received {type(goal_handle)}")
        request = self._action_type.Impl.GetResultService.Request()
        request.goal_id = goal_handle.goal_id
        return self._results.add(self._client_handle.send("result", request), goal_handle.goal_id)

    def server_is_ready(self) -> bool:
        """Whether a server of this action exists."""
        return self._client_handle.is_action_server_available()

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        """Wait in steps of 0.25 s until a server exists; whether one does at the end."""
        left_s = float("inf") if timeout_sec is None else timeout_sec
        while self._node.context.ok() and not self.server_is_ready() and left_s > 0.0:
            kernel.sleep_ns(POLL_NS)
            left_s -= POLL_NS / 1e9
        return self.server_is_ready()

    def destroy(self) -> None:
        """Destroy the client."""
        self._client_handle.destroy_when_not_in_use()
        self._node.remove_waitable(self)
