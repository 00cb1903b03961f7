"""Mistakes on the way to places that the measures do not show: what was touched, and goals visited in vain."""

from collections.abc import Iterator, Sequence

from grader.checks.drive import Drive
from grader.checks.kinds.places.visits import Visit, Way
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import command_mistakes, only_turned, swings, time_was_up
from grader.checks.surroundings import name_of
from grader.contracts.assignment import Assignment
from grader.contracts.scoring import Run
from grader.messages import say
from grader.messages.quantity import number, number_beside

_GOAL_MEASURES = ("reached", "reached_pct", "missed_m", "time_s", "detour_pct")
_END_MEASURES = ("end_off_m", "heading_error_deg")
_DRIVE_MEASURES = ("distance_m", *_GOAL_MEASURES, *_END_MEASURES)
LEAST_M = 0.02  # a shorter way is no drive


def place_mistakes(
    assignment: Assignment, run: Run, drive: Drive, way: Way, visits: Sequence[Visit]
) -> Iterator[Mistake]:
    """Yield what probably went wrong on the way to the places."""
    spoilt = (*_GOAL_MEASURES, *_END_MEASURES)
    yield from command_mistakes(run, assignment.world, turns=spoilt, drives=_DRIVE_MEASURES)
    first = next((visit for visit in visits if visit.done_s is None), None)
    if first is not None and float(drive.path.along_m[-1]) < LEAST_M:
        yield from only_turned(run, _DRIVE_MEASURES)
    elif first is not None and first.entered_s is not None:
        yield _entered_in_vain(visits, first)
    elif first is not None and way.put:
        yield mistake("teleported", spoilt, topic=assignment.world.cmd_vel_topic)
    yield from _touched(assignment, run)
    if first is not None and (swung := swings(run, (*spoilt, "settled"))) is not None:
        yield swung
    elif first is not None:
        yield from time_was_up(run, drive, (*spoilt, "settled"))


def _touched(assignment: Assignment, run: Run) -> Iterator[Mistake]:
    """Name the first thing that the car touched."""
    spoilt = ("contacts", "clearance_m", *_GOAL_MEASURES)
    for contact in run.trajectory.contacts[:1]:
        time = number(contact.start_ns / 1e9, "s")
        if assignment.world.kind == "robot":
            yield mistake("place_hit", spoilt, time=time, what=name_of(contact.wall))
            continue
        wall = say(f"wall.{contact.wall}")
        yield mistake("place_wall", spoilt, time=time, wall=wall)


def _entered_in_vain(visits: Sequence[Visit], first: Visit) -> Mistake:
    """Say why a goal that the car entered does not count: it came too late, left too soon or broke the order."""
    goal = first.goal
    came_s = first.entered_s or 0.0
    if goal.by_s is not None and came_s > goal.by_s:
        came, by = number(came_s, "s"), number(goal.by_s, "s")
        return mistake("place_late", _GOAL_MEASURES, goal=first.number, came=came, by=by)
    if first.stayed_s < goal.hold_s:
        stayed, hold = number_beside(first.stayed_s, "s", (goal.hold_s,)), number(goal.hold_s, "s")
        return mistake("place_not_held", _GOAL_MEASURES, goal=first.number, stayed=stayed, hold=hold)
    came_in = sorted(
        (visit for visit in visits if visit.entered_s is not None), key=lambda visit: visit.entered_s or 0.0
    )
    order = " → ".join(str(visit.number) for visit in came_in)
    wanted = " → ".join(str(visit.number) for visit in visits)
    return mistake("place_order", _GOAL_MEASURES, order=order, wanted=wanted)
