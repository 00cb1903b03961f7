"""The plot's view of a polygon: detected sides and corners over the wanted figure."""

import itertools
import math

import numpy as np

from grader.checks.credit import fits
from grader.checks.wanted_polygon import WantedPolygon, wanted_polygon
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch, Point, SketchCorner, SketchSide
from grader.contracts.trajectory import Floats, Trajectory
from grader.geometry.figure import PolygonFigure


def polygon_sketch(
    assignment: Assignment, trajectory: Trajectory, figure: PolygonFigure, corners_deg: Floats
) -> FigureSketch:
    """Return sides, corners and gap with their verdicts, and the wanted figure fitted to the driven one.

    `corners_deg` are (n,) the judged corners, positive to the left. Points are where the car was recorded, so
    that they lie on the drawn path even after a teleport.
    """
    wanted = wanted_polygon(assignment.options)
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
    """Judge each side by its distance from its wanted length, or from the median side as the spread is."""
    lengths = [math.dist(start, end) for start, end in itertools.pairwise(points)]
    band = assignment.item_on("side_error_pct") or assignment.item_on("side_spread_pct")
    judged = band is not None and band.high is not None and len(lengths) == len(figure.sides_m)
    targets = wanted.aligned(figure.sides_m) or (float(np.median(figure.sides_m)),) * len(figure.sides_m)
    sides = []
    for i, (start, end) in enumerate(itertools.pairwise(points)):
        ok = None
        if judged and band is not None and band.high is not None:
            ok = 100.0 * abs(lengths[i] - targets[i]) <= band.high * targets[i]
        sides.append(SketchSide(start_m=start, end_m=end, length_m=lengths[i], ok=ok))
    return tuple(sides)


def _corners(points: list[Point], corners_deg: Floats, assignment: Assignment) -> tuple[SketchCorner, ...]:
    sense = math.copysign(1.0, float(np.sum(corners_deg)))
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
    """Fit the wanted polygon with the driven sense of turning.

    With as many sides driven as wanted it is the least-squares fit over the vertices (a similarity, solved
    as one complex ratio); otherwise it stands on the first driven side.
    """
    if len(points) < 2 or points[0] == points[1]:
        return ()
    begun_in_a_side = len(points) == len(figure.sides_m) + 2  # then start and end are no vertices
    driven = np.array([complex(*point) for point in (points[1:-1] if begun_in_a_side else points[:-1])])
    shape = np.array(wanted.vertices(_first_length_m(figure, wanted, later=begun_in_a_side)))
    if sum(figure.corners_rad) < 0.0:
        shape = np.conj(shape)
    if len(driven) == wanted.sides:
        shape = shape - np.mean(shape)
        centre = complex(np.mean(driven))
        scale = complex(np.vdot(shape, driven - centre) / np.vdot(shape, shape))
    else:
        scale = complex((driven[1] if len(driven) > 1 else complex(*points[1])) - driven[0]) / complex(
            shape[1] - shape[0]
        )
        centre = complex(driven[0]) - scale * complex(shape[0])
    return tuple((float(vertex.real), float(vertex.imag)) for vertex in centre + scale * shape)


def _first_length_m(figure: PolygonFigure, wanted: WantedPolygon, *, later: bool) -> float | None:
    """Return the wanted length of the side after the first vertex; `later`: the path began in a side."""
    aligned = wanted.aligned(figure.sides_m)
    return aligned[1 if later and len(aligned) > 1 else 0] if aligned else None
