"""Check ``path``: a path that the assignment describes, laid on the driven one as well as it allows."""

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from grader.checks.drive import Drive, drive_of
from grader.checks.fit import Misfit, unmet
from grader.checks.kinds.path.driven import (
    DrivenStretch,
    Figure,
    as_turned_deg,
    corners_deg,
    driven_stretches,
    end_ns,
    looked_at,
)
from grader.checks.kinds.path.mistakes import name_of, named_corner, path_mistakes
from grader.checks.kinds.path.wanted import go_on, track_of
from grader.checks.measure import UNMEASURED, Check, Measure, MeasureKind, Measures, Mistake
from grader.checks.mistakes import driving_mistakes
from grader.checks.scoring import earns_all, fits, points_of
from grader.contracts.assignment import Assignment, WantedPath
from grader.contracts.figure import FigureSketch, Point, SketchCorner, SketchLabel, SketchSide
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text
from grader.geometry import exact
from grader.geometry.exact import Points
from grader.messages import say
from grader.messages.quantity import number

_BEGINNING = 3  # points on, in whose direction a path begins: before any piece ends

MEASURES = {
    "distance_m": MeasureKind("m"),
    "off_pct": MeasureKind("%"),
    "mean_off_pct": MeasureKind("%"),
    "covered_pct": MeasureKind("%"),
    "corner_error_deg": MeasureKind("deg"),
    "length_error_pct": MeasureKind("%"),
    "radius_error_pct": MeasureKind("%"),
    "round_pct": MeasureKind("%"),
    "touch_pct": MeasureKind("%"),
    "gap_pct": MeasureKind("%"),
    "settled": MeasureKind(form="flag"),
}
# Of the size: a path of another size that is off by no more is the wanted one; from twice that on none of it is.
ALIKE_SHARE = 0.025
SIZE_FACTOR = 5.0  # one that is larger or smaller by more fits by chance
_Pair = Callable[[DrivenStretch], tuple[float, float]]
_NO_PATH = Text(
    zh="缺少：写上 path 和它的 pieces，例如 pieces: [{line: 2.0}, {turn: 90}]",
    en="missing; give path with its pieces, such as pieces: [{line: 2.0}, {turn: 90}]",
)
_NOT_RECORDED = Text(
    zh="还没有记录答案走的路，或者 solution.py 后来改过：运行 `grader assignments validate`",
    en="what the solution drives is not recorded, or solution.py has changed; run `grader assignments validate`",
)
_NOTHING_DRIVEN = Text(
    zh="里面没有走的路：加上 line、arc 或 goto", en="nothing of it is driven; add a line, arc or goto"
)
_NO_LINES = Text(
    zh="路径里没有 line 或 goto：删掉这一项", en="the path has no line or goto; remove this item"
)
_NO_ARCS = Text(zh="路径里没有 arc：删掉这一项", en="the path has no arc; remove this item")
_NO_TOUCH = Text(
    zh="路径里没有一段弧接着另一段弧：删掉这一项",
    en="the path has no arc that goes on as another one; remove this item",
)
_NO_CORNERS = Text(zh="路径里没有转角：删掉这一项", en="the path has no corner; remove this item")


def measure(assignment: Assignment, run: Run) -> Measures:
    """Measure how well the driven path is the wanted one.

    Of a path with a size of its own it is measured as well as if any size would do: of the right shape in another
    size only its lengths and radii are wrong. What earns more counts.
    """
    drive, wanted = drive_of(run), assignment.path
    if drive is None or wanted is None:
        return {}
    sized = _measures(*looked_at(drive, wanted, assignment.world.start))
    resized = None if earns_all(assignment.items, sized) else _resized(assignment, wanted, drive)
    return resized[1] if resized is not None and _earns_more(assignment, resized[1], sized) else sized


def _earns_more(assignment: Assignment, one: Measures, other: Measures) -> bool:
    return round(points_of(assignment.items, one), 2) > round(points_of(assignment.items, other), 2)


def _resized(
    assignment: Assignment, wanted: WantedPath, drive: Drive
) -> tuple[Figure, dict[str, Measure]] | None:
    """Return the wanted path in another size, laid on a drive, and its measures; None where it does not fit."""
    if wanted.any_scale:
        return None
    part, figure = looked_at(drive, replace(wanted, any_scale=True), assignment.world.start)
    if figure is None or not 1.0 / SIZE_FACTOR < figure.placed.scale < SIZE_FACTOR:
        return None
    like = 2.0 - figure.apart_m / figure.size_m / ALIKE_SHARE
    if like <= 0.0:
        return None
    share, why = min(like, 1.0), {"why": say("path.resized")}
    taken = _measures(part, figure, scale=1.0)
    less = {name: replace(each, share=share, details={**why, **each.details}) for name, each in taken.items()}
    return figure, {**less, "distance_m": taken["distance_m"]}


def _measures(drive: Drive, figure: Figure | None, scale: float | None = None) -> dict[str, Measure]:
    """Measure a figure. `scale`: by how much its pieces should be enlarged; None: by as much as the whole path."""
    measures = {"distance_m": Measure(float(np.max(drive.path.along_m))), "settled": _settled(drive, figure)}
    if figure is not None:
        stretches = driven_stretches(figure, drive)
        measures |= _of_the_whole(figure, _drove_on_m(drive, figure))
        measures |= _of_the_pieces(figure, stretches, figure.placed.scale if scale is None else scale)
    return measures


def explain(assignment: Assignment, run: Run, measures: Measures) -> tuple[Mistake, ...]:
    """Return what probably went wrong."""
    drive, wanted = drive_of(run), assignment.path
    if drive is None or wanted is None:
        return driving_mistakes(run, ())
    part, figure = looked_at(drive, wanted, assignment.world.start)
    return driving_mistakes(run, path_mistakes(assignment, run, part, figure))


def _settled(drive: Drive, figure: Figure | None) -> Measure:
    if figure is not None and figure.repeated:
        return Measure(1.0)
    return Measure(0.0 if drive.moving_at_end or (figure is not None and figure.overrun) else 1.0)


def _drove_on_m(drive: Drive, figure: Figure) -> float:
    """Return how far the car drove on after the path, before it came to rest by itself."""
    if not figure.overrun or drive.cut_short:
        return 0.0
    return float(np.max(drive.path.along_m)) - figure.end_m


def _of_the_whole(figure: Figure, on_m: float) -> dict[str, Measure]:
    size, length = figure.size_m, figure.track.length_m * figure.placed.scale
    away, nearest = max(figure.apart_m, figure.strayed_m), figure.distances_m
    mean = exact.mean(nearest)
    ends = (figure.driven[-1] - figure.driven[0]) - (figure.wanted[-1] - figure.wanted[0])
    gap = exact.magnitude(complex(ends))
    gap = max(gap, figure.approach_m)  # the car ends where the path begins, not where it set out
    after = say("path.drove_on", length=number(on_m, "m")) if on_m > 0.0 else EMPTY
    if size <= 0.0 or length <= 0.0:
        return {}
    return {
        "off_pct": Measure(100.0 * away / size, {"away": number(away, "m"), "size": number(size, "m")}),
        "mean_off_pct": Measure(100.0 * mean / size, {"away": number(mean, "m"), "size": number(size, "m")}),
        "covered_pct": Measure(100.0 * figure.covered_share),
        "gap_pct": Measure(
            100.0 * max(gap, on_m) / length,
            {"gap": number(gap, "m"), "length": number(length, "m"), "after": after},
        ),
    }


def _of_the_pieces(figure: Figure, stretches: list[DrivenStretch], scale: float) -> dict[str, Measure]:
    if len(stretches) < len(figure.track.stretches):
        return {}
    lines = [stretch for stretch in stretches if stretch.wanted.kind == "line"]
    arcs = [stretch for stretch in stretches if stretch.wanted.kind == "arc"]
    taken = {"corner_error_deg": _corners(figure, stretches)}
    if lines:
        taken["length_error_pct"] = _worst(lines, lambda one: (one.length_m, scale * one.wanted.length_m))
    if arcs:
        taken["radius_error_pct"] = _worst(arcs, lambda one: (one.radius_m, scale * one.wanted.radius_m))
        taken["round_pct"] = _roundness(arcs)
        taken["touch_pct"] = _touch(stretches)
    return taken


def _corners(figure: Figure, stretches: list[DrivenStretch]) -> Measure:
    corners = corners_deg(stretches, mirrored=figure.placed.mirrored)
    if not corners:
        return UNMEASURED
    driven, wanted = max(corners, key=lambda pair: abs(pair[0] - pair[1]))
    return Measure(abs(driven - wanted), named_corner(driven, wanted))


def _worst(stretches: Sequence[DrivenStretch], pair: _Pair) -> Measure:
    """Return the largest share by which a piece is off what is wanted, and which piece that is."""
    errors = [_error_pct(*pair(stretch)) for stretch in stretches]
    if any(math.isnan(error) for error in errors):
        return UNMEASURED
    worst = stretches[int(np.argmax(errors))]
    driven, wanted = (number(value, "m") for value in pair(worst))
    return Measure(max(errors), {"piece": name_of(worst.wanted), "driven": driven, "wanted": wanted})


def _error_pct(driven: float, wanted: float) -> float:
    return 100.0 * abs(driven - wanted) / wanted if wanted > 0.0 else math.nan


def _roundness(arcs: Sequence[DrivenStretch]) -> Measure:
    shares = [100.0 * arc.deviation_m / arc.radius_m for arc in arcs]
    if any(math.isnan(share) for share in shares):
        return UNMEASURED
    worst = arcs[int(np.argmax(shares))]
    details = {"piece": name_of(worst.wanted), "deviation": number(worst.deviation_m, "m")}
    return Measure(max(shares), details)


def _touch(stretches: Sequence[DrivenStretch]) -> Measure:
    """Return how far the centres of two arcs that touch are from where they should be, for the worst two."""
    found = []
    for before, after in itertools.pairwise(stretches):
        if not go_on(before.wanted, after.wanted):
            continue
        radii_m = before.radius_m, after.radius_m
        same_way = before.wanted.angle_deg * after.wanted.angle_deg > 0.0
        wanted_m = abs(radii_m[0] - radii_m[1]) if same_way else exact.total(radii_m)
        driven_m = exact.magnitude(after.centre - before.centre)
        found.append(
            (100.0 * abs(driven_m - wanted_m) / exact.total(radii_m), driven_m, wanted_m, before, after)
        )
    if not found or any(math.isnan(one[0]) for one in found):
        return UNMEASURED
    error, driven_m, wanted_m, before, after = max(found, key=lambda one: one[0])
    names = {"first": name_of(before.wanted), "second": name_of(after.wanted)}
    return Measure(error, {**names, "driven": number(driven_m, "m"), "wanted": number(wanted_m, "m")})


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the wanted path from where the car set out, and the driven pieces with lengths, corners and radii."""
    drive = drive_of(run)
    figure = None
    if drive is not None and assignment.path is not None:
        drive, figure = looked_at(drive, assignment.path, assignment.world.start)
    if drive is None or figure is None:
        return FigureSketch()
    stretches, scale = driven_stretches(figure, drive), figure.placed.scale
    return FigureSketch(
        view="path",
        sides=tuple(
            _side(assignment, stretch, scale) for stretch in stretches if stretch.wanted.kind == "line"
        ),
        corners=_sketched_corners(assignment, figure, stretches),
        ideal_m=tuple(_point(point) for point in _from_the_start(figure).tolist()),
        ideal_closed=False,
        labels=tuple(
            _radius_label(assignment, stretch, scale)
            for stretch in stretches
            if not math.isnan(stretch.radius_m)
        ),
        end_ns=end_ns(figure, drive),
    )


def _from_the_start(figure: Figure) -> Points:
    """Return the wanted path, begun as the driven one is, so that the first error shows first."""
    wanted, driven = figure.wanted - figure.wanted[0], figure.driven - figure.driven[0]
    if wanted[_BEGINNING] == 0 or driven[_BEGINNING] == 0:
        return figure.wanted
    turn = complex(driven[_BEGINNING]) * complex(wanted[_BEGINNING]).conjugate()
    start = complex(figure.driven[0])
    return start + exact.turned(wanted, turn / exact.magnitude(turn))


def _side(assignment: Assignment, one: DrivenStretch, scale: float) -> SketchSide:
    error = _error_pct(one.length_m, scale * one.wanted.length_m)
    ok = fits(assignment, "length_error_pct", error)
    return SketchSide(start_m=_point(one.start), end_m=_point(one.end), length_m=one.length_m, ok=ok)


def _sketched_corners(
    assignment: Assignment, figure: Figure, stretches: list[DrivenStretch]
) -> tuple[SketchCorner, ...]:
    found = []
    for before, after in itertools.pairwise(stretches):
        for driven, wanted in corners_deg([before, after], mirrored=figure.placed.mirrored):
            ok = fits(assignment, "corner_error_deg", abs(driven - wanted))
            found.append(SketchCorner(at_m=_point(before.end), angle_deg=as_turned_deg(driven), ok=ok))
    return tuple(found)


def _radius_label(assignment: Assignment, one: DrivenStretch, scale: float) -> SketchLabel:
    ok = fits(assignment, "radius_error_pct", _error_pct(one.radius_m, scale * one.wanted.radius_m))
    text = Text(zh=f"r = {number(one.radius_m, 'm')}", en=f"r = {number(one.radius_m, 'm')}")
    return SketchLabel(at_m=_point(one.centre), text=text, ok=ok)


def _point(at: complex) -> Point:
    return at.real, at.imag


def _consult(assignment: Assignment) -> Iterable[Misfit]:
    if assignment.path is None:
        return (("path", _NO_PATH),)
    if assignment.path.by_solution and not assignment.path.trace:
        return (("path.reference", _NOT_RECORDED),)
    track = track_of(assignment.path)
    if track is None:
        return (("path.pieces", _NOTHING_DRIVEN),)
    kinds = {stretch.kind for stretch in track.stretches}
    return unmet(
        assignment,
        (("length_error_pct",), "line" in kinds, _NO_LINES),
        (("radius_error_pct", "round_pct"), "arc" in kinds, _NO_ARCS),
        (("corner_error_deg",), track.has_corners, _NO_CORNERS),
        (("touch_pct",), any(map(go_on, track.stretches, track.stretches[1:])), _NO_TOUCH),
    )


CHECK = Check(
    kind="path", measures=MEASURES, consult=_consult, measure=measure, explain=explain, sketch=sketch
)
