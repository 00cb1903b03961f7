"""Measure the polygon that straights and turns make: which part is the first figure, its sides and corners.

Scripts drive an approach first, repeat the figure, begin in the middle of a side, or drive on afterwards. The
wanted number of sides must decide as little as possible here: a square driven for a triangle has to be measured
as a square. Only direction, closing and likeness tell what belongs to the figure.

All tolerances are shares of the path's own size or angles, so that small and large figures are measured alike.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from grader.contracts.record import Record
from grader.geometry import exact
from grader.geometry.path import (
    ARC_SHARE,
    FULL_TURN_RAD,
    MIN_TURN_RAD,
    SETTLING_SHARE,
    STILL_M,
    STILL_RAD,
    Path,
    Segments,
    Straight,
    Turn,
    bare,
    median,
)

# The shipped rubrics give full credit to sides that differ by 4 %, a gap of 4 % of the perimeter and corners
# within 3°, and nothing beyond 20 %, 16 % and 15°. Up to the first, a motion is what was meant; beyond the
# second, it is worth nothing whatever it is taken for. The tolerances stand at these edges, so that a motion
# that earns something is never taken for another one.
CLOSED_SHARE = 0.04  # of the perimeter: a figure whose end is this near to its start has closed
SAME_SHARE = 0.04  # by how much a side too many may differ from the first side
MERGE_TOLERANCE = 0.2  # by how much the two halves of a side begun in its middle may miss a whole side

# Of the perimeter: a wider gap says nothing about what was meant. At 8 %, the approach to a figure with one
# corner off would be taken for a side.
NEARLY_CLOSED_SHARE = 0.16

BETTER_SHARE = 0.02  # of the perimeter: by so much a later figure must close better than one before it

# By how much the corners of a figure with equal corners may differ. At 7.5°, the first of several laps that do
# not quite close would be taken for an approach.
ALIKE_RAD = math.radians(15.0)

# Of a corner: by how much the corners of the wanted number of sides may miss a full turn. One corner off, it is
# exactly the next number of sides.
LAP_TOLERANCE = 0.9

REPEAT_TOLERANCE = 0.15  # by how much a side of a later lap may differ: on a slipping car laps drift apart
# Of the difference between their sides: so near to its start begins a larger or smaller lap. In a
# spiral, whose laps grow without a corner in common, that is about 0.7.
MOVED_SHARE = 0.3

# A turn between two laps that is off by more was no attempt at the corner: the next lap lies elsewhere, and the
# first is judged. Up to here the corner costs less than that does.
APART_RAD = math.radians(9.0)
SPOT_SHARE = 0.05  # a turn that goes further than this share of the path's extent is no turn on the spot
# Of the distance travelled along a side: so much may be driven beside its line (`Straight.strayed_m`) before it
# counts as less than one side, and from the second on it counts as none.
STRAYED_SHARE, LOST_SHARE = 0.1, 0.5
# From the first bend on a part of a side counts as driven while turning, from the second on all of it.
BENT_RAD, ROUND_RAD = math.radians(10.0), math.radians(30.0)
# Of a side from corner to corner: with less than the first driven straight it counts as less than one side, with
# the second as none, because the figure is nearly a circle.
LEVEL_SHARE, ROUND_SHARE = 0.45, 0.27
# How much the distance driven in a turn counts against the angle, to find its middle. More would move the middle
# of an arc that is driven unevenly; any less decides where the angle does not change.
CUT_OFF_COUNTS = 0.02
MAX_APPROACH_STRAIGHTS = 3  # to one of its sides, perhaps round something, and along that to a corner


class PolygonFigure(Record, kw_only=False):
    """The first figure of a path, complete or not.

    Attributes:
        vertices: sample indices: start of the first side, each corner, end of the last side.
        sides_m: length of each side, from vertex to vertex.
        corners_rad: signed change of direction at the end of each side. The last side has one only where the
            figure needs it: it is repeated, or does not come round without it, and that turn is not much wider.
        last_turn_rad: the turn after the last side where it is no corner, without whole turns on the spot;
            0 if there was none.
        last_turned_rad: that turn with them.
        approach_m: distance driven before the first side.
        start: sample index where the first straight begins, which may be an approach.
        end: sample index where the figure ends, its last turn included.
        rest: sample index where the car came to rest: `end` unless it drove on.
        gap_m: distance from `start` to `rest`.
        curved_share: share of the distance that was travelled in corners, on bent sides or off the sides.
        strayed_share: share of the distance that was travelled off the sides.
        bows: of each side 0 where it is about straight, up to 1 where it bends so much as to be taken for a turn,
            or is lost among detours.
        repeated: further sides follow that continue the figure over again.
        overrun: something else follows the complete figure.
        apart: what follows is the same figure, but turned.
    """

    vertices: tuple[int, ...]
    sides_m: tuple[float, ...]
    corners_rad: tuple[float, ...]
    last_turn_rad: float
    last_turned_rad: float
    approach_m: float
    start: int
    end: int
    rest: int
    gap_m: float
    curved_share: float
    strayed_share: float
    bows: tuple[float, ...]
    repeated: bool
    overrun: bool
    apart: bool = False

    @property
    def perimeter_m(self) -> float:
        """Sum of the sides."""
        return exact.total(self.sides_m)


class _Extent(Record, kw_only=False):
    """Which straights make the figure, and how those that follow relate to it.

    Attributes:
        joined: the last and the first straight are two parts of one side.
        inside: the path began in the middle of what is now the last side.
        retraced: what follows lies on the figure itself, whatever turn led to it.
        apart: what follows repeats the figure, but turned against it.
    """

    first: int
    count: int
    joined: bool = False
    inside: bool = False
    retraced: bool = False
    repeated: bool = False
    overrun: bool = False
    apart: bool = False


def measure_polygon(path: Path, segments: Segments, *, sides: int, cut_short: bool) -> PolygonFigure | None:
    """Measure the first figure of `sides` sides, or return None when there is not one straight.

    `cut_short`: the car was still under way when the recording ended, so that the last segment says nothing about
    its intended size.
    """
    if not segments.straights:
        return None
    corners = _corners(path, segments)
    extent = _extent(path, segments, corners, sides, cut_short=cut_short)
    if not cut_short:
        corners += _closing_corner(path, segments, extent.first)
    return _figure(path, segments, corners, extent, at_rest=not cut_short)


def _corners(path: Path, segments: Segments) -> list[float]:
    """Return the change of direction from each straight to the next.

    Where the car drives forward before a corner and backs up after it (or the reverse), a turn by an angle and a
    turn by its supplement the other way lead to the same path. The smaller change of direction is taken.
    """
    corners = []
    for before, after in itertools.pairwise(segments.straights):
        corner_rad = after.direction_rad - before.direction_rad - before.spun_rad
        other_way = _backs_up(path, before) != _backs_up(path, after)
        corners.append(math.remainder(corner_rad, FULL_TURN_RAD) if other_way else corner_rad)
    return corners


def _closing_corner(path: Path, segments: Segments, first: int) -> list[float]:
    """Return the turn after the last straight, if there is one.

    The next side would be driven as straight `first` was: forward or backing up, and as bent.
    """
    if (closing := segments.turns[-1]) is None:
        return []
    last = segments.straights[-1]
    next_rad = float(path.travel_rad[closing.last]) + 0.5 * segments.straights[first].bend_rad
    corner_rad = next_rad - last.direction_rad - last.spun_rad
    other_way = _backs_up(path, last) != _backs_up(path, segments.straights[first])
    return [math.remainder(corner_rad + math.pi, FULL_TURN_RAD) if other_way else corner_rad]


def _backs_up(path: Path, straight: Straight) -> bool:
    return bool(path.signed_m[straight.last] < path.signed_m[straight.first])


def _extent(path: Path, segments: Segments, corners: list[float], sides: int, *, cut_short: bool) -> _Extent:
    """Find the figure: the first one that closes, else the first one whose direction comes round.

    A side begun in its middle is looked for first, because its two halves are neither approach nor repetition;
    then laps, whose first one would otherwise be taken for an approach to the next.
    """
    total = len(segments.straights)
    lengths = [chord(path, *span(path, segments, i)) for i in range(total)]
    lap = _lap(path, segments, corners, sides, cut_short=cut_short)
    if total == sides > lap and not cut_short and _repeats(lengths, corners, lap, cut_short=False):
        return _Extent(
            0, total
        )  # as many sides as are wanted, each turned too far: not laps of another figure
    if _halves(lengths, corners, lap):
        return _Extent(0, total, joined=True)
    if _begins_inside(path, segments, lengths, lap) and _repeats(
        [*lengths[1:-1], lengths[-1] if cut_short else _completed(lengths, lap)],
        corners[1:],
        lap,
        cut_short=cut_short,
    ):
        return _Extent(1, lap, inside=True, repeated=True)
    again = _repeats(lengths, corners, lap, cut_short=cut_short)
    if not again and (begun := _approached_halves(path, segments, corners, lengths)) is not None:
        return _Extent(begun, total - begun, joined=True)
    plain = again or lap == sides == total
    first, count = (None if plain else _closed(path, segments, corners, lengths, sides)) or (0, lap)
    if first + count == total:
        return _Extent(first, count)
    found = _followed(path, segments, corners, _Extent(first, count), cut_short=cut_short)
    meant = total == sides or _one_too_many(lengths[first:], corners[first:])
    if meant and not (found.repeated or found.apart) and not cut_short:
        return _Extent(first, total - first)
    return found


def _followed(
    path: Path, segments: Segments, corners: list[float], lap: _Extent, *, cut_short: bool
) -> _Extent:
    """Say of a lap how what follows relates to it."""
    first, count = lap.first, lap.count
    lengths = [chord(path, *span(path, segments, i)) for i in range(first, len(segments.straights))]
    retraced = _retraced(path, segments, first, count, cut_short=cut_short)
    repeated = (
        retraced
        or _repeats(lengths, corners[first:], count, cut_short=cut_short)
        or _resized(path, segments, corners, lap, cut_short=cut_short)
    )
    apart = repeated and not retraced and _turned_between(corners[first : first + count])
    return replace(
        lap,
        retraced=retraced,
        repeated=repeated and not apart,
        overrun=not repeated or apart,
        apart=apart,
    )


def _lap(path: Path, segments: Segments, corners: list[float], sides: int, *, cut_short: bool) -> int:
    """Return after how many straights the direction has come round; all of them if it has not.

    Where corners are a few degrees off, laps of the wanted number of sides come round a side too early or late.
    They are taken for what was meant if the path consists of them, or if the other number closes no figure.
    """
    total = len(segments.straights)
    lap = _comes_round(corners) or total
    if lap == sides or not 2 < sides <= total or not alike(corners[:sides]):
        return lap
    mean = abs(exact.total(map(bare, corners[: sides - 1]))) / (sides - 1)
    if abs(sides * mean - FULL_TURN_RAD) > LAP_TOLERANCE * mean:
        return lap
    begin, end = span(path, segments, 0)[0], span(path, segments, lap - 1)[1]
    closed = chord(path, begin, end) <= CLOSED_SHARE * float(path.along_m[end] - path.along_m[begin])
    consists = not cut_short and total % sides == 0 < total % lap
    return sides if consists or not closed else lap


def _begins_inside(path: Path, segments: Segments, lengths: list[float], lap: int) -> bool:
    """Whether the path begins in the middle of a side, and drives all of that side once it has come round."""
    if lap < 3 or len(lengths) < lap + 2 or lengths[0] > (1.0 - 0.5 * MERGE_TOLERANCE) * lengths[lap]:
        return False
    begin, corner = span(path, segments, 0)
    before, again = span(path, segments, lap)
    near_m = MERGE_TOLERANCE * lengths[lap]
    rest_m = chord(path, before, begin)
    return chord(path, corner, again) <= near_m and abs(rest_m + lengths[0] - lengths[lap]) <= near_m


def _completed(lengths: list[float], lap: int) -> float:
    """Return the length of the last straight with that of the first, if they are two parts of one side."""
    both = lengths[-1] + lengths[0]
    return both if abs(both - lengths[lap]) <= MERGE_TOLERANCE * lengths[lap] else lengths[-1]


def _retraced(path: Path, segments: Segments, first: int, count: int, *, cut_short: bool) -> bool:
    """Whether what follows the figure lies on its sides, in either sense: whole laps, unless it was cut short."""
    later = [span(path, segments, i) for i in range(first + count, len(segments.straights))]
    if len(later) % count and not cut_short:
        return False
    corners = [span(path, segments, i)[0] for i in range(first, first + count)]
    near_m = REPEAT_TOLERANCE * min(
        chord(path, *span(path, segments, i)) for i in range(first, first + count)
    )
    whole = later[:-1] if cut_short else later

    def places(sample: int) -> set[int]:
        return {place for place, corner in enumerate(corners) if chord(path, sample, corner) <= near_m}

    return bool(whole) and all(
        any((one - other) % count in (1, count - 1) for one in places(start) for other in places(stop))
        for start, stop in whole
    )


def _resized(path: Path, segments: Segments, corners: list[float], lap: _Extent, *, cut_short: bool) -> bool:
    """Whether whole laps follow that begin where the first one did, and are larger or smaller as a whole."""
    spans = [span(path, segments, i) for i in range(lap.first, len(segments.straights))]
    if len(spans) < 2 * lap.count or (len(spans) % lap.count and not cut_short):
        return False
    sides = [chord(path, *one) for one in spans]
    if min(sides[: lap.count]) <= 0.0:  # there and back
        return False
    for start in range(lap.count, len(spans), lap.count):
        later = sides[start : start + lap.count]
        shares = [one / other for one, other in zip(later, sides, strict=False)]
        moved_m = chord(path, spans[0][0], spans[start][0])
        if moved_m > MOVED_SHARE * abs(later[0] - sides[0]):
            return False
        done = start + lap.count <= len(spans) - cut_short
        if done and max(shares) > (1.0 + REPEAT_TOLERANCE) * min(shares):
            return False
    return _turns_alike(corners[lap.first :], lap.count)


def _turned_between(lap: list[float]) -> bool:
    """Whether the corner from a lap to the next is far off the others, which make the figure without it."""
    inner = [bare(corner) for corner in lap[:-1]]
    if _comes_round(inner) != len(lap) or not alike(inner):
        return False
    return abs(math.remainder(lap[-1] - exact.total(inner) / len(inner), FULL_TURN_RAD)) > APART_RAD


def _one_too_many(lengths: list[float], corners: list[float]) -> bool:
    """Whether the last side continues a complete figure as its own sides do: one repetition too many in a loop."""
    count = len(lengths) - 1
    same = abs(lengths[-1] - lengths[0]) <= SAME_SHARE * lengths[0]
    return same and _comes_round(corners) == count and alike(corners)


def _comes_round(corners: list[float]) -> int | None:
    """Return how many sides bring the direction round once, or None.

    The turn after the last side may be missing, so it is taken to be the mean of the others. Half a mean corner is
    the widest tolerance at which only one number of sides fits. Whole turns at a corner do not count.
    """
    total = 0.0
    for sides, corner in enumerate(corners, start=2):
        total += bare(corner)
        mean = abs(total) / (sides - 1)
        if sides > 2 and abs(abs(total) + mean - FULL_TURN_RAD) <= 0.5 * mean:
            return sides
    return None


def alike(corners: Sequence[float]) -> bool:
    """Whether corners are about equal, whole turns aside."""
    less = [bare(corner) for corner in corners]
    return max(less) - min(less) <= ALIKE_RAD


def _closed(
    path: Path, segments: Segments, corners: list[float], lengths: list[float], sides: int
) -> tuple[int, int] | None:
    """Return first straight and number of straights of the first figure of equal corners that closes, or None.

    What is driven before it is an approach. A later one is taken only if it closes clearly better. Where no figure
    closes, one that nearly does is taken if it has the wanted number of sides.
    """
    closed = nearly = None
    least = least_nearly = math.inf
    for first in range(min(MAX_APPROACH_STRAIGHTS + 1, len(lengths))):
        count = _comes_round(corners[first:])
        if count is None or count < 3 or not alike(corners[first : first + count - 1]):
            continue
        start, end = span(path, segments, first)[0], span(path, segments, first + count - 1)[1]
        gap = chord(path, start, end) / exact.total(lengths[first : first + count])
        if gap <= min(CLOSED_SHARE, least - BETTER_SHARE):
            closed, least = (first, count), gap
        elif count == sides and gap <= min(NEARLY_CLOSED_SHARE, least_nearly - BETTER_SHARE):
            nearly, least_nearly = (first, count), gap
    return closed or nearly


def _approached_halves(
    path: Path, segments: Segments, corners: list[float], lengths: list[float]
) -> int | None:
    """Return the straight at which, after an approach, a figure begins in the middle of a side; None: nowhere."""
    for first in range(1, min(MAX_APPROACH_STRAIGHTS + 1, len(lengths))):
        rest_m, inner = lengths[first:], corners[first:]
        lap = _comes_round(inner)
        if lap is None or not _halves(rest_m, inner, lap) or not alike(inner):
            continue
        ends = span(path, segments, first)[0], span(path, segments, len(lengths) - 1)[1]
        if chord(path, *ends) <= CLOSED_SHARE * exact.total(rest_m):
            return first
    return None


def _halves(lengths: list[float], corners: list[float], lap: int) -> bool:
    """Whether the path begins in the middle of a side, which its last straight completes in the same direction."""
    if len(lengths) != lap + 1 or lap < 3:
        return False
    turned = abs(exact.total(map(bare, corners)))
    if abs(turned - FULL_TURN_RAD) > 0.5 * turned / lap:
        return False
    like = [median(lengths[1:-1])]
    if lap % 2 == 0:
        like.append(lengths[lap // 2])  # a rectangle's side is as long as the one across
    first, last = lengths[0], lengths[-1]
    return any(
        abs(first + last - whole) <= MERGE_TOLERANCE * whole
        and abs(first + last - whole) < abs(max(first, last) - whole)  # else one of them is a whole side
        for whole in like
    )


def _figure(
    path: Path, segments: Segments, corners: list[float], extent: _Extent, *, at_rest: bool
) -> PolygonFigure:
    first, stop = extent.first, extent.first + extent.count
    spans, straights = [span(path, segments, i) for i in range(first, stop)], segments.straights[first:stop]
    closing = segments.turns[stop] if len(corners) >= stop else None
    end = segments.straights[stop - 1].last if closing is None else closing.last
    start = spans[0][0] if extent.inside else _set_out(path, segments)
    rest = len(path) - 1 if extent.overrun and at_rest else end
    vertices = [spans[0][0], *(stop for _, stop in spans)]
    if first == 0 and stop == len(segments.straights) and at_rest and not extent.joined:
        vertices = _closed_up(path, vertices, segments.turns[0], closing)
    sides = [chord(path, *one) for one in itertools.pairwise(vertices)]
    driven_m = float(path.along_m[end] - path.along_m[spans[0][0]])
    strayed_m = exact.total(straight.strayed_m for straight in straights)
    bows = tuple(_bow(each, path.extent_m, side_m) for each, side_m in zip(straights, sides, strict=True))
    curved_m = strayed_m + _curved_m(straights, [*segments.turns[first + 1 : stop], closing])
    if extent.joined:
        sides = [sides[0] + sides[-1], *sides[1:-1]]
    inner, last_turned_rad = _shaping(corners[first:stop], extent, turned=closing is not None)
    return PolygonFigure(
        vertices=tuple(vertices),
        sides_m=tuple(sides),
        corners_rad=tuple(inner),
        last_turn_rad=_last_turn(path, closing, last_turned_rad) if closing is not None else 0.0,
        last_turned_rad=last_turned_rad,
        approach_m=max(float(path.along_m[spans[0][0]] - path.along_m[start]), 0.0),
        start=start,
        end=end,
        rest=rest,
        gap_m=chord(path, start, rest),
        curved_share=min(curved_m / driven_m, 1.0) if driven_m > 0.0 else 0.0,
        strayed_share=min(strayed_m / driven_m, 1.0) if driven_m > 0.0 else 0.0,
        bows=bows,
        repeated=extent.repeated,
        overrun=extent.overrun,
        apart=extent.apart,
    )


def _shaping(corners: list[float], extent: _Extent, *, turned: bool) -> tuple[list[float], float]:
    """Return the corners that shape the figure, and the turn after its last side if it is none of them, else 0."""
    inner = corners[: extent.count - 1]
    if not turned or extent.joined:
        return inner, 0.0
    about = extent.retraced and _turned_between(corners)
    needed = _comes_round(inner) != extent.count and not _further(inner, corners[-1])
    if (extent.repeated and not about) or needed:
        return corners, 0.0
    return inner, corners[-1]


def _further(inner: list[float], last: float) -> bool:
    """Whether the last turn goes the way of the corners, which are alike, and clearly further."""
    if not inner or not alike(inner):
        return False
    mean = exact.total(map(bare, inner)) / len(inner)
    return last * mean > 0.0 and abs(last) > abs(mean) + ALIKE_RAD


def _set_out(path: Path, segments: Segments) -> int:
    """Return the sample where the car set out: an arc before the first straight led it away from there."""
    begun = segments.turns[0]
    far = begun is not None and begun.length_m > SPOT_SHARE * path.extent_m
    return begun.first if begun is not None and far else segments.straights[0].first


def _closed_up(path: Path, vertices: list[int], begun: Turn | None, closing: Turn | None) -> list[int]:
    """Return the corners of a figure that began, or ended, near one: what was driven there counts as a corner.

    The short part of the side beyond that corner completes the other part, if the two make a better side.
    """
    sides = [chord(path, *one) for one in itertools.pairwise(vertices)]
    usual_m, perimeter_m = median(sides), exact.total(sides)

    def better(turn: Turn | None, end: int, far: int, side_m: float) -> bool:
        if turn is None or chord(path, end, 0) > CLOSED_SHARE * perimeter_m:
            return False
        if turn.length_m < SETTLING_SHARE * path.extent_m or _is_arc(path, turn):
            return False
        return abs(chord(path, half_turned(path, turn), far) - usual_m) < abs(side_m - usual_m)

    rest = len(path) - 1
    if begun is not None and better(begun, rest, vertices[-2], sides[-1]):
        return [*vertices[:-1], half_turned(path, begun)]
    if closing is not None and better(closing, rest, vertices[1], sides[0]):
        return [half_turned(path, closing), *vertices[1:]]
    return vertices


def _is_arc(path: Path, turn: Turn) -> bool:
    """Whether a good part of a turn was driven while turning, and not straight before or after it."""
    travel, along = path.travel_rad[turn.first : turn.last + 1], path.along_m[turn.first : turn.last + 1]
    turning = (np.abs(travel - travel[0]) > MIN_TURN_RAD) & (np.abs(travel - travel[-1]) > MIN_TURN_RAD)
    return exact.total(np.diff(along)[turning[1:]]) > 0.1 * turn.length_m


def _curved_m(straights: Sequence[Straight], turns: Sequence[Turn | None]) -> float:
    length_m = exact.total(turn.length_m for turn in turns if turn is not None) + exact.total(
        map(_bent_m, straights)
    )
    return max(length_m, 0.0)  # distance falls within a correction, so a turn in it counts negative


def _bent_m(straight: Straight) -> float:
    """Return how much of a side counts as driven while turning."""
    share = (abs(straight.bend_rad) - BENT_RAD) / (ROUND_RAD - BENT_RAD)
    return straight.length_m * min(max(share, 0.0), 1.0)


def _bow(straight: Straight, extent_m: float, side_m: float) -> float:
    """Return how far a side is from being one: 1 if it bends as much as a turn, or is mostly detours or corners.

    A bend counts from half of that on.
    """
    most_rad = max(straight.length_m / (ARC_SHARE * extent_m), MIN_TURN_RAD)
    bent = 2.0 * abs(straight.bend_rad) / most_rad - 1.0
    strayed = straight.strayed_m / straight.length_m if straight.length_m > 0.0 else 0.0
    astray = (strayed - STRAYED_SHARE) / (LOST_SHARE - STRAYED_SHARE)
    level = straight.length_m / side_m if side_m > 0.0 else 1.0
    rounded = (LEVEL_SHARE - level) / (LEVEL_SHARE - ROUND_SHARE)
    return min(max(bent, astray, rounded, 0.0), 1.0)


def _last_turn(path: Path, turn: Turn, angle_rad: float) -> float:
    on_the_spot = turn.length_m <= SPOT_SHARE * path.extent_m
    return math.remainder(angle_rad, FULL_TURN_RAD) if on_the_spot else angle_rad


def _repeats(lengths: list[float], corners: list[float], count: int, *, cut_short: bool) -> bool:
    """Whether the first `count` sides are followed by whole laps, the last of which may have been cut short.

    A part that the script itself ended was no lap: the car drove on after the figure.
    """
    sides, later = lengths[:count], lengths[count:]
    if not later or (len(later) % count and not cut_short):
        return False
    before = list(itertools.islice(itertools.cycle(sides), len(later)))
    whole = len(later) - 1 if cut_short else len(later)
    same = all(
        abs(length - side) <= REPEAT_TOLERANCE * side
        for length, side in zip(later[:whole], before[:whole], strict=True)
    )
    return same and later[-1] <= (1.0 + REPEAT_TOLERANCE) * before[-1] and _turns_alike(corners, count)


def _turns_alike(corners: list[float], count: int) -> bool:
    """Whether each lap after the first `count` sides turns as the first one does, in either sense."""
    inner = _from_its_sense(corners[: count - 1])
    return all(
        abs(math.remainder(corner - first, FULL_TURN_RAD)) <= ALIKE_RAD
        for i in range(count, len(corners), count)
        for corner, first in zip(_from_its_sense(corners[i : i + count - 1]), inner, strict=False)
    )


def _from_its_sense(corners: list[float]) -> list[float]:
    """Return the corners of a lap without whole turns, mirrored if the first one turns right."""
    less = [bare(corner) for corner in corners]
    return [-corner for corner in less] if less and less[0] < 0.0 else less


def span(path: Path, segments: Segments, index: int) -> tuple[int, int]:
    """Return the sample indices of the two vertices of straight `index`."""
    straight, before, after = segments.straights[index], segments.turns[index], segments.turns[index + 1]
    start = _start(path, straight) if index == 0 or before is None else half_turned(path, before)
    if after is None:
        return start, _end(path, straight)
    is_last = index == len(segments.straights) - 1
    return start, _last_vertex(path, after) if is_last else half_turned(path, after)


def chord(path: Path, start: int, stop: int) -> float:
    """Return the distance between two samples, in metres."""
    return exact.hypot(float(path.x_m[stop] - path.x_m[start]), float(path.y_m[stop] - path.y_m[start]))


def half_turned(path: Path, turn: Turn) -> int:
    """Return the sample at which half of the turn is done: where the corner of a rounded turn is measured from.

    Where the car drives straight on then, because it cuts the corner off, that is in the middle of this straight.
    """
    if turn.first == turn.last:
        return turn.first
    travel, along = path.travel_rad[turn.first : turn.last + 1], path.along_m[turn.first : turn.last + 1]
    turned = np.abs(travel - (travel[0] + travel[-1]) / 2.0) / max(abs(turn.angle_rad), STILL_RAD)
    driven = np.abs(along - (along[0] + along[-1]) / 2.0) / max(abs(turn.length_m), STILL_M)
    return turn.first + int(np.argmin(turned + CUT_OFF_COUNTS * driven))


def _last_vertex(path: Path, turn: Turn) -> int:
    """Return the sample at which half of the corner in the last turn is done, before any whole turns."""
    turned = np.abs(path.travel_rad[turn.first : turn.last + 1] - path.travel_rad[turn.first])
    corner_rad = abs(math.remainder(float(turned[-1]), FULL_TURN_RAD))
    return turn.first + int(np.argmax(turned >= 0.5 * corner_rad))


def _start(path: Path, straight: Straight) -> int:
    """Return where the first side begins. After a correction that is the point to which the car backed up."""
    return straight.first + int(np.argmin(path.along_m[straight.first : straight.last + 1]))


def _end(path: Path, straight: Straight) -> int:
    """Return where the last side ends. With a correction, where the car came nearest to where the path began."""
    far = straight.first + int(np.argmax(path.along_m[straight.first : straight.last + 1]))
    x_m, y_m = path.x_m[far : straight.last + 1], path.y_m[far : straight.last + 1]
    return far + int(np.argmin(exact.hypot(x_m - path.x_m[0], y_m - path.y_m[0])))
