"""Mistakes told by a motion that should have been straight."""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from grader.checks.drive import Drive
from grader.checks.measure import UNMEASURED, Measure, Mistake
from grader.checks.mistakes.commands import command_mistakes
from grader.checks.mistakes.script import script_mistakes
from grader.checks.quantity import number
from grader.contracts.verdict import Run
from grader.messages import say

MIN_MOTION_M = 0.05
TURNING_DEG = 5.0
WAY_BACK_M = 0.05
SHORT_M = 0.5
SPOT_RADIUS_M = 0.1  # an arc tighter than this is a turn on the spot


def motion_mistakes(
    run: Run, topic: str, drive: Drive | None, measures: Mapping[str, Measure], *, backward: bool
) -> tuple[Mistake, ...]:
    """Return what probably went wrong while driving straight."""
    found = [*script_mistakes(run.outcome)]
    if drive is None:
        return tuple(found)
    values = {
        name: measures.get(name, UNMEASURED).value for name in ("advance_m", "turned_deg", "way_back_m")
    }
    if not _turned_round(drive, values["turned_deg"], backward=backward):
        found += _wrong_way(values["advance_m"], backward=backward)
    found += command_mistakes(run, topic)
    found += _turning(drive, values)
    if values["way_back_m"] > WAY_BACK_M and values["advance_m"] > -MIN_MOTION_M:
        text = say("mistake.came_back", way_back=number(values["way_back_m"], "m"))
        found.append(Mistake("came_back", text, ("way_back_m", "advance_m")))
    if MIN_MOTION_M < values["advance_m"] < SHORT_M and values["way_back_m"] <= WAY_BACK_M:
        text = say("mistake.too_short", distance=number(values["advance_m"], "m"))
        found.append(Mistake("too_short", text, ("advance_m",)))
    return tuple(found)


def _wrong_way(advance_m: float, *, backward: bool) -> Iterator[Mistake]:
    if advance_m < -MIN_MOTION_M:
        code = "drove_forward" if backward else "drove_backward"
        yield Mistake(code, say(f"mistake.{code}", distance=number(-advance_m, "m")), ("advance_m",))


def _turned_round(drive: Drive, turned_deg: float, *, backward: bool) -> bool:
    """Whether the car drove the right way but had turned: its speed had the right sign, so that is no mistake."""
    driven_m = float(drive.path.signed_m[-1]) * (-1.0 if backward else 1.0)
    return turned_deg > TURNING_DEG and driven_m > MIN_MOTION_M and _on_the_spot(drive)


def _turning(drive: Drive, values: Mapping[str, float]) -> Iterator[Mistake]:
    if not values["turned_deg"] > TURNING_DEG:
        return
    travelled_m = float(drive.path.along_m[-1])
    turned = number(values["turned_deg"], "deg")
    spoilt = ("turned_deg", "lateral_pct", "way_back_m", "advance_m")
    if travelled_m < MIN_MOTION_M:
        yield Mistake("only_turned", say("mistake.only_turned", turned=turned))
    elif _on_the_spot(drive):
        yield Mistake("turned_too", say("mistake.turned_too", turned=turned), spoilt)
    else:
        radius_m = travelled_m / math.radians(values["turned_deg"])
        text = say("mistake.curved", turned=turned, radius=number(radius_m, "m"))
        yield Mistake("curved", text, spoilt)


def _on_the_spot(drive: Drive) -> bool:
    """Whether most of the turning was done on the spot rather than in an arc."""
    turned_rad = np.abs(np.diff(drive.path.heading_rad))
    driven_m = np.abs(np.diff(drive.path.along_m))
    on_the_spot_rad = float(np.sum(turned_rad[driven_m < SPOT_RADIUS_M * turned_rad]))
    return on_the_spot_rad > 0.5 * float(np.sum(turned_rad))
