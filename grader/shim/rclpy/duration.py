"""Spans of time."""

from __future__ import annotations

from rclpy._rcl.clocks import INFINITE_NS, NativeDuration
from rclpy.constants import S_TO_NS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Duration:
    """A span of time in nanoseconds; as in Humble it has an order but no arithmetic.

    Raises OverflowError: the span does not fit 64 bits.
    """

    def __init__(self, *, seconds: float = 0, nanoseconds: float = 0) -> None:
        # Its product is a text of gigabytes, which is refused next.
        if isinstance(seconds, str) and seconds.isdigit():
            digits = len(seconds) * S_TO_NS
            raise ValueError(
                f"Exceeds the limit (4300) for integer string conversion: value has {digits} digits"
            )
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if not -(2**63) <= total < 2**63:
            raise OverflowError("Total nanoseconds value is too large to store in C duration.")
        self._duration_handle = NativeDuration(total)

    @property
    def nanoseconds(self) -> int:
        return self._duration_handle.nanoseconds

    def __repr__(self) -> str:
        return f"Duration(nanoseconds={self.nanoseconds})"

    def __str__(self) -> str:
        if self == Infinite:
            return "Infinite"
        return f"{self.nanoseconds} nanoseconds"

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Duration):
            return self.nanoseconds == other.nanoseconds
        raise TypeError("Can't compare duration with object of type: ", type(other))

    __hash__ = None  # type: ignore[assignment]

    def __ne__(self, other: object) -> bool:
        return not self.__eq__(other)

    def __lt__(self, other: Any) -> bool:
        return self.nanoseconds < other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __le__(self, other: Any) -> bool:
        return self.nanoseconds <= other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __gt__(self, other: Any) -> bool:
        return self.nanoseconds > other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __ge__(self, other: Any) -> bool:
        return self.nanoseconds >= other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def to_msg(self) -> Any:
        """Return a builtin_interfaces/msg/Duration."""
        from rclpy._interfaces.own import Duration as DurationMsg

        seconds, nanoseconds = divmod(self.nanoseconds, S_TO_NS)
        return DurationMsg(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(cls, msg: Any) -> Duration:
        """Return the span a builtin_interfaces/msg/Duration holds; TypeError for anything else."""
        from rclpy._interfaces.own import Duration as DurationMsg

        if not isinstance(msg, DurationMsg):
            raise TypeError("Must pass a builtin_interfaces.msg.Duration object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec)

    def get_c_duration(self) -> NativeDuration:
        """Return the handle upstream passes to C."""
        return self._duration_handle


Infinite = Duration(nanoseconds=INFINITE_NS)
