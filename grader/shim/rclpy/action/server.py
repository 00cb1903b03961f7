"""Action servers."""

from __future__ import annotations

from enum import Enum

from rclpy._interfaces.own import GoalInfo, GoalStatus
from rclpy._patches.tracebacks import tell_caught
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
        self._node.add_waitable(self)

    def _create_handle(self, name: str, profiles: list[QoSProfile], timeout_s: float) -> ActionServerHandle:
        node, native = self._node, [profile.get_c_qos_profile() for profile in profiles]
        return ActionServerHandle(
            node.handle, node.get_clock().handle, self._action_type, name, native, timeout_s
        )

    def _register(
        self,
        accepted: Callable[..., Any] | None,
        goal: Callable[..., Any] | None,
        cancel: Callable[..., Any] | None,
    ) -> None:
        self.register_handle_accepted_callback(accepted)
        self.register_goal_callback(goal)
        self.register_cancel_callback(cancel)

    # What comes in -------------------------------------------------------------------------------

    async def _execute_goal_request(self, request_header_and_message: tuple[Any, Any]) -> None:
        header, request = request_header_and_message
        info = GoalInfo(goal_id=request.goal_id)
        logger = self._logger
        accepted = False
        goal_handle: ServerGoalHandle | None = None
        if not self._handle.goal_exists(info):
            response = await await_or_execute(self._goal_callback, request.goal)
            accepted = response == GoalResponse.ACCEPT
            if not isinstance(response, GoalResponse):
                logger.warning("Goal request callback did not return a GoalResponse type. Rejecting goal.")
        if accepted:
            info.stamp = self._node.get_clock().now().to_msg()
            key = uuid_bytes(info.goal_id)
            try:
                goal_handle = ServerGoalHandle(self, info, request.goal)
            except RuntimeError as error:
                logger.error(f"Failed to accept new goal with ID {uuid_text(info.goal_id)}: {error}")
                accepted = False
            else:
                self._goal_handles[key] = goal_handle
                self._result_futures[key] = Future()
                self.add_future(self._result_futures[key])
        answer = self._action_type.Impl.SendGoalService.Response(accepted=accepted, stamp=info.stamp)
        self._handle.goal.service_send_response(answer, header)
        if goal_handle is not None:
            await await_or_execute(self._handle_accepted_callback, goal_handle)

    async def _execute_goal(
        self, execute_callback: Callable[[ServerGoalHandle], Any], goal_handle: ServerGoalHandle
    ) -> None:
        logger = self._logger
        try:
            result = await await_or_execute(execute_callback, goal_handle)
        except Exception as error:
            import traceback

            result = self._action_type.Result()
            tell_caught(error)
            logger.error(f"Error raised in execute callback: {error}")
            traceback.print_exc()
        if goal_handle.is_active:
            logger.warning(f"Goal state not set, assuming aborted. Goal ID: {uuid_text(goal_handle.goal_id)}")
            goal_handle.abort()
        response = self._action_type.Impl.GetResultService.Response()
        response.status = goal_handle.status
        response.result = result
        self._result_futures[uuid_bytes(goal_handle.goal_id)].set_result(response)

    async def _execute_cancel_request(self, request_header_and_message: tuple[Any, Any]) -> None:
        header, request = request_header_and_message
        response = self._handle.process_cancel_request(
            request, self._action_type.Impl.CancelGoalService.Response
        )
        granted = []
        for info in response.goals_canceling:
            goal_handle = self._goal_handles.get(uuid_bytes(info.goal_id))
            if goal_handle is None:
                continue
            answer = await await_or_execute(self._cancel_callback, goal_handle)
            if answer != CancelResponse.ACCEPT:
                continue
            try:
                goal_handle._update_state(GoalEvent.CANCEL_GOAL)
            except RCLError as error:
                self._logger.debug(f"Failed to cancel goal in cancel callback: {error}")
            else:
                granted.append(info)
        response.goals_canceling = granted
        self._handle.cancel.service_send_response(response, header)

    async def _execute_get_result_request(self, request_header_and_message: tuple[Any, Any]) -> None:
        header, request = request_header_and_message
        future = self._result_futures.get(uuid_bytes(request.goal_id))
        if future is None:
            response = self._action_type.Impl.GetResultService.Response()
            response.status = GoalStatus.STATUS_UNKNOWN
            self._handle.result.service_send_response(response, header)
            return
        future.add_done_callback(lambda done: self._send_result_response(header, done))

    async def _execute_expire_goals(self, expired_goals: list[Any]) -> None:
        for info in expired_goals:
            key = uuid_bytes(info.goal_id)
            self._goal_handles.pop(key).destroy()
            self.remove_future(self._result_futures.pop(key))

    def _send_result_response(self, request_header: Any, future: Future) -> None:
        self._handle.result.service_send_response(future.result(), request_header)

    # Waitable ------------------------------------------------------------------------------------

    @property
    def action_type(self) -> Any:
        return self._action_type

    def _doomed(self) -> bool:
        return self._handle.doomed

    def _timer(self) -> Any:
        return self._handle.timer

    def _poll(self) -> bool:
        self._ready = list(map(bool, self._backlogs))
        return any(self._ready) or self._handle.timer.is_timer_ready()

    def is_ready(self, wait_set: WaitSet) -> bool:
        return self._poll()

    def take_data(self) -> dict[str, Any]:
        impl = self._action_type.Impl
        kinds = (impl.SendGoalService, impl.CancelGoalService, impl.GetResultService)
        data: dict[str, Any] = {}
        keys = ("goal", "cancel", "result")
        for key, service, kind, ready in zip(keys, self._services, kinds, self._ready, strict=True):
            request, header = service.service_take_request(kind.Request) if ready else (None, None)
            if header is not None:
                data[key] = (header.request_id, request)
        if self._handle.timer.is_timer_ready():
            data["expired"] = self._handle.expire_goals(len(self._goal_handles))
        return data

    async def execute(self, taken_data: dict[str, Any]) -> None:
        if "goal" in taken_data:
            await self._execute_goal_request(taken_data["goal"])
        if "cancel" in taken_data:
            await self._execute_cancel_request(taken_data["cancel"])
        if "result" in taken_data:
            await self._execute_get_result_request(taken_data["result"])
        if "expired" in taken_data:
            await self._execute_expire_goals(taken_data["expired"])

    def get_num_entities(self) -> NumberOfEntities:
        return NumberOfEntities(0, 0, 1, 0, 3)

    def add_to_wait_set(self, wait_set: WaitSet) -> None:
        for service in self._services:
            wait_set.add_service(service)
        wait_set.add_timer(self._handle.timer)

    def __enter__(self) -> None:
        self._handle.__enter__()

    def __exit__(self, *details: object) -> None:
        self._handle.__exit__(*details)

    # Callbacks -----------------------------------------------------------------------------------

    def notify_execute(
        self, goal_handle: ServerGoalHandle, execute_callback: Callable[[ServerGoalHandle], Any] | None
    ) -> None:
        """Have the node's executor run a goal."""
        callback = self._execute_callback if execute_callback is None else execute_callback
        executor = self._node.executor
        if executor is None:
            raise AttributeError("'NoneType' object has no attribute 'create_task'")
        executor.create_task(self._execute_goal, callback, goal_handle)

    def notify_goal_done(self) -> None:
        """Note that a goal has ended."""
        self._handle.notify_goal_done()

    def register_handle_accepted_callback(self, handle_accepted_callback: Callable[..., Any] | None) -> None:
        """Set the callback for accepted goals; None: the default."""
        self._handle_accepted_callback = handle_accepted_callback or default_handle_accepted_callback

    def register_goal_callback(self, goal_callback: Callable[..., Any] | None) -> None:
        """Set the callback that accepts goals; None: the default."""
        self._goal_callback = goal_callback or default_goal_callback

    def register_cancel_callback(self, cancel_callback: Callable[..., Any] | None) -> None:
        """Set the callback that grants cancelling; None: the default."""
        self._cancel_callback = cancel_callback or default_cancel_callback

    def register_execute_callback(self, execute_callback: Callable[..., Any]) -> None:
        """Set the callback that executes goals; TypeError unless it can be called."""
        if not callable(execute_callback):
            raise TypeError("Failed to register goal execution callback: not callable")
        self._execute_callback = execute_callback

    def destroy(self) -> None:
        """Destroy the server and forget its goals."""
        for goal_handle in self._goal_handles.values():
            goal_handle.destroy()
        for future in self._result_futures.values():
            self.remove_future(future)
        self._handle.destroy_when_not_in_use()
        self._node.remove_waitable(self)
