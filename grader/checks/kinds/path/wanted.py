"""The wanted path as a line in the plane: its pieces end to end, and the ways in which it may be driven."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np

from grader.contracts.assignment import PathPiece, WantedPath
from grader.contracts.record import Record
from grader.geometry import exact
from grader.geometry.matching import Floats, Points, resampled

# Points of a whole path: they resolve a tenth of its smallest usual piece. Matching them takes milliseconds,
# and grows with the square of their number.
SAMPLES = 160
CLOSED_SHARE = 0.02  # of the length: a path that ends this near to its start is closed
MIN_CORNER_RAD = math.radians(15.0)  # a smaller change of direction between two pieces is no corner
_ARC_STEP_DEG = 6.0  # between two points of an arc; the chord is off by 0.14 % of the radius
_MIN_ARC_STEPS = 8
_CIRCLE_DEG = 360.0


class Stretch(Record, kw_only=False):
    """A piece that is driven along: a line, an arc or a trace.

    Attributes:
        kind: a piece ``goto`` becomes a line; a ``trace`` is the path that the solution drives.
        number: its number among those of its kind, in the order driven, from 1.
        points: from its start to its end.
        length_m: the length along it.
        begins_rad, ends_rad: the direction of travel at its ends.
        radius_m, angle_deg: of an arc, otherwise 0.
    """

    kind: Literal["line", "arc", "trace"]
    number: int
    points: tuple[complex, ...]
    length_m: float
    begins_rad: float
    ends_rad: float
    radius_m: float = 0.0
    angle_deg: float = 0.0


@dataclass(frozen=True, eq=False)
class Track:
    """One way to drive the wanted path.

    Attributes:
        stretches: its pieces, in the order driven.
        reversed: it is driven from the end of the wanted path to its start.
    """

    stretches: tuple[Stretch, ...]
    reversed: bool = False

    @property
    def length_m(self) -> float:
        """The length of all stretches together."""
        return exact.total(stretch.length_m for stretch in self.stretches)

    @property
    def shares(self) -> list[float]:
        """The share of the length at which each stretch ends."""
        ends = np.cumsum([stretch.length_m for stretch in self.stretches])
        return [float(end / ends[-1]) for end in ends]

    @cached_property
    def points(self) -> Points:
        """`SAMPLES` points along it at equal distances."""
        return sampled(np.array([point for stretch in self.stretches for point in stretch.points]))

    @property
    def has_corners(self) -> bool:
        """Whether the direction jumps between any two stretches."""
        pairs = itertools.pairwise(self.stretches)
        return any(abs(corner_rad(before, after)) >= MIN_CORNER_RAD for before, after in pairs)

    @property
    def turns_one_way(self) -> bool:
        """Whether all its arcs and corners turn to the same side; False for a trace, whose turns are not known."""
        corners = [corner_rad(before, after) for before, after in itertools.pairwise(self.stretches)]
        turns = [turn for turn in corners if abs(turn) >= MIN_CORNER_RAD]
        turns += [math.radians(stretch.angle_deg) for stretch in self.stretches if stretch.kind == "arc"]
        return bool(turns) and (min(turns) > 0.0 or max(turns) < 0.0)

    @property
    def is_closed(self) -> bool:
        """Whether it ends where it begins."""
        return (
            exact.magnitude(self.stretches[-1].points[-1] - self.stretches[0].points[0])
            <= CLOSED_SHARE * self.length_m
        )


def corner_rad(before: Stretch, after: Stretch) -> float:
    """Return the change of direction from one stretch to the next, positive to the left."""
    return math.remainder(after.begins_rad - before.ends_rad, math.tau)


def go_on(before: Stretch, after: Stretch) -> bool:
    """Whether one arc goes on as another one, without a corner: their circles touch there."""
    return before.kind == after.kind == "arc" and abs(corner_rad(before, after)) < MIN_CORNER_RAD


def sampled(points: Points) -> Points:
    """Return `SAMPLES` points along a line of points at equal distances."""
    along: Floats = np.concatenate(([0.0], np.cumsum(exact.magnitudes(np.diff(points)))))
    at = np.linspace(0.0, float(along[-1]), SAMPLES)
    return resampled(points, along, at)


def size_m(points: Points) -> float:
    """Return the diagonal of the box around points; distances are given as shares of it."""
    return exact.hypot(float(np.ptp(points.real)), float(np.ptp(points.imag)))


def track_of(wanted: WantedPath) -> Track | None:
    """Return the path that begins at the origin, along the x axis; None where nothing is driven."""
    stretches = _numbered([_traced(wanted.trace)] if wanted.trace else list(_stretches(wanted.pieces)))
    return Track(stretches) if stretches else None


@lru_cache(maxsize=64)  # `mistakes` asks for four variants of each path, and for each several times
def tracks(wanted: WantedPath) -> tuple[Track, ...]:
    """Return the ways in which the path may be driven: forth and back; a closed one from each end of a piece.

    A closed one with a whole circle may also begin half way round it, as an eight does that begins at its top.
    """
    given = track_of(wanted)
    if given is None:
        return ()
    ways = [given]
    # Driven backwards, a closed path of left turns is one of right turns, which is as wrong as its mirror image.
    if wanted.any_direction and (wanted.mirror or not (given.is_closed and given.turns_one_way)):
        ways.append(reverse(given))
    if given.is_closed and wanted.any_start and wanted.any_direction:
        ways += [
            begun for way in ways for first in range(len(way.stretches)) for begun in _begun_near(way, first)
        ]
    return tuple(ways)


def reverse(track: Track) -> Track:
    """Return a track driven from its end to its start."""
    turned = [
        replace(
            stretch,
            points=stretch.points[::-1],
            begins_rad=stretch.ends_rad + math.pi,
            ends_rad=stretch.begins_rad + math.pi,
            angle_deg=-stretch.angle_deg,
        )
        for stretch in reversed(track.stretches)
    ]
    return Track(_numbered(turned), reversed=True)


def _begun_near(track: Track, first: int) -> Iterator[Track]:
    """Yield a closed track driven from the start of its stretch `first` on, and from the middle of a circle."""
    there = track.stretches[first]
    if first > 0:
        yield Track(_numbered([*track.stretches[first:], *track.stretches[:first]]), track.reversed)
    if len(track.stretches) > 1 and abs(there.angle_deg) == _CIRCLE_DEG:
        before, after = _halves(there)
        later = [*track.stretches[first + 1 :], *track.stretches[:first]]
        yield Track(_numbered([after, *later, before]), track.reversed)


def _halves(arc: Stretch) -> tuple[Stretch, Stretch]:
    """Return the two halves of an arc."""
    middle = len(arc.points) // 2
    half = replace(arc, length_m=arc.length_m / 2.0, angle_deg=arc.angle_deg / 2.0)
    turned_rad = arc.begins_rad + math.radians(half.angle_deg)
    return (
        replace(half, points=arc.points[: middle + 1], ends_rad=turned_rad),
        replace(half, points=arc.points[middle:], begins_rad=turned_rad),
    )


def _numbered(stretches: Sequence[Stretch]) -> tuple[Stretch, ...]:
    """Return the stretches numbered in the order driven, each kind by itself."""
    counts = {"line": 0, "arc": 0, "trace": 0}
    found = []
    for stretch in stretches:
        counts[stretch.kind] += 1
        found.append(replace(stretch, number=counts[stretch.kind]))
    return tuple(found)


def _traced(trace: Sequence[tuple[float, float]]) -> Stretch:
    points = tuple(complex(x, y) for x, y in trace)
    steps = [after - before for before, after in itertools.pairwise(points) if after != before]
    ends = [exact.phase(step) for step in (*steps[:1], *steps[-1:])] or [0.0, 0.0]
    return Stretch("trace", 0, points, exact.total(map(exact.magnitude, steps)), ends[0], ends[-1])


def _stretches(pieces: Sequence[PathPiece]) -> Iterator[Stretch]:
    here, heading_rad = 0j, 0.0
    for piece in pieces:
        if piece.kind == "turn":
            heading_rad += math.radians(piece.angle_deg)
            continue
        stretch = _arc(here, heading_rad, piece) if piece.kind == "arc" else _line(here, heading_rad, piece)
        if stretch is None:
            continue
        yield stretch
        here = stretch.points[-1]
        # A line of negative length is driven backing up: the car still faces as before, not along the stretch.
        heading_rad = heading_rad if piece.kind == "line" else stretch.ends_rad


def _line(here: complex, heading_rad: float, piece: PathPiece) -> Stretch | None:
    there = complex(piece.x_m, piece.y_m)
    if piece.kind == "line":
        there = here + exact.rect(piece.length_m, heading_rad)
    if there == here:
        return None
    ahead_rad = exact.phase(there - here)
    return Stretch("line", 0, (here, there), exact.magnitude(there - here), ahead_rad, ahead_rad)


def _arc(here: complex, heading_rad: float, piece: PathPiece) -> Stretch:
    """Return an arc that begins at `here`; it bends to the left if its angle is positive."""
    angle_rad = math.radians(piece.angle_deg)
    centre = here + exact.rect(piece.radius_m, heading_rad + math.copysign(math.pi / 2.0, angle_rad))
    angles = np.linspace(
        0.0, angle_rad, max(_MIN_ARC_STEPS, math.ceil(abs(piece.angle_deg) / _ARC_STEP_DEG)) + 1
    )
    points = tuple(centre + (here - centre) * exact.rect(1.0, angle) for angle in angles.tolist())
    return Stretch(
        "arc",
        0,
        points,
        piece.radius_m * abs(angle_rad),
        heading_rad,
        heading_rad + angle_rad,
        piece.radius_m,
        piece.angle_deg,
    )
