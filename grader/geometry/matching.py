"""How well one path lies on another: the best similarity, a match in order, and the distance that it leaves.

Paths are complex arrays, x + iy. A similarity of the plane is then one complex factor and one offset, and the
least squares of S. Umeyama ("Least-squares estimation of transformation parameters between two point patterns",
IEEE PAMI 13(4), 1991) are a division. The match in order is dynamic time warping (H. Sakoe, S. Chiba, "Dynamic
programming algorithm optimization for spoken word recognition", IEEE ASSP 26(1), 1978), the largest distance the
discrete Frechet distance (T. Eiter, H. Mannila, "Computing discrete Frechet distance", TU Wien CD-TR 94/64, 1994).
"""

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from grader.contracts.record import Record
from grader.geometry import exact

Floats = exact.Floats
Points = exact.Points

ON_A_LINE = 1e-12  # of the squared spread: a circle of a thousand times the length of the arc is none


class Similarity(Record, kw_only=False):
    """The map ``z -> factor * z + offset``, after a reflection at the x axis if `mirrored`."""

    factor: complex = 1.0 + 0.0j
    offset: complex = 0.0j
    mirrored: bool = False

    def of(self, points: Points) -> Points:
        """Return where it maps `points`."""
        return exact.turned(np.conj(points) if self.mirrored else points, self.factor) + self.offset

    @property
    def scale(self) -> float:
        """By how much it enlarges."""
        return exact.magnitude(self.factor)


def fitted(points: Points, targets: Points, *, scaled: bool, mirrored: bool = False) -> Similarity:
    """Return the similarity that maps `points` nearest to `targets`, pair by pair, in the sense of least squares.

    `scaled`: it may enlarge; else it only turns and moves. `mirrored`: it reflects first.
    """
    points = np.conj(points) if mirrored else points
    middle, centre = exact.middle(points), exact.middle(targets)
    product = exact.correlation(points - middle, targets - centre)
    if scaled:
        spread = exact.correlation(points - middle, points - middle).real
        factor = product / spread if spread > 0.0 else 1.0 + 0.0j
    else:
        length = exact.magnitude(product)
        factor = product / length if length > 0.0 else 1.0 + 0.0j
    return Similarity(factor, centre - factor * middle, mirrored)


def resampled(points: Points, along: Floats, at: Floats) -> Points:
    """Return a path's points at the distances `at` along it; `along` are those of `points`, not falling."""
    return exact.paired(
        exact.interpolated(at, along, points.real), exact.interpolated(at, along, points.imag)
    )


def matched(first: Points, second: Points) -> NDArray[np.intp]:
    """Return (k, 2) pairs of indices that match two paths in order, at the least sum of squared distances."""
    return matched_each(first[None, :], second[None, :])[0]


def matched_each(first: Points, second: Points) -> list[NDArray[np.intp]]:
    """Return what `matched` says of each row of (b, n) and (b, m) points; all at once is many times faster."""
    between = first[:, :, None] - second[:, None, :]
    squares = between.real * between.real + between.imag * between.imag
    ways = _ways_back(_accumulated(squares, "sum"))
    return [_walked_back(way, first.shape[1], second.shape[1]) for way in ways]


def frechet(first: Points, second: Points) -> float:
    """Return the discrete Frechet distance: how far apart two walkers get at most who walk both to their ends."""
    apart = exact.magnitudes(first[:, None] - second[None, :])[None]
    return float(_accumulated(apart, "largest")[-1, 0, -1])


def _accumulated(cost: Floats, how: Literal["sum", "largest"]) -> Floats:
    """Return the least cost of the ways from the first cell to each, by diagonals: their cells are independent.

    Args:
        cost: (b, rows, columns) of b tables.
        how: what a way costs: its cells together, or the dearest of them.

    Returns:
        (rows + columns + 1, b, rows + 1): the cell (i, j) of table k stands at [i + j + 2, k, i + 1]; around the
        tables is infinity.
    """
    slanted = _slanted(cost)
    total = np.full((len(slanted) + 2, cost.shape[0], cost.shape[1] + 1), np.inf)
    total[2, :, 1:] = slanted[0]
    before = np.empty(cost.shape[:2])
    join = np.add if how == "sum" else np.maximum
    for diagonal in range(1, len(slanted)):
        last = total[diagonal + 1]
        np.minimum(total[diagonal, :, :-1], last[:, 1:], out=before)
        np.minimum(before, last[:, :-1], out=before)
        join(before, slanted[diagonal], out=total[diagonal + 2, :, 1:])
    return total


def _slanted(cost: Floats) -> Floats:
    """Return tables by diagonals: [i + j, k, i] is the cell (i, j) of table k; infinity where there is none."""
    tables, rows, columns = cost.shape
    wide = np.full((tables, rows, rows + columns), np.inf)
    wide[:, :, :columns] = cost
    shifted = wide.reshape(tables, -1)[:, :-rows].reshape(tables, rows, rows + columns - 1)
    return np.ascontiguousarray(shifted.transpose(2, 0, 1))


def _ways_back(total: Floats) -> list[bytes]:
    """Return for each table, cell by cell as in `total`, from where the cheapest way to it comes.

    That is 0 from before in both paths, 1 in the first, 2 in the second; of equal ones the first.
    """
    both, first, second = total[:-2, :, :-1], total[1:-1, :, :-1], total[1:-1, :, 1:]
    code = np.where((both <= first) & (both <= second), 0, np.where(first <= second, 1, 2)).astype(np.uint8)
    return [np.ascontiguousarray(code[:, k]).tobytes() for k in range(total.shape[1])]


def _walked_back(way: bytes, rows: int, columns: int) -> NDArray[np.intp]:
    """Return the cells of the cheapest way, from the first to the last."""
    i, j = rows - 1, columns - 1
    pairs = [(i, j)]
    while i or j:
        step = way[(i + j) * rows + i]
        i, j = i - (step != 2), j - (step != 1)
        pairs.append((i, j))
    return np.array(pairs[::-1], dtype=np.intp)


class Circle(Record, kw_only=False):
    """A circle through points.

    Attributes:
        deviation_m: the largest distance of a point from it.
        swept_rad: by how much the points go round its centre, positive to the left.
    """

    centre: complex
    radius_m: float
    deviation_m: float
    swept_rad: float


def circle_through(points: Points) -> Circle | None:
    """Return the circle of least squares through n >= 3 points, or None where they lie on a line.

    The algebraic fit of I. Kasa ("A circle fitting procedure and its error analysis", IEEE IM 25(1), 1976).
    """
    if len(points) < 3:
        return None
    middle = exact.middle(points)
    x, y = exact.coordinates(points - middle)
    square: Floats = x * x + y * y
    xx, xy, yy = exact.products(x, x), exact.products(x, y), exact.products(y, y)
    across = xx * yy - xy * xy  # the points lie on a line where this is nothing beside the squares
    if across <= ON_A_LINE * (xx + yy) * (xx + yy):
        return None
    along, up = 0.5 * exact.products(x, square), 0.5 * exact.products(y, square)
    centre = complex((along * yy - up * xy) / across, (up * xx - along * xy) / across)
    radius_m = math.sqrt(exact.mean(square) + centre.real * centre.real + centre.imag * centre.imag)
    arms = points - middle - centre
    ahead, aside = exact.coordinates(arms)
    sines = np.asarray(ahead[:-1] * aside[1:] - aside[:-1] * ahead[1:], dtype=np.float64)
    cosines = np.asarray(ahead[:-1] * ahead[1:] + aside[:-1] * aside[1:], dtype=np.float64)
    steps = exact.atan2(sines, cosines)
    deviation_m = float(np.max(np.abs(exact.magnitudes(arms) - radius_m)))
    return Circle(middle + centre, radius_m, deviation_m, exact.total(steps))
