"""A coarser look at a driven path: the polygon that it draws, where a fine look finds more or fewer sides.

A fine look (`grader.geometry.path.segment`) takes a corner that is cut off by a short straight for two corners, a
side with a kink for three sides, and one that bends to and fro for none, all from some size on. Whoever sees the
drawing sees the same figure, driven less well. So what cuts a corner off is taken for a part of it. And the path
is simplified in the plane, where a side that strays counts as bent, like an arc that strays as far.
"""

import itertools
import math
from collections.abc import Iterator

import numpy as np

from grader.geometry import exact
from grader.geometry.path import (
    Path,
    Segments,
    Straight,
    Turn,
    arc_rad,
    aside_m,
    beside_m,
    driven_m,
    simplified,
)

TOLERANCES = (0.02, 0.04, 0.08, 0.15)  # of a path's extent: what is simplified away

# With both ends of the path: of a triangle; of seven laps of an octagon. It bounds the time that a circle takes.
LEAST_CORNERS, MOST_CORNERS = 4, 60

ROUNDS = 3  # in which vertices are left out and moved: further ones change hardly anything

# Of the longest side: a shorter straight between two turns may cut a corner off.
CUT_SHARE = 0.7

# Points of a side that say which way it was driven; its share left out at both ends, where the car turns.
LOOKED_AT, END_SHARE = 20, 0.25


def without_cuts(segments: Segments) -> Segments:
    """Return the straights of a fine look without those that cut a corner off: they are a part of its turn.

    The first straight stays: it may be the last part of a side.
    """
    longest_m = max((straight.length_m for straight in segments.straights), default=0.0)
    straights: list[Straight] = []
    turns = [segments.turns[0]]
    for straight, after in zip(segments.straights, segments.turns[1:], strict=True):
        before = turns[-1]
        if (
            not (straights and before and after)
            or straight.length_m >= CUT_SHARE * longest_m
            or before.angle_rad * after.angle_rad < 0.0
            or abs(before.angle_rad + after.angle_rad) >= math.pi
        ):
            straights.append(straight)
            turns.append(after)
            continue
        length_m = before.length_m + straight.length_m + after.length_m
        turns[-1] = Turn(before.first, after.last, before.angle_rad + after.angle_rad, length_m)
    return Segments(tuple(straights), tuple(turns))


def coarse_looks(path: Path) -> Iterator[Segments]:
    """Cut `path` into straights and the corners between them, where it goes furthest out, with each tolerance.

    There is no turn after the last straight. A path that has hardly any corner, or more than a figure that one can
    see, is not cut.
    """
    seen: list[list[int]] = []
    for tolerance in TOLERANCES:
        width_m = tolerance * path.extent_m
        corners = simplified(path.x_m / width_m, path.y_m / width_m, MOST_CORNERS + 1)
        if len(corners) <= MOST_CORNERS:
            for _ in range(ROUNDS):
                corners = _sharpened(path, _plain_corners(path, corners, width_m))
        if LEAST_CORNERS <= len(corners) <= MOST_CORNERS and corners not in seen:
            seen.append(corners)
            yield _cut(path, corners)


def _cut(path: Path, corners: list[int]) -> Segments:
    straights = tuple(_straight(path, *ends) for ends in itertools.pairwise(corners))
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
        while len(kept) > 2 and aside_m(path, kept[-3], corner) < width_m:
            del kept[-2]
    return kept


def _sharpened(path: Path, corners: list[int]) -> list[int]:
    """Return the vertices, each where the path goes furthest out between the two beside it."""
    moved = list(corners)
    for i in range(1, len(moved) - 1):
        moved[i] = moved[i - 1] + int(np.argmax(np.abs(beside_m(path, moved[i - 1], moved[i + 1]))))
    return moved


def _between(path: Path, first: int, last: int) -> complex:
    return complex(path.x_m[last] - path.x_m[first], path.y_m[last] - path.y_m[first])


def _direction_rad(path: Path, first: int, last: int) -> float:
    """Return the direction of a side, which has two, as it was driven on the whole."""
    along = np.maximum.accumulate(path.along_m[first : last + 1])
    at = float(along[0]) + float(along[-1] - along[0]) * np.linspace(END_SHARE, 1.0 - END_SHARE, LOOKED_AT)
    mean_rad = exact.mean(exact.interpolated(at, along, path.travel_rad[first : last + 1]))
    line_rad = exact.phase(_between(path, first, last))
    return line_rad + math.pi * round((mean_rad - line_rad) / math.pi)


def _straight(path: Path, first: int, last: int) -> Straight:
    """Return a side; what is driven further than it is long was driven beside it, or to and fro."""
    length_m = max(float(path.along_m[last] - path.along_m[first]), 0.0)
    side_m = exact.magnitude(_between(path, first, last))
    strayed_m = max(driven_m(path, first, last) - side_m, 0.0)
    bend_rad = arc_rad(path, first, last)
    return Straight(first, last, _direction_rad(path, first, last), bend_rad, length_m, strayed_m)
