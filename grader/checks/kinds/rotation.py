"""Check ``rotation``: turn on the spot, in either direction."""

import math
from collections.abc import Iterator

import numpy as np

from grader.checks.drive import FAST_TURN_RADPS, Drive, drive_of, fastest_radps, moves_of
from grader.checks.measure import Check, Measure, MeasureKind, Measures, Mistake, mistake
from grader.checks.mistakes import command_mistakes, driving_mistakes, time_was_up
from grader.checks.scoring import fits
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch, SketchCorner, SketchLabel
from grader.contracts.scoring import Run
from grader.geometry import exact
from grader.geometry.path import Path
from grader.messages import say
from grader.messages.quantity import number

MAX_STARTS = 200  # samples at which a part of the path may begin: to try all costs the square of their number
PLACE_M = 0.2  # a turn that stays within this distance of where it began counts in full
FULL_TURN_DEG = 360.0
ROTATE = "/turtle1/rotate_absolute/_action/send_goal"
MEASURES = {
    "commands": MeasureKind(form="count"),
    "turned_deg": MeasureKind("deg"),
    "rate_radps": MeasureKind("rad/s"),
    "drift_m": MeasureKind("m"),
}


def measure(assignment: Assignment, run: Run) -> Measures:
    """Measure how far the car turned, and how far it strayed meanwhile."""
    drive = drive_of(run)
    measures = {"commands": Measure(float(run.outcome.command_count + _goals(run)))}
    if drive is not None:
        measures |= _rotation(drive.path)
        measures["rate_radps"] = Measure(fastest_radps(run))
    return measures


def explain(assignment: Assignment, run: Run, measures: Measures) -> tuple[Mistake, ...]:
    """Return what probably went wrong."""
    drive = drive_of(run)
    return driving_mistakes(run, () if drive is None else rotation_mistakes(assignment, run, drive, measures))


def _goals(run: Run) -> int:
    """Return how many goals the script sent to turtlesim's own action for turning."""
    return sum(
        endpoint.count
        for endpoint in run.outcome.endpoints
        if (endpoint.kind, endpoint.name) == ("client", ROTATE)
    )


def _rotation(path: Path) -> dict[str, Measure]:
    total_deg = math.degrees(float(np.ptp(path.heading_rad)))
    turned_deg = math.degrees(_in_one_place(path))
    strayed = exact.hypot(path.x_m - path.x_m[0], path.y_m - path.y_m[0])
    return {
        "turned_deg": Measure(
            turned_deg, {"total": number(total_deg, "deg"), "turns": f"{turned_deg / 360.0:.2f}"}
        ),
        "drift_m": Measure(float(np.max(strayed))),
    }


def _in_one_place(path: Path) -> float:
    """Return the largest turn of any part of the path that stayed in one place.

    A part that strayed further counts as one full turn at most, divided by its largest distance in units of
    `PLACE_M`. Otherwise laps of a wide circle, or corners far apart, would sum up to a turn on the spot.
    """
    largest = 0.0
    for first in range(0, len(path), 1 + len(path) // MAX_STARTS):
        turned = np.abs(path.heading_rad[first:] - path.heading_rad[first])
        strayed = exact.hypot(path.x_m[first:] - path.x_m[first], path.y_m[first:] - path.y_m[first])
        places = np.maximum.accumulate(strayed) / PLACE_M
        counted = np.where(places <= 1.0, turned, np.minimum(turned, math.tau) / np.maximum(places, 1.0))
        largest = max(largest, float(np.max(counted)))
    return largest


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the view of heading over time: the wanted and the counted turn, and a drift that cost points."""
    item, drive = assignment.item_on("turned_deg"), drive_of(run)
    wanted_deg = None if item is None else item.low
    if drive is None:
        return FigureSketch(view="heading", wanted_turn_deg=wanted_deg)
    path, measures = drive.path, _rotation(drive.path)
    ahead = path.heading_rad - path.heading_rad[0]
    turned_deg, drift_m = measures["turned_deg"].value, measures["drift_m"].value
    here = (float(run.trajectory.x_m[0]), float(run.trajectory.y_m[0]))
    turn = SketchCorner(
        at_m=here,
        angle_deg=math.copysign(turned_deg, float(ahead[int(np.argmax(np.abs(ahead)))])),
        ok=fits(assignment, "turned_deg", turned_deg),
    )
    strayed = SketchLabel(at_m=here, text=say("figure.aside", value=number(drift_m, "m")), ok=False)
    return FigureSketch(
        view="heading",
        corners=(turn,),
        labels=(strayed,) if fits(assignment, "drift_m", drift_m) is False else (),
        wanted_turn_deg=wanted_deg,
    )


def rotation_mistakes(
    assignment: Assignment, run: Run, drive: Drive, measures: Measures
) -> Iterator[Mistake]:
    """Yield what probably went wrong while turning."""
    # Wherever the car turned; the measure `turned_deg` counts what it turned in one place.
    heading_rad = drive.path.heading_rad
    turned = math.degrees(float(np.max(np.abs(heading_rad - heading_rad[0]))))
    short, fastest = fits(assignment, "turned_deg", turned) is False, fastest_radps(run)
    if fastest > FAST_TURN_RADPS:
        yield mistake("degrees_as_radians", rate=number(fastest, "1"), ideal=number(FULL_TURN_DEG, "deg"))
    if not _goals(run):
        yield from command_mistakes(run, assignment.world, turns=("turned_deg",), drives=())
    if short and _goals(run) and not moves_of(run.trajectory):
        yield mistake("rotation_absolute", ("turned_deg",), turned=number(turned, "deg"))
    elif short:
        yield from time_was_up(run, drive, ("turned_deg",))


CHECK = Check(kind="rotation", measures=MEASURES, measure=measure, explain=explain, sketch=sketch)
