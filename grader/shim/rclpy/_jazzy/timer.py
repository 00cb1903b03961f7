"""Timers that do not start by themselves."""

from __future__ import annotations

from rclpy import timer
from rclpy._jazzy.overlay import extends
from rclpy._rcl import clocks

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_humble_init = timer.Timer.__init__
_humble_handle_init = clocks.TimerHandle.__init__


@extends(clocks.TimerHandle)
class TimerHandle(clocks.TimerHandle):
    """May be cancelled from the beginning."""

    def __init__(self, clock: Any, context: Any, period_ns: int, autostart: bool = True) -> None:
        _humble_handle_init(self, clock, context, period_ns)
        self.canceled = not autostart


@extends(timer.Timer)
class Timer(timer.Timer):
    """Calls back every period; without `autostart` only after `reset`."""

    def __init__(self, *given: Any, autostart: bool = True, **options: Any) -> None:
        _humble_init(self, *given, **options)
        if not autostart:
            self.handle.cancel_timer()
