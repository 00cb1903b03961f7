"""Mistakes recognised from which places were visited, and how near the car came to the others."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from grader.checks.drive import Drive
from grader.checks.kinds.places.visits import Visit, Way, entered
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import asleep, command_mistakes, lost_at_home, script_mistakes
from grader.checks.scoring import fits
from grader.checks.surroundings import name_of
from grader.contracts.assignment import Assignment
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.messages import say
from grader.messages.quantity import number
from grader.messages.script import ScriptText

_GOALS = ("reached", "missed_m", "time_s", "detour_pct")
_END = ("end_off_m", "heading_error_deg")
_CAUSES = ("place_no_feedback", "place_away", "place_lost")
_DRIVES = ("distance_m", *_GOALS, *_END)
LEAST_M = 0.02  # a shorter way does not count as driving
AWAY_SHARE = 0.9  # of the distance at the start: a car that never came nearer drove the wrong way
CIRCLED_RAD = 2.5 * math.tau  # a car that turns more than this without arriving circles the goal
LOST_TIMES, LOST_M = 1.25, 0.5  # a car that ends this much further from a goal than at best was not too slow
NEAR_TIMES = 12.0  # of the goal's size: a circle further off is not one round the goal


def place_mistakes(
    assignment: Assignment, run: Run, drive: Drive | None, way: Way | None, seen: Sequence[Visit]
) -> tuple[Mistake, ...]:
    """Return what probably went wrong on the way to the places."""
    found = [*script_mistakes(run), *asleep(run)]
    if drive is None or way is None:
        return tuple(found)
    found += command_mistakes(run, assignment.world, turns=(*_GOALS, *_END), drives=_DRIVES)
    touched = list(_touched(assignment, run, way))
    if all(visit.done_s is not None for visit in seen):
        found += [*touched, *_ending(assignment, run, drive, way, seen)]
    elif float(drive.path.along_m[-1]) < LEAST_M:
        found += touched  # a car that never drove needs the hint to drive, not the hint where to
    else:
        cause = _missed(assignment, run, drive, way, seen)
        # a car that drove the wrong way met the wall for that reason
        found += [cause, *touched] if cause.code in _CAUSES else [*touched, cause]
    found += lost_at_home(run)
    return tuple(found)


def _touched(assignment: Assignment, run: Run, way: Way) -> Iterator[Mistake]:
    for contact in run.trajectory.contacts[:1]:
        time = number(contact.start_ns / 1e9, "s")
        if assignment.world.kind == "robot":
            spoilt = ("contacts", "clearance_m", *_GOALS)
            yield mistake("place_hit", spoilt, time=time, what=name_of(contact.wall))
            continue
        wall = say(f"wall.{contact.wall}")
        yield mistake("place_wall", ("contacts", "clearance_m", *_GOALS), time=time, wall=wall)
    avoid = () if assignment.places is None else assignment.places.avoid
    for i in entered(avoid, way)[:1]:
        region = avoid[i - 1]
        at = f"({number(region.x_m, 'm')}, {number(region.y_m, 'm')})"
        yield mistake("place_entered", ("entered", "clearance_m"), at=at)


def _missed(assignment: Assignment, run: Run, drive: Drive, way: Way, seen: Sequence[Visit]) -> Mistake:
    """Say why the first goal that was not reached was not."""
    first = next(visit for visit in seen if visit.done_s is None)
    values = {
        "reached": sum(visit.done_s is not None for visit in seen),
        "goals": len(seen),
        "goal": first.number,
        "nearest": _nearest(first),
        "allowed": _allowed(first),
    }
    spoilt = (*_GOALS, *_END)
    if first.entered_s is not None:
        return _entered_in_vain(assignment, seen, first)
    if _ignores_the_pose(assignment, run):
        return mistake("place_no_feedback", spoilt, topic=_pose_topic(assignment), **values)
    if drive.moving_at_end and _circles(drive, first):
        return mistake("place_circled", (*spoilt, "settled"), **values)
    last_m = _off_m(way, first)
    if first.nearest_m > AWAY_SHARE * first.first_m and values["reached"] == 0 and not _nears(first, last_m):
        return mistake("place_away", spoilt, first=number(first.first_m, "m"), **values)
    if drive.cut_short and last_m > LOST_TIMES * first.nearest_m + LOST_M:
        return mistake("place_lost", spoilt, **values)
    if drive.cut_short:
        return mistake("place_too_slow", (*spoilt, "settled"), **values)
    return mistake("place_missed", spoilt, **values)


def _nearest(visit: Visit) -> Text | str:
    """Return how near the car came: to the middle of a circle, to the edge of a box."""
    if visit.goal.region.kind == "circle":
        return number(visit.nearest_m, "m")
    return say("place.edge", value=number(visit.outside_m, "m"))


def _allowed(visit: Visit) -> Text:
    region = visit.goal.region
    if region.kind == "circle":
        return say("place.within", value=number(region.radius_m, "m"))
    return say("place.box", width=number(region.width_m, "m"), height=number(region.height_m, "m"))


def _entered_in_vain(assignment: Assignment, seen: Sequence[Visit], first: Visit) -> Mistake:
    """Say why a goal that the car was in does not count: too late, too short, or out of turn."""
    goal = first.goal
    came_s = first.entered_s or 0.0
    if goal.by_s is not None and came_s > goal.by_s:
        came, by = number(came_s, "s"), number(goal.by_s, "s")
        return mistake("place_late", _GOALS, goal=first.number, came=came, by=by)
    if first.stayed_s < goal.hold_s:
        stayed, hold = number(first.stayed_s, "s"), number(goal.hold_s, "s")
        return mistake("place_not_held", _GOALS, goal=first.number, stayed=stayed, hold=hold)
    came_in = sorted(
        (visit for visit in seen if visit.entered_s is not None), key=lambda visit: visit.entered_s or 0.0
    )
    order = " → ".join(str(visit.number) for visit in came_in)
    wanted = " → ".join(str(visit.number) for visit in seen)
    return mistake("place_order", _GOALS, order=order, wanted=wanted)


def _ignores_the_pose(assignment: Assignment, run: Run) -> bool:
    """Whether the car starts somewhere else in each case, and the script never asks where."""
    starts = {case.start for case in assignment.cases}
    tells = _pose_topic(assignment).removeprefix("/turtle1")  # a second turtle's will do, too
    heard = any(each.kind == "subscription" and each.name.endswith(tells) for each in run.outcome.endpoints)
    return len(starts) > 1 and not heard


def _pose_topic(assignment: Assignment) -> str:
    """Return the topic that tells where the car is."""
    is_robot = assignment.world.kind == "robot"
    return assignment.world.topics.get("/odom", "/odom") if is_robot else "/turtle1/pose"


def _circles(drive: Drive, goal: Visit) -> bool:
    turned = float(np.ptp(drive.path.heading_rad))
    region = goal.goal.region
    wide_m = region.radius_m or math.hypot(region.width_m, region.height_m) / 2.0
    return turned > CIRCLED_RAD and goal.nearest_m < NEAR_TIMES * wide_m


def _off_m(way: Way, visit: Visit) -> float:
    """Return how far the car is from the middle of a goal in the end."""
    region = visit.goal.region
    return math.hypot(float(way.x_m[-1]) - region.x_m, float(way.y_m[-1]) - region.y_m)


def _nears(visit: Visit, last_m: float) -> bool:
    """Whether the car was still coming nearer to a goal when its motion ended, however slowly."""
    return last_m <= visit.nearest_m + LEAST_M and visit.nearest_m < visit.first_m - LEAST_M


def _ending(
    assignment: Assignment, run: Run, drive: Drive, way: Way, seen: Sequence[Visit]
) -> Iterator[Mistake]:
    """Tell of what was wrong after all places were visited."""
    if drive.moving_at_end:
        publisher = ScriptText(run.source).publisher or "publisher"
        yield mistake("place_never_stops", ("settled", *_END), publisher=publisher)
        return
    off_m = _off_m(way, seen[-1])
    if fits(assignment, "end_off_m", off_m) is False:
        yield mistake("place_left", ("end_off_m",), away=number(off_m, "m"))
    wanted_deg = None if assignment.places is None else assignment.places.end_heading_deg
    if wanted_deg is not None:
        looks_deg = math.remainder(math.degrees(way.end_rad), 360.0)
        error_deg = abs(math.remainder(looks_deg - wanted_deg, 360.0))
        if fits(assignment, "heading_error_deg", error_deg) is False:
            looks, wanted = number(looks_deg, "deg"), number(wanted_deg, "deg")
            yield mistake("place_heading", ("heading_error_deg",), looks=looks, wanted=wanted)
