"""Action servers."""

from __future__ import annotations

from enum import Enum

from rclpy._interfaces.own import GoalInfo, GoalStatus
from rclpy._rcl.errors import RCLError as RCLError
from rclpy.action._native import ActionServerHandle, GoalHandleCore, uuid_bytes, uuid_text
from rclpy.action._native import GoalEvent as GoalEvent
from rclpy.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from rclpy.task import Future, await_or_execute
from rclpy.type_support import check_for_type_support
from rclpy.waitable import NumberOfEntities, Waitable

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Any

    from rclpy._rcl.wait_set import WaitSet
    from rclpy.callback_groups import CallbackGroup
    from rclpy.node import Node


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
        self._cancel_requested = False  # as upstream, where nothing sets it either

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


class ActionServer(Waitable):
    """Accepts goals, executes them and tells their results.

    Args:
        node: node it belongs to.
        action_type: class of the action.
        action_name: name, made absolute and remapped.
        execute_callback: called with the ServerGoalHandle, returns the Result.
        callback_group: of all its callbacks.
        goal_callback: called with each goal, returns a GoalResponse.
        handle_accepted_callback: called with each accepted ServerGoalHandle.
        cancel_callback: called with the handle to be cancelled, returns a CancelResponse.
        goal_service_qos_profile, result_service_qos_profile, cancel_service_qos_profile: of the services.
        feedback_pub_qos_profile, status_pub_qos_profile: of the topics.
        result_timeout: seconds for which results are kept.
    """

    _ready: Sequence[bool] = (False, False, False)  # at the last wait: what comes after it waits for the next

    def __init__(
        self,
        node: Node,
        action_type: Any,
        action_name: str,
        execute_callback: Callable[[ServerGoalHandle], Any],
        *,
        callback_group: CallbackGroup | None = None,
        goal_callback: Callable[[Any], Any] | None = default_goal_callback,
        handle_accepted_callback: Callable[[ServerGoalHandle], Any] | None = default_handle_accepted_callback,
        cancel_callback: Callable[[Any], Any] | None = default_cancel_callback,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_pub_qos_profile: QoSProfile = QoSProfile(depth=10),  # noqa: B008
        status_pub_qos_profile: QoSProfile = qos_profile_action_status_default,
        result_timeout: float = 900,
    ) -> None:
        super().__init__(node.default_callback_group if callback_group is None else callback_group)
        self._register(handle_accepted_callback, goal_callback, cancel_callback)
        self.register_execute_callback(execute_callback)
        check_for_type_support(action_type)
        self._node, self._action_type = node, action_type
        self._logger = node.get_logger()
        node.handle.require()
        profiles = [
            goal_service_qos_profile,
            result_service_qos_profile,
            cancel_service_qos_profile,
            feedback_pub_qos_profile,
            status_pub_qos_profile,
        ]
        self._handle = self._create_handle(action_name, profiles, result_timeout)
        self._goal_handles: dict[bytes, ServerGoalHandle] = {}
        self._result_futures: dict[bytes, Future] = {}
        self._services = self._handle.services
        self._backlogs = tuple(service.backlog for service in self._services)
