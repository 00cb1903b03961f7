"""The poses of one frame in its parent: samples over a span of time, or a single one that holds at all times.

The rules and texts are those of tf2's cache.cpp and static_cache.cpp (ROS 2 Humble).
"""

from __future__ import annotations

from bisect import bisect_right
from typing import NamedTuple

from tf2_py._algebra import Rigid, mix, slerp
from tf2_py._exceptions import ExtrapolationException


class Sample(NamedTuple):
    """Pose of a frame in its parent at one time (nanoseconds)."""

    stamp_ns: int
    parent: str
    rigid: Rigid


class TimeCache:
    """Samples of a moving frame, oldest first, kept for `span_ns` nanoseconds."""

    def __init__(self, span_ns: int) -> None:
        self._span_ns = span_ns
        self._samples: list[Sample] = []

    @property
    def latest(self) -> Sample:
        """The newest sample."""
        return self._samples[-1]

    @property
    def latest_ns(self) -> int:
        """Time of the newest sample."""
        return self._samples[-1].stamp_ns

    @property
    def oldest_ns(self) -> int:
        """Time of the oldest sample."""
        return self._samples[0].stamp_ns

    @property
    def length(self) -> int:
        """Number of samples."""
        return len(self._samples)

    def insert(self, sample: Sample) -> bool:
        """Add a sample in order of time. Return False, and drop it, if it is older than the span of the cache."""
        if self._samples:
            oldest_ns = self.latest_ns - self._span_ns
            if sample.stamp_ns < oldest_ns:
                return False
            first = next(i for i, known in enumerate(self._samples) if known.stamp_ns >= oldest_ns)
            del self._samples[:first]
        place = bisect_right(self._samples, sample.stamp_ns, key=lambda known: known.stamp_ns)
        if sample not in self._samples[max(0, place - 1) : place]:
            self._samples.insert(place, sample)
        return True

    def at(self, time_ns: int) -> Sample:
        """Return the pose at `time_ns`, interpolated between samples; time 0 asks for the latest sample.

        Raises ExtrapolationException: the time lies outside the samples.
        """
        samples = self._samples
        first_ns, last_ns = samples[0].stamp_ns, samples[-1].stamp_ns
        if time_ns in (0, last_ns):
            return samples[-1]
        if len(samples) == 1:
            raise ExtrapolationException(
                f"Lookup would require extrapolation at time {_seconds(time_ns)}, "
                f"but only time {_seconds(last_ns)} is in the buffer"
            )
        if time_ns > last_ns:
            raise ExtrapolationException(
                f"Lookup would require extrapolation into the future.  Requested time {_seconds(time_ns)} "
                f"but the latest data is at time {_seconds(last_ns)}"
            )
        if time_ns < first_ns:
            raise ExtrapolationException(
                f"Lookup would require extrapolation into the past.  Requested time {_seconds(time_ns)} "
                f"but the earliest data is at time {_seconds(first_ns)}"
            )
        place = bisect_right(samples, time_ns, key=lambda known: known.stamp_ns)
        return _between(samples[place - 1], samples[place], time_ns)


class StaticCache:
    """The pose of a frame that never moves in its parent."""

    latest_ns = oldest_ns = 0
    length = 1

    def __init__(self) -> None:
        self.latest: Sample

    def insert(self, sample: Sample) -> bool:
        """Replace the pose."""
        self.latest = sample._replace(stamp_ns=0)
        return True

    def at(self, time_ns: int) -> Sample:
        """Return the pose, whatever the time."""
        return self.latest


def _between(older: Sample, newer: Sample, time_ns: int) -> Sample:
    if older.parent != newer.parent:
        return older
    fraction = (time_ns - older.stamp_ns) / (newer.stamp_ns - older.stamp_ns)
    translation = mix(older.rigid.translation, newer.rigid.translation, fraction)
    return Sample(
        time_ns, older.parent, Rigid(translation, slerp(older.rigid.rotation, newer.rigid.rotation, fraction))
    )


def _seconds(time_ns: int) -> str:
    return f"{time_ns / 1e9:.6f}"
