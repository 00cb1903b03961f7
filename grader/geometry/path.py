"""From recorded poses to the path that was driven."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# A way back shorter than this share of the path's extent is a correction: a controller that went too far backs up
# a little, but driving back on purpose goes for a good part of a side. Halved or doubled, a longer way back would
# earn more than a shorter one.
REVERSAL_SHARE = 0.1

MIN_REVERSAL_M = 0.01  # of a path that hardly moved; halved, the noise of a car at rest adds up to a distance


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """A driven path of n >= 1 samples.

    Attributes:
        x_m, y_m: (n,) position; teleports are taken out (see `driven_path`).
        heading_rad: (n,) continuous heading of the car.
        travel_rad: (n,) continuous direction of travel: the heading, plus half a turn while backing up.
        along_m: (n,) distance travelled since the start. It falls only within a correction: a way back that
            is small against the extent of the whole path.
        signed_m: (n,) distance along the car's own axis, falling while it backs up.
        extent_m: diagonal of the box around the path.
    """

    x_m: Floats
    y_m: Floats
    heading_rad: Floats
    travel_rad: Floats
    along_m: Floats
    signed_m: Floats
    extent_m: float

    def __len__(self) -> int:
        return len(self.x_m)


def driven_path(x_m: Floats, y_m: Floats, heading_rad: Floats, jumps: Sequence[int] = ()) -> Path:
    """Build the path from poses with continuous heading.

    `jumps` are indices whose pose was reached without driving: everything from there on is moved and turned
    rigidly so that it continues where the car stood, because a teleport is not motion.
    """
    x_m, y_m, heading_rad = _without_jumps(x_m, y_m, heading_rad, jumps)
    dx, dy = np.diff(x_m), np.diff(y_m)
    middle = (heading_rad[1:] + heading_rad[:-1]) / 2.0
    # Projected on the heading, measuring noise cancels from sample to sample; a sum of lengths would grow.
    signed_m = np.concatenate(([0.0], np.cumsum(dx * np.cos(middle) + dy * np.sin(middle))))
    extent_m = math.hypot(float(np.ptp(x_m)), float(np.ptp(y_m)))
    turning = _turning_points(signed_m, max(REVERSAL_SHARE * extent_m, MIN_REVERSAL_M))
    along_m, travel_rad = _unfold(signed_m, heading_rad, turning)
    return Path(x_m, y_m, heading_rad, travel_rad, along_m, signed_m, extent_m)


def _without_jumps(
    x_m: Floats, y_m: Floats, heading_rad: Floats, jumps: Sequence[int]
) -> tuple[Floats, Floats, Floats]:
    if not jumps:
        return x_m, y_m, heading_rad
    x_m, y_m, heading_rad = x_m.copy(), y_m.copy(), heading_rad.copy()
    for i in jumps:
        turn = heading_rad[i - 1] - heading_rad[i]
        cos, sin = math.cos(turn), math.sin(turn)
        dx, dy = x_m[i:] - x_m[i], y_m[i:] - y_m[i]
        x_m[i:] = x_m[i - 1] + cos * dx - sin * dy
        y_m[i:] = y_m[i - 1] + sin * dx + cos * dy
        heading_rad[i:] += turn
    return x_m, y_m, heading_rad


def _turning_points(signed_m: Floats, threshold_m: float) -> list[int]:
    """Return the indices at which the way along the axis turns round by more than `threshold_m`."""
    if float(np.max(np.maximum.accumulate(signed_m) - signed_m)) <= threshold_m:
        return []
    points: list[int] = []
    best, direction = 0, 0
    for i, value in enumerate(signed_m.tolist()):
        ahead = value - float(signed_m[best])
        if direction == 0:
            if abs(ahead) > threshold_m:
                direction, best = (1 if ahead > 0 else -1), i
        elif ahead * direction >= 0.0:
            best = i
        elif -ahead * direction > threshold_m:
            points.append(best)
            direction, best = -direction, i
    return points


def _unfold(signed_m: Floats, heading_rad: Floats, turning: list[int]) -> tuple[Floats, Floats]:
    """Make distance grow and direction of travel jump by half a turn at each turning point."""
    edges = [0, *turning, len(signed_m) - 1]
    along_m, travel_rad = np.empty_like(signed_m), heading_rad.copy()
    total_m = 0.0
    for first, last in itertools.pairwise(edges):
        ahead_m = signed_m[first : last + 1] - signed_m[first]
        backwards = ahead_m[-1] < 0.0
        along_m[first : last + 1] = total_m + (-ahead_m if backwards else ahead_m)
        if backwards:
            travel_rad[first + 1 : last + 1] = heading_rad[first + 1 : last + 1] + math.pi
            if first == 0:
                travel_rad[0] = heading_rad[0] + math.pi
        total_m += abs(float(ahead_m[-1]))
    return along_m, travel_rad
