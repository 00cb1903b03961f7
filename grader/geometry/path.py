"""From recorded poses to the path that was driven, and its straights and turns (in place or in an arc).

The path is cut in the plane of distance travelled against direction of travel, where a straight is a level line, a
turn in place an upright one and an arc a slope. Time plays no part, so pauses, speed and sampling cannot matter.
Ramer-Douglas-Peucker simplifies this staircase with one tolerance in degrees and one in shares of the path's
extent: wobble and noise below them vanish. What is left is classified and merged.

The smallest corner of an assignment is the 30° of a dodecagon. A car that steers by the sign of its error
swings by up to 10° about a straight side. The constants below keep the two apart; the tests of steering
that weaves and of figures with twelve sides fail when one is halved or doubled, as its comment says.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from grader.contracts.record import Record
from grader.geometry import exact

Floats = NDArray[np.float64]

# A way back shorter than this share of the path's extent is a correction: a controller that went too far backs up
# a little, but driving back on purpose goes for a good part of a side. Halved or doubled, a longer way back would
# earn more than a shorter one.
REVERSAL_SHARE = 0.1

OVERSHOOT_SHARE = 0.5  # of a straight: who backs up along it for less had gone too far

# Of the extent: what is shorter is how a controller settles, and no way worth counting.
SETTLING_SHARE = 0.01

MIN_REVERSAL_M = 0.01  # of a path that hardly moved; halved, the noise of a car at rest adds up to a distance
FULL_TURN_RAD = 2.0 * math.pi
WILD_RAD = 2.0 * FULL_TURN_RAD  # nobody means a corner this wide: what it leaves of a turn is chance
HEADING_TOLERANCE_RAD = math.radians(10.0)  # doubled, it swallows the corners of a dodecagon
DISTANCE_TOLERANCE_SHARE = 0.02  # of the extent; doubled, weaving is taken for corners
WOBBLE_RAD = math.radians(12.0)  # to either side: a swing of 10° with some noise is still straight

# Half of a dodecagon's corner. A smaller change of direction, or one in an arc of a radius of more than this share
# of the extent, is a straight that bends. A circle has a radius of 0.35 of its extent.
MIN_TURN_RAD, ARC_SHARE = math.radians(15.0), 0.75

# Of the extent: shorter straight bits belong to the corner around them. Halved, a step after the figure counts
# as a side; doubled, a weaving side falls apart.
MIN_STRAIGHT_SHARE = 0.06

# Of the extent: how wide the strip may be in which a car that steers to and fro drives straight, and how long it
# must be. Who steers in steps of 0.1 s at 0.5 m/s and 3 rad/s swings by 17 degrees, and is 1 cm off its line.
STRIP_SHARE, MIN_STRIP_SHARE = 0.015, 0.12

BOX_STEP_DEG = 5.0  # a box that stands askew by half of it is 3 % larger
MIN_SWINGS = 4  # an S has two
MOST_ASIDE_RAD = math.radians(60.0)
MIN_EXTENT_M = 0.02  # keeps the tolerances of a car that turned on the spot from shrinking to its noise
MAX_VERTICES = 1000  # bounds the work for a path that never goes straight; a dodecagon needs 25
STILL_RAD, STILL_M = 1e-3, 1e-3  # less than this is rest, not motion
SAGITTA = 8.0  # an arc that strays by s from its chord of length c turns by about 8 s / c


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """A driven path of n >= 1 samples.

    Attributes:
        x_m, y_m: (n,) position; teleports are taken out (see `driven_path`).
        heading_rad: (n,) continuous heading of the car.
        travel_rad: (n,) continuous direction of travel: the heading, plus half a turn while backing up.
        along_m: (n,) distance travelled since the start. It falls only within a correction: a way back that
            is small against the extent of the whole path.
        signed_m: (n,) distance along the car's own axis, falling while it backs up.
        extent_m: diagonal of the smallest box around the path, however it lies.
    """

    x_m: Floats
    y_m: Floats
    heading_rad: Floats
    travel_rad: Floats
    along_m: Floats
    signed_m: Floats
    extent_m: float

    def __len__(self) -> int:
        return len(self.x_m)


def driven_path(x_m: Floats, y_m: Floats, heading_rad: Floats, jumps: Sequence[int] = ()) -> Path:
    """Build the path from poses with continuous heading.

    `jumps` are indices whose pose was reached without driving: everything from there on is moved and turned
    rigidly so that it continues where the car stood, because a teleport is not motion.
    """
    x_m, y_m, heading_rad = _without_jumps(x_m, y_m, heading_rad, jumps)
    dx, dy = np.diff(x_m), np.diff(y_m)
    middle = (heading_rad[1:] + heading_rad[:-1]) / 2.0
    # Projected on the heading, measuring noise cancels from sample to sample; a sum of lengths would grow.
    cos, sin = exact.cos_sin(middle)
    signed_m = np.concatenate(([0.0], np.cumsum(dx * cos + dy * sin)))
    extent_m = _extent_m(x_m, y_m, float(heading_rad[0]))
    turning = _turning_points(signed_m, _reversal_m(extent_m))
    along_m, travel_rad = _unfold(signed_m, heading_rad, turning)
    return Path(x_m, y_m, heading_rad, travel_rad, along_m, signed_m, extent_m)


def _extent_m(x_m: Floats, y_m: Floats, heading_rad: float) -> float:
    """Return the diagonal of the smallest box around a path, of those at multiples of 5° to its start."""
    angles = heading_rad + np.radians(np.arange(0.0, 90.0, BOX_STEP_DEG))
    cos, sin = (column[:, None] for column in exact.cos_sin(angles))
    width_m, depth_m = np.ptp(cos * x_m + sin * y_m, axis=1), np.ptp(cos * y_m - sin * x_m, axis=1)
    return float(np.min(exact.hypot(width_m, depth_m)))


def without_overshoots(path: Path) -> Path:
    """Return the path with each way back from too far taken for a correction, however long.

    A car that backs up along a straight for less than `OVERSHOOT_SHARE` of it, and then turns or drives ahead, had
    gone too far.
    """
    found = _turning_points(path.signed_m, _reversal_m(path.extent_m))
    kept: list[int] = []
    i = 0
    while i < len(found):
        before, after = kept[-1] if kept else 0, found[i + 1] if i + 1 < len(found) else len(path) - 1
        overshot = _is_overshoot(path, before, found[i], after)
        if not overshot:
            kept.append(found[i])
        i += 2 if overshot else 1
    if len(kept) == len(found):
        return path
    along_m, travel_rad = _unfold(path.signed_m, path.heading_rad, kept)
    return replace(path, along_m=along_m, travel_rad=travel_rad)


def _is_overshoot(path: Path, before: int, there: int, back: int) -> bool:
    """Whether the way between samples `there` and `back` leads back along the end of a straight before it."""
    signed_m, heading_rad = path.signed_m, path.heading_rad
    aside = np.abs(heading_rad[before : there + 1] - heading_rad[there]) >= MIN_TURN_RAD
    begin = before + int(np.max(np.flatnonzero(aside), initial=-1)) + 1
    straight_m = abs(float(signed_m[there] - signed_m[begin]))
    back_m = abs(float(signed_m[back] - signed_m[there]))
    # The car may turn before it drives on: `back` is anywhere in that turn, and the way back ends before.
    near_m = back_m - SETTLING_SHARE * path.extent_m
    end = there + int(np.argmax(np.abs(signed_m[there : back + 1] - signed_m[there]) >= near_m))
    swung_rad = float(np.ptp(heading_rad[there : end + 1]))
    return back_m < OVERSHOOT_SHARE * straight_m and swung_rad < MIN_TURN_RAD


def _reversal_m(extent_m: float) -> float:
    """Return how long a way back must be at least to be no correction."""
    return max(REVERSAL_SHARE * extent_m, MIN_REVERSAL_M)


def _without_jumps(
    x_m: Floats, y_m: Floats, heading_rad: Floats, jumps: Sequence[int]
) -> tuple[Floats, Floats, Floats]:
    if not jumps:
        return x_m, y_m, heading_rad
    x_m, y_m, heading_rad = x_m.copy(), y_m.copy(), heading_rad.copy()
    for i in jumps:
        turn = heading_rad[i - 1] - heading_rad[i]
        cos, sin = exact.cos_sin(float(turn))
        dx, dy = x_m[i:] - x_m[i], y_m[i:] - y_m[i]
        x_m[i:] = x_m[i - 1] + cos * dx - sin * dy
        y_m[i:] = y_m[i - 1] + sin * dx + cos * dy
        heading_rad[i:] += turn
    return x_m, y_m, heading_rad


def _turning_points(signed_m: Floats, threshold_m: float) -> list[int]:
    """Return the indices at which the way along the axis turns round by more than `threshold_m`."""
    if float(np.max(np.maximum.accumulate(signed_m) - signed_m)) <= threshold_m:
        return []
    points: list[int] = []
    best, direction = 0, 0
    for i, value in enumerate(signed_m.tolist()):
        ahead = value - float(signed_m[best])
        if direction == 0:
            if abs(ahead) > threshold_m:
                direction, best = (1 if ahead > 0 else -1), i
        elif ahead * direction >= 0.0:
            best = i
        elif -ahead * direction > threshold_m:
            points.append(best)
            direction, best = -direction, i
    return points


def _unfold(signed_m: Floats, heading_rad: Floats, turning: list[int]) -> tuple[Floats, Floats]:
    """Make distance grow and direction of travel jump by half a turn at each turning point."""
    edges = [0, *turning, len(signed_m) - 1]
    along_m, travel_rad = np.empty_like(signed_m), heading_rad.copy()
    total_m = 0.0
    for first, last in itertools.pairwise(edges):
        ahead_m = signed_m[first : last + 1] - signed_m[first]
        backwards = ahead_m[-1] < 0.0
        along_m[first : last + 1] = total_m + (-ahead_m if backwards else ahead_m)
        if backwards:
            travel_rad[first + 1 : last + 1] = heading_rad[first + 1 : last + 1] + math.pi
            if first == 0:
                travel_rad[0] = heading_rad[0] + math.pi
        total_m += abs(float(ahead_m[-1]))
    return along_m, travel_rad


def bare(corner_rad: float) -> float:
    """Return a corner less the whole turn in it; a wild one is no corner and stays as it is."""
    return math.remainder(corner_rad, FULL_TURN_RAD) if abs(corner_rad) < WILD_RAD else corner_rad


class Straight(Record, kw_only=False):
    """A straight stretch between samples `first` and `last`, perhaps with a detour, after which it goes on.

    Attributes:
        direction_rad: mean continuous direction of travel over its middle part, detours left out.
        bend_rad: by how much that direction changes from its start to its end, wobble aside; positive to the left.
        length_m: distance travelled.
        strayed_m: distance driven in its detours, and beyond its end and back, but for a correction.
        spun_rad: whole turns made on the way: by so much the direction at its end is ahead of `direction_rad`.
    """

    first: int
    last: int
    direction_rad: float
    bend_rad: float
    length_m: float
    strayed_m: float = 0.0
    spun_rad: float = 0.0


class Turn(Record, kw_only=False):
    """A change of direction between samples `first` and `last`, on the spot or in an arc.

    Attributes:
        angle_rad: signed change of continuous direction.
        length_m: distance travelled meanwhile (near zero for a turn in place).
    """

    first: int
    last: int
    angle_rad: float
    length_m: float


class Segments(Record, kw_only=False):
    """Runs and the turns around them.

    Attributes:
        turns: one more than there are straights: ``turns[i]`` comes before ``straights[i]``, the last one
            after the last straight; None where there was none. Without any straight: a single turn or None.
    """

    straights: tuple[Straight, ...]
    turns: tuple[Turn | None, ...]


@dataclass(slots=True)
class _Piece:
    """A turn, or a straight. `detours`: the turns within a straight, from sample to sample."""

    first: int
    last: int
    straight: bool
    detours: tuple[tuple[int, int], ...] = ()


@lru_cache(maxsize=2)  # as driven and as commanded; what looks at a path asks for its pieces again and again
def segment(path: Path) -> Segments:
    """Cut `path` into alternating turns and straights."""
    extent_m = max(path.extent_m, MIN_EXTENT_M)
    path = _steadied(path, extent_m)
    across, up = path.along_m / (DISTANCE_TOLERANCE_SHARE * extent_m), path.travel_rad / HEADING_TOLERANCE_RAD
    corners = _without_wobble(path, simplified(across, up))
    for piece in _classify(path, corners, extent_m):
        if not piece.straight:  # half the tolerance tells a side that bends at one end from an arc
            part = slice(piece.first, piece.last + 1)
            corners += [piece.first + i for i in simplified(across[part], 2.0 * up[part])[1:-1]]
    return _assemble(path, _join(path, _classify(path, sorted(corners), extent_m)))


def _steadied(path: Path, extent_m: float) -> Path:
    """Return the path with one direction of travel wherever the car steered to and fro within a narrow strip.

    However far a car swings, what it draws there is a line. Of its turn on the spot at an end, that part is left
    out which lies within the width of a swing.
    """
    tolerance_m = STRIP_SHARE * extent_m
    travel_rad = path.travel_rad
    for first, last in itertools.pairwise(simplified(path.x_m / tolerance_m, path.y_m / tolerance_m)):
        dx, dy = float(path.x_m[last] - path.x_m[first]), float(path.y_m[last] - path.y_m[first])
        along, travel = path.along_m[first : last + 1], path.travel_rad[first : last + 1]
        inner = travel[(along > along[0] + tolerance_m) & (along < along[-1] - tolerance_m)]
        if exact.hypot(dx, dy) < MIN_STRIP_SHARE * extent_m or len(inner) == 0:
            continue
        line_rad = exact.atan2(dy, dx)
        line_rad += FULL_TURN_RAD * round((exact.mean(inner) - line_rad) / FULL_TURN_RAD)
        widest_rad = float(np.max(np.abs(inner - line_rad)))
        swings = int(np.count_nonzero(np.diff(np.sign(inner - line_rad))))
        if swings >= MIN_SWINGS and widest_rad < MOST_ASIDE_RAD:
            travel_rad = travel_rad.copy()
            travel_rad[first : last + 1][np.abs(travel - line_rad) <= widest_rad] = line_rad
    return replace(path, travel_rad=travel_rad)


def simplified(across: Floats, up: Floats, most: int = MAX_VERTICES) -> list[int]:
    """Return the sorted indices kept by Ramer-Douglas-Peucker with tolerance 1: both axes are in tolerances.

    It gives up at `most` of them.
    """
    last = len(across) - 1
    kept, stack = {0, last}, [(0, last)]
    while stack and len(kept) < most:
        first, last = stack.pop()
        if last - first < 2:
            continue
        dx, dy = float(across[last] - across[first]), float(up[last] - up[first])
        px, py = across[first + 1 : last] - across[first], up[first + 1 : last] - up[first]
        length = exact.hypot(dx, dy)
        distance = np.abs(dx * py - dy * px) / length if length > 0.0 else exact.hypot(px, py)
        far = int(np.argmax(distance))
        if distance[far] > 1.0:
            middle = first + 1 + far
            kept.add(middle)
            stack += [(first, middle), (middle, last)]
    return sorted(kept)


def _without_wobble(path: Path, corners: list[int]) -> list[int]:
    """Drop the vertices of swings to and fro that are no wider than wobble."""
    kept: list[int] = []
    for corner in corners:
        kept.append(corner)
        while len(kept) > 2 and _swings(path, *kept[-3:]):
            del kept[-2]
    return kept


def _swings(path: Path, first: int, middle: int, last: int) -> bool:
    """Whether the direction swings out until `middle` and back again, no wider than wobble does."""
    there_rad = float(path.travel_rad[middle] - path.travel_rad[first])
    back_rad = float(path.travel_rad[last] - path.travel_rad[middle])
    wide = max(abs(there_rad), abs(back_rad)) > 2.0 * WOBBLE_RAD
    return there_rad * back_rad < 0.0 and abs(there_rad + back_rad) <= MIN_TURN_RAD and not wide


def _classify(path: Path, corners: list[int], extent_m: float) -> list[_Piece]:
    along, travel = path.along_m[corners], path.travel_rad[corners]
    pieces = []
    for i in range(len(corners) - 1):
        change_rad, length_m = abs(travel[i + 1] - travel[i]), along[i + 1] - along[i]
        bent = change_rad > MIN_TURN_RAD and abs(length_m) < ARC_SHARE * extent_m * change_rad
        short = length_m < MIN_STRAIGHT_SHARE * extent_m  # as a correction is, in which the distance falls
        pieces.append(_Piece(corners[i], corners[i + 1], straight=not bent and not short))
    return pieces


def _join(path: Path, pieces: list[_Piece]) -> list[_Piece]:
    """Merge neighbours of one kind, and two straights in one direction with the detour between them."""
    joined: list[_Piece] = []
    for piece in pieces:
        if joined and joined[-1].straight == piece.straight:
            joined[-1].last = piece.last
        else:
            joined.append(_Piece(piece.first, piece.last, piece.straight))
    i = 1
    while i < len(joined) - 1:
        before, turn, after = joined[i - 1 : i + 2]
        if (
            not turn.straight
            and abs(math.remainder(_change(path, before, after), FULL_TURN_RAD)) < MIN_TURN_RAD
        ):
            detours = (*before.detours, (turn.first, turn.last), *after.detours)
            joined[i - 1 : i + 2] = [_Piece(before.first, after.last, True, detours)]
        else:
            i += 1
    return joined


def _change(path: Path, before: _Piece, after: _Piece) -> float:
    """Return the change of direction from the end of one straight piece to the start of another."""
    direction_rad, _, spun_rad = _line(path, before.first, before.last, before.detours)
    return _line(path, after.first, after.last, after.detours)[0] - direction_rad - spun_rad


@lru_cache(maxsize=32)  # a piece is looked at with the one before it, the one after it, and by itself
def _line(
    path: Path, begin: int, end: int, detours: tuple[tuple[int, int], ...]
) -> tuple[float, float, float]:
    """Return direction, bend and whole turns of a straight piece: a line fitted over its middle four fifths.

    Its ends are left out because the car still settles there after a turn; so are its detours.
    """
    along = path.along_m[begin : end + 1]
    travel, spun_rad = _without_detours(path, begin, end, detours)
    start, length = float(along[0]), float(along[-1] - along[0])
    if length <= 0.0:
        return float(travel[-1]), 0.0, spun_rad
    inner = np.clip(along, start + 0.1 * length, start + 0.9 * length)
    steps, ahead, middle = np.diff(inner), (inner[1:] + inner[:-1]) / 2.0, (travel[1:] + travel[:-1]) / 2.0
    for first, last in detours:
        steps[first - begin : last - begin] = 0.0
    total = exact.total(steps)
    if total <= 0.0:
        return float(travel[-1]), 0.0, spun_rad
    direction = exact.products(steps, middle) / total
    ahead = ahead - exact.products(steps, ahead) / total
    spread = exact.products(steps, ahead * ahead)
    slope = exact.products(steps, ahead * (middle - direction)) / spread if spread > 0.0 else 0.0
    most_rad = abs(float(travel[-1] - travel[0]))
    return direction, min(max(length * slope, -most_rad), most_rad), spun_rad


def _without_detours(
    path: Path, begin: int, end: int, detours: tuple[tuple[int, int], ...]
) -> tuple[Floats, float]:
    """Return the direction of travel in a straight piece as if it made no whole turn, and the turns it made."""
    travel = path.travel_rad[begin : end + 1]
    spun_rad = 0.0
    for first, last in detours:
        turned_rad = float(path.travel_rad[last] - path.travel_rad[first])
        whole_rad = FULL_TURN_RAD * round(turned_rad / FULL_TURN_RAD)
        if whole_rad:
            travel = travel.copy()
            travel[last - begin :] -= whole_rad
            spun_rad += whole_rad
    return travel, spun_rad


def driven_m(path: Path, first: int, last: int) -> float:
    """Return the distance driven between two samples, forwards and backwards, without small swings to a stop."""
    signed_m = path.signed_m[first : last + 1]
    turning = _turning_points(signed_m, max(SETTLING_SHARE * path.extent_m, MIN_REVERSAL_M))
    edges = [0, *turning, len(signed_m) - 1]
    return exact.total(
        abs(float(signed_m[end] - signed_m[begin])) for begin, end in itertools.pairwise(edges)
    )


def arc_rad(path: Path, first: int, last: int) -> float:
    """Return how far an arc turns that strays as far from the line between its ends as the path does."""
    length_m = exact.hypot(float(path.x_m[last] - path.x_m[first]), float(path.y_m[last] - path.y_m[first]))
    return SAGITTA * aside_m(path, first, last) / length_m if length_m > 0.0 else 0.0


def aside_m(path: Path, first: int, last: int) -> float:
    """Return how far the path strays from the line between two samples; to the less far side it counts half."""
    aside = beside_m(path, first, last)
    return (float(np.max(np.abs(aside))) + float(np.ptp(aside))) / 2.0


def beside_m(path: Path, first: int, last: int) -> Floats:
    """Return how far to the left of the line between two samples each sample from one to the other lies."""
    chord = complex(path.x_m[last] - path.x_m[first], path.y_m[last] - path.y_m[first])
    length_m, between = exact.magnitude(chord), slice(first, last + 1)
    along = chord / length_m if length_m > 0.0 else 1.0 + 0.0j
    ahead_m, left_m = path.x_m[between] - path.x_m[first], path.y_m[between] - path.y_m[first]
    return np.asarray(left_m * along.real - ahead_m * along.imag)


def _assemble(path: Path, pieces: list[_Piece]) -> Segments:
    straights: list[Straight] = []
    turns: list[Turn | None] = [None]
    for piece in pieces:
        length_m = float(path.along_m[piece.last] - path.along_m[piece.first])
        if piece.straight:
            direction_rad, bend_rad, spun_rad = _line(path, piece.first, piece.last, piece.detours)
            strayed_m = exact.total(driven_m(path, *detour) for detour in piece.detours)
            straights.append(
                Straight(piece.first, piece.last, direction_rad, bend_rad, length_m, strayed_m, spun_rad)
            )
            turns.append(None)
        else:
            angle = float(path.travel_rad[piece.last] - path.travel_rad[piece.first])
            overshot_m = -length_m - _reversal_m(path.extent_m)  # in a way back the distance falls
            if straights and overshot_m > 0.0:
                strayed_m = straights[-1].strayed_m + 2.0 * overshot_m
                straights[-1] = replace(straights[-1], strayed_m=strayed_m)
            if abs(angle) > STILL_RAD or abs(length_m) > STILL_M:
                turns[-1] = Turn(piece.first, piece.last, angle, length_m)
    return Segments(tuple(straights), tuple(turns))


def median(values: Sequence[float]) -> float:
    """Return the middle one of at least one number, or the mean of the two in the middle.

    numpy's own imports `numpy.ma` when it is first called, which takes a cold grading 10 ms.
    """
    ordered, half = sorted(values), len(values) // 2
    return ordered[half] if len(ordered) % 2 else (ordered[half - 1] + ordered[half]) / 2.0
