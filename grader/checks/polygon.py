"""Check ``polygon``: a closed regular figure with a given number of sides."""

import math

import numpy as np

from grader.checks.drive import Drive, drive_of
from grader.checks.measure import UNMEASURED, Check, Findings, Measure, MeasureKind, Option
from grader.checks.mistakes.polygon import polygon_mistakes
from grader.checks.polygon_sketch import polygon_sketch
from grader.checks.quantity import listed, number
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch
from grader.contracts.verdict import Run
from grader.geometry.figure import PolygonFigure, measure_polygon
from grader.geometry.segmentation import Segments, segment

MEASURES = {
    "distance_m": MeasureKind("m"),
    "sides": MeasureKind(form="count"),
    "corner_deg": MeasureKind("deg"),
    "side_spread_pct": MeasureKind("%"),
    "curved_pct": MeasureKind("%"),
    "opposite_corners": MeasureKind(form="count"),
    "gap_pct": MeasureKind("%"),
    "settled": MeasureKind(form="flag"),
}


def examine(assignment: Assignment, run: Run) -> Findings:
    """Measure the figure that the car drove in `run`."""
    sides, topic = int(assignment.options["sides"]), assignment.world.cmd_vel_topic
    drive = drive_of(run)
    if drive is None:
        return Findings(mistakes=polygon_mistakes(run, sides, topic, None, None, None))
    segments = segment(drive.path)
    figure = measure_polygon(drive.path, segments, cut_short=drive.cut_short)
    return Findings(
        measures=measures(sides, drive, figure),
        mistakes=polygon_mistakes(run, sides, topic, drive, segments, figure),
    )


def measures(sides: int, drive: Drive, figure: PolygonFigure | None) -> dict[str, Measure]:
    """Return the check's measures of a figure with `sides` sides wanted."""
    taken = {
        "distance_m": Measure(float(drive.path.along_m[-1])),
        "sides": Measure(0.0, {"lengths": "—"}),
        "settled": _settled(drive, figure),
    }
    if figure is None:
        return taken
    taken["sides"] = Measure(float(len(figure.sides_m)), {"lengths": listed(figure.sides_m, "m")})
    taken["side_spread_pct"] = _spread(figure)
    taken["curved_pct"] = Measure(100.0 * figure.curved_share)
    taken["gap_pct"] = Measure(
        100.0 * figure.gap_m / figure.perimeter_m if figure.perimeter_m > 0.0 else math.nan,
        {"gap": number(figure.gap_m, "m"), "perimeter": number(figure.perimeter_m, "m")},
    )
    taken |= _corner_measures(sides, figure)
    return taken


def _settled(drive: Drive, figure: PolygonFigure | None) -> Measure:
    if figure is not None and figure.repeated:
        return Measure(1.0)
    return Measure(0.0 if drive.moving_at_end or drive.commanded_at_end else 1.0)


def _spread(figure: PolygonFigure) -> Measure:
    longest, shortest = max(figure.sides_m), min(figure.sides_m)
    mean = figure.perimeter_m / len(figure.sides_m)
    return Measure(
        100.0 * (longest - shortest) / mean if mean > 0.0 else math.nan,
        {"longest": number(longest, "m"), "shortest": number(shortest, "m")},
    )


def _corner_measures(sides: int, figure: PolygonFigure) -> dict[str, Measure]:
    if not figure.corners_rad:
        return {"corner_deg": UNMEASURED, "opposite_corners": UNMEASURED}
    corners = np.degrees(figure.corners_rad)
    sense = math.copysign(1.0, float(np.sum(corners)))
    ideal = 360.0 / sides
    worst = corners[int(np.argmax(np.abs(sense * corners - ideal)))]
    opposite = int(np.count_nonzero(sense * corners < 0.0))
    details = {"corners": listed(np.abs(corners), "deg"), "ideal": number(ideal, "deg")}
    return {
        "corner_deg": Measure(float(sense * worst), details),
        "opposite_corners": Measure(
            float(opposite),
            {"left": int(np.count_nonzero(corners > 0.0)), "right": int(np.count_nonzero(corners < 0.0))},
        ),
    }


def analyse(run: Run) -> tuple[Drive, Segments, PolygonFigure | None] | None:
    """Return motion, segments and figure of a run, or None for an empty trajectory."""
    drive = drive_of(run)
    if drive is None:
        return None
    segments = segment(drive.path)
    return drive, segments, measure_polygon(drive.path, segments, cut_short=drive.cut_short)


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return what a plot of `run` shows: sides, corners, and the wanted figure under them."""
    found = analyse(run)
    if found is None or found[2] is None:
        return FigureSketch()
    return polygon_sketch(assignment, found[0], found[2])


def _problem_with_sides(value: Option) -> str | None:
    if isinstance(value, bool) or not isinstance(value, int) or not 3 <= value <= 12:
        return "must be a whole number from 3 to 12"
    return None


CHECK = Check(
    kind="polygon",
    measures=MEASURES,
    options={"sides": _problem_with_sides},
    examine=examine,
    sketch=sketch,
)
