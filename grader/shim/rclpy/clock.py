"""Clocks of the three kinds."""

from __future__ import annotations

from rclpy._rcl.clocks import ClockEvent, ClockHandle
from rclpy._rcl.enums import ClockChange as ClockChange
from rclpy._rcl.enums import ClockType as ClockType
from rclpy.duration import Duration
from rclpy.exceptions import NotInitializedException
from rclpy.time import Time
from rclpy.utilities import get_default_context

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy.context import Context


class JumpThreshold:
    """How large a time jump must be to be told; ValueError for a threshold of the wrong sign or none."""

    def __init__(
        self, *, min_forward: Duration | None, min_backward: Duration | None, on_clock_change: bool = True
    ) -> None:
        if min_forward is not None and min_forward.nanoseconds <= 0:
            raise ValueError("min_forward must be a positive non-zero duration")
        if min_backward is not None and min_backward.nanoseconds >= 0:
            raise ValueError("min_backward must be a negative non-zero duration")
        if min_forward is None and min_backward is None and not on_clock_change:
            raise ValueError("At least one jump threshold must be enabled")
        self.min_forward = min_forward
        self.min_backward = min_backward
        self.on_clock_change = on_clock_change


class TimeJump:
    """A jump that happened."""

    def __init__(self, clock_change: ClockChange, delta: Duration) -> None:
        if not isinstance(clock_change, ClockChange):
            raise TypeError("clock_change must be an instance of rclpy.clock.ClockChange")
        self._clock_change = clock_change
        self._delta = delta

    @property
    def clock_change(self) -> ClockChange:
        return self._clock_change

    @property
    def delta(self) -> Duration:
        return self._delta


class JumpHandle:
    """Registration of jump callbacks, until `unregister` or the end of its ``with`` block."""

    def __init__(
        self,
        *,
        clock: Clock,
        threshold: JumpThreshold,
        pre_callback: Callable[[], Any] | None,
        post_callback: Callable[[Any], Any] | None,
    ) -> None:
        if pre_callback is None and post_callback is None:
            raise ValueError("One of pre_callback or post_callback must be callable")
        if pre_callback is not None and not callable(pre_callback):
            raise ValueError("pre_callback must be callable if given")
        if post_callback is not None and not callable(post_callback):
            raise ValueError("post_callback must be callable if given")
        self._clock: Clock | None = clock
        self._pre_callback = pre_callback
        self._post_callback = post_callback
        forward = threshold.min_forward
        backward = threshold.min_backward
        clock.handle.require()
        clock.handle.add_clock_callback(
            self,
            threshold.on_clock_change,
            0 if forward is None else forward.nanoseconds,
            0 if backward is None else backward.nanoseconds,
        )

    def unregister(self) -> None:
        """Stop calling back."""
        if self._clock is not None:
            self._clock.handle.remove_clock_callback(self)
            self._clock = None

    def __enter__(self) -> JumpHandle:
        return self

    def __exit__(self, *_: object) -> None:
        self.unregister()


class Clock:
    """A clock; ``Clock(clock_type=ClockType.ROS_TIME)`` gives a `ROSClock`."""

    __clock: ClockHandle
    _clock_type: ClockType

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> Any:
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        self = super().__new__(ROSClock if clock_type is ClockType.ROS_TIME else cls)
        self.__clock = ClockHandle(clock_type)
        self._clock_type = clock_type
        return self

    @property
    def clock_type(self) -> ClockType:
        return self._clock_type

    @property
    def handle(self) -> ClockHandle:
        return self.__clock

    def __repr__(self) -> str:
        return f"Clock(clock_type={self.clock_type.name})"

    def now(self) -> Time:
        """Return the time; looking costs a little of it."""
        self.__clock.require()
        return Time(nanoseconds=self.__clock.look_ns(), clock_type=self._clock_type)

    def create_jump_callback(
        self,
        threshold: JumpThreshold,
        *,
        pre_callback: Callable[[], Any] | None = None,
        post_callback: Callable[[TimeJump], Any] | None = None,
    ) -> JumpHandle:
        """Have callbacks called before and after time jumps, as long as the returned handle lives."""
        after: Any = post_callback
        if post_callback is not None and callable(post_callback):
            told = post_callback

            def after(jump: dict[str, Any]) -> None:
                told(TimeJump(jump["clock_change"], Duration(nanoseconds=jump["delta"])))

        return JumpHandle(clock=self, threshold=threshold, pre_callback=pre_callback, post_callback=after)

    def sleep_until(self, until: Time, context: Context | None = None) -> bool:
        """Sleep until this clock reaches `until`.

        Returns:
            True when it did; False when the context was shut down or the source of time changed.

        Raises:
            NotInitializedException: the context is not initialised. ValueError: another kind of clock.
        """
        if context is None:
            context = get_default_context()
        if not context.ok():
            raise NotInitializedException()
        if until.clock_type != self._clock_type:
            raise ValueError("until's clock type does not match this clock's type")
        event = ClockEvent()
        changed = False

        def on_jump(jump: TimeJump) -> None:
            nonlocal changed
            changed = changed or jump.clock_change in (
                ClockChange.ROS_TIME_ACTIVATED,
                ClockChange.ROS_TIME_DEACTIVATED,
            )
            if changed:
                event.set()

        context.on_shutdown(event.set)
        threshold = JumpThreshold(
            min_forward=Duration(nanoseconds=1), min_backward=None, on_clock_change=True
        )
        with self.create_jump_callback(threshold, post_callback=on_jump):
            event.wait_until(self.__clock, until.nanoseconds)
        if not context._valid() or changed:
            return False
        return self.__clock.read_ns() >= until.nanoseconds

    def sleep_for(self, rel_time: Duration, context: Context | None = None) -> bool:
        """Sleep for a duration; see `sleep_until`."""
        start = Time(nanoseconds=self.__clock.read_ns(), clock_type=self._clock_type)
        return self.sleep_until(start + rel_time, context)


class ROSClock(Clock):
    """A clock of ROS time: system time unless a time source drives it."""

    def __new__(cls) -> ROSClock:
        clock: ROSClock = super().__new__(Clock, clock_type=ClockType.ROS_TIME)
        return clock

    @property
    def ros_time_is_active(self) -> bool:
        self.handle.require()
        return self.handle.get_ros_time_override_is_enabled()

    def _set_ros_time_is_active(self, enabled: bool) -> None:
        self.handle.require()
        self.handle.set_ros_time_override_is_enabled(enabled)

    def set_ros_time_override(self, time: Time) -> None:
        """Set what the clock reads while ROS time is active; TypeError for anything but a Time."""
        if not isinstance(time, Time):
            raise TypeError(f"Time must be specified as rclpy.time.Time. Received type: {type(time)}")
        self.handle.require()
        self.handle.set_ros_time_override(time._time_handle)
