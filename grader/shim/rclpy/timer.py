"""Timers and rates."""

from __future__ import annotations

from rclpy._kernel import kernel
from rclpy._rcl.clocks import TimerHandle
from rclpy._rcl.handles import required
from rclpy.exceptions import ROSInterruptException
from rclpy.utilities import get_default_context

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy.callback_groups import CallbackGroup
    from rclpy.clock import Clock
    from rclpy.context import Context


class Timer:
    """Calls back every period, first after one period, in phase with its creation.

    Raises RCLError: the period is negative.
    """

    def __init__(
        self,
        callback: Callable[[], Any] | None,
        callback_group: CallbackGroup | None,
        timer_period_ns: int,
        clock: Clock,
        *,
        context: Context | None = None,
    ) -> None:
        self._context = get_default_context() if context is None else context
        self._clock = clock
        self._clock.handle.require()
        self.__timer = TimerHandle(self._clock.handle, required(self._context.handle), timer_period_ns)
        self.timer_period_ns = timer_period_ns
        self.callback = callback
        self.callback_group = callback_group
        self._executor_event = False

    @property
    def handle(self) -> TimerHandle:
        return self.__timer

    def destroy(self) -> None:
        """Destroy the handle."""
        self.__timer.destroy_when_not_in_use()

    @property
    def clock(self) -> Clock:
        return self._clock

    @property
    def timer_period_ns(self) -> int:
        self.__timer.require()
        return self.__timer.get_timer_period()

    @timer_period_ns.setter
    def timer_period_ns(self, value: float) -> None:
        self.__timer.require()
        self.__timer.change_timer_period(int(value))

    def is_ready(self) -> bool:
        """Whether the timer is due."""
        self.__timer.require()
        kernel.charge()
        return self.__timer.is_timer_ready()

    def is_canceled(self) -> bool:
        """Whether the timer is cancelled."""
        self.__timer.require()
        return self.__timer.is_timer_canceled()

    def cancel(self) -> None:
        """Stop calling back until `reset`."""
        self.__timer.require()
        self.__timer.cancel_timer()

    def reset(self) -> None:
        """Begin a new period now."""
        self.__timer.require()
        self.__timer.reset_timer()

    def time_since_last_call(self) -> int:
        """Return nanoseconds since the last call or the creation."""
        self.__timer.require()
        return self.__timer.time_since_last_call()

    def time_until_next_call(self) -> int | None:
        """Return nanoseconds until the next call, None when cancelled."""
        self.__timer.require()
        return self.__timer.time_until_next_call()


class Rate:
    """Sleeps until a timer fires; some executor has to spin that timer's node in another thread."""

    def __init__(self, timer: Timer, *, context: Context) -> None:
        self._timer = timer
        self._is_shutdown = False
        self._is_destroyed = False
        self._fired = False
        self._num_sleepers = 0
        self._timer.callback = self._fire
        context.on_shutdown(self._on_shutdown)

    def _fire(self) -> None:
        self._fired = True

    def _on_shutdown(self) -> None:
        self._is_shutdown = True
        self.destroy()

    def destroy(self) -> None:
        """Wake the sleepers and forbid further sleep."""
        self._is_destroyed = True
        self._fired = True

    def sleep(self) -> None:
        """Block until the timer fires.

        Raises:
            ROSInterruptException: the context was shut down.
            RuntimeError: the rate was destroyed.
        """
        if self._is_shutdown:
            raise ROSInterruptException()
        if self._is_destroyed:
            raise RuntimeError("Rate cannot sleep because it has been destroyed")
        self._num_sleepers += 1
        try:
            kernel.wait(
                lambda: self._fired,
                None,
                "rate.sleep() waits for a timer of its node, but nothing spins that node in another thread",
            )
        finally:
            self._num_sleepers -= 1
            if self._num_sleepers == 0:
                self._fired = False
            if self._is_shutdown:
                self.destroy()
                raise ROSInterruptException()
