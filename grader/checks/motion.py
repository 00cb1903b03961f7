"""Check ``motion``: drive straight along or against the initial heading."""

import math

import numpy as np

from grader.checks.drive import Drive, drive_of
from grader.checks.measure import UNMEASURED, Check, Findings, Measure, MeasureKind, Option
from grader.checks.mistakes.motion import motion_mistakes
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch, SketchSide
from grader.contracts.trajectory import Floats
from grader.contracts.verdict import Run

DIRECTIONS = ("forward", "backward")
MEASURES = {
    "commands": MeasureKind(form="count"),
    "advance_m": MeasureKind("m"),
    "lateral_pct": MeasureKind("%"),
    "turned_deg": MeasureKind("deg"),
    "way_back_m": MeasureKind("m"),
}


def examine(assignment: Assignment, run: Run) -> Findings:
    """Measure the motion up to the first wall contact."""
    backward = assignment.options["direction"] == "backward"
    drive = drive_of(run, until_contact=True)
    measures = {"commands": Measure(float(run.outcome.command_count))}
    if drive is not None:
        measures |= _motion(drive, backward=backward)
    mistakes = motion_mistakes(run, assignment.world.cmd_vel_topic, drive, measures, backward=backward)
    return Findings(measures, mistakes)


def _frame(drive: Drive) -> tuple[Floats, Floats]:
    """Return the path in the frame of the start pose: ahead and to the left, both (n,) in metres."""
    path = drive.path
    heading = float(path.heading_rad[0])
    dx, dy = path.x_m - path.x_m[0], path.y_m - path.y_m[0]
    return dx * math.cos(heading) + dy * math.sin(heading), dy * math.cos(heading) - dx * math.sin(heading)


def _motion(drive: Drive, *, backward: bool) -> dict[str, Measure]:
    ahead_m, left_m = _frame(drive)
    advance_m = -ahead_m if backward else ahead_m
    net_m = float(advance_m[-1])
    headings = np.degrees(drive.path.heading_rad - drive.path.heading_rad[0])
    turned = float(headings[int(np.argmax(np.abs(headings)))])
    return {
        "advance_m": Measure(net_m),
        "lateral_pct": Measure(100.0 * float(np.max(np.abs(left_m))) / net_m) if net_m > 0.0 else UNMEASURED,
        "turned_deg": Measure(abs(turned)),
        "way_back_m": Measure(float(np.max(np.maximum.accumulate(advance_m) - advance_m))),
    }


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the net displacement beside the wanted straight line."""
    drive = drive_of(run, until_contact=True)
    if drive is None or drive.path.extent_m < 0.01:
        return FigureSketch()
    trajectory, last = run.trajectory, len(drive.path) - 1
    start, end = ((float(trajectory.x_m[i]), float(trajectory.y_m[i])) for i in (0, last))
    length_m = math.dist(start, end)
    sign = -1.0 if assignment.options["direction"] == "backward" else 1.0
    heading = float(trajectory.heading_rad[0])
    goal = (start[0] + sign * length_m * math.cos(heading), start[1] + sign * length_m * math.sin(heading))
    return FigureSketch(
        view="path",
        sides=(SketchSide(start_m=start, end_m=end, length_m=length_m),),
        ideal_m=(start, goal),
        ideal_closed=False,
        end_ns=int(drive.t_ns[-1]),
    )


def _problem_with_direction(value: Option) -> str | None:
    return None if value in DIRECTIONS else f"must be one of {', '.join(DIRECTIONS)}"


CHECK = Check(
    kind="motion",
    measures=MEASURES,
    options={"direction": _problem_with_direction},
    examine=examine,
    sketch=sketch,
)
