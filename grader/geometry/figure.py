"""Measure the polygon that runs and turns make: which part is the first figure, its sides and corners."""

import itertools
import math

import numpy as np

from grader.contracts.record import positional_record
from grader.geometry.path import Path
from grader.geometry.segmentation import Segments, Turn

FULL_TURN_RAD = 2.0 * math.pi
MERGE_TOLERANCE = 0.2  # by how much the two halves of a side begun in its middle may miss a whole side
REPEAT_TOLERANCE = 0.15  # by how much a later side may differ when the figure is repeated
MIN_CLOSING_TURN_RAD = math.radians(10.0)
SPOT_SHARE = 0.05  # a turn that goes further than this share of the path's extent is no turn on the spot


@positional_record
class PolygonFigure:
    """The first figure of a path, complete or not.

    Attributes:
        vertices: sample indices: start of the first side, each corner, end of the last side.
        sides_m: length of each side, from vertex to vertex.
        corners_rad: signed change of direction at the end of each side; the last one only if it was driven
            to its end, and less whole turns on the spot.
        gap_m: distance from the end of the figure to its start.
        end: sample index where the figure ends, its closing turn included.
        curved_share: share of the distance travelled within corners instead of on straight sides.
        repeated: further sides follow that continue the figure over again.
        overrun: something else follows the complete figure.
    """

    vertices: tuple[int, ...]
    sides_m: tuple[float, ...]
    corners_rad: tuple[float, ...]
    gap_m: float
    end: int
    curved_share: float
    repeated: bool
    overrun: bool

    @property
    def perimeter_m(self) -> float:
        """Sum of the sides."""
        return sum(self.sides_m)


def measure_polygon(path: Path, segments: Segments, *, cut_short: bool) -> PolygonFigure | None:
    """Measure the first figure, or return None when there is not one straight run.

    Args:
        path: the driven path.
        segments: its runs and turns.
        cut_short: the car was still under way when the recording ended, so that the last segment says
            nothing about its intended size.
    """
    runs = segments.runs
    if not runs:
        return None
    corners = _corners(path, segments, cut_short=cut_short)
    lap = _lap(corners)
    count = len(runs)
    lengths = [_chord(path, *_span(path, segments, i)) for i in range(len(runs))]
    if lap is not None and count > lap:
        if _halves(lengths, lap):
            return _figure(path, segments, corners, count, joined=True)
        if cut_short or count % lap == 0 or count >= 2 * lap:
            count = lap
    figure = _figure(path, segments, corners, count, joined=False)
    later = lengths[count:]
    return figure if not later else _with_rest(figure, later, cut_short=cut_short)


def _corners(path: Path, segments: Segments, *, cut_short: bool) -> list[float]:
    """Return the change of direction after each run; the last run has one only if a whole turn follows."""
    runs, closing = segments.runs, segments.turns[-1]
    corners = [after.direction_rad - before.direction_rad for before, after in itertools.pairwise(runs)]
    if closing is None or cut_short:
        return corners
    corner = float(path.travel_rad[closing.last]) - runs[-1].direction_rad
    spun_before = any(abs(each) >= FULL_TURN_RAD for each in corners)  # then it is how the script turns
    if closing.length_m <= SPOT_SHARE * path.extent_m and not spun_before:
        corner = _closing(path, closing, corner, math.copysign(1.0, sum(corners)))
    return corners if abs(corner) < MIN_CLOSING_TURN_RAD else [*corners, corner]


def _closing(path: Path, turn: Turn, corner_rad: float, sense: float) -> float:
    """Return a closing turn on the spot less whole turns: the figure is complete before a last pirouette.

    One the other way round begins where the turn went furthest in the sense of the figure.
    """
    ahead_rad = sense * path.travel_rad[turn.first : turn.last + 1]
    spun_rad = sense * float(ahead_rad[-1] - np.max(ahead_rad))
    return _without_spins(corner_rad - spun_rad + _without_spins(spun_rad))


def _without_spins(angle_rad: float) -> float:
    """Return what whole turns leave of an angle."""
    spins = math.floor((abs(angle_rad) + MIN_CLOSING_TURN_RAD) / FULL_TURN_RAD)
    return angle_rad - math.copysign(spins * FULL_TURN_RAD, angle_rad)


def _lap(corners: list[float]) -> int | None:
    """Return after how many corners the direction has come round once, or None; spins at a corner aside."""
    total = 0.0
    for count, driven in enumerate(corners, start=1):
        corner = math.remainder(driven, FULL_TURN_RAD)
        total += corner
        if abs(total) >= FULL_TURN_RAD - 0.5 * abs(corner):
            return count
    return None


def _halves(lengths: list[float], lap: int) -> bool:
    """Whether the path begins in the middle of a side, which its last run completes."""
    if len(lengths) != lap + 1 or lap < 3:
        return False
    like = [float(np.median(lengths[1:-1]))]
    if lap % 2 == 0:
        like.append(lengths[lap // 2])  # a rectangle's side is as long as the one across
    first, last = lengths[0], lengths[-1]
    return any(
        abs(first + last - whole) <= MERGE_TOLERANCE * whole
        and max(first, last) < (1.0 - 0.5 * MERGE_TOLERANCE) * whole
        for whole in like
    )


def _vertex(path: Path, turn: Turn) -> int:
    """Return the sample at which half of the turn is done."""
    travel = path.travel_rad[turn.first : turn.last + 1]
    return turn.first + int(np.argmin(np.abs(travel - (travel[0] + travel[-1]) / 2.0)))


def _span(path: Path, segments: Segments, index: int) -> tuple[int, int]:
    """Return the sample indices of the two vertices of run `index`."""
    run, before, after = segments.runs[index], segments.turns[index], segments.turns[index + 1]
    start = run.first if index == 0 or before is None else _vertex(path, before)
    stop = run.last if after is None else _vertex(path, after)
    return start, stop


def _chord(path: Path, start: int, stop: int) -> float:
    return math.hypot(float(path.x_m[stop] - path.x_m[start]), float(path.y_m[stop] - path.y_m[start]))


def _figure(
    path: Path, segments: Segments, corners: list[float], count: int, *, joined: bool
) -> PolygonFigure:
    """Measure the first `count` runs; with `joined`, the last and the first are two parts of one side."""
    spans = [_span(path, segments, i) for i in range(count)]
    last = segments.runs[count - 1]
    closing = segments.turns[count] if len(corners) >= count else None
    end = last.last if closing is None else closing.last
    sides = [_chord(path, *span) for span in spans]
    vertices = [spans[0][0], *(stop for _, stop in spans)]
    gap_m = _chord(path, segments.runs[0].first, end)
    driven_m = float(path.along_m[end] - path.along_m[segments.runs[0].first])
    curved_m = sum(turn.length_m for turn in segments.turns[1:count] if turn is not None)
    if closing is not None:
        curved_m += closing.length_m
    if joined:
        sides = [sides[0] + sides[-1], *sides[1:-1]]
        corners = corners[: count - 1]
    return PolygonFigure(
        vertices=tuple(vertices),
        sides_m=tuple(sides),
        corners_rad=tuple(corners[:count]),
        gap_m=gap_m,
        end=end,
        curved_share=curved_m / driven_m if driven_m > 0.0 else 0.0,
        repeated=False,
        overrun=False,
    )


def _with_rest(figure: PolygonFigure, later: list[float], *, cut_short: bool) -> PolygonFigure:
    """Judge what follows the figure: the same over again, or something else."""
    before = list(itertools.islice(itertools.cycle(figure.sides_m), len(later)))
    whole = len(later) - 1 if cut_short else len(later)
    same = all(
        abs(length - side) <= REPEAT_TOLERANCE * side
        for length, side in zip(later[:whole], before[:whole], strict=True)
    )
    same = same and later[-1] <= (1.0 + REPEAT_TOLERANCE) * before[-1]
    return PolygonFigure(
        vertices=figure.vertices,
        sides_m=figure.sides_m,
        corners_rad=figure.corners_rad,
        gap_m=figure.gap_m,
        end=figure.end,
        curved_share=figure.curved_share,
        repeated=same,
        overrun=not same,
    )
