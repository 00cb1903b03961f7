"""Check ``polygon``: a closed figure of equal corners; its sides are equal, or of given lengths."""

import math

import numpy as np

from grader.checks.driven_polygon import DrivenPolygon, driven_polygon
from grader.checks.measure import UNMEASURED, Check, Findings, Measure, MeasureKind, Option
from grader.checks.mistakes.polygon import polygon_mistakes
from grader.checks.polygon_sketch import polygon_sketch
from grader.checks.wanted_polygon import WantedPolygon, wanted_polygon
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch
from grader.contracts.text import Text
from grader.contracts.verdict import Run
from grader.geometry.figure import PolygonFigure
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


def examine(assignment: Assignment, run: Run) -> Findings:
    """Measure the figure that the car drove in `run`."""
    wanted = wanted_polygon(assignment.options)
    driven = driven_polygon(assignment, wanted, run)
    mistakes = polygon_mistakes(assignment, run, wanted, driven)
    if driven is None:
        return Findings(mistakes=mistakes)
    return Findings(_measures(wanted, driven), mistakes)


def _measures(wanted: WantedPolygon, driven: DrivenPolygon) -> dict[str, Measure]:
    figure = driven.figure
    taken = {
        "distance_m": Measure(float(driven.drive.path.along_m[-1])),
        "sides": Measure(0.0, {"lengths": "—"}),
        "settled": _settled(driven),
    }
    if figure is None:
        return taken
    taken["sides"] = Measure(float(len(figure.sides_m)), {"lengths": listed(figure.sides_m, "m")})
    taken["side_spread_pct"] = _spread(figure)
    if wanted.lengths_m is not None:
        taken["side_error_pct"] = _side_error(wanted, figure)
    taken["curved_pct"] = Measure(100.0 * figure.curved_share)
    taken["gap_pct"] = Measure(
        100.0 * figure.gap_m / figure.perimeter_m if figure.perimeter_m > 0.0 else math.nan,
        {"gap": number(figure.gap_m, "m"), "perimeter": number(figure.perimeter_m, "m")},
    )
    taken |= _corner_measures(wanted, driven)
    return taken


def _settled(driven: DrivenPolygon) -> Measure:
    figure = driven.figure
    if figure is not None and figure.repeated:
        return Measure(1.0)
    under_way = driven.drive.moving_at_end or driven.drive.commanded_at_end
    went_on = driven.turned_on or (figure is not None and figure.overrun)
    return Measure(0.0 if under_way or went_on else 1.0)


def _spread(figure: PolygonFigure) -> Measure:
    longest, shortest = max(figure.sides_m), min(figure.sides_m)
    mean = figure.perimeter_m / len(figure.sides_m)
    return Measure(
        100.0 * (longest - shortest) / mean if mean > 0.0 else math.nan,
        {"longest": number(longest, "m"), "shortest": number(shortest, "m")},
    )


def _side_error(wanted: WantedPolygon, figure: PolygonFigure) -> Measure:
    aligned = wanted.aligned(figure.sides_m)
    return Measure(
        wanted.side_error_pct(figure.sides_m),
        {"lengths": listed(figure.sides_m, "m"), "wanted": listed(aligned, "m")},
    )


def _corner_measures(wanted: WantedPolygon, driven: DrivenPolygon) -> dict[str, Measure]:
    corners = driven.corners_deg
    if len(corners) == 0:
        return {"corner_deg": UNMEASURED, "opposite_corners": UNMEASURED}
    along, against = int(np.count_nonzero(corners > 0.0)), int(np.count_nonzero(corners < 0.0))
    left, right = (along, against) if driven.sense > 0.0 else (against, along)
    worst = corners[int(np.argmax(np.abs(corners - wanted.corner_deg)))]
    details = {"corners": listed(corners, "deg"), "ideal": number(wanted.corner_deg, "deg")}
    return {
        "corner_deg": Measure(float(worst), details),
        "opposite_corners": Measure(float(against), {"left": left, "right": right}),
    }


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return what a plot of `run` shows: sides, corners, and the wanted figure under them."""
    driven = driven_polygon(assignment, wanted_polygon(assignment.options), run)
    if driven is None or driven.figure is None:
        return FigureSketch()
    return polygon_sketch(assignment, run.trajectory, driven.figure, driven.sense * driven.corners_deg)


_ONLY_RECTANGLES = Text(
    zh="只用于 4 条边，和 side_m 一起：请删掉", en="only for 4 sides, beside side_m; remove it"
)
_NO_SIDE = Text(
    zh="缺少：测量值 'side_error_pct' 要和它比较", en="missing; the measure 'side_error_pct' compares with it"
)


def _problem_with_sides(value: Option) -> Text | None:
    if isinstance(value, bool) or not isinstance(value, int) or not 3 <= value <= 12:
        return Text(zh="要填 3 到 12 的整数", en="must be a whole number from 3 to 12")
    return None


def _problem_with_length(value: Option) -> Text | None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.1 <= value <= 10.0:
        return Text(zh="要填 0.1 到 10 米的长度", en="must be a length from 0.1 to 10 m")
    return None


def _consult(assignment: Assignment) -> tuple[tuple[str, Text], ...]:
    found = []
    for case in assignment.cases:
        options = {**assignment.options, **case.options}
        if "other_side_m" in options and (options.get("sides") != 4 or "side_m" not in options):
            found.append(("options.other_side_m", _ONLY_RECTANGLES))
        if "side_m" not in options and assignment.item_on("side_error_pct") is not None:
            found.append(("options.side_m", _NO_SIDE))
    return tuple(found)


CHECK = Check(
    kind="polygon",
    measures=MEASURES,
    options={"sides": _problem_with_sides},
    optional={"side_m": _problem_with_length, "other_side_m": _problem_with_length},
    consult=_consult,
    examine=examine,
    sketch=sketch,
)
