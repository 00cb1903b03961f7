"""Clock, timer and sleep handles: the arithmetic of rcl's time.c and timer.c over virtual time."""

from __future__ import annotations

from rclpy import _distro
from rclpy._kernel import kernel
from rclpy._patches.time import UPTIME_NS
from rclpy._rcl.enums import ClockChange, ClockType
from rclpy._rcl.errors import (
    GUARD_CONTEXT,
    NEGATIVE_PERIOD,
    TIMER_CANCELED,
    RCLError,
    native,
    wrong_arguments,
)
from rclpy._rcl.handles import ContextHandle, Handle, changes, required

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any


class TimePoint:
    """Nanoseconds on one kind of clock."""

    __slots__ = ("clock_type", "nanoseconds")

    def __init__(self, nanoseconds: int, clock_type: ClockType) -> None:
        self.nanoseconds = nanoseconds
        self.clock_type = clock_type


INFINITE_NS = 9223372036854775807


@native("rcl_duration_t")
class NativeDuration:
    """Nanoseconds between two points."""

    __slots__ = ("nanoseconds",)

    def __init__(self, nanoseconds: int) -> None:
        self.nanoseconds = nanoseconds


class _Watcher:
    """Callbacks around jumps of at least a given size; a threshold of 0 is off."""

    __slots__ = ("after", "backward_ns", "before", "forward_ns", "on_change")

    def __init__(
        self,
        on_change: bool,
        forward_ns: int,
        backward_ns: int,
        before: Callable[[], object] | None,
        after: Callable[[dict[str, Any]], object] | None,
    ) -> None:
        self.on_change = on_change
        self.forward_ns = forward_ns
        self.backward_ns = backward_ns
        self.before = before
        self.after = after

    def concerned(self, switched: bool, delta_ns: int) -> bool:
        """Whether a jump is large enough to be told."""
        if switched and self.on_change:
            return True
        if delta_ns < 0:
            return self.backward_ns != 0 and delta_ns <= self.backward_ns
        return delta_ns > 0 and self.forward_ns != 0 and delta_ns >= self.forward_ns


@native("Clock")
class ClockHandle(Handle):
    """A clock; a ROS clock can be driven by hand (``/clock``) instead of following system time."""

    def __init__(self, clock_type: ClockType) -> None:
        super().__init__()
        self.clock_type = clock_type
        self.overridden = False
        self._override_ns = 0
        self._watchers: dict[int, _Watcher] = {}

    def read_ns(self) -> int:
        """Return the time without the cost a student's look has."""
        if self.overridden:
            return self._override_ns
        if self.clock_type is ClockType.STEADY_TIME:
            return UPTIME_NS + kernel.now_ns
        return kernel.epoch_ns + kernel.now_ns

    def look_ns(self) -> int:
        """Return the time as a student reads it: looking costs virtual time."""
        kernel.clock_ns()
        return self.read_ns()

    def get_now(self) -> TimePoint:
        """Return the time as a student reads it."""
        return TimePoint(self.look_ns(), self.clock_type)

    def kernel_deadline_ns(self, at_ns: int) -> int | None:
        """Return the kernel's time at which this clock reads `at_ns`; None when only ``/clock`` can tell."""
        if self.overridden:
            return None
        if self.clock_type is ClockType.STEADY_TIME:
            return at_ns - UPTIME_NS
        return at_ns - kernel.epoch_ns

    def add_clock_callback(self, jump: Any, on_change: bool, forward_ns: int, backward_ns: int) -> None:
        """Call a JumpHandle's callbacks around every jump of at least the given size."""
        self.watch(
            id(jump), _Watcher(on_change, forward_ns, backward_ns, jump._pre_callback, jump._post_callback)
        )

    def remove_clock_callback(self, jump: Any) -> None:
        """Stop calling a JumpHandle's callbacks."""
        self._watchers.pop(id(jump), None)

    def watch(self, key: int, watcher: _Watcher) -> None:
        """Register callbacks under `key`."""
        self._watchers[key] = watcher

    def unwatch(self, key: int) -> None:
        """Forget the callbacks registered under `key`."""
        self._watchers.pop(key, None)

    def get_ros_time_override_is_enabled(self) -> bool:
        """Whether the clock follows `set_ros_time_override`."""
        return self.overridden

    def set_ros_time_override_is_enabled(self, enabled: bool) -> None:
        """Switch the source of ROS time; a jump of unknown size."""
        if enabled == self.overridden:
            return
        change = ClockChange.ROS_TIME_ACTIVATED if enabled else ClockChange.ROS_TIME_DEACTIVATED
        changes.count += 1
        called = self._announce(change, 0)
        self.overridden = enabled
        self._conclude(called, change, 0)

    def set_ros_time_override(self, point: TimePoint) -> None:
        """Set the time the clock reads while overridden."""
        if not self.overridden:
            self._override_ns = point.nanoseconds
            return
        delta_ns = point.nanoseconds - self._override_ns
        called = self._announce(ClockChange.ROS_TIME_NO_CHANGE, delta_ns)
        self._override_ns = point.nanoseconds
        self._conclude(called, ClockChange.ROS_TIME_NO_CHANGE, delta_ns)

    def _announce(self, change: ClockChange, delta_ns: int) -> list[_Watcher]:
        switched = change is not ClockChange.ROS_TIME_NO_CHANGE
        called = [watcher for watcher in self._watchers.values() if watcher.concerned(switched, delta_ns)]
        for watcher in called:
            if watcher.before is not None:
                watcher.before()
        return called

    def _conclude(self, called: list[_Watcher], change: ClockChange, delta_ns: int) -> None:
        for watcher in called:
            if watcher.after is not None:
                watcher.after({"clock_change": change, "delta": delta_ns})


def _no_period(period_ns: int, clock: ClockHandle, context: ContextHandle) -> TypeError:
    """Return what pybind11 raises for a period that its constructor does not take."""
    jazzy, kind = _distro.chosen == _distro.JAZZY, "rclpy._rclpy_pybind11"
    return wrong_arguments(
        "__init__",
        f"{kind}.Timer(arg0: rclpy::Clock, arg1: {kind}.Context, arg2: int{', arg3: bool' if jazzy else ''})",
        *(clock, context, period_ns),
        *((True,) if jazzy else ()),
    )


FREE_TIMERS = 10_000
"""Timers that are made without a charge; from then on each costs one, as a publish does. A callback that makes a
timer each time doubles their number each period, and would take the whole CPU time at one instant."""


class TimerHandle(Handle):
    """A phase-locked timer: a late call skips to the next multiple of the period, never a burst.

    Attributes:
        due_ns: next call, on the timer's clock.
        period_ns: between calls; the one already scheduled stays where it is when this changes.
        backlog: non-empty when a reset or a clock jump must wake a waiting executor.
    """

    _made = 0

    def __init__(self, clock: ClockHandle, context: ContextHandle, period_ns: int) -> None:
        super().__init__()
        required(context)
        TimerHandle._made += 1
        if TimerHandle._made > FREE_TIMERS:
            kernel.charge()
        if not -(2**63) <= period_ns < 2**63:
            raise _no_period(period_ns, clock, context)
        if period_ns < 0:
            raise RCLError(NEGATIVE_PERIOD)
        if not context.valid:
            # A timer has a guard condition of its own.
            raise RCLError(f"failed to create timer: {GUARD_CONTEXT}")
        self.clock = clock
        self.canceled = False
        self.backlog: list[bool] = []
        self.period_ns = period_ns
        self._last_ns = clock.read_ns()
        self.due_ns = self._last_ns + period_ns
        self._credit_ns = 0
        if clock.clock_type is ClockType.ROS_TIME:
            clock.watch(id(self), _Watcher(True, 1, -1, self._before_jump, self._after_jump))

    def _dispose(self) -> None:
        self.clock.unwatch(id(self))

    def _before_jump(self) -> None:
        now_ns = self.clock.read_ns()
        if now_ns:
            self._credit_ns = self.due_ns - now_ns

    def _after_jump(self, jump: dict[str, Any]) -> None:
        changes.count += 1
        now_ns = self.clock.read_ns()
        if jump["clock_change"] is not ClockChange.ROS_TIME_NO_CHANGE:
            self.backlog = [True]
            if now_ns and self._credit_ns:
                self._last_ns = now_ns - self._credit_ns
                self.due_ns = self._last_ns + self.period_ns
                self._credit_ns = 0
        elif self.due_ns <= now_ns:
            self.backlog = [True]
        elif now_ns < self._last_ns:
            self._last_ns = now_ns
            self.due_ns = now_ns + self.period_ns

    def is_timer_ready(self) -> bool:
        """Whether the timer is due and not cancelled."""
        return not self.canceled and self.due_ns <= self.clock.read_ns()

    def call_timer(self) -> None:
        """Note a call now and set the next one; RCLError when cancelled."""
        if self.canceled:
            raise RCLError(TIMER_CANCELED)
        now_ns = self.clock.read_ns()
        self._last_ns = now_ns
        self.due_ns += self.period_ns
        late_ns = now_ns - self.due_ns
        if late_ns > 0:
            period_ns = self.period_ns
            self.due_ns = now_ns if not period_ns else self.due_ns + -(-late_ns // period_ns) * period_ns

    def reset_timer(self) -> None:
        """Start a new period now; a cancelled timer runs again."""
        changes.count += 1
        self.due_ns = self.clock.read_ns() + self.period_ns
        self.canceled = False
        self.backlog = [True]

    def cancel_timer(self) -> None:
        """Never be due until reset."""
        self.canceled = True

    def is_timer_canceled(self) -> bool:
        """Whether the timer is cancelled."""
        return self.canceled

    def get_timer_period(self) -> int:
        """Return the period in nanoseconds."""
        return self.period_ns

    def change_timer_period(self, period_ns: int) -> None:
        """Set the period; the call already scheduled stays where it is."""
        self.period_ns = period_ns

    def time_since_last_call(self) -> int:
        """Return nanoseconds since the last call (or creation)."""
        return self.clock.look_ns() - self._last_ns

    def time_until_next_call(self) -> int | None:
        """Return nanoseconds to the next call (negative when late); None when cancelled."""
        if self.canceled:
            return None
        return self.due_ns - self.clock.look_ns()


class ClockEvent:
    """One sleeper on a clock, woken by `set` or by the clock reaching a time."""

    def __init__(self) -> None:
        self._set = False

    def set(self) -> None:
        """Wake the sleeper."""
        self._set = True

    def clear(self) -> None:
        """Sleep again."""
        self._set = False

    def is_set(self) -> bool:
        """Whether the sleeper was woken."""
        return self._set

    def wait_until(self, clock: ClockHandle, until_ns: int) -> None:
        """Block until `clock` reads `until_ns` or the event is set."""
        kernel.wait(
            lambda: self._set or clock.read_ns() >= until_ns,
            clock.kernel_deadline_ns(until_ns),
            "Clock.sleep_until()",
        )
