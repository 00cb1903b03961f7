"""Check ``rotation``: turn on the spot, in either direction."""

import numpy as np

from grader.checks.drive import Drive, drive_of
from grader.checks.measure import Check, Findings, Measure, MeasureKind
from grader.checks.mistakes.rotation import rotation_mistakes
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch
from grader.contracts.verdict import Run

MEASURES = {
    "commands": MeasureKind(form="count"),
    "turned_deg": MeasureKind("deg"),
    "drift_m": MeasureKind("m"),
}


def examine(assignment: Assignment, run: Run) -> Findings:
    """Measure the rotation and how far the car strayed from its place."""
    drive = drive_of(run)
    measures = {"commands": Measure(float(run.outcome.command_count))}
    if drive is not None:
        measures |= _rotation(drive)
    return Findings(measures, rotation_mistakes(run, assignment.world.cmd_vel_topic, drive, measures))


def _rotation(drive: Drive) -> dict[str, Measure]:
    path = drive.path
    turned = np.degrees(path.heading_rad - path.heading_rad[0])
    strayed = np.hypot(path.x_m - path.x_m[0], path.y_m - path.y_m[0])
    return {
        "turned_deg": Measure(
            float(np.max(np.abs(turned))), {"turns": f"{float(np.max(np.abs(turned))) / 360.0:.2f}"}
        ),
        "drift_m": Measure(float(np.max(strayed))),
    }


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the view of heading over time with the wanted turn."""
    item = assignment.item_on("turned_deg")
    return FigureSketch(view="heading", wanted_turn_deg=None if item is None else item.low)


CHECK = Check(kind="rotation", measures=MEASURES, examine=examine, sketch=sketch)
