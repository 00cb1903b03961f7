"""Points in time."""

from __future__ import annotations

from rclpy._rcl.clocks import TimePoint
from rclpy._rcl.enums import ClockType
from rclpy.constants import S_TO_NS
from rclpy.duration import Duration

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

CONVERSION_CONSTANT = S_TO_NS


class Time:
    """A point in time on one kind of clock; points of different clocks do not mix.

    Raises:
        TypeError: `clock_type` is no ClockType.
        ValueError: a part is negative. OverflowError: the sum does not fit 63 bits.
    """

    def __init__(
        self, *, seconds: float = 0, nanoseconds: float = 0, clock_type: ClockType = ClockType.SYSTEM_TIME
    ) -> None:
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        if seconds < 0:
            raise ValueError("Seconds value must not be negative")
        if nanoseconds < 0:
            raise ValueError("Nanoseconds value must not be negative")
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if total >= 2**63:
            raise OverflowError("Total nanoseconds value is too large to store in C time point.")
        self._time_handle = TimePoint(total, clock_type)

    @property
    def nanoseconds(self) -> int:
        return self._time_handle.nanoseconds

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """Return whole seconds and the nanoseconds left."""
        return divmod(self.nanoseconds, S_TO_NS)

    @property
    def clock_type(self) -> ClockType:
        return self._time_handle.clock_type

    def __repr__(self) -> str:
        return f"Time(nanoseconds={self.nanoseconds}, clock_type={self.clock_type.name})"

    def __add__(self, other: Any) -> Time:
        if not isinstance(other, Duration):
            return NotImplemented
        try:
            return Time(nanoseconds=self.nanoseconds + other.nanoseconds, clock_type=self.clock_type)
        except OverflowError as error:
            raise OverflowError("Addition leads to overflow in C storage.") from error

    def __radd__(self, other: Any) -> Time:
        return self.__add__(other)

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Time):
            if self.clock_type != other.clock_type:
                raise TypeError("Can't subtract times with different clock types")
            return Duration(nanoseconds=self.nanoseconds - other.nanoseconds)
        if not isinstance(other, Duration):
            return NotImplemented
        try:
            return Time(nanoseconds=self.nanoseconds - other.nanoseconds, clock_type=self.clock_type)
        except ValueError as error:
            raise ValueError("Subtraction leads to negative time.") from error

    def _comparable(self, other: Any) -> bool:
        if not isinstance(other, Time):
            return False
        if self.clock_type != other.clock_type:
            raise TypeError("Can't compare times with different clock types")
        return True

    def __eq__(self, other: object) -> bool:
        if not self._comparable(other):
            raise TypeError("Can't compare time with object of type: ", type(other))
        return self.nanoseconds == other.nanoseconds  # type: ignore[attr-defined,no-any-return]

    __hash__ = None  # type: ignore[assignment]

    def __ne__(self, other: object) -> bool:
        return not self.__eq__(other)

    def __lt__(self, other: Any) -> bool:
        return self.nanoseconds < other.nanoseconds if self._comparable(other) else NotImplemented

    def __le__(self, other: Any) -> bool:
        return self.nanoseconds <= other.nanoseconds if self._comparable(other) else NotImplemented

    def __gt__(self, other: Any) -> bool:
        return self.nanoseconds > other.nanoseconds if self._comparable(other) else NotImplemented

    def __ge__(self, other: Any) -> bool:
        return self.nanoseconds >= other.nanoseconds if self._comparable(other) else NotImplemented

    def to_msg(self) -> Any:
        """Return a builtin_interfaces/msg/Time."""
        from rclpy._interfaces.own import Time as TimeMsg

        seconds, nanoseconds = self.seconds_nanoseconds()
        return TimeMsg(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(cls, msg: Any, clock_type: ClockType = ClockType.ROS_TIME) -> Time:
        """Return the point a builtin_interfaces/msg/Time holds; TypeError for anything else."""
        from rclpy._interfaces.own import Time as TimeMsg

        if not isinstance(msg, TimeMsg):
            raise TypeError("Must pass a builtin_interfaces.msg.Time object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec, clock_type=clock_type)
