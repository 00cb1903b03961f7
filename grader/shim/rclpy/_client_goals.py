"""The client's view of goals: handles, and requests under way."""

from __future__ import annotations

from rclpy._actions import uuid_bytes, uuid_text
from rclpy._interfaces import GoalStatus
from rclpy.task import Future

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from rclpy.action.client import ActionClient


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
