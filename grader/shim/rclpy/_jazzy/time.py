"""A `Time` or `Duration` is unlike any object of another class, instead of refusing the comparison."""

from __future__ import annotations

from rclpy import duration, time
from rclpy._jazzy.overlay import extends


@extends(duration.Duration)
class Duration(duration.Duration):
    """A span of time in nanoseconds."""

    def __eq__(self, other: object) -> bool:
        return (
            self.nanoseconds == other.nanoseconds if isinstance(other, duration.Duration) else NotImplemented
        )

    __hash__ = None

    def __ne__(self, other: object) -> bool:
        return (
            self.nanoseconds != other.nanoseconds if isinstance(other, duration.Duration) else NotImplemented
        )


@extends(time.Time)
class Time(time.Time):
    """A point in time on one kind of clock."""

    def __eq__(self, other: object) -> bool:
        return self.nanoseconds == other.nanoseconds if self._comparable(other) else NotImplemented  # type: ignore[attr-defined]

    __hash__ = None

    def __ne__(self, other: object) -> bool:
        return self.nanoseconds != other.nanoseconds if self._comparable(other) else NotImplemented  # type: ignore[attr-defined]


del time.CONVERSION_CONSTANT
