"""How well one path lies on another: the best similarity, a match in order, and the distance that it leaves.

Paths are complex arrays, x + iy. A similarity of the plane is then one complex factor and one offset, and the
least squares of S. Umeyama ("Least-squares estimation of transformation parameters between two point patterns",
IEEE PAMI 13(4), 1991) are a division. The match in order is dynamic time warping (H. Sakoe, S. Chiba, "Dynamic
programming algorithm optimization for spoken word recognition", IEEE ASSP 26(1), 1978), the largest distance the
discrete Frechet distance (T. Eiter, H. Mannila, "Computing discrete Frechet distance", TU Wien CD-TR 94/64, 1994).
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from grader.contracts.record import PositionalRecord

Points = NDArray[np.complex128]
Floats = NDArray[np.float64]


class Similarity(PositionalRecord):
    """The map ``z -> factor * z + offset``, after a reflection at the x axis if `mirrored`."""

    factor: complex = 1.0 + 0.0j
    offset: complex = 0.0j
    mirrored: bool = False

    def of(self, points: Points) -> Points:
        """Return where it maps `points`."""
        image: Points = self.factor * (np.conj(points) if self.mirrored else points) + self.offset
        return image

    @property
    def scale(self) -> float:
        """By how much it enlarges."""
        return abs(self.factor)


def fitted(points: Points, targets: Points, *, scaled: bool, mirrored: bool = False) -> Similarity:
    """Return the similarity that maps `points` nearest to `targets`, pair by pair, in the sense of least squares.

    Args:
        points: n >= 1 points.
        targets: what each of them is to come near to.
        scaled: whether it may enlarge; else it only turns and moves.
        mirrored: whether it reflects first.
    """
    points = np.conj(points) if mirrored else points
    middle, centre = complex(np.mean(points)), complex(np.mean(targets))
    product = complex(np.vdot(points - middle, targets - centre))
    if scaled:
        spread = float(np.vdot(points - middle, points - middle).real)
        factor = product / spread if spread > 0.0 else 1.0 + 0.0j
    else:
        factor = product / abs(product) if abs(product) > 0.0 else 1.0 + 0.0j
    return Similarity(factor, centre - factor * middle, mirrored)


def resampled(points: Points, along: Floats, at: Floats) -> Points:
    """Return a path's points at the distances `at` along it; `along` are those of `points`, not falling."""
    return np.interp(at, along, points.real) + 1j * np.interp(at, along, points.imag)


def matched(first: Points, second: Points) -> NDArray[np.intp]:
    """Return (k, 2) pairs of indices that match two paths in order, at the least sum of squared distances."""
    squares = np.abs(first[:, None] - second[None, :]) ** 2
    cost = _accumulated(squares, "sum")
    i, j = len(first) - 1, len(second) - 1
    pairs = [(i, j)]
    while i or j:
        steps = [(i - 1, j - 1)] if i and j else []
        steps += [(i - 1, j)] if i else []
        steps += [(i, j - 1)] if j else []
        i, j = min(steps, key=lambda step: float(cost[step]))
        pairs.append((i, j))
    return np.array(pairs[::-1], dtype=np.intp)


def frechet(first: Points, second: Points) -> float:
    """Return the discrete Frechet distance: how far apart two walkers get at most who walk both to their ends."""
    return float(_accumulated(np.abs(first[:, None] - second[None, :]), "largest")[-1, -1])


def _accumulated(cost: Floats, how: Literal["sum", "largest"]) -> Floats:
    """Return the least cost of the ways from the first cell to each, by diagonals: their cells are independent."""
    rows, columns = cost.shape
    total = np.full((rows + 1, columns + 1), np.inf)  # a border of infinity around the table
    total[0, 0] = 0.0
    for diagonal in range(rows + columns - 1):
        i = np.arange(max(0, diagonal - columns + 1), min(rows, diagonal + 1))
        j = diagonal - i
        before = np.minimum(np.minimum(total[i, j], total[i, j + 1]), total[i + 1, j])
        here = cost[i, j]
        total[i + 1, j + 1] = before + here if how == "sum" else np.maximum(before, here)
        if diagonal == 0:
            total[0, 0] = np.inf
    return total[1:, 1:]


class Circle(PositionalRecord):
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
    middle = complex(np.mean(points))
    x, y = (points - middle).real, (points - middle).imag
    table = np.column_stack((2.0 * x, 2.0 * y, np.ones_like(x)))
    (a, b, c), _, rank, _ = np.linalg.lstsq(table, x * x + y * y, rcond=1e-9)
    square = float(c + a * a + b * b)
    if rank < 3 or square <= 0.0:
        return None
    centre, radius_m = complex(a, b) + middle, square**0.5
    arms = points - centre
    steps = np.angle(arms[1:] * np.conj(arms[:-1]))
    deviation_m = float(np.max(np.abs(np.abs(arms) - radius_m)))
    return Circle(centre, radius_m, deviation_m, float(np.sum(steps)))
