"""Mistakes told by a motion that should have been straight."""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from grader.checks.credit import fits
from grader.checks.drive import Drive
from grader.checks.measure import UNMEASURED, Measure, Mistake, mistake
from grader.checks.mistakes.commands import command_mistakes
from grader.checks.mistakes.script import script_mistakes
from grader.contracts.assignment import Assignment
from grader.contracts.verdict import Run
from grader.messages.quantity import number

MIN_MOTION_M = 0.05
SPOT_RADIUS_M = 0.1  # an arc tighter than this is a turn on the spot


def motion_mistakes(
    assignment: Assignment, run: Run, drive: Drive | None, measures: Mapping[str, Measure], *, backward: bool
) -> tuple[Mistake, ...]:
    """Return what probably went wrong while driving straight."""
    found = [*script_mistakes(run.outcome)]
    if drive is None:
        return tuple(found)
    values = {
        name: measures.get(name, UNMEASURED).value for name in ("advance_m", "turned_deg", "way_back_m")
    }
    lost = {name for name, value in values.items() if fits(assignment, name, value) is False}
    if "turned_deg" not in lost or not _turned_round(drive, backward=backward):
        found += _wrong_way(values["advance_m"], backward=backward)
    found += command_mistakes(run, assignment.world.cmd_vel_topic)
    if "turned_deg" in lost:
        found.append(_turning(drive, values))
    if "way_back_m" in lost and values["advance_m"] > -MIN_MOTION_M:
        found.append(
            mistake("came_back", ("way_back_m", "advance_m"), way_back=number(values["way_back_m"], "m"))
        )
    elif "advance_m" in lost and values["advance_m"] > MIN_MOTION_M:
        found.append(mistake("too_short", ("advance_m",), distance=number(values["advance_m"], "m")))
    return tuple(found)


def _wrong_way(advance_m: float, *, backward: bool) -> Iterator[Mistake]:
    if advance_m < -MIN_MOTION_M:
        code = "drove_forward" if backward else "drove_backward"
        yield mistake(code, ("advance_m",), distance=number(-advance_m, "m"))


def _turned_round(drive: Drive, *, backward: bool) -> bool:
    """Whether the car drove the right way after it had turned: its speed had the right sign."""
    driven_m = float(drive.path.signed_m[-1]) * (-1.0 if backward else 1.0)
    return driven_m > MIN_MOTION_M and _on_the_spot(drive)


def _turning(drive: Drive, values: Mapping[str, float]) -> Mistake:
    travelled_m = float(drive.path.along_m[-1])
    turned = number(values["turned_deg"], "deg")
    spoilt = ("turned_deg", "lateral_pct", "way_back_m", "advance_m")
    if travelled_m < MIN_MOTION_M:
        return mistake("only_turned", turned=turned)
    if _on_the_spot(drive):
        return mistake("turned_too", spoilt, turned=turned)
    radius_m = travelled_m / math.radians(values["turned_deg"])
    return mistake("curved", spoilt, turned=turned, radius=number(radius_m, "m"))


def _on_the_spot(drive: Drive) -> bool:
    """Whether most of the turning was done on the spot rather than in an arc."""
    turned_rad = np.abs(np.diff(drive.path.heading_rad))
    driven_m = np.abs(np.diff(drive.path.along_m))
    on_the_spot_rad = float(np.sum(turned_rad[driven_m < SPOT_RADIUS_M * turned_rad]))
    return on_the_spot_rad > 0.5 * float(np.sum(turned_rad))
