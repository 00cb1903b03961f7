"""Mistakes told by a motion that should have been a turn on the spot."""

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
from grader.geometry.segmentation import segment
from grader.messages.quantity import number

SAME_DEG = 4.0
MIN_TURN_DEG = 3.0


def rotation_mistakes(
    assignment: Assignment, run: Run, drive: Drive | None, measures: Mapping[str, Measure]
) -> tuple[Mistake, ...]:
    """Return what probably went wrong while turning."""
    found = [*script_mistakes(run.outcome)]
    if drive is None:
        return tuple(found)
    path = drive.path
    turned = math.degrees(float(np.max(np.abs(path.heading_rad - path.heading_rad[0]))))  # on whatever way
    short = fits(assignment, "turned_deg", turned) is False
    drift = measures.get("drift_m", UNMEASURED).value
    if fits(assignment, "drift_m", drift) is False:
        found.append(_strayed(turned, drift, drive, ("drift_m",) if short else ("drift_m", "turned_deg")))
    found += command_mistakes(run, assignment.world.cmd_vel_topic)
    if short and turned > MIN_TURN_DEG:
        found += _short_turn(turned, drive)
    return tuple(found)


def _strayed(turned: float, drift: float, drive: Drive, spoilt: tuple[str, ...]) -> Mistake:
    """Say how the car left its place: without turning, on straight runs, or in a circle."""
    distance = number(drift, "m")
    if not turned > MIN_TURN_DEG:
        return mistake("only_drove", distance=distance)
    if segment(drive.path).runs:
        return mistake("left_place", spoilt, drift=distance)
    radius = number(float(drive.path.along_m[-1]) / math.radians(turned), "m")
    return mistake("circling", spoilt, radius=radius, drift=distance)


def _short_turn(turned: float, drive: Drive) -> Iterator[Mistake]:
    """Say why the turn ended before it was whole."""
    angle = number(turned, "deg")
    codes = {math.degrees(1.0): "turned_one_radian", 180.0: "half_turn"}
    for telling, code in codes.items():
        if abs(turned - telling) <= SAME_DEG:
            yield mistake(code, ("turned_deg",), turned=angle)
            return
    code = "turn_too_slow" if drive.cut_short else "turn_too_short"
    yield mistake(code, ("turned_deg",), turned=angle)
