"""The server's view of goals: handles, answers and default callbacks."""

from __future__ import annotations

from enum import Enum

from rclpy._actions import GoalEvent, GoalHandleCore
from rclpy._interfaces import GoalStatus

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy.action.server import ActionServer


class GoalResponse(Enum):
    """Answer to a goal."""

    REJECT = 1
    ACCEPT = 2


class CancelResponse(Enum):
    """Answer to a request to cancel."""

    REJECT = 1
    ACCEPT = 2


class ServerGoalHandle:
    """A goal the server has accepted."""

    def __init__(self, action_server: ActionServer, goal_info: Any, goal_request: Any) -> None:
        self._goal_handle: GoalHandleCore | None = GoalHandleCore(action_server._handle, goal_info)
        self._action_server = action_server
        self._goal_info = goal_info
        self._goal_request = goal_request
        self._cancel_requested = False

    def __eq__(self, other: object) -> bool:
        return bool(self.goal_id == other.goal_id)  # type: ignore[attr-defined]

    __hash__ = None  # type: ignore[assignment]

    def __ne__(self, other: object) -> bool:
        return bool(self.goal_id != other.goal_id)  # type: ignore[attr-defined]

    @property
    def request(self) -> Any:
        return self._goal_request

    @property
    def goal_id(self) -> Any:
        return self._goal_info.goal_id

    @property
    def is_active(self) -> bool:
        return self._goal_handle is not None and self._goal_handle.is_active()

    @property
    def is_cancel_requested(self) -> bool:
        return bool(self.status == GoalStatus.STATUS_CANCELING)

    @property
    def status(self) -> int:
        if self._goal_handle is None:
            return int(GoalStatus.STATUS_UNKNOWN)
        return self._goal_handle.get_status()

    def _update_state(self, event: GoalEvent) -> None:
        if self._goal_handle is None:
            return
        self._goal_handle.update_goal_state(event)
        self._action_server._handle.publish_status()
        if not self._goal_handle.is_active():
            self._action_server.notify_goal_done()

    def execute(self, execute_callback: Callable[[Any], Any] | None = None) -> None:
        """Have the executor run the callback (default: the server's) for this goal."""
        if not self.is_cancel_requested:
            self._update_state(GoalEvent.EXECUTE)
        self._action_server.notify_execute(self, execute_callback)

    def publish_feedback(self, feedback: Any) -> None:
        """Publish feedback; TypeError unless it is a Feedback of this action."""
        if not isinstance(feedback, self._action_server.action_type.Feedback):
            raise TypeError()
        if self._goal_handle is None:
            return
        message = self._action_server.action_type.Impl.FeedbackMessage()
        message.goal_id = self.goal_id
        message.feedback = feedback
        self._action_server._handle.publish_feedback(message)

    def succeed(self) -> None:
        """End the goal: reached."""
        self._update_state(GoalEvent.SUCCEED)

    def abort(self) -> None:
        """End the goal: given up."""
        self._update_state(GoalEvent.ABORT)

    def canceled(self) -> None:
        """End the goal: cancelled as asked."""
        self._update_state(GoalEvent.CANCELED)

    def destroy(self) -> None:
        """Forget the goal."""
        self._goal_handle = None


def default_handle_accepted_callback(goal_handle: ServerGoalHandle) -> None:
    """Execute an accepted goal at once."""
    goal_handle.execute()


def default_goal_callback(goal_request: Any) -> GoalResponse:
    """Accept every goal."""
    return GoalResponse.ACCEPT


def default_cancel_callback(cancel_request: Any) -> CancelResponse:
    """Refuse to cancel."""
    return CancelResponse.REJECT
