"""Guard conditions: callbacks that another thread can trigger."""

from __future__ import annotations

from rclpy._rcl.handles import GuardHandle, required
from rclpy.utilities import get_default_context

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy.callback_groups import CallbackGroup
    from rclpy.context import Context


class GuardCondition:
    """Something that wakes an executor, and has its callback executed there, when triggered."""

    def __init__(
        self,
        callback: Callable[[], Any] | None,
        callback_group: CallbackGroup | None,
        context: Context | None = None,
    ) -> None:
        self._context = get_default_context() if context is None else context
        self.__gc = GuardHandle(required(self._context.handle))
        self.callback = callback
        self.callback_group = callback_group
        self._executor_event = False
        self._executor_triggered = False

    def trigger(self) -> None:
        """Trigger; InvalidHandle after destruction."""
        self.__gc.require()
        self.__gc.trigger_guard_condition()

    @property
    def handle(self) -> GuardHandle:
        return self.__gc

    def destroy(self) -> None:
        """Destroy the handle."""
        self.__gc.destroy_when_not_in_use()
