"""Where the sides of a path begin and end."""

import math

import numpy as np

from grader.geometry.path import Path
from grader.geometry.segmentation import Run, Segments, Turn


def span(path: Path, segments: Segments, index: int) -> tuple[int, int]:
    """Return the sample indices of the two vertices of run `index`."""
    run, before, after = segments.runs[index], segments.turns[index], segments.turns[index + 1]
    start = _start(path, run) if index == 0 or before is None else _vertex(path, before)
    return start, _end(path, run) if after is None else _vertex(path, after)


def chord(path: Path, start: int, stop: int) -> float:
    """Return the distance between two samples, in metres."""
    return math.hypot(float(path.x_m[stop] - path.x_m[start]), float(path.y_m[stop] - path.y_m[start]))


def _vertex(path: Path, turn: Turn) -> int:
    """Return the sample at which half of the turn is done."""
    travel = path.travel_rad[turn.first : turn.last + 1]
    return turn.first + int(np.argmin(np.abs(travel - (travel[0] + travel[-1]) / 2.0)))


def _start(path: Path, run: Run) -> int:
    """Return where the first side begins: of a correction there, where the car had backed up to."""
    return run.first + int(np.argmin(path.along_m[run.first : run.last + 1]))


def _end(path: Path, run: Run) -> int:
    """Return where the last side ends: of a correction there, where it came nearest to where the path began."""
    far = run.first + int(np.argmax(path.along_m[run.first : run.last + 1]))
    x_m, y_m = path.x_m[far : run.last + 1], path.y_m[far : run.last + 1]
    return far + int(np.argmin(np.hypot(x_m - path.x_m[0], y_m - path.y_m[0])))
