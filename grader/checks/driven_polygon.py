"""The motion of a run, seen as a polygon."""

import math
from dataclasses import dataclass

import numpy as np

from grader.checks.credit import error
from grader.checks.drive import Drive, drive_of
from grader.checks.wanted_polygon import WantedPolygon
from grader.contracts.assignment import Assignment
from grader.contracts.trajectory import Floats
from grader.contracts.verdict import Run
from grader.geometry.figure import PolygonFigure, measure_polygon
from grader.geometry.segmentation import Segments, segment

LIKE_DEG = 1.0  # a last turn this little further off than the corners was meant to be like them
NO_TURN_DEG = 10.0  # whoever ends within this of the direction of the last side has not turned after it


@dataclass(frozen=True, slots=True, eq=False)
class DrivenPolygon:
    """A driven path, its runs and turns, and the first figure in it (None without a straight run).

    Attributes:
        corners_deg: (n,) the figure's corners, positive in the sense most of them have; the turn after the
            last side is one if it is no further off than the others.
        sense: +1 if that is to the left, else -1.
        turned_on: that turn is neither one of them nor none.
    """

    drive: Drive
    segments: Segments
    figure: PolygonFigure | None
    corners_deg: Floats
    sense: float = 1.0
    turned_on: bool = False


def driven_polygon(assignment: Assignment, wanted: WantedPolygon, run: Run) -> DrivenPolygon | None:
    """Return what `run` drove, or None when its trajectory is empty or not finite."""
    drive = drive_of(run)
    if drive is None:
        return None
    segments = segment(drive.path)
    figure = measure_polygon(drive.path, segments, sides=wanted.sides, cut_short=drive.cut_short)
    if figure is None:
        return DrivenPolygon(drive, segments, None, np.empty(0))
    sense = -1.0 if sum(figure.corners_rad) < 0.0 else 1.0
    corners = sense * np.degrees(figure.corners_rad)
    last_deg = sense * math.degrees(figure.last_turn_rad)
    if abs(last_deg) <= NO_TURN_DEG:
        return DrivenPolygon(drive, segments, figure, corners, sense)
    worse_deg = _worse_deg(assignment, last_deg, corners)
    if worse_deg <= 0.0:
        corners = np.append(corners, last_deg)
    return DrivenPolygon(drive, segments, figure, corners, sense, worse_deg > LIKE_DEG and not figure.overrun)


def _worse_deg(assignment: Assignment, last_deg: float, corners_deg: Floats) -> float:
    """Return by how much the turn after the last side is further off than any corner."""
    spec = assignment.item_on("corner_deg")
    if spec is None:
        return 0.0
    return error(spec, last_deg) - max(error(spec, corner) for corner in corners_deg.tolist())
