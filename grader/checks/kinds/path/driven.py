"""Which part of a driven path is the wanted one, laid on it as well as the assignment allows."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from grader.checks.drive import Drive
from grader.checks.kinds.path.wanted import (
    MIN_CORNER_RAD,
    SAMPLES,
    Stretch,
    Track,
    corner_rad,
    size_m,
    tracks,
)
from grader.contracts.assignment import StartPose, WantedPath
from grader.geometry import exact
from grader.geometry.figure import MAX_APPROACH_STRAIGHTS, chord, half_turned
from grader.geometry.matching import (
    Floats,
    Points,
    Similarity,
    circle_through,
    fitted,
    frechet,
    matched_each,
    resampled,
)
from grader.geometry.path import Path, Straight, driven_path, median, segment

APPROACHED_SHARE = 0.02  # of the size: nearer to the wanted path, a drive has no approach
SEAM_SHARE = 0.2  # of the way: a car that ends further from where it began within a line has not come back
LEAST_M = 0.05  # a shorter drive is not a path
LAPS_TRIED = 8  # ends of the first lap that are tried: where the car came back to its start
LAP_SHARE = 0.6  # of the wanted length: a car that was back sooner had not driven a lap
LOOKED_AT = 400  # points of a whole drive among which such ends are looked for
BACK_SHARE = 0.2  # of the drive's size: a car that comes nearer to its start than this is back
ON_IT_SHARE = 0.08  # of the figure's size: what stays this near to it after its end repeats it
LONGER_SHARE = 1.1  # a shorter part replaces a longer one only if it fits better by this factor
UNFINISHED_SHARE = 0.85  # of the wanted length: a shorter drive has left something out
# Share of the path's size: a part of the wanted path that is further from the driven one was left out.
COVERED_SHARE = 0.05
BEGUN_SHARE = 0.02  # of the size: a part that is nowhere further off is the first part of the path
NEARLY_SHARE = 0.002  # of the size: residuals that differ by less count as equal
# Of the size, for a radian by which a corner is off: of ways that fit alike, that of the driven corners is taken.
CORNER_COUNTS = 0.05
LIKELY = 4  # ways of driving that are matched, those that fit best at equal distances
THIN = 4  # the matching uses every fourth point: it only chooses among them
NO_LINE_SHARE = 0.02  # of the path: a corner this near to its end has no line behind it
REFINED = 2  # rounds of matching and fitting in turn: further ones hardly change anything
FINE = 5 * SAMPLES  # points of the driven figure from which pieces are measured


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivenStretch:
    """A driven piece.

    Attributes:
        wanted: the piece that it is, as wide as it would have to be here.
        start, end: where it begins and ends.
        length_m: of a line, from corner to corner.
        radius_m, deviation_m, centre, swept_rad: of an arc; NaN where it is none.
        begins_rad, ends_rad: direction of travel at its ends.
    """

    wanted: Stretch
    start: complex
    end: complex
    length_m: float
    begins_rad: float
    ends_rad: float
    radius_m: float = math.nan
    deviation_m: float = math.nan
    centre: complex = 0j
    swept_rad: float = math.nan


@dataclass(frozen=True, kw_only=True, eq=False)
class Figure:
    """The wanted path laid on the driven one.

    Attributes:
        track: the way in which it was driven.
        placed: from the wanted path to where it lies.
        wanted: points of the wanted path there.
        driven: as many points of the driven one. fine: more of them.
        pairs: which of these points belong together, in order.
        end_m: how far the car had driven when the figure was complete.
        residual: root mean square distance of the pairs as a share of the size.
        begun: the share of its first part, if that was driven well and nothing else; otherwise 0.
        repeated: what follows is the same figure again. overrun: something else follows.
        strayed_m: how far what follows an open path leads away from it.
        on_m: how far what follows goes straight on from the last piece.
        approach_m: how far from where the car set out the path begins, after straights that are no part of it.
    """

    track: Track
    placed: Similarity
    wanted: Points
    driven: Points
    fine: Points
    pairs: NDArray[np.intp]
    end_m: float
    residual: float
    begun: float = 0.0
    repeated: bool = False
    overrun: bool = False
    strayed_m: float = 0.0
    on_m: float = 0.0
    approach_m: float = 0.0

    @property
    def size_m(self) -> float:
        """Diagonal of the box around the wanted path, as large as it is here."""
        return size_m(self.track.points) * self.placed.scale

    @cached_property
    def apart_m(self) -> float:
        """The discrete Frechet distance of the wanted path from the driven one."""
        return frechet(self.wanted, self.driven)

    @property
    def covered_share(self) -> float:
        """How much of the wanted path was driven; a part further from the driven path was left out."""
        if self.begun:
            return self.begun
        return float(np.mean(self.distances_m <= COVERED_SHARE * self.size_m))

    @property
    def distances_m(self) -> Floats:
        """How far each point of the wanted path is from the nearest one that belongs to it."""
        far = exact.magnitudes(self.wanted[self.pairs[:, 0]] - self.driven[self.pairs[:, 1]])
        nearest = np.full(len(self.wanted), np.inf)
        np.minimum.at(nearest, self.pairs[:, 0], far)
        return nearest


@dataclass(frozen=True, slots=True)
class _Allowed:
    """Where the wanted path may lie."""

    wanted: WantedPath
    start: StartPose

    def placed(self, given: Points, driven: Points, *, mirrored: bool) -> Similarity:
        """Return where the wanted path lies: as near as it may to the driven points, pair by pair."""
        if self.wanted.any_start:
            return fitted(given, driven, scaled=self.wanted.any_scale, mirrored=mirrored)
        turned = exact.rect(1.0, math.radians(self.start.heading_deg))
        offset = complex(self.start.x_m, self.start.y_m)
        if self.wanted.any_scale:
            ahead = exact.turned(np.conj(given) if mirrored else given, turned)
            product = exact.correlation(ahead, driven - offset).real
            turned *= max(product, 0.0) / exact.correlation(ahead, ahead).real
        return Similarity(turned, offset, mirrored)


def from_a_corner(drive: Drive, wanted: WantedPath) -> Drive:
    """Return the drive of a closed path that began within a line as if it had begun at the end of that line.

    What was driven up to there follows at its end, moved to where the car came to rest. It is left out where
    Ctrl+C ended one of several laps.
    """
    ways, straights = tracks(wanted), segment(drive.path).straights
    if not (ways and ways[0].is_closed and wanted.any_start and wanted.any_direction and len(straights) > 2):
        return drive
    lines = len(ways[0].stretches)
    if drive.cut_short and len(straights) > lines:
        over = straights[lines].length_m > straights[0].length_m
        return (
            _rest_of(drive, straights[0].last) if over and _goes_on(straights[lines], straights[0]) else drive
        )
    path, first, last = drive.path, straights[0].first, straights[-1].last
    away_m = chord(path, first, last)
    came_m = chord(path, straights[-1].first, first)  # by so much the last line led towards the start
    back = away_m <= SEAM_SHARE * float(path.along_m[last]) and away_m < came_m
    if not (back and _goes_on(straights[-1], straights[0])):
        return drive
    return _turned_round(drive, first, straights[0].last, last)


def looked_at(drive: Drive, wanted: WantedPath, start: StartPose) -> tuple[Drive, Figure | None]:
    """Return the part of a drive that is looked at, as if it began at a corner, and the wanted path laid on it.

    Straights before a closed path that may lie anywhere are an approach, where the rest is that path.
    """
    whole = from_a_corner(drive, wanted)
    figure = figure_in(whole, wanted, start)
    ways = tracks(wanted)
    may_be_approached = bool(ways) and ways[0].is_closed and wanted.any_start
    if figure is None or figure.residual <= APPROACHED_SHARE or not may_be_approached:
        return whole, figure
    for before in segment(drive.path).straights[:MAX_APPROACH_STRAIGHTS]:
        rest = from_a_corner(_rest_of(drive, before.last), wanted)
        found = figure_in(rest, wanted, start)
        if (
            found is not None
            and found.residual <= min(COVERED_SHARE, figure.residual / 2.0)
            and not found.begun
        ):
            return rest, replace(found, approach_m=chord(drive.path, 0, before.last))
    return whole, figure


def _goes_on(later: Straight, first: Straight) -> bool:
    """Whether a later straight leads the way that the first one does."""
    turned_rad = math.remainder(first.direction_rad - later.direction_rad - later.spun_rad, math.tau)
    return abs(turned_rad) < MIN_CORNER_RAD


def _rest_of(drive: Drive, begin: int) -> Drive:
    path = drive.path
    rest = driven_path(path.x_m[begin:], path.y_m[begin:], path.heading_rad[begin:])
    return replace(drive, path=rest, t_ns=drive.t_ns[begin:])


def _turned_round(drive: Drive, first: int, corner: int, last: int) -> Drive:
    """Return the drive from a corner to its end, and from where its beginning would go on there to the corner."""
    path, rest, begun = drive.path, slice(corner, last + 1), slice(first, corner + 1)

    def joined(values: Floats, step: float) -> Floats:
        return np.concatenate((values[rest], values[begun] + step))

    whole_rad = math.tau * round(float(path.heading_rad[last] - path.heading_rad[first]) / math.tau)
    round_again = driven_path(
        joined(path.x_m, float(path.x_m[last] - path.x_m[first])),
        joined(path.y_m, float(path.y_m[last] - path.y_m[first])),
        joined(path.heading_rad, whole_rad),
    )
    ended_ns = np.full(corner + 1 - first, drive.t_ns[last])
    return replace(drive, path=round_again, t_ns=np.concatenate((drive.t_ns[rest], ended_ns)))


def figure_in(drive: Drive, wanted: WantedPath, start: StartPose) -> Figure | None:
    """Return the wanted path laid on what was driven, or None where hardly anything was."""
    path = drive.path
    along = np.maximum.accumulate(path.along_m)
    total_m = float(along[-1])
    if total_m < LEAST_M:
        return None
    points = exact.paired(path.x_m, path.y_m)
    found, found_off = None, math.inf
    ways, allowed = tracks(wanted), _Allowed(wanted, start)
    closed = bool(ways) and ways[0].is_closed
    least_share = LAP_SHARE if closed else UNFINISHED_SHARE
    least_m = 0.0 if wanted.any_scale or not ways else least_share * ways[0].length_m
    likely: list[Figure] = []  # longer parts come first
    ends = _ends_of_laps(points, along, least_m) if closed else _ends_of_pieces(path, along, least_m)
    for end_m in (total_m, *ends):
        tried = _tried(points, along, end_m, ways, allowed)  # of equal ones the plainest comes first
        likely += sorted(tried, key=lambda each: round(_misfit(each, drive), 3))[:LIKELY]
    for one in _refined(likely, allowed, THIN):
        if not closed and one.end_m < total_m and one.residual > COVERED_SHARE:
            continue  # hardly the whole path: with what follows it is one that was driven badly
        off = _misfit(one, drive)
        if found is None or off < (found_off - NEARLY_SHARE) / LONGER_SHARE:
            found, found_off = one, off
    begun = None if wanted.any_scale else _begun(points, along, ways, allowed)
    if begun is not None:
        return begun
    if found is None:
        return None
    found = _refined([found], allowed)[0]
    return _with_what_follows(found, points, along, wanted, drive)


def _misfit(figure: Figure, drive: Drive) -> float:
    """Return how far the figure is off, and the corners between its lines, where as many were driven."""
    driven = inner_corners(figure, drive)
    wanted = [corner_rad(*pair) for pair in itertools.pairwise(figure.track.stretches)]
    if driven is None or len(driven) != len(wanted):
        return figure.residual
    sign = -1.0 if figure.placed.mirrored else 1.0
    pairs = zip(driven, wanted, strict=True)
    off = (abs(math.remainder(one.angle_rad - sign * other, math.tau)) for one, other in pairs)
    return figure.residual + CORNER_COUNTS * max(off, default=0.0)


def _begun(points: Points, along: Floats, ways: tuple[Track, ...], allowed: _Allowed) -> Figure | None:
    """Return the wanted path if the whole drive lies on its first part: what is left out moves no other piece."""
    total = float(along[-1])
    found: Figure | None = None
    for way in ways:
        last = math.floor(total / way.length_m * (SAMPLES - 1))
        if not 2 <= last < UNFINISHED_SHARE * (SAMPLES - 1):
            continue
        reached = last / (SAMPLES - 1) * way.length_m
        given, driven = way.points[: last + 1], resampled(points, along, np.linspace(0.0, reached, last + 1))
        partners = np.minimum(np.arange(SAMPLES), last) / last * (SAMPLES - 1)
        pairs = np.stack([np.arange(SAMPLES), np.rint(partners).astype(int)], axis=1)
        for one in _tried(points, along, total, (way,), allowed):
            placed = allowed.placed(given, driven, mirrored=one.placed.mirrored)
            off = float(np.max(exact.magnitudes(placed.of(given) - driven))) / size_m(way.points)
            if off <= BEGUN_SHARE and (found is None or off < found.residual - NEARLY_SHARE):
                whole = placed.of(way.points)
                found = replace(one, placed=placed, wanted=whole, pairs=pairs, residual=off)
                found = replace(found, begun=total / way.length_m)
    return found


def _ends_of_laps(points: Points, along: Floats, least_m: float) -> Iterator[float]:
    """Yield how far the car had driven when it was back at its start, later ones first."""
    total = float(along[-1])
    at = np.linspace(0.0, total, LOOKED_AT)
    away = exact.magnitudes(resampled(points, along, at) - points[0])
    near = BACK_SHARE * size_m(points)
    inner = (away[1:-1] <= away[:-2]) & (away[1:-1] < away[2:]) & (away[1:-1] < near)
    back = [float(at[i + 1]) for i in np.flatnonzero(inner) if at[i + 1] > max(least_m, 0.02 * total)]
    yield from reversed(back[:LAPS_TRIED])


def _ends_of_pieces(path: Path, along: Floats, least_m: float) -> Iterator[float]:
    """Yield how far the car had driven at the ends of its straights and arcs, later ones first.

    An open path may end there, and what follows be something else; no other place says that a piece is done.
    """
    ends = {
        float(along[at]) for turn in segment(path).turns if turn is not None for at in (turn.first, turn.last)
    }
    later = [
        end_m
        for end_m in sorted(ends)
        if max(least_m, LEAST_M) < end_m < (1.0 - NO_LINE_SHARE) * float(along[-1])
    ]
    yield from reversed(later[:LAPS_TRIED])


def _tried(
    points: Points, along: Floats, end_m: float, ways: tuple[Track, ...], allowed: _Allowed
) -> Iterator[Figure]:
    """Yield each way of driving laid on a part of the path, point by point at equal distances."""
    driven = resampled(points, along, np.linspace(0.0, end_m, SAMPLES))
    fine = resampled(points, along, np.linspace(0.0, end_m, FINE))
    both = np.repeat(np.arange(SAMPLES)[:, None], 2, axis=1)
    for way in ways:
        given = way.points
        for mirrored in (False, True) if allowed.wanted.mirror else (False,):
            placed = allowed.placed(given, driven, mirrored=mirrored)
            there = placed.of(given)
            yield Figure(
                track=way,
                placed=placed,
                wanted=there,
                driven=driven,
                fine=fine,
                pairs=both,
                end_m=end_m,
                residual=_residual(there, driven),
            )


def _residual(there: Points, driven: Points) -> float:
    size = size_m(there)
    return exact.root_mean_square(there - driven) / size if size > LEAST_M else math.inf


def _refined(figures: Sequence[Figure], allowed: _Allowed, thinned: int = 1) -> list[Figure]:
    """Return the figures with a match in order, so that one side that is too long does not shift all others.

    Args:
        figures: laid on parts of one drive.
        allowed: where they may lie.
        thinned: use only each `thinned`-th point. The pairs then count these points and must not be used.
    """
    if not figures:
        return []
    given = [figure.track.points[::thinned] for figure in figures]
    driven = np.array([figure.driven[::thinned] for figure in figures])
    placed = [figure.placed for figure in figures]
    for _ in range(REFINED):
        pairs = _matched(placed, given, driven)
        placed = [
            allowed.placed(here[pair[:, 0]], there[pair[:, 1]], mirrored=one.mirrored)
            for one, here, there, pair in zip(placed, given, driven, pairs, strict=True)
        ]
    found = []
    last = _matched(placed, given, driven)
    for figure, one, here, there, pair in zip(figures, placed, given, driven, last, strict=True):
        residual = _residual(one.of(here)[pair[:, 0]], there[pair[:, 1]])
        wanted = one.of(figure.track.points)
        found.append(replace(figure, placed=one, wanted=wanted, pairs=pair, residual=residual))
    return found


def _matched(placed: Sequence[Similarity], given: Sequence[Points], driven: Points) -> list[NDArray[np.intp]]:
    """Return the match of each of the wanted paths, where it is placed, with its part of the drive."""
    there = np.array([one.of(points) for one, points in zip(placed, given, strict=True)])
    return matched_each(there, driven)


def _with_what_follows(
    figure: Figure, points: Points, along: Floats, wanted: WantedPath, drive: Drive
) -> Figure:
    left_m = float(along[-1]) - figure.end_m
    if left_m <= 0.03 * figure.end_m:
        return figure
    later = resampled(points, along, np.linspace(figure.end_m, float(along[-1]), SAMPLES))
    away = _nearest_m(later, figure.driven)
    laps = left_m / figure.end_m
    whole = drive.cut_short or abs(laps - max(round(laps), 1)) < 0.1
    again = wanted.laps and whole and float(np.max(away)) <= ON_IT_SHARE * figure.size_m
    strayed_m = 0.0 if figure.track.is_closed else float(np.max(_nearest_m(later, figure.wanted)))
    on_m = 0.0 if again else _straight_on_m(figure, drive.path)
    return replace(figure, repeated=again, overrun=not again, strayed_m=strayed_m, on_m=on_m)


def _straight_on_m(figure: Figure, path: Path) -> float:
    """Return how far the straight that leads to the figure's end goes beyond it; 0 if the car turned there."""
    along = np.maximum.accumulate(path.along_m)
    for straight in segment(path).straights:
        begin_m, end_m = float(along[straight.first]), float(along[straight.last])
        if begin_m < (1.0 - NO_LINE_SHARE) * figure.end_m < end_m:
            return max(end_m - figure.end_m, 0.0)
    return 0.0


def _nearest_m(points: Points, others: Points) -> Floats:
    """Return how far each point is from the nearest of the others."""
    return np.asarray(np.min(exact.magnitudes(points[:, None] - others[None, :]), axis=1))


def end_ns(figure: Figure, drive: Drive) -> int:
    """Return when the figure was complete."""
    along = np.maximum.accumulate(drive.path.along_m)
    return int(drive.t_ns[min(int(np.searchsorted(along, figure.end_m)), len(drive.t_ns) - 1)])


def driven_stretches(figure: Figure, drive: Drive) -> list[DrivenStretch]:
    """Return the pieces as they were driven; fewer than wanted only where one has no length.

    Lines end at the corners that were driven, where there are as many; other pieces where the match says so.
    """
    ends = _line_ends(figure, drive) or [
        _driven_index(figure, share) for share in (0.0, *figure.track.shares)
    ]
    found = []
    for stretch, first, last in zip(figure.track.stretches, ends, ends[1:], strict=False):
        if last - first >= 5:
            found.append(_measured(stretch, figure.fine[first : last + 1]))
    return _with_the_way_on(_from_corner_to_corner(found), figure.on_m)


def _with_the_way_on(found: list[DrivenStretch], on_m: float) -> list[DrivenStretch]:
    """Let a last line end where the car turned or stopped, which may be beyond the end of the path."""
    if not found or found[-1].wanted.kind != "line":
        return found
    *others, last = found
    end = last.end + exact.rect(on_m, last.ends_rad)
    return [*others, replace(last, end=end, length_m=last.length_m + on_m)]


def _line_ends(figure: Figure, drive: Drive) -> list[int]:
    """Return the points of `fine` at which the lines of a path without arcs end; none if others were driven."""
    inner = inner_corners(figure, drive)
    if inner is None or len(inner) != len(figure.track.stretches) - 1:
        return []
    ends_m = (0.0, *(corner.at_m for corner in inner), figure.end_m)
    return [round(end_m / figure.end_m * (FINE - 1)) for end_m in ends_m]


class DrivenCorner(NamedTuple):
    """A corner between two lines: how far along the way it was driven, and the change of direction."""

    at_m: float
    angle_rad: float


def inner_corners(figure: Figure, drive: Drive) -> list[DrivenCorner] | None:
    """Return the corners that were driven between two lines; None for a path with arcs."""
    if any(each.kind != "line" for each in figure.track.stretches):
        return None
    along, segments = np.maximum.accumulate(drive.path.along_m), segment(drive.path)
    corners = [
        DrivenCorner(
            float(along[half_turned(drive.path, turn)]),
            after.direction_rad - before.direction_rad - before.spun_rad,
        )
        for (before, after), turn in zip(
            itertools.pairwise(segments.straights), segments.turns[1:-1], strict=True
        )
        if turn is not None
    ]
    return [corner for corner in corners if corner.at_m < (1.0 - NO_LINE_SHARE) * figure.end_m]


def _driven_index(figure: Figure, share: float) -> int:
    """Return the point of `fine` that belongs to a share of the wanted path."""
    if share in (0.0, 1.0):
        return round(share * (FINE - 1))
    partners = figure.pairs[figure.pairs[:, 0] == round(share * (SAMPLES - 1)), 1]
    return round(median(partners) / (SAMPLES - 1) * (FINE - 1))


def _measured(stretch: Stretch, points: Points) -> DrivenStretch:
    start, end = complex(points[0]), complex(points[-1])
    inner = points[len(points) // 8 : len(points) - len(points) // 8]
    circle = circle_through(inner) if stretch.kind == "arc" else None
    if circle is None:
        direction = _direction(inner)
        return DrivenStretch(
            wanted=stretch,
            start=start,
            end=end,
            length_m=math.nan if stretch.kind == "arc" else exact.magnitude(end - start),
            begins_rad=direction,
            ends_rad=direction,
        )
    quarter = math.copysign(math.pi / 2.0, circle.swept_rad)
    return DrivenStretch(
        wanted=stretch,
        start=start,
        end=end,
        length_m=circle.radius_m * abs(circle.swept_rad),
        begins_rad=exact.phase(start - circle.centre) + quarter,
        ends_rad=exact.phase(end - circle.centre) + quarter,
        radius_m=circle.radius_m,
        deviation_m=circle.deviation_m,
        centre=circle.centre,
        swept_rad=circle.swept_rad,
    )


def _direction(points: Points) -> float:
    """Return the direction of the line of least squares through points, towards the last of them."""
    axis = exact.rect(1.0, exact.axis(points - exact.middle(points)))
    ahead = complex(points[-1] - points[0])
    return exact.phase(axis if (axis * ahead.conjugate()).real >= 0.0 else -axis)


def _from_corner_to_corner(found: list[DrivenStretch]) -> list[DrivenStretch]:
    """Let two lines that meet in a corner end in its vertex, where their middles lead to."""
    for i in range(len(found) - 1):
        before, after = found[i], found[i + 1]
        if before.wanted.kind != "line" or after.wanted.kind != "line":
            continue
        vertex = _vertex(before, after)
        if vertex is not None:
            found[i] = replace(before, end=vertex, length_m=exact.magnitude(vertex - before.start))
            found[i + 1] = replace(after, start=vertex, length_m=exact.magnitude(after.end - vertex))
    return found


def _vertex(before: DrivenStretch, after: DrivenStretch) -> complex | None:
    ahead, next_ahead = exact.rect(1.0, before.ends_rad), exact.rect(1.0, after.begins_rad)
    cross = (ahead.conjugate() * next_ahead).imag
    if abs(cross) < exact.sin(MIN_CORNER_RAD):
        return None
    way = ((after.end - before.start).conjugate() * next_ahead).imag / cross
    vertex = before.start + way * ahead
    near = 0.25 * min(before.length_m, after.length_m)
    return vertex if exact.magnitude(vertex - before.end) <= near else None


def corners_deg(stretches: list[DrivenStretch], *, mirrored: bool) -> list[tuple[float, float]]:
    """Return the driven and the wanted change of direction at each corner between two pieces."""
    found = []
    for before, after in itertools.pairwise(stretches):
        wanted = corner_rad(before.wanted, after.wanted)
        wanted = -wanted if mirrored else wanted
        if abs(wanted) >= MIN_CORNER_RAD:
            driven = math.remainder(after.begins_rad - before.ends_rad - wanted, math.tau) + wanted
            found.append((math.degrees(driven), math.degrees(wanted)))
    return found


def as_turned_deg(driven_deg: float) -> float:
    """Return a change of direction as one would say it: what comes to 270 degrees is 90 the other way."""
    return math.remainder(driven_deg, 360.0)
