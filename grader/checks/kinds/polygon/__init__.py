"""Check ``polygon``: a closed figure of equal corners; its sides are equal, or of given lengths."""

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from grader.checks.drive import Drive, drive_of, pushed_m
from grader.checks.fit import Misfit, is_number
from grader.checks.kinds.polygon.figures import (
    DrivenPolygon,
    WantedPolygon,
    coarse_readings,
    fine_readings,
    wanted_polygon,
)
from grader.checks.kinds.polygon.mistakes import polygon_mistakes
from grader.checks.measure import UNMEASURED, Check, Measure, MeasureKind, Measures, Mistake, Option
from grader.checks.mistakes import driving_mistakes
from grader.checks.scoring import band_error, credit, fits, points_of
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch, Point, SketchCorner, SketchSide
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text
from grader.contracts.trajectory import Floats, Trajectory
from grader.geometry import exact
from grader.geometry.figure import PolygonFigure
from grader.geometry.path import median, without_overshoots
from grader.messages import say
from grader.messages.quantity import listed, number

MEASURES = {
    "distance_m": MeasureKind("m"),
    "sides": MeasureKind(form="count"),
    "corner_deg": MeasureKind("deg"),
    "side_spread_pct": MeasureKind("%"),
    "side_error_pct": MeasureKind("%"),
    "curved_pct": MeasureKind("%"),
    "opposite_corners": MeasureKind(form="count"),
    "gap_pct": MeasureKind("%"),
    "settled": MeasureKind(form="flag"),
}


# Of the points for the number of sides: left with one too many; half of it with two.
EXTRA_SIDE_SHARE = 2.0 / 3.0

_LENGTHS = ("side_spread_pct", "side_error_pct")
_OF_THE_SIDES = ("corner_deg", "curved_pct", "opposite_corners")
_OF_THE_FIGURE = ("curved_pct", "opposite_corners", "gap_pct", "settled")
_ONLY_RECTANGLES = Text(
    zh="只用于 4 条边，和 side_m 一起：请删掉", en="only for 4 sides, beside side_m; remove it"
)
_NO_SIDE = Text(
    zh="缺少：测量值 'side_error_pct' 要和它比较", en="missing; the measure 'side_error_pct' compares with it"
)


def measure(assignment: Assignment, run: Run) -> Measures:
    """Measure the figure that the car drove in `run`."""
    drive = drive_of(run)
    return {} if drive is None else read(assignment, run, drive)[1]


def explain(assignment: Assignment, run: Run, measures: Measures) -> tuple[Mistake, ...]:
    """Return what probably went wrong."""
    drive = drive_of(run)
    if drive is None:
        return driving_mistakes(run, ())
    wanted, (driven, _) = wanted_polygon(assignment.options), read(assignment, run, drive)
    return driving_mistakes(run, polygon_mistakes(assignment, run, wanted, driven))


def read(assignment: Assignment, run: Run, drive: Drive) -> tuple[DrivenPolygon, Measures]:
    """Return of the ways to read a drive as a figure the one that earns most, and its measures.

    Of several that earn as much it is the plainest.
    """
    drive = replace(drive, path=without_overshoots(drive.path))
    wanted = wanted_polygon(assignment.options)
    fine = fine_readings(assignment, wanted, drive)
    best = _best(assignment, run, wanted, fine)
    another = max(each.anotherness(wanted) for each in fine)
    if drive.path.extent_m <= 0.0 or another >= 1.0 or _is_plain(best[0], wanted):
        return best
    coarse = coarse_readings(assignment, wanted, drive, another)
    return _best(assignment, run, wanted, itertools.chain([best[0]], coarse))


def _best(
    assignment: Assignment, run: Run, wanted: WantedPolygon, readings: Iterable[DrivenPolygon]
) -> tuple[DrivenPolygon, Measures]:
    measured = ((each, _measures(assignment, wanted, each, _wall_m(run, each))) for each in readings)
    return max(measured, key=lambda pair: round(points_of(assignment.items, pair[1]), 2))


def _is_plain(best: DrivenPolygon, wanted: WantedPolygon) -> bool:
    """Whether a coarser look has nothing to better: as many sides as are wanted, and none of them bends.

    What was driven before the figure may be a part of its first side.
    """
    figure, count = best.figure, len(best.segments.straights)
    if figure is None or count < 3:
        return False
    as_wanted = count == wanted.sides or best.is_on_the_whole(wanted)
    return as_wanted and max(figure.bows) <= 0.0 and figure.approach_m <= 0.0


def _measures(
    assignment: Assignment, wanted: WantedPolygon, driven: DrivenPolygon, wall_m: float
) -> dict[str, Measure]:
    figure = driven.figure
    taken = {
        "distance_m": Measure(float(driven.drive.path.along_m[-1])),
        "sides": Measure(0.0, {"lengths": "—", "part": EMPTY}),
        "settled": _settled(driven),
    }
    if figure is None:
        return taken
    taken["sides"] = _side_count(assignment, figure, wanted, driven.left_out(wanted))
    taken["curved_pct"] = Measure(100.0 * figure.curved_share)
    taken["gap_pct"] = _gap_measure(driven, figure)
    taken |= _corner_measures(assignment, wanted, driven)
    done = driven.done_share(wanted)
    taken |= {name: _of_a_part(taken[name], done) for name in _OF_THE_SIDES if name in taken}
    taken |= _lengths(assignment, wanted, driven, wall_m)
    if (otherness := round(driven.otherness(wanted), 3)) > 0.0:
        counted = len(figure.sides_m) == wanted.sides and driven.rival <= 0.0
        spoilt = _OF_THE_FIGURE if counted else (*_OF_THE_FIGURE, *_LENGTHS)
        taken |= {name: _of_another(taken[name], otherness) for name in spoilt if name in taken}
        if not counted:
            share = taken["sides"].share * (1.0 - otherness)
            taken["sides"] = _shared(taken["sides"], share, say("polygon.near_another"))
    return taken


def _of_a_part(measure: Measure, done: float) -> Measure:
    """Return a measure of the sides that were driven, which are a part of those that are wanted."""
    return measure if done >= 1.0 else _shared(measure, measure.share * done, say("polygon.part_of_figure"))


def _shared(measure: Measure, share: float, why: Text) -> Measure:
    return replace(measure, details={**measure.details, "why": why}, share=share)


def _lengths(
    assignment: Assignment, wanted: WantedPolygon, driven: DrivenPolygon, wall_m: float
) -> dict[str, Measure]:
    """Return the measures of the sides' lengths, as far as these sides are the wanted ones.

    A last side that was begun and not driven to its end must not cost more than if it had not been begun.
    """
    figure = driven.figure
    assert figure is not None
    taken = _lengths_of(wanted, figure.sides_m, wall_m)
    if driven.left_out(wanted, whole=1.0) <= 0.0:
        return taken
    without = _lengths_of(wanted, figure.sides_m[:-1], wall_m)
    return {
        name: max(taken[name], without[name], key=lambda one: _credit(assignment, name, one))
        for name in taken
    }


def _credit(assignment: Assignment, name: str, measure: Measure) -> float:
    spec = assignment.item_on(name)
    return measure.share if spec is None else credit(spec, measure.value) * measure.share


def _lengths_of(wanted: WantedPolygon, sides_m: Sequence[float], wall_m: float) -> dict[str, Measure]:
    taken = {"side_spread_pct": _spread(sides_m, wall_m)}
    if wanted.lengths_m is not None:
        taken["side_error_pct"] = _side_error(wanted, sides_m)
    share = min(len(sides_m) / wanted.sides, 1.0)
    return {name: _of_a_part(one, share) for name, one in taken.items()}


def _of_another(measure: Measure, otherness: float) -> Measure:
    """Return a measure of another figure, which earns nothing for being driven well."""
    if otherness >= 1.0:
        return Measure(math.nan, {"why": say("polygon.other")})
    return _shared(measure, measure.share * (1.0 - otherness), say("polygon.near_another"))


def _side_count(
    assignment: Assignment, figure: PolygonFigure, wanted: WantedPolygon, left_out: float
) -> Measure:
    """Return the number of sides, less what was left out of the last one.

    From some bend on, a side is taken for a turn, and the corners beside it are lost as well. So that the score
    does not jump there, less of the number counts the more sides bend.
    """
    count = len(figure.sides_m)
    part = say("polygon.part_of_side") if left_out > 0.0 else EMPTY
    counted = Measure(count - left_out, {"lengths": listed(figure.sides_m, "m"), "part": part})
    if count == 1:
        return _shared(counted, 0.0, say("polygon.part_of_figure"))  # a straight is no part of a figure
    straight = _of_bent(_worst_and_mean(figure.bows))
    if count > wanted.sides:
        most = _credit(assignment, "sides", counted)
        share = min(EXTRA_SIDE_SHARE / (count - wanted.sides) / most, 1.0) if most > 0.0 else 1.0
        return _shared(counted, straight * share, say("polygon.part_of_figure"))
    return _shared(counted, straight, say("polygon.bent_sides")) if straight < 1.0 else counted


def _of_bent(bow: float) -> float:
    """Return the share that is left of the number of sides that bend.

    All items need the number. They lose by it from half of its points on, so the second half is lost slowly.
    """
    return max(1.0 - 2.0 * bow, (1.0 - bow) / 1.5)


def _worst_and_mean(errors: Sequence[float]) -> float:
    """Return the mean of the largest of some errors and of all of them: one counts much, and the others, too."""
    return (max(errors) + exact.mean(np.array(errors))) / 2.0


def _gap_measure(driven: DrivenPolygon, figure: PolygonFigure) -> Measure:
    """Return the gap, or the way that was driven after the figure if that is longer."""
    on_m = driven.drove_on_m
    gap = 100.0 * max(figure.gap_m, on_m) / figure.perimeter_m if figure.perimeter_m > 0.0 else math.nan
    after = say("polygon.drove_on", length=number(on_m, "m")) if on_m > 0.0 else EMPTY
    details = {"gap": number(figure.gap_m, "m"), "perimeter": number(figure.perimeter_m, "m"), "after": after}
    return _of_laps(figure, Measure(gap, details))


def _of_laps(figure: PolygonFigure, measure: Measure) -> Measure:
    """Return a measure of the end of a figure, which counts less where later laps are not quite the same."""
    if not 0.0 < figure.repeated < 1.0:
        return measure
    return _shared(measure, figure.repeated, say("polygon.part_of_figure"))


def _settled(driven: DrivenPolygon) -> Measure:
    figure = driven.figure
    if figure is not None and figure.repeated > 0.0:
        return _of_laps(figure, Measure(1.0))
    under_way = driven.drive.moving_at_end  # a car that turtlesim stopped after its hold has stopped
    went_on = driven.turned_on or (figure is not None and figure.overrun)
    return Measure(0.0 if under_way or went_on else 1.0)


def _wall_m(run: Run, driven: DrivenPolygon) -> float:
    """Return how much a wall took off a side of the figure, at most."""
    end = 0 if driven.figure is None else driven.figure.end
    return pushed_m(run.trajectory, int(driven.drive.t_ns[end]))


def _spread(sides_m: Sequence[float], wall_m: float) -> Measure:
    """Return by how much the sides differ, including the length that a wall took off one of them."""
    longest, shortest, mean = max(sides_m), min(sides_m), exact.mean(sides_m)
    return Measure(
        100.0 * (longest - shortest + wall_m) / mean if mean > 0.0 else math.nan,
        {
            "longest": number(longest, "m"),
            "shortest": number(shortest, "m"),
            "wall": say("polygon.wall_took", length=number(wall_m, "m")) if wall_m > 0.0 else EMPTY,
        },
    )


def _side_error(wanted: WantedPolygon, sides_m: Sequence[float]) -> Measure:
    aligned = wanted.aligned(sides_m)
    return Measure(
        wanted.side_error_pct(sides_m),
        {"lengths": listed(sides_m, "m"), "wanted": listed(aligned, "m")},
    )


def _corner_measures(
    assignment: Assignment, wanted: WantedPolygon, driven: DrivenPolygon
) -> dict[str, Measure]:
    corners = driven.corners_deg
    if len(corners) == 0:
        return {"corner_deg": UNMEASURED, "opposite_corners": UNMEASURED}
    turned = driven.sense * driven.turned_deg
    left, right = int(np.count_nonzero(turned > 0.0)), int(np.count_nonzero(turned < 0.0))
    against, far = int(np.count_nonzero(corners < 0.0)), int(np.count_nonzero(driven.long_way))
    worst = max(corners.tolist(), key=lambda corner: abs(corner - wanted.corner_deg))
    counted = _counted_deg(assignment, wanted, driven, worst)
    seen, counts = number(worst, "deg"), number(counted, "deg")
    details = {
        "corners": listed(corners, "deg"),
        "ideal": number(wanted.corner_deg, "deg"),
        "counts": say("polygon.corner_is") if counts == seen else say("polygon.corner_counts", worst=seen),
    }
    return {
        "corner_deg": Measure(counted, details),
        "opposite_corners": Measure(
            float(max(against, far)),
            {"left": left, "right": right, "far": say("polygon.far", count=far) if far else EMPTY},
        ),
    }


def _counted_deg(
    assignment: Assignment, wanted: WantedPolygon, driven: DrivenPolygon, worst_deg: float
) -> float:
    """Return the corner that counts: as far outside of the band as the worst and the mean corner on average.

    A turn after the last side that is better than the worst corner, but not than most, makes nothing worse.
    """
    spec, inner = assignment.item_on("corner_deg"), len(driven.figure.corners_rad) if driven.figure else 0
    if spec is None:
        return worst_deg
    errors = [band_error(spec, corner) for corner in driven.corners_deg.tolist()]
    counted = min(_worst_and_mean(errors), _worst_and_mean(errors[:inner] or errors))
    return worst_deg - math.copysign(max(errors) - counted, worst_deg - wanted.corner_deg)


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return sides, corners and gap, whether they fit, and the wanted figure fitted to the driven one.

    Points are where the car was recorded, so that they lie on the drawn path even after a teleport.
    """
    drive, wanted = drive_of(run), wanted_polygon(assignment.options)
    driven = None if drive is None else read(assignment, run, drive)[0]
    if driven is None or driven.figure is None:
        return FigureSketch()
    trajectory, figure = run.trajectory, driven.figure
    corners_deg = driven.sense * driven.corners_deg  # positive to the left, as plots show them
    points = [_point(trajectory, i) for i in figure.vertices]
    return FigureSketch(
        view="path",
        sides=_sides(points, figure, wanted, assignment),
        corners=_corners(points, corners_deg, assignment),
        ideal_m=ideal_polygon(points, figure, wanted),
        gap=_gap(trajectory, figure, assignment),
        begin_ns=int(trajectory.t_ns[figure.vertices[0]]) if figure.approach_m > 0.0 else 0,
        end_ns=int(trajectory.t_ns[figure.end]),
    )


def _sides(
    points: list[Point], figure: PolygonFigure, wanted: WantedPolygon, assignment: Assignment
) -> tuple[SketchSide, ...]:
    """Compare each side with its wanted length, or with the median side where only the spread is scored."""
    lengths = [exact.apart(start, end) for start, end in itertools.pairwise(points)]
    band = assignment.item_on("side_error_pct") or assignment.item_on("side_spread_pct")
    targets = wanted.aligned(figure.sides_m) or (median(figure.sides_m),) * len(figure.sides_m)
    sides = []
    for i, (start, end) in enumerate(itertools.pairwise(points)):
        ok = None
        if band is not None and band.high is not None and len(lengths) == len(figure.sides_m):
            ok = 100.0 * abs(lengths[i] - targets[i]) <= band.high * targets[i]
        sides.append(SketchSide(start_m=start, end_m=end, length_m=lengths[i], ok=ok))
    return tuple(sides)


def _corners(points: list[Point], corners_deg: Floats, assignment: Assignment) -> tuple[SketchCorner, ...]:
    sense = math.copysign(1.0, exact.total(corners_deg))
    return tuple(
        SketchCorner(at_m=at, angle_deg=corner, ok=fits(assignment, "corner_deg", sense * corner))
        for at, corner in zip(points[1:], corners_deg.tolist(), strict=False)
    )


def _gap(trajectory: Trajectory, figure: PolygonFigure, assignment: Assignment) -> SketchSide:
    gap_pct = 100.0 * figure.gap_m / figure.perimeter_m if figure.perimeter_m > 0.0 else math.nan
    return SketchSide(
        start_m=_point(trajectory, figure.start),
        end_m=_point(trajectory, figure.rest),
        length_m=figure.gap_m,
        ok=fits(assignment, "gap_pct", gap_pct),
    )


def _point(trajectory: Trajectory, index: int) -> Point:
    return float(trajectory.x_m[index]), float(trajectory.y_m[index])


def ideal_polygon(points: list[Point], figure: PolygonFigure, wanted: WantedPolygon) -> tuple[Point, ...]:
    """Lay the wanted polygon where the car set out, along its first side, so that the first error shows first.

    It has the driven sense of turning, and the wanted size; where that is free, the size of the median side.
    """
    if len(points) < 2 or points[0] == points[1]:
        return ()
    begun_in_a_side = len(points) == len(figure.sides_m) + 2  # then start and end are no vertices
    corner = complex(*points[1 if begun_in_a_side else 0])
    shape = np.array(wanted.vertices(_first_length_m(figure, wanted, later=begun_in_a_side)))
    if exact.total(figure.corners_rad) < 0.0:
        shape = np.conj(shape)
    first = complex(*points[1]) - complex(*points[0])
    along = complex(
        shape[0] - shape[-1] if begun_in_a_side else shape[1] - shape[0]
    )  # the same side, as wanted
    scale = first / exact.magnitude(first) * along.conjugate() / exact.magnitude(along)
    scale *= 1.0 if wanted.lengths_m is not None else median(figure.sides_m)
    return tuple((float(one.real), float(one.imag)) for one in corner + exact.turned(shape - shape[0], scale))


def _first_length_m(figure: PolygonFigure, wanted: WantedPolygon, *, later: bool) -> float | None:
    """Return the wanted length of the side after the first vertex; `later`: the path began in a side."""
    aligned = wanted.aligned(figure.sides_m)
    return aligned[1 if later and len(aligned) > 1 else 0] if aligned else None


def _problem_with_sides(value: Option) -> Text | None:
    if isinstance(value, bool) or not isinstance(value, int) or not 3 <= value <= 12:
        return Text(zh="要填 3 到 12 的整数", en="must be a whole number from 3 to 12")
    return None


def _problem_with_length(value: Option) -> Text | None:
    if not is_number(value) or not 0.1 <= value <= 10.0:
        return Text(zh="要填 0.1 到 10 米的长度", en="must be a length from 0.1 to 10 m")
    return None


def _consult(assignment: Assignment) -> Iterator[Misfit]:
    for case in assignment.cases:
        options = {**assignment.options, **case.options}
        if "other_side_m" in options and (options.get("sides") != 4 or "side_m" not in options):
            yield "options.other_side_m", _ONLY_RECTANGLES
        if "side_m" not in options and assignment.item_on("side_error_pct") is not None:
            yield "options.side_m", _NO_SIDE


CHECK = Check(
    kind="polygon",
    measures=MEASURES,
    options={"sides": _problem_with_sides},
    optional={"side_m": _problem_with_length, "other_side_m": _problem_with_length},
    consult=_consult,
    measure=measure,
    explain=explain,
    sketch=sketch,
)
