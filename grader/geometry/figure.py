"""Read a path as a polygon: which of its straights are the figure, and what are its sides and corners.

Scripts drive an approach first, repeat the figure, begin in the middle of a side, or drive on afterwards. Each way
to read a drive is a figure of its own; who scores them takes the one that earns most. So the closer a drive comes
to the wanted figure in any of them, the more it earns, and no threshold decides what it is taken for.

All tolerances are shares of the path's own size or angles, so that small and large figures are measured alike.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from grader.contracts.record import Record
from grader.geometry import exact
from grader.geometry.path import (
    FULL_TURN_RAD,
    MIN_TURN_RAD,
    SETTLING_SHARE,
    STILL_M,
    STILL_RAD,
    Path,
    Segments,
    Straight,
    Turn,
    arc_rad,
    bare,
)

# The shipped rubrics give full credit to sides that differ by 4 %, a gap of 4 % of the perimeter and corners
# within 3°, and nothing beyond 20 %, 16 % and 15°. Up to the first, a motion is what was meant; beyond the
# second, it is worth nothing whatever it is taken for. The tolerances stand at these edges, so that a motion
# that earns something is never taken for another one.
CLOSED_SHARE = 0.04  # of the perimeter: a figure whose end is this near to its start has closed
MERGE_TOLERANCE = 0.2  # by how much the two halves of a side begun in its middle may miss a whole side

# Of the perimeter: a wider gap says nothing about what was meant. At 8 %, the approach to a figure with one
# corner off would be taken for a side.
NEARLY_CLOSED_SHARE = 0.16

BETTER_SHARE = 0.02  # of the perimeter: by so much a later figure must close better than one before it

# By how much the corners of a figure with equal corners may differ. At 7.5°, the first of several laps that do
# not quite close would be taken for an approach.
ALIKE_RAD = math.radians(15.0)

REPEAT_TOLERANCE = 0.15  # by how much a side of a later lap may differ: on a slipping car laps drift apart
# Of the difference between their sides: so near to its start begins a larger or smaller lap. In a
# spiral, whose laps grow without a corner in common, that is about 0.7.
MOVED_SHARE = 0.3

SPOT_SHARE = 0.05  # a turn that goes further than this share of the path's extent is no turn on the spot
# Of the distance travelled along a side: so much may be driven beside its line (`Straight.strayed_m`) before it
# counts as less than one side, and from the second on it counts as none.
STRAYED_SHARE, LOST_SHARE = 0.15, 0.6
# From the first bend on a part of a side counts as driven while turning, from the second on all of it.
BENT_RAD, ROUND_RAD = math.radians(10.0), math.radians(30.0)
SWUNG_RAD = math.radians(16.0)  # instead of the first, for a side that swings out and comes back
# Of a side from corner to corner: with less than the first driven straight it counts as less than one side, with
# the second as none, because the figure is nearly a circle.
LEVEL_SHARE, ROUND_SHARE = 0.45, 0.27
# Of a corner: a side that bends by more than the first counts as less than one, by the second as none. Where all
# bend by a whole corner, the figure is a circle.
BOWED_SHARE, CIRCLED_SHARE = 0.3, 0.7
# How much the distance driven in a turn counts against the angle, to find its middle. More would move the middle
# of an arc that is driven unevenly; any less decides where the angle does not change.
CUT_OFF_COUNTS = 0.02
MAX_APPROACH_STRAIGHTS = 3  # to one of its sides, perhaps round something, and along that to a corner


class PolygonFigure(Record, kw_only=False):
    """A path, or a part of it, as a figure, complete or not.

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
        bows: of each side 0 where it is about straight, up to 1 where it bends so much as to be taken for a turn,
            or is lost among detours.
        repeated: how far, from 0 to 1, further sides follow that continue the figure over again.
        overrun: something else follows the complete figure.
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
    bows: tuple[float, ...]
    repeated: float
    overrun: bool

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
        repeated: how far what follows is the figure again, from 0 to 1.
    """

    first: int
    count: int
    joined: bool = False
    inside: bool = False
    retraced: bool = False
    repeated: float = 0.0
    overrun: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class _Straights:
    """The straights of a path, from vertex to vertex.

    Attributes:
        spans: sample indices of the two vertices of each. sides_m: their distances.
        corners: the change of direction from each straight to the next.
        wanted: how many sides the figure should have.
        cut_short: the car was still under way when the recording ended, so that the last segment says nothing
            about its intended size.
    """

    path: Path
    segments: Segments
    spans: list[tuple[int, int]]
    sides_m: list[float]
    corners: list[float]
    wanted: int
    cut_short: bool

    def __len__(self) -> int:
        return len(self.spans)

    def apart_m(self, one: int, other: int) -> float:
        """Return the distance between two samples."""
        return chord(self.path, one, other)


def readings(path: Path, segments: Segments, *, sides: int, cut_short: bool) -> Iterator[PolygonFigure]:
    """Yield the ways in which a path may be read as a figure of `sides` sides; none without a straight."""
    spans = [span(path, segments, i) for i in range(len(segments.straights))]
    sides_m = [chord(path, *ends) for ends in spans]
    straights = _Straights(path, segments, spans, sides_m, _corners(path, segments), sides, cut_short)
    for extent in _extents(straights):
        yield from _figures(straights, extent)


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


def _extents(straights: _Straights) -> Iterator[_Extent]:
    """Yield which straights may be the figure: all, until the direction comes round, or as many as are wanted.

    Straights before it are an approach if a figure of equal corners then closes, or nearly does, and clearly
    better than one before it. The first and the last straight may be two parts of one side.
    """
    total, sides, least = len(straights), straights.wanted, math.inf
    for first in range(min(MAX_APPROACH_STRAIGHTS + 1, total)):
        rest, nearly = total - first, min(NEARLY_CLOSED_SHARE, least - BETTER_SHARE)
        lap = _comes_round(straights.corners) if first == 0 else None
        if lap is not None and lap not in (sides, total):
            yield from _followed(straights, _Extent(first, lap))
        if first == 0:
            yield _Extent(first, total)
        is_figure = 2 < sides <= rest and alike(straights.corners[first : first + sides - 1])
        if is_figure or lap == sides:
            inside = first == 1 and sides < rest and _begins_inside(straights, sides)
            extent = _Extent(first, sides, inside=inside)
            open_share = _open_share(straights, extent)
            if (first == 0 and sides < rest) or (first > 0 and open_share <= nearly):
                yield from _followed(straights, extent)
            if is_figure:
                least = min(least, open_share)
        joined = _Extent(first, rest, joined=True)
        if rest == sides + 1 > 3 and _open_share(straights, joined) <= nearly:
            yield joined


def _begins_inside(straights: _Straights, lap: int) -> bool:
    """Whether the path begins in the middle of a side, and drives all of that side once it has come round."""
    (begin, corner), (before, again) = straights.spans[0], straights.spans[lap]
    near_m = MERGE_TOLERANCE * straights.sides_m[lap]
    way_m = straights.apart_m(before, begin) + straights.sides_m[0]
    return straights.apart_m(corner, again) <= near_m and abs(way_m - straights.sides_m[lap]) <= near_m


def _open_share(straights: _Straights, extent: _Extent) -> float:
    """Return by which share of its length a figure misses to come back to its start."""
    stop = extent.first + extent.count
    length_m = exact.total(straights.sides_m[extent.first : stop])
    gap_m = straights.apart_m(straights.spans[extent.first][0], straights.spans[stop - 1][1])
    return gap_m / length_m if length_m > 0.0 else math.inf


def _followed(straights: _Straights, lap: _Extent) -> Iterator[_Extent]:
    """Yield how what follows a lap may relate to it.

    The turn to a lap that repeats the first one elsewhere is a corner, or that lap was driven after the figure.
    So was one that is not quite the same.
    """
    if lap.first + lap.count == len(straights):
        yield lap
        return
    retraced = _retraced(straights, lap)
    repeated = 1.0 if retraced else _repeats(straights, lap)
    if repeated > 0.0:
        yield replace(lap, retraced=retraced, repeated=repeated)
    if not retraced:
        yield replace(lap, overrun=True)


def _retraced(straights: _Straights, lap: _Extent) -> bool:
    """Whether what follows the figure lies on its sides, in either sense: whole laps, unless it was cut short."""
    stop = lap.first + lap.count
    later = straights.spans[stop:]
    if len(later) % lap.count and not straights.cut_short:
        return False
    corners = [start for start, _ in straights.spans[lap.first : stop]]
    near_m = REPEAT_TOLERANCE * min(straights.sides_m[lap.first : stop])
    whole = later[:-1] if straights.cut_short else later

    def places(sample: int) -> set[int]:
        return {place for place, corner in enumerate(corners) if straights.apart_m(sample, corner) <= near_m}

    return bool(whole) and all(
        any((one - other) % lap.count in (1, lap.count - 1) for one in places(start) for other in places(end))
        for start, end in whole
    )


def _repeats(straights: _Straights, lap: _Extent) -> float:
    """Return how far whole laps follow, as large as the first or, from the same corner on, of another size.

    The last one may have been cut short. A part that the script itself ended was no lap: the car drove on.
    """
    spans, sides_m = straights.spans[lap.first :], straights.sides_m[lap.first :]
    if lap.inside:  # a last part of a side is completed by the part with which the path began
        parts_m = sides_m[-1], sides_m[-1] + straights.sides_m[0]
        sides_m[-1] = min(parts_m, key=lambda part_m: abs(part_m - sides_m[lap.count - 1]))
    if (len(spans) % lap.count and not straights.cut_short) or min(sides_m[: lap.count]) <= 0.0:
        return 0.0
    off = 0.0
    for start in range(lap.count, len(spans), lap.count):
        later_m = sides_m[start : start + lap.count]
        shares = [later / first for later, first in zip(later_m, sides_m, strict=False)]
        under_way = shares.pop() if straights.cut_short and start + lap.count >= len(spans) else 0.0
        moved_m = straights.apart_m(spans[0][0], spans[start][0])
        resized = len(shares) > 1 and max(shares) <= (1.0 + REPEAT_TOLERANCE) * min(shares)
        if not (resized and moved_m <= MOVED_SHARE * abs(later_m[0] - sides_m[0])):
            off = max(off, *(abs(share - 1.0) for share in shares), 0.0)
        if under_way > (1.0 + REPEAT_TOLERANCE) * max(shares, default=1.0):
            return 0.0
    turned_rad = _turned_otherwise_rad(straights.corners[lap.first :], lap.count)
    return min(max(2.0 - max(off / REPEAT_TOLERANCE, turned_rad / ALIKE_RAD), 0.0), 1.0)


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


def _figures(straights: _Straights, extent: _Extent) -> Iterator[PolygonFigure]:
    """Yield the figure of some straights, and as if a side within which the path began, or ended, were whole."""
    path, first, stop = straights.path, extent.first, extent.first + extent.count
    vertices = [straights.spans[first][0], *(end for _, end in straights.spans[first:stop])]
    sides = [chord(path, *one) for one in itertools.pairwise(vertices)]
    yield _figure(
        straights, extent, vertices, [sides[0] + sides[-1], *sides[1:-1]] if extent.joined else sides
    )
    closed_m = CLOSED_SHARE * exact.total(straights.sides_m)
    # What is open beyond that is left out of the side, twice: so it is not left out all at once.
    left_out_m = max(2.0 * (chord(path, len(path) - 1, 0) - closed_m), 0.0)
    if first > 0 or stop < len(straights) or straights.cut_short or left_out_m > 2.0 * closed_m:
        return
    if extent.joined:
        whole_m = chord(path, vertices[-2], vertices[1]) - left_out_m
        yield _figure(straights, extent, vertices, [max(whole_m, sides[0] + sides[-1]), *sides[1:-1]])
        return
    for turn, at in ((straights.segments.turns[0], -1), (straights.segments.turns[-1], 0)):
        if turn is None or turn.length_m < SETTLING_SHARE * path.extent_m or _is_arc(path, turn):
            continue
        moved = list(vertices)
        moved[at] = half_turned(path, turn)
        sides = [chord(path, *one) for one in itertools.pairwise(moved)]
        sides[at] = max(sides[at] - left_out_m, 0.0)
        yield _figure(straights, extent, moved, sides)


def _figure(
    straights: _Straights, extent: _Extent, vertices: list[int], sides_m: list[float]
) -> PolygonFigure:
    path, first, stop = straights.path, extent.first, extent.first + extent.count
    corners = straights.corners[first:stop]
    if stop == len(straights) and not straights.cut_short:
        corners += _closing_corner(path, straights.segments, first)
    closing = straights.segments.turns[stop] if len(corners) == extent.count else None
    own = straights.segments.straights[first:stop]
    end = own[-1].last if closing is None else closing.last
    begin = straights.spans[first][0]
    start = begin if extent.inside else _set_out(path, straights.segments)
    rest = len(path) - 1 if extent.overrun and not straights.cut_short else end
    driven_m = float(path.along_m[end] - path.along_m[begin])
    strayed_m = exact.total(straight.strayed_m for straight in own)
    swings = [_swing_rad(path, each) for each in own]
    turns = [turn for turn in (*straights.segments.turns[first + 1 : stop], closing) if turn is not None]
    bent_m = exact.total(map(_bent_m, own, swings))
    turned_m = exact.total(turn.length_m for turn in turns)  # negative in a correction: the distance falls
    curved_m = strayed_m + max(bent_m + turned_m, 0.0)
    inner, last_turned_rad = _shaping(corners, extent, turned=closing is not None)
    return PolygonFigure(
        vertices=tuple(vertices),
        sides_m=tuple(sides_m),
        corners_rad=tuple(inner),
        last_turn_rad=_last_turn(path, closing, last_turned_rad) if closing is not None else 0.0,
        last_turned_rad=last_turned_rad,
        approach_m=max(float(path.along_m[begin] - path.along_m[start]), 0.0),
        start=start,
        end=end,
        rest=rest,
        gap_m=chord(path, start, rest),
        curved_share=min(curved_m / driven_m, 1.0) if driven_m > 0.0 else 0.0,
        bows=_bows(straights, own, swings, vertices),
        repeated=extent.repeated,
        overrun=extent.overrun,
    )


def _shaping(corners: list[float], extent: _Extent, *, turned: bool) -> tuple[list[float], float]:
    """Return the corners that shape the figure, and the turn after its last side if it is none of them, else 0."""
    inner = corners[: extent.count - 1]
    if not turned or extent.joined:
        return inner, 0.0
    about = extent.retraced and alike(inner) and not alike(corners)
    needed = _comes_round(inner) != extent.count and not _further(inner, corners[-1])
    if (extent.repeated > 0.0 and not about) or needed:
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


def _is_arc(path: Path, turn: Turn) -> bool:
    """Whether a good part of a turn was driven while turning, and not straight before or after it."""
    travel, along = path.travel_rad[turn.first : turn.last + 1], path.along_m[turn.first : turn.last + 1]
    turning = (np.abs(travel - travel[0]) > MIN_TURN_RAD) & (np.abs(travel - travel[-1]) > MIN_TURN_RAD)
    return exact.total(np.diff(along)[turning[1:]]) > 0.1 * turn.length_m


def _bows(
    straights: _Straights, own: Sequence[Straight], swings: Sequence[float], vertices: Sequence[int]
) -> tuple[float, ...]:
    drawn_m = [chord(straights.path, *ends) for ends in itertools.pairwise(vertices)]
    corner_rad, mean_m = FULL_TURN_RAD / straights.wanted, exact.mean(drawn_m) or STILL_M
    return tuple(
        _bow(side, swing_rad, corner_rad * max(side_m / mean_m, 1.0), side_m)
        for side, swing_rad, side_m in zip(own, swings, drawn_m, strict=True)
    )


def _swing_rad(path: Path, straight: Straight) -> float:
    """Return how far an arc would bend that strays as far from its chord as a side; no more than that side turns.

    Detours count by themselves.
    """
    if straight.strayed_m > 0.0:
        return 0.0
    turned_rad = float(np.ptp(path.travel_rad[straight.first : straight.last + 1]))
    return min(arc_rad(path, straight.first, straight.last), turned_rad)


def _bent_m(straight: Straight, swing_rad: float) -> float:
    """Return how much of a side counts as driven while turning; wobble does not."""
    beyond_rad = max(abs(straight.bend_rad) - BENT_RAD, swing_rad - SWUNG_RAD, 0.0)
    return straight.length_m * min(beyond_rad / (ROUND_RAD - BENT_RAD), 1.0)


def _bow(straight: Straight, swing_rad: float, circle_rad: float, side_m: float) -> float:
    """Return how far a side is from being one: 1 if it is nearly an arc of a circle, or mostly detours.

    `circle_rad`: by so much it would bend if the whole figure were a circle.
    """
    bend_rad = max(abs(straight.bend_rad), swing_rad)
    bent = (bend_rad / circle_rad - BOWED_SHARE) / (CIRCLED_SHARE - BOWED_SHARE)
    strayed = straight.strayed_m / straight.length_m if straight.length_m > 0.0 else 0.0
    astray = (strayed - STRAYED_SHARE) / (LOST_SHARE - STRAYED_SHARE)
    level = straight.length_m / side_m if side_m > 0.0 else 1.0
    rounded = (LEVEL_SHARE - level) / (LEVEL_SHARE - ROUND_SHARE)
    return min(max(bent, astray, rounded, 0.0), 1.0)


def _last_turn(path: Path, turn: Turn, angle_rad: float) -> float:
    on_the_spot = turn.length_m <= SPOT_SHARE * path.extent_m
    return math.remainder(angle_rad, FULL_TURN_RAD) if on_the_spot else angle_rad


def _turned_otherwise_rad(corners: list[float], count: int) -> float:
    """Return by how much a corner of a lap after the first `count` sides differs from the first lap's, at most.

    Either sense will do.
    """
    inner = _from_its_sense(corners[: count - 1])
    apart_rad = (
        abs(math.remainder(corner - first, FULL_TURN_RAD))
        for i in range(count, len(corners), count)
        for corner, first in zip(_from_its_sense(corners[i : i + count - 1]), inner, strict=False)
    )
    return max(apart_rad, default=0.0)


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
    if abs(turn.angle_rad) < FULL_TURN_RAD:
        return half_turned(path, turn)
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
