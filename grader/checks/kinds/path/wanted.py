"""The wanted path as a line in the plane: its pieces laid end to end, and the ways in which it may be driven."""

import cmath
import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np

from grader.contracts.assignment import PathPiece, WantedPath
from grader.contracts.record import PositionalRecord
from grader.geometry.matching import Floats, Points

SAMPLES = (
    160  # of a whole path: fine enough for a tenth of its smallest usual piece, and matched in milliseconds
)
CLOSED_SHARE = 0.02  # of the length: a path that ends this near to its start is a closed one
MIN_CORNER_RAD = math.radians(15.0)  # between two pieces; a smaller one is no corner
_FINE_DEG = 6.0  # between two points of an arc


class Stretch(PositionalRecord):
    """A piece that is driven along: a line or an arc.

    Attributes:
        kind: a ``goto`` is a line; a ``trace`` is what the solution drives.
        number: which of its kind it is, in the order driven, from 1.
        points: from its start to its end.
        length_m: along it.
        begins_rad, ends_rad: direction of travel at its ends.
        radius_m, angle_deg: of an arc; of a line 0.
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
        stretches: in the order driven.
        reversed: from the end to the start.
    """

    stretches: tuple[Stretch, ...]
    reversed: bool = False

    @property
    def length_m(self) -> float:
        """Of all stretches."""
        return sum(stretch.length_m for stretch in self.stretches)

    @property
    def shares(self) -> list[float]:
        """Where each stretch ends, as a share of the length."""
        ends = np.cumsum([stretch.length_m for stretch in self.stretches])
        return [float(end / ends[-1]) for end in ends]

    @cached_property
    def points(self) -> Points:
        """`SAMPLES` points along it at equal distances."""
        return sampled(np.array([point for stretch in self.stretches for point in stretch.points]))

    @property
    def has_corners(self) -> bool:
        """Whether the direction changes at once anywhere on the way."""
        pairs = itertools.pairwise(self.stretches)
        return any(abs(corner_rad(before, after)) >= MIN_CORNER_RAD for before, after in pairs)

    @property
    def turns_one_way(self) -> bool:
        """Whether it turns to one side alone, in its arcs and at its corners; not known of a trace."""
        corners = [corner_rad(before, after) for before, after in itertools.pairwise(self.stretches)]
        turns = [turn for turn in corners if abs(turn) >= MIN_CORNER_RAD]
        turns += [math.radians(each.angle_deg) for each in self.stretches if each.kind == "arc"]
        return bool(turns) and (min(turns) > 0.0 or max(turns) < 0.0)

    @property
    def is_closed(self) -> bool:
        """Whether it ends where it begins."""
        return (
            abs(self.stretches[-1].points[-1] - self.stretches[0].points[0]) <= CLOSED_SHARE * self.length_m
        )


def corner_rad(before: Stretch, after: Stretch) -> float:
    """Return the change of direction from one stretch to the next, positive to the left."""
    return math.remainder(after.begins_rad - before.ends_rad, math.tau)


def sampled(points: Points, count: int = SAMPLES) -> Points:
    """Return `count` points along a line of points at equal distances."""
    along: Floats = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(points)))))
    at = np.linspace(0.0, float(along[-1]), count)
    return np.interp(at, along, points.real) + 1j * np.interp(at, along, points.imag)


def size_m(points: Points) -> float:
    """Return the diagonal of the box around points: what distances are compared with."""
    return math.hypot(float(np.ptp(points.real)), float(np.ptp(points.imag)))


def track_of(wanted: WantedPath) -> Track | None:
    """Return the path as its pieces say, from the origin along the x axis; None where nothing is driven."""
    stretches = _numbered([_traced(wanted.trace)] if wanted.trace else list(_stretches(wanted.pieces)))
    return Track(stretches) if stretches else None


@lru_cache(maxsize=64)
def tracks(wanted: WantedPath) -> tuple[Track, ...]:
    """Return the ways in which the path may be driven: forth and back, and from each corner of a closed one."""
    given = track_of(wanted)
    if given is None:
        return ()
    ways = [given]
    # a closed path of left turns driven backwards is one of right turns: as wrong as its mirror image
    if wanted.any_direction and (wanted.mirror or not (given.is_closed and given.turns_one_way)):
        ways.append(reverse(given))
    if given.is_closed and wanted.any_start and wanted.any_direction:
        ways += [_from(way, first) for way in ways for first in range(1, len(way.stretches))]
    return tuple(ways)


def reverse(track: Track) -> Track:
    """Return a track driven from its end to its start."""
    turned = [
        replace(
            each,
            points=each.points[::-1],
            begins_rad=each.ends_rad + math.pi,
            ends_rad=each.begins_rad + math.pi,
            angle_deg=-each.angle_deg,
        )
        for each in reversed(track.stretches)
    ]
    return Track(_numbered(turned), reversed=True)


def _from(track: Track, first: int) -> Track:
    return Track(_numbered([*track.stretches[first:], *track.stretches[:first]]), track.reversed)


def _numbered(stretches: Sequence[Stretch]) -> tuple[Stretch, ...]:
    """Return the stretches numbered in the order driven, lines and arcs apart."""
    counts = {"line": 0, "arc": 0, "trace": 0}
    found = []
    for each in stretches:
        counts[each.kind] += 1
        found.append(replace(each, number=counts[each.kind]))
    return tuple(found)


def _traced(trace: Sequence[tuple[float, float]]) -> Stretch:
    points = tuple(complex(x, y) for x, y in trace)
    steps = [after - before for before, after in itertools.pairwise(points) if after != before]
    ends = [cmath.phase(step) for step in (*steps[:1], *steps[-1:])] or [0.0, 0.0]
    return Stretch("trace", 0, points, sum(map(abs, steps)), ends[0], ends[-1])


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
        # a car that backs up along a line faces away from where it goes
        heading_rad = heading_rad if piece.kind == "line" else stretch.ends_rad


def _line(here: complex, heading_rad: float, piece: PathPiece) -> Stretch | None:
    there = complex(piece.x_m, piece.y_m)
    if piece.kind == "line":
        there = here + cmath.rect(piece.length_m, heading_rad)
    if there == here:
        return None
    ahead_rad = cmath.phase(there - here)
    return Stretch("line", 0, (here, there), abs(there - here), ahead_rad, ahead_rad)


def _arc(here: complex, heading_rad: float, piece: PathPiece) -> Stretch:
    """Return an arc that begins at `here`; it bends to the left if its angle is positive."""
    angle_rad = math.radians(piece.angle_deg)
    centre = here + cmath.rect(piece.radius_m, heading_rad + math.copysign(math.pi / 2.0, angle_rad))
    angles = np.linspace(0.0, angle_rad, max(8, math.ceil(abs(piece.angle_deg) / _FINE_DEG)) + 1)
    points = tuple(centre + (here - centre) * cmath.exp(1j * angle) for angle in angles.tolist())
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
