"""Geometry of a driven path: pure numpy, no I/O.

`path` turns recorded poses into a driven path and cuts it into straights and turns, `figure` measures the polygon
they make.
"""

from collections.abc import Sequence


def median(values: Sequence[float]) -> float:
    """Return the middle one of at least one number, or the mean of the two in the middle.

    numpy's own imports `numpy.ma` when it is first called, which takes a cold grading 10 ms.
    """
    ordered, half = sorted(values), len(values) // 2
    return ordered[half] if len(ordered) % 2 else (ordered[half - 1] + ordered[half]) / 2.0
