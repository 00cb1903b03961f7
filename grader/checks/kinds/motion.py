"""Check ``motion``: drive straight along or against the initial heading."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from grader.checks.drive import Drive, drive_of
from grader.checks.measure import (
    UNMEASURED,
    Check,
    Measure,
    MeasureKind,
    Measures,
    Mistake,
    Option,
    one_of,
)
from grader.checks.mistakes import command_mistakes, driving_mistakes, only_turned
from grader.checks.scoring import fits
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch, SketchLabel, SketchSide
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text
from grader.contracts.trajectory import Floats, Trajectory
from grader.geometry import exact
from grader.messages import say
from grader.messages.quantity import number

DIRECTIONS = ("forward", "backward")
Bools = NDArray[np.bool_]
MEASURES = {
    "commands": MeasureKind(form="count"),
    "advance_m": MeasureKind("m"),
    "lateral_pct": MeasureKind("%"),
    "turned_deg": MeasureKind("deg"),
    "way_back_m": MeasureKind("m"),
}
SPOT_RADIUS_M = 0.1  # an arc tighter than this is a turn on the spot
STILL_M = 1e-6  # within a step
# In the shipped rubrics that leaves a third of the points for heading and distance: the line is right, but
# their briefs ask for no turn.
MOST_ON_THE_SPOT_DEG = 30.0


def measure(assignment: Assignment, run: Run) -> Measures:
    """Measure the motion up to the first wall contact."""
    drive = drive_of(run, until_contact=True)
    measures = {"commands": Measure(float(run.outcome.command_count))}
    if drive is not None:
        measures |= _motion(drive, backward=_is_backward(assignment))
    return measures


def explain(assignment: Assignment, run: Run, measures: Measures) -> tuple[Mistake, ...]:
    """Return what probably went wrong."""
    drive = drive_of(run, until_contact=True)
    return driving_mistakes(run, () if drive is None else motion_mistakes(assignment, run, drive))


def _is_backward(assignment: Assignment) -> bool:
    return assignment.options["direction"] == "backward"


def _frame(drive: Drive) -> tuple[Floats, Floats]:
    """Return the path in the frame of the start pose: ahead and to the left, both (n,) in metres."""
    path = drive.path
    heading = float(path.heading_rad[0])
    dx, dy = path.x_m - path.x_m[0], path.y_m - path.y_m[0]
    cos, sin = exact.cos_sin(heading)
    return dx * cos + dy * sin, dy * cos - dx * sin


def _motion(drive: Drive, *, backward: bool) -> dict[str, Measure]:
    ahead_m, left_m = _frame(drive)
    advance_m = -ahead_m if backward else ahead_m
    net_m = float(advance_m[-1])
    facing_m = exact.total(np.diff(advance_m)[_keeps_facing(drive)])
    return {
        "advance_m": Measure(min(net_m, facing_m)),  # what was driven after turning round does not count
        "lateral_pct": Measure(100.0 * float(np.max(np.abs(left_m))) / net_m) if net_m > 0.0 else UNMEASURED,
        "turned_deg": _turned(drive),
        "way_back_m": Measure(float(np.max(np.maximum.accumulate(advance_m) - advance_m))),
    }


def _turned(drive: Drive) -> Measure:
    """Return how far the car was turned from its initial heading while it drove.

    A turn on the spot draws nothing, so it counts as `MOST_ON_THE_SPOT_DEG` at most.
    """
    heading_rad, on_the_spot = drive.path.heading_rad, _on_the_spot(drive)
    middle_rad = (heading_rad[1:] + heading_rad[:-1]) / 2.0 - heading_rad[0]
    aside_rad = np.where(
        on_the_spot, 0.0, middle_rad - math.tau * np.rint(middle_rad / math.tau)
    )  # without whole turns on the spot
    driven_rad = np.cumsum(np.where(on_the_spot, 0.0, np.diff(heading_rad)))
    driving_deg = math.degrees(float(np.max(np.abs((aside_rad, driven_rad)), initial=0.0)))
    largest_deg = math.degrees(_largest_rad(drive))
    turned_deg = max(driving_deg, min(largest_deg, MOST_ON_THE_SPOT_DEG))
    noted = _turns_on_the_spot(drive) and largest_deg > turned_deg + 1.0
    spot = say("motion.on_the_spot", turned=number(largest_deg, "deg")) if noted else EMPTY
    return Measure(turned_deg, {"spot": spot})


def _largest_rad(drive: Drive) -> float:
    return float(np.max(np.abs(drive.path.heading_rad - drive.path.heading_rad[0])))


def _on_the_spot(drive: Drive) -> Bools:
    """Return for each of the (n - 1) steps whether the car stood, or turned about a point next to itself."""
    driven_m, turned_rad = np.abs(np.diff(drive.path.signed_m)), np.abs(np.diff(drive.path.heading_rad))
    still: Bools = (driven_m < SPOT_RADIUS_M * turned_rad) | (driven_m < STILL_M)
    return still


def _keeps_facing(drive: Drive) -> Bools:
    """Return for each of the (n - 1) steps whether the car faced its initial heading rather than away from it."""
    heading = drive.path.heading_rad
    facing: Bools = exact.cos((heading[1:] + heading[:-1]) / 2.0 - heading[0]) > 0.0
    return facing


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the sketch of the net displacement, of the wanted line, and of where the car left that line."""
    drive = drive_of(run, until_contact=True)
    if drive is None or drive.path.extent_m < 0.01:  # nothing that a plot could show
        return FigureSketch()
    backward = assignment.options["direction"] == "backward"
    measures = _motion(drive, backward=backward)
    trajectory, last = run.trajectory, len(drive.path) - 1
    start, end = ((float(trajectory.x_m[i]), float(trajectory.y_m[i])) for i in (0, last))
    band = assignment.item_on("advance_m")
    length_m = max(abs(measures["advance_m"].value), (band and band.low) or 0.0)
    sign = -1.0 if backward else 1.0
    heading = float(trajectory.heading_rad[0])
    cos, sin = exact.cos_sin(heading)
    goal = (start[0] + sign * length_m * cos, start[1] + sign * length_m * sin)
    far = fits(assignment, "advance_m", measures["advance_m"].value)
    return FigureSketch(
        view="path",
        sides=(SketchSide(start_m=start, end_m=end, length_m=exact.apart(start, end), ok=far),),
        ideal_m=(start, goal),
        ideal_closed=False,
        labels=tuple(_departures(assignment, drive, run.trajectory, measures)),
        end_ns=int(drive.t_ns[-1]),
    )


def _departures(
    assignment: Assignment, drive: Drive, trajectory: Trajectory, measures: Measures
) -> Iterator[SketchLabel]:
    """Yield where the car was furthest aside and where it was turned most, if that cost points."""
    _, left_m = _frame(drive)
    headings = np.abs(drive.path.heading_rad - drive.path.heading_rad[0])
    aside, turned = int(np.argmax(np.abs(left_m))), int(np.argmax(headings))
    found = (
        ("lateral_pct", aside, say("figure.aside", value=number(float(abs(left_m[aside])), "m"))),
        (
            "turned_deg",
            turned,
            say("figure.turned", value=number(math.degrees(float(headings[turned])), "deg")),
        ),
    )
    for measure, at, text in found:
        if fits(assignment, measure, measures[measure].value) is False:
            at_m = (float(trajectory.x_m[at]), float(trajectory.y_m[at]))
            yield SketchLabel(at_m=at_m, text=text, ok=False)


def _problem_with_direction(value: Option) -> Text | None:
    return None if value in DIRECTIONS else one_of(DIRECTIONS)


def motion_mistakes(assignment: Assignment, run: Run, drive: Drive) -> Iterator[Mistake]:
    """Yield what probably went wrong while driving straight."""
    # in whatever direction: then no drive that ended too early is why it did not get far
    drove_enough = fits(assignment, "advance_m", float(drive.path.along_m[-1])) is True
    yield from command_mistakes(
        run, assignment.world, turns=(), drives=() if drove_enough else ("advance_m",)
    )
    yield from only_turned(run, ("advance_m", "turned_deg", "lateral_pct"))


def _turns_on_the_spot(drive: Drive) -> bool:
    """Whether most of the turning was done on the spot rather than in an arc."""
    turned_rad = np.abs(np.diff(drive.path.heading_rad))
    return exact.total(turned_rad[_on_the_spot(drive)]) > 0.5 * exact.total(turned_rad)


CHECK = Check(
    kind="motion",
    measures=MEASURES,
    options={"direction": _problem_with_direction},
    measure=measure,
    explain=explain,
    sketch=sketch,
)
