"""Check ``rotation``: turn on the spot, in either direction."""

import math

import numpy as np

from grader.checks.credit import fits
from grader.checks.drive import drive_of
from grader.checks.measure import Check, Findings, Measure, MeasureKind
from grader.checks.mistakes.rotation import rotation_mistakes
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch, SketchCorner, SketchLabel
from grader.contracts.verdict import Run
from grader.geometry.path import Path
from grader.messages import say
from grader.messages.quantity import number

MAX_STARTS = 200  # parts of a path are looked at from so many samples on
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
        measures |= _rotation(drive.path, _spot_m(assignment))
    return Findings(measures, rotation_mistakes(assignment, run, drive, measures))


def _spot_m(assignment: Assignment) -> float:
    """Return on how long a way turning still counts in full: round a circle too wide to stay in place."""
    place = assignment.item_on("drift_m")
    return math.inf if place is None or place.high is None else math.pi * (place.high + place.ramp)


def _rotation(path: Path, spot_m: float) -> dict[str, Measure]:
    total_deg = math.degrees(float(np.max(np.abs(path.heading_rad - path.heading_rad[0]))))
    turned_deg = math.degrees(_on_the_spot(path, spot_m))
    strayed = np.hypot(path.x_m - path.x_m[0], path.y_m - path.y_m[0])
    return {
        "turned_deg": Measure(
            turned_deg, {"total": number(total_deg, "deg"), "turns": f"{turned_deg / 360.0:.2f}"}
        ),
        "drift_m": Measure(float(np.max(strayed))),
    }


def _on_the_spot(path: Path, spot_m: float) -> float:
    """Return the largest turn of any part of the path, less where it needed a way longer than `spot_m`."""
    largest = 0.0
    for first in range(0, len(path), 1 + len(path) // MAX_STARTS):
        turned = np.abs(path.heading_rad[first:] - path.heading_rad[first])
        way_m = np.abs(path.along_m[first:] - path.along_m[first])
        largest = max(largest, float(np.max(turned / np.maximum(way_m / spot_m, 1.0))))
    return largest


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the view of heading over time with the wanted turn, the counted one, and a place left."""
    item, drive = assignment.item_on("turned_deg"), drive_of(run)
    wanted_deg = None if item is None else item.low
    if drive is None:
        return FigureSketch(view="heading", wanted_turn_deg=wanted_deg)
    path, measures = drive.path, _rotation(drive.path, _spot_m(assignment))
    ahead = path.heading_rad - path.heading_rad[0]
    turned_deg, drift_m = measures["turned_deg"].value, measures["drift_m"].value
    here = (float(run.trajectory.x_m[0]), float(run.trajectory.y_m[0]))
    turn = SketchCorner(
        at_m=here,
        angle_deg=math.copysign(turned_deg, float(ahead[int(np.argmax(np.abs(ahead)))])),
        ok=fits(assignment, "turned_deg", turned_deg),
    )
    left = SketchLabel(at_m=here, text=say("figure.aside", value=number(drift_m, "m")), ok=False)
    return FigureSketch(
        view="heading",
        corners=(turn,),
        labels=(left,) if fits(assignment, "drift_m", drift_m) is False else (),
        wanted_turn_deg=wanted_deg,
    )


CHECK = Check(kind="rotation", measures=MEASURES, examine=examine, sketch=sketch)
