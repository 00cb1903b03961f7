"""Timers that do not start by themselves."""

from __future__ import annotations

from rclpy import timer
from rclpy._jazzy.overlay import extends
from rclpy._rcl import clocks

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy._rcl.handles import ContextHandle
    from rclpy.callback_groups import CallbackGroup
    from rclpy.clock import Clock
    from rclpy.context import Context

_humble_init = timer.Timer.__init__
_humble_handle_init = clocks.TimerHandle.__init__


@extends(clocks.TimerHandle)
class TimerHandle(clocks.TimerHandle):
    """May be cancelled from the beginning."""

    def __init__(
        self, clock: clocks.ClockHandle, context: ContextHandle, period_ns: int, autostart: bool = True
    ) -> None:
        _humble_handle_init(self, clock, context, period_ns)
        self.canceled = not autostart


@extends(timer.Timer)
class Timer(timer.Timer):
    """Calls back every period; without `autostart` only after `reset`."""

    def __init__(
        self,
        callback: Callable[[], Any] | None,
        callback_group: CallbackGroup | None,
        timer_period_ns: int,
        clock: Clock,
        *,
        context: Context | None = None,
        autostart: bool = True,
    ) -> None:
        _humble_init(self, callback, callback_group, timer_period_ns, clock, context=context)
        if not autostart:
            self.handle.cancel_timer()
