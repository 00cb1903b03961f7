"""The polygon that an assignment asks for, and the one that a run drove."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from grader.checks.drive import Drive
from grader.checks.measure import Option
from grader.checks.scoring import band_error
from grader.contracts.assignment import Assignment
from grader.contracts.record import Record
from grader.contracts.trajectory import Floats
from grader.geometry import exact
from grader.geometry.coarse import coarse_looks, without_cuts
from grader.geometry.figure import (
    NEARLY_CLOSED_SHARE,
    REPEAT_TOLERANCE,
    PolygonFigure,
    alike,
    chord,
    readings,
)
from grader.geometry.path import Segments, bare, segment

FULL_TURN_DEG = 360.0
Bools = NDArray[np.bool_]
SAME_DEG = 4.0  # corners this close to the value of a known mistake count as that mistake
OTHER_GAP_SHARE = 0.1  # of the perimeter: a figure that ends this near to its start was meant as it is
UNFINISHED_SHARE = 0.8  # a last side below this was not driven to its end: then its length costs everything
EQUAL_RATIO = 1.2  # of the longest to the shortest side: halfway to the rectangle of 3 m by 2 m
ALIKE_RATIO = 1.02  # up to here they are equal
OBLONG_RATIO = 1.5  # from here on a rectangle is nothing of a square

# The shortest side of the longest: up to the first, a figure of other corners is the wanted one with its corners
# cut off, from the second on it is plainly another one.
CUT_SIDES, OTHER_SIDES = 0.25, 0.7
STRAIGHT_SHARE = 0.05  # of the way: with no more of it driven while turning, sides are straight

# Of the perimeter: by so much a complete figure must close better than a part of it to be what was meant: by the
# first nothing of it is, by the second all. A side of a dodecagon is 0.08.
BETTER_SHARE, MUCH_BETTER_SHARE = 0.04, 0.08

# Opposite sides that differ by more belong to no rectangle with a short side.
ALIKE_PCT = 12.0

LIKE_DEG = 1.0  # a last turn that is worse than the worst corner by no more than this was meant as a corner

# Of a corner: a smaller change of direction after the last side is nearer to none than to a corner. It is how the
# car came to rest, or how a script that steers came to its last goal.
NO_TURN_SHARE = 0.5


class WantedPolygon(Record, kw_only=False):
    """A polygon with equal corners.

    Attributes:
        lengths_m: length of each side, in the order in which they are driven; any side may come first, in either
            sense. None: equal sides of any length.
    """

    sides: int
    lengths_m: tuple[float, ...] | None = None

    @property
    def corner_deg(self) -> float:
        """Exterior angle."""
        return FULL_TURN_DEG / self.sides

    @property
    def differing(self) -> bool:
        """Whether its sides differ."""
        return self.lengths_m is not None and len(set(self.lengths_m)) > 1

    def aligned(self, sides_m: Sequence[float]) -> tuple[float, ...]:
        """Return the wanted length of each driven side, beginning at the side that fits them best.

        Reversing a pattern of two alternating lengths is the same as shifting it.
        """
        if self.lengths_m is None or not sides_m:
            return ()
        shifts = (self.lengths_m[i:] + self.lengths_m[:i] for i in range(self.sides))
        patterns = [tuple(itertools.islice(itertools.cycle(shift), len(sides_m))) for shift in shifts]
        return min(patterns, key=lambda pattern: _worst_pct(sides_m, pattern))

    def side_error_pct(self, sides_m: Sequence[float]) -> float:
        """Return the largest deviation of a driven side from its wanted length; NaN without either."""
        wanted = self.aligned(sides_m)
        return _worst_pct(sides_m, wanted) if wanted else math.nan

    def vertices(self, first_length_m: float | None = None) -> list[complex]:
        """Return the corners of the polygon, driven counter-clockwise from the origin.

        Args:
            first_length_m: wanted length of the first side where sides differ.
        """
        lengths = self.lengths_m or (1.0,) * self.sides
        if first_length_m is not None and first_length_m != lengths[0]:
            lengths = lengths[1:] + lengths[:1]
        corner_rad = math.radians(self.corner_deg)
        steps = (length * exact.rect(1.0, corner_rad * i) for i, length in enumerate(lengths))
        return list(itertools.accumulate(steps, initial=0j))[:-1]


def wanted_polygon(options: Mapping[str, Option]) -> WantedPolygon:
    """Return the polygon that a check's options ask for."""
    sides = int(options["sides"])
    if "side_m" not in options:
        return WantedPolygon(sides)
    first = float(options["side_m"])
    second = float(options.get("other_side_m", first))
    return WantedPolygon(sides, tuple(second if i % 2 else first for i in range(sides)))


def _worst_pct(sides_m: Sequence[float], wanted_m: Sequence[float]) -> float:
    return max(100.0 * abs(side - wanted) / wanted for side, wanted in zip(sides_m, wanted_m, strict=True))


@dataclass(frozen=True, slots=True, eq=False)
class DrivenPolygon:
    """A driven path, its straights and turns, and the first figure in it (None without a straight).

    Attributes:
        corners_deg: (n,) the figure's corners as they shape it, without whole turns, positive in the sense in
            which the figure turns. The turn after the last side is one of them if it is no further off than the
            others.
        turned_deg: (n,) what the car turned there: -270° shape a corner of 90°.
        sense: +1 if the figure turns left, else -1.
        turned_on: there was a turn after the last side that is not one of the corners.
        rival: how far it is a part, or laps, of another complete figure, from 0 to 1.
    """

    drive: Drive
    segments: Segments
    figure: PolygonFigure | None
    corners_deg: Floats
    turned_deg: Floats
    sense: float = 1.0
    turned_on: bool = False
    rival: float = 0.0

    def anotherness(self, wanted: WantedPolygon) -> float:
        """Return from 0 to 1 how plainly it is another number of straight sides, and not corners cut off."""
        figure = self.figure
        if figure is None or not 3 <= len(figure.sides_m) != wanted.sides:
            return 0.0
        sides = figure.sides_m
        straight = alike(figure.corners_rad) and figure.curved_share <= STRAIGHT_SHARE
        another = straight or self.otherness(wanted) >= 0.5
        return _from(min(sides) / max(sides), CUT_SIDES, OTHER_SIDES) if another else 0.0

    def is_on_the_whole(self, wanted: WantedPolygon) -> bool:
        """Whether it is a figure of as many sides as are wanted and of equal corners that closes, if roughly."""
        figure = self.figure
        if figure is None or len(figure.sides_m) != wanted.sides or max(figure.bows) >= 1.0:
            return False
        return alike(figure.corners_rad) and _open_share(self) <= NEARLY_CLOSED_SHARE

    def otherness(self, wanted: WantedPolygon) -> float:
        """Return from 0 to 1 how far a complete figure with equal corners was driven that is not the wanted one.

        It has another number of sides, equal sides where they should differ, or is a rectangle where a square is
        wanted.
        """
        figure, corners = self.figure, self.corners_deg
        if self.rival > 0.0 or figure is None or len(corners) == 0 or figure.perimeter_m <= 0.0:
            return self.rival
        sides, own_deg = figure.sides_m, FULL_TURN_DEG / len(figure.sides_m)
        apart_deg = abs(own_deg - wanted.corner_deg) or FULL_TURN_DEG
        complete = min(
            _fading(_open_share(self), OTHER_GAP_SHARE),
            _fading(abs(exact.mean(corners) - own_deg), min(SAME_DEG, apart_deg / 3.0)),
            _fading(float(np.ptp(corners)), 2.0 * SAME_DEG),
        )
        if len(sides) != wanted.sides:
            return complete
        if wanted.differing:
            return complete * (1.0 - _from(max(sides) / min(sides), ALIKE_RATIO, EQUAL_RATIO))
        return complete * _oblong(sides)

    def left_out(self, wanted: WantedPolygon, whole: float = UNFINISHED_SHARE) -> float:
        """Return which share of its last side a figure left out, against the shortest other of that length.

        Where the next side begins must not decide about all that needs the number of sides. A side that is driven
        to the share `whole` counts as one.
        """
        figure = self.figure
        if figure is None or figure.repeated or figure.overrun or not 1 < len(figure.sides_m) <= wanted.sides:
            return 0.0
        *others, last = figure.sides_m
        across = others[-2::-2] if wanted.differing else others
        differ = 1.0 if across or wanted.lengths_m is None else min(wanted.lengths_m) / max(wanted.lengths_m)
        done_m = whole * differ * min(across or others)
        return max(1.0 - last / done_m, 0.0) if done_m > 0.0 else 0.0

    def done_share(self, wanted: WantedPolygon) -> float:
        """Return how much of the wanted figure its sides are, such as 6 of 8; what follows it adds nothing."""
        count = 0.0 if self.figure is None else len(self.figure.sides_m) - self.left_out(wanted)
        return min(count / wanted.sides, 1.0)

    @property
    def drove_on_m(self) -> float:
        """How far the car drove on after the figure, which it did not repeat.

        Ctrl+C may have cut a further lap short; but none goes straight on for more than a side.
        """
        figure = self.figure
        if figure is None or not figure.overrun:
            return 0.0
        later = [one.length_m for one in self.segments.straights if one.last > figure.end]
        if self.drive.cut_short and max(later, default=0.0) <= (1.0 + REPEAT_TOLERANCE) * max(figure.sides_m):
            return 0.0
        return float(self.drive.path.along_m[-1] - self.drive.path.along_m[figure.end])

    @property
    def long_way(self) -> Bools:
        """Which corners were turned the long way round, or by a whole turn too much.

        The turn after the last side is none of them: it shapes nothing.
        """
        inner = 0 if self.figure is None else len(self.figure.corners_rad)
        far: Bools = np.abs(self.turned_deg[:inner] - self.corners_deg[:inner]) > FULL_TURN_DEG / 2.0
        return far


def _oblong(sides_m: Sequence[float]) -> float:
    """Return from 0 to 1 how far these are the sides of a rectangle that is no square."""
    if len(sides_m) != 4:
        return 0.0
    pairs = sides_m[0] + sides_m[2], sides_m[1] + sides_m[3]
    opposite = _fading(_worst_pct(sides_m[:2], sides_m[2:]), ALIKE_PCT)
    return opposite * _from(max(pairs) / min(pairs), EQUAL_RATIO, OBLONG_RATIO)


def _from(value: float, none: float, full: float) -> float:
    """Return how far `value` is from `none` to `full`, as a share between 0 and 1."""
    return min(max((value - none) / (full - none), 0.0), 1.0)


def _fading(value: float, full: float) -> float:
    """Return 1 up to `full`, and less from there on, down to 0 at twice that: no score may hang by a hair."""
    return 1.0 - _from(value, full, 2.0 * full)


def fine_readings(assignment: Assignment, wanted: WantedPolygon, drive: Drive) -> list[DrivenPolygon]:
    """Return the ways to read what was driven, straight by straight, as a figure."""
    segments = segment(drive.path)
    every = list(_readings(assignment, wanted, drive, segments))
    others = [one for one in every if one.figure is not None and len(one.figure.sides_m) != wanted.sides]
    rival = max(others, key=lambda one: one.otherness(wanted), default=None)
    if rival is None:
        return every
    return [replace(one, rival=_rivalled(one, rival, wanted)) for one in every]


def _rivalled(one: DrivenPolygon, rival: DrivenPolygon, wanted: WantedPolygon) -> float:
    """Return how far a figure is a part, or laps, of another one, which is complete, from 0 to 1.

    One of as many sides as are wanted is not where the script drove so many in all, or whole laps of so many that
    nearly close, or where it closes nearly as well as the other one.
    """
    figure, other = one.figure, rival.figure
    if figure is None or other is None:
        return 0.0
    total = len(one.segments.straights)
    if len(figure.sides_m) != wanted.sides:
        return rival.otherness(wanted)
    if total == wanted.sides:
        return 0.0
    laps = not one.drive.cut_short and total % wanted.sides == 0 < total % len(other.sides_m)
    if laps and _open_share(one) <= NEARLY_CLOSED_SHARE:
        return 0.0
    joined = len(figure.vertices) > len(figure.sides_m) + 1
    better_share = 1.0 if joined else _open_share(one) - _open_share(rival)
    return rival.otherness(wanted) * _from(better_share, BETTER_SHARE, MUCH_BETTER_SHARE)


def _open_share(one: DrivenPolygon) -> float:
    """Return by which share of its perimeter a figure itself misses to come back to its start."""
    figure = one.figure
    if figure is None or figure.perimeter_m <= 0.0:
        return math.inf
    return chord(one.drive.path, figure.vertices[0], figure.vertices[-1]) / figure.perimeter_m


def coarse_readings(
    assignment: Assignment, wanted: WantedPolygon, drive: Drive, another: float
) -> Iterator[DrivenPolygon]:
    """Yield the figures of as many sides as are wanted that the path draws on the whole.

    `another`: how plainly its straights are the sides of another figure.
    """
    looks = itertools.chain([without_cuts(segment(drive.path))], coarse_looks(drive.path))
    for one in itertools.chain.from_iterable(_readings(assignment, wanted, drive, look) for look in looks):
        if one.is_on_the_whole(wanted):
            yield replace(one, rival=max(one.rival, another))


def _readings(
    assignment: Assignment, wanted: WantedPolygon, drive: Drive, segments: Segments
) -> Iterator[DrivenPolygon]:
    for figure in readings(drive.path, segments, sides=wanted.sides, cut_short=drive.cut_short):
        yield _polygon_of(assignment, wanted, drive, segments, figure)
    if not segments.straights:
        yield DrivenPolygon(drive, segments, None, np.empty(0), np.empty(0))


def _polygon_of(
    assignment: Assignment, wanted: WantedPolygon, drive: Drive, segments: Segments, figure: PolygonFigure
) -> DrivenPolygon:
    sense = -1.0 if exact.total(map(bare, figure.corners_rad)) < 0.0 else 1.0
    turned = sense * np.degrees(figure.corners_rad)
    corners = sense * np.degrees([bare(corner) for corner in figure.corners_rad])
    last_deg = sense * math.degrees(figure.last_turn_rad)
    if abs(last_deg) <= NO_TURN_SHARE * wanted.corner_deg:
        return DrivenPolygon(drive, segments, figure, corners, turned, sense)
    worse_deg = _worse_deg(assignment, last_deg, corners)
    if worse_deg <= 0.0:
        corners, turned = np.append(corners, last_deg), np.append(turned, _last_turned_deg(figure, sense))
    turned_on = worse_deg > LIKE_DEG and not figure.overrun
    return DrivenPolygon(drive, segments, figure, corners, turned, sense, turned_on)


def _last_turned_deg(figure: PolygonFigure, sense: float) -> float:
    """Return the last turn as the car turned it; whole turns on top of it are a flourish, not a corner."""
    turned_deg = sense * math.degrees(figure.last_turned_rad)
    return turned_deg if abs(turned_deg) < FULL_TURN_DEG else sense * math.degrees(figure.last_turn_rad)


def _worse_deg(assignment: Assignment, last_deg: float, corners_deg: Floats) -> float:
    """Return by how much the turn after the last side is further off than any corner."""
    spec = assignment.item_on("corner_deg")
    if spec is None:
        return 0.0
    return band_error(spec, last_deg) - max(band_error(spec, corner) for corner in corners_deg.tolist())
