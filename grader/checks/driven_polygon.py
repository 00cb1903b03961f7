"""The motion of a run, seen as a polygon."""

from dataclasses import dataclass

from grader.checks.drive import Drive, drive_of
from grader.contracts.verdict import Run
from grader.geometry.figure import PolygonFigure, measure_polygon
from grader.geometry.segmentation import Segments, segment


@dataclass(frozen=True, slots=True, eq=False)
class DrivenPolygon:
    """A driven path, its runs and turns, and the first figure in it (None without a straight run)."""

    drive: Drive
    segments: Segments
    figure: PolygonFigure | None


def driven_polygon(run: Run) -> DrivenPolygon | None:
    """Return what `run` drove, or None when its trajectory is empty or not finite."""
    drive = drive_of(run)
    if drive is None:
        return None
    segments = segment(drive.path)
    return DrivenPolygon(drive, segments, measure_polygon(drive.path, segments, cut_short=drive.cut_short))
