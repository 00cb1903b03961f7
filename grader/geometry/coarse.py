"""A coarser look at a driven path: the polygon that it draws, where a fine look finds more or fewer sides.

A fine look (`grader.geometry.path.segment`) takes a corner that is cut off by a short straight for two corners, a
side with a kink for three sides, and one that bends to and fro for none, all from some size on. Whoever sees the
drawing sees the same figure, driven less well. So the path is simplified in the plane, and a side that strays
counts as bent, like an arc that strays as far.
"""

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np

from grader.geometry import exact
from grader.geometry.path import (
    MIN_TURN_RAD,
    Floats,
    Path,
    Segments,
    Straight,
    Turn,
    driven_m,
    simplified,
)

# Of a path's extent: what is simplified away. Of the two ends of a corner that is cut off by 30 % of a side, one
# lies 15 % of a square's extent beside the sides.
TOLERANCES = (0.02, 0.04, 0.08, 0.15)

# With both ends of the path: of a triangle; of seven laps of an octagon. It bounds the time that a circle takes.
LEAST_CORNERS, MOST_CORNERS = 4, 60

FITTED_AT = 20  # points of a side, at equal distances, through which its line is laid
# Of a side: left out at its ends, where corners are cut off. With less, a cut at one end turns the line.
END_SHARE = 0.25
SAGITTA = 8.0  # an arc that strays by s from its chord of length c turns by about 8 s / c

_Line = tuple[complex, float]
"""A point of a line and its direction as a continuous angle."""


def coarse_looks(path: Path) -> Iterator[Segments]:
    """Cut `path` into straights and the corners between them, in several ways: with each tolerance twice.

    First corners are where the path goes furthest out; then where lines through the middles of two sides cross, as
    if they were not cut off. There is no turn after the last straight. A path that has hardly any corner, or more
    than a figure that one can see, is not cut.
    """
    seen: list[list[int]] = []
    for tolerance in TOLERANCES:
        width_m = tolerance * path.extent_m
        corners = simplified(path.x_m / width_m, path.y_m / width_m, MOST_CORNERS + 1)
        if len(corners) <= MOST_CORNERS:
            corners = _plain_corners(path, corners, width_m)
        if not LEAST_CORNERS <= len(corners) <= MOST_CORNERS:
            continue
        if corners not in seen:
            yield _cut(path, corners, [_through_ends(path, *ends) for ends in itertools.pairwise(corners)])
        seen.append(corners)
        lines = [_through_middle(path, *ends) for ends in itertools.pairwise(corners)]
        yield _cut(path, _crossings(path, lines, corners, width_m), lines)


def _cut(path: Path, corners: list[int], lines: Sequence[_Line]) -> Segments:
    straights = tuple(
        _straight(path, direction_rad, first, last)
        for (_, direction_rad), (first, last) in zip(lines, itertools.pairwise(corners), strict=True)
    )
    turns = [
        Turn(at, at, after.direction_rad - before.direction_rad, 0.0)
        for at, (before, after) in zip(corners[1:-1], itertools.pairwise(straights), strict=True)
    ]
    return Segments(straights, (None, *turns, None))


def _plain_corners(path: Path, corners: list[int], width_m: float) -> list[int]:
    """Return the vertices without those where the path does not get on, or strays little without them."""
    kept: list[int] = []
    for corner in corners:
        if kept and not path.along_m[corner] > path.along_m[kept[-1]]:
            continue
        kept.append(corner)
        while len(kept) > 2 and _aside_m(path, kept[-3], corner) < width_m:
            del kept[-2]
    return kept


def _between(path: Path, first: int, last: int) -> complex:
    return complex(path.x_m[last] - path.x_m[first], path.y_m[last] - path.y_m[first])


def _through_ends(path: Path, first: int, last: int) -> _Line:
    chord = _between(path, first, last)
    middle = complex(path.x_m[first], path.y_m[first]) + chord / 2.0
    return middle, _as_travelled(path, exact.phase(chord), first, last)


def _through_middle(path: Path, first: int, last: int) -> _Line:
    """Return the line of least squares along the middle of a side."""
    points = exact.paired(_inner(path, path.x_m, first, last), _inner(path, path.y_m, first, last))
    middle = exact.middle(points)
    return middle, _as_travelled(path, exact.axis(points - middle), first, last)


def _as_travelled(path: Path, direction_rad: float, first: int, last: int) -> float:
    """Return the direction of a line, which has two, as it was driven on the whole."""
    mean_rad = exact.mean(_inner(path, path.travel_rad, first, last))
    return direction_rad + math.pi * round((mean_rad - direction_rad) / math.pi)


def _inner(path: Path, values: Floats, first: int, last: int) -> Floats:
    """Return values of a side at equal distances, without those at its ends."""
    along = np.maximum.accumulate(path.along_m[first : last + 1])
    at = float(along[0]) + float(along[-1] - along[0]) * np.linspace(END_SHARE, 1.0 - END_SHARE, FITTED_AT)
    return exact.interpolated(at, along, values[first : last + 1])


def _crossings(path: Path, lines: Sequence[_Line], corners: list[int], near_m: float) -> list[int]:
    """Return the samples nearest to where each line crosses the next, and the last one the first if they meet."""
    moved = list(corners)
    for i, (before, after) in enumerate(itertools.pairwise(lines), 1):
        moved[i] = _crossing(path, before, after, (moved[i - 1], corners[i], corners[i + 1]))
    if len(lines) > 1 and exact.magnitude(_between(path, corners[0], corners[-1])) <= near_m:
        moved[-1] = _crossing(path, lines[-1], lines[0], (moved[-2], corners[-1], corners[-1]))
    return moved


def _crossing(path: Path, before: _Line, after: _Line, ends: tuple[int, int, int]) -> int:
    """Return the sample nearest to where two lines cross, between the middles of their sides."""
    (here, here_rad), (there, there_rad) = before, after
    across = exact.sin(there_rad - here_rad)
    if abs(across) < exact.sin(MIN_TURN_RAD):
        return ends[1]
    apart = (there - here) * exact.rect(1.0, -there_rad)
    crossing = here - exact.rect(1.0, here_rad) * (apart.imag / across)
    first, last = _halfway(path, *ends[:2]), _halfway(path, *ends[1:])
    x_m, y_m = path.x_m[first : last + 1], path.y_m[first : last + 1]
    return first + int(np.argmin(exact.hypot(x_m - crossing.real, y_m - crossing.imag)))


def _halfway(path: Path, first: int, last: int) -> int:
    along = np.maximum.accumulate(path.along_m[first : last + 1])
    return first + int(np.searchsorted(along, (along[0] + along[-1]) / 2.0))


def _straight(path: Path, direction_rad: float, first: int, last: int) -> Straight:
    """Return a side; what is driven further than it is long was driven beside it, or to and fro."""
    length_m = max(float(path.along_m[last] - path.along_m[first]), 0.0)
    side_m = exact.magnitude(_between(path, first, last))
    strayed_m = max(driven_m(path, first, last) - side_m, 0.0)
    bend_rad = SAGITTA * _aside_m(path, first, last) / side_m if side_m > 0.0 else 0.0
    return Straight(first, last, direction_rad, bend_rad, length_m, strayed_m)


def _aside_m(path: Path, first: int, last: int) -> float:
    """Return how far the path strays from the line between two samples; to the less far side it counts half."""
    chord, between = _between(path, first, last), slice(first, last + 1)
    length_m = exact.magnitude(chord)
    along = chord / length_m if length_m > 0.0 else 1.0 + 0.0j
    aside_m = (path.y_m[between] - path.y_m[first]) * along.real - (
        path.x_m[between] - path.x_m[first]
    ) * along.imag
    return (float(np.max(np.abs(aside_m))) + float(np.ptp(aside_m))) / 2.0
