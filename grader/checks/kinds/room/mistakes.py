"""Mistakes of a drive in a room, recognised from what was touched."""

from collections.abc import Iterator

from grader.checks.drive import Drive
from grader.checks.measure import Measures, Mistake, mistake
from grader.checks.mistakes import only_turned, robot_mistakes
from grader.checks.surroundings import name_of
from grader.contracts.assignment import Assignment
from grader.contracts.scoring import Run
from grader.messages.quantity import number

_TOUCH = ("contacts", "clearance_m", "ahead_m", "settled", "band_pct", "band_m", "moving_s", "covered_pct")


def room_mistakes(
    assignment: Assignment, run: Run, drive: Drive | None, measures: Measures
) -> Iterator[Mistake]:
    """Yield what probably went wrong in a room."""
    yield from robot_mistakes(run, assignment.world)
    yield from only_turned(run, _TOUCH)
    leads_past_walls = "line_pct" in measures
    for contact in run.trajectory.contacts[: drive is not None and not leads_past_walls]:
        time, what = number(contact.start_ns / 1e9, "s"), name_of(contact.wall)
        yield mistake("room_hit", _TOUCH, time=time, what=what)
