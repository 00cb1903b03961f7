"""The plot's view of a polygon: detected sides and corners over the wanted figure."""

import itertools
import math

import numpy as np

from grader.contracts.assignment import Assignment, ItemSpec
from grader.contracts.figure import FigureSketch, Point, SketchCorner, SketchSide
from grader.contracts.trajectory import Trajectory
from grader.geometry.figure import PolygonFigure


def polygon_sketch(assignment: Assignment, trajectory: Trajectory, figure: PolygonFigure) -> FigureSketch:
    """Return sides, corners and gap with their verdicts, and the wanted figure fitted to the driven one.

    Points are where the car was recorded, so that they lie on the drawn path even after a teleport.
    """
    count = int(assignment.options["sides"])
    points = [_point(trajectory, i) for i in figure.vertices]
    return FigureSketch(
        view="path",
        sides=_sides(points, figure, _band(assignment, "side_spread_pct")),
        corners=_corners(points, figure, _band(assignment, "corner_deg")),
        ideal_m=ideal_polygon(points, figure, count),
        gap=_gap(trajectory, figure, _band(assignment, "gap_pct")),
        end_ns=int(trajectory.t_ns[figure.end]),
    )


def _band(assignment: Assignment, measure: str) -> ItemSpec | None:
    return next((item for item in assignment.items if item.measure == measure), None)


def _sides(points: list[Point], figure: PolygonFigure, band: ItemSpec | None) -> tuple[SketchSide, ...]:
    """Judge each side by its distance from the median side, as the spread of all is judged."""
    lengths = [math.dist(start, end) for start, end in itertools.pairwise(points)]
    middle = float(np.median(figure.sides_m))
    sides = []
    for start, end, length in zip(points[:-1], points[1:], lengths, strict=True):
        whole = len(lengths) == len(figure.sides_m)
        off_pct = 100.0 * abs(length - middle) / middle if middle > 0.0 else math.inf
        ok = None if band is None or band.high is None or not whole else off_pct <= band.high
        sides.append(SketchSide(start_m=start, end_m=end, length_m=length, ok=ok))
    return tuple(sides)


def _corners(points: list[Point], figure: PolygonFigure, band: ItemSpec | None) -> tuple[SketchCorner, ...]:
    corners = []
    sense = math.copysign(1.0, sum(figure.corners_rad)) if figure.corners_rad else 1.0
    for at, corner in zip(points[1:], figure.corners_rad, strict=False):
        angle_deg = math.degrees(corner)
        ok = None
        if band is not None and band.low is not None and band.high is not None:
            ok = band.low <= sense * angle_deg <= band.high
        corners.append(SketchCorner(at_m=at, angle_deg=angle_deg, ok=ok))
    return tuple(corners)


def _gap(trajectory: Trajectory, figure: PolygonFigure, band: ItemSpec | None) -> SketchSide:
    ok = None
    if band is not None and band.high is not None:
        ok = 100.0 * figure.gap_m <= band.high * figure.perimeter_m
    return SketchSide(
        start_m=_point(trajectory, figure.vertices[0]),
        end_m=_point(trajectory, figure.end),
        length_m=figure.gap_m,
        ok=ok,
    )


def _point(trajectory: Trajectory, index: int) -> Point:
    return float(trajectory.x_m[index]), float(trajectory.y_m[index])


def ideal_polygon(points: list[Point], figure: PolygonFigure, count: int) -> tuple[Point, ...]:
    """Fit a regular polygon of `count` sides with the driven sense of turning.

    With as many sides driven as wanted it is the least-squares fit over the vertices (a similarity, solved
    as one complex ratio); otherwise it stands on the first driven side.
    """
    if len(points) < 2 or points[0] == points[1]:
        return ()
    sense = -1.0 if sum(figure.corners_rad) < 0.0 else 1.0
    unit = np.exp(1j * sense * 2.0 * math.pi * np.arange(count) / count)
    begun_in_a_side = len(points) == len(figure.sides_m) + 2  # then start and end are no vertices
    driven = np.array([complex(*point) for point in (points[1:-1] if begun_in_a_side else points[:-1])])
    if len(driven) == count:
        centre = complex(np.mean(driven))
        scale = complex(np.vdot(unit, driven - centre) / count)
    else:
        scale = complex((driven[1] if len(driven) > 1 else complex(*points[1])) - driven[0]) / complex(
            unit[1] - unit[0]
        )
        centre = complex(driven[0]) - scale * complex(unit[0])
    return tuple((float(vertex.real), float(vertex.imag)) for vertex in centre + scale * unit)
