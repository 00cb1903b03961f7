"""Mistakes told by which places were visited, and how near the car came to the others."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from grader.checks.drive import Drive, share_backwards
from grader.checks.kinds.places.visits import Visit, Way, entered
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import command_mistakes, only_turned, swings
from grader.checks.scoring import fits
from grader.checks.surroundings import name_of
from grader.contracts.assignment import Assignment, outside_m
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text
from grader.geometry import exact
from grader.messages import say
from grader.messages.quantity import number

_GOAL_MEASURES = ("reached", "reached_pct", "missed_m", "time_s", "detour_pct")
_END_MEASURES = ("end_off_m", "heading_error_deg")
_WRONG_WAY = (
    "path_backwards",
    "place_no_feedback",
    "place_away",
    "place_lost",
)
_DRIVE_MEASURES = ("distance_m", *_GOAL_MEASURES, *_END_MEASURES)
_SAME_HEADING_DEG = 3.0
_MOSTLY = 0.5  # of the way
LEAST_M = 0.02  # a shorter way is no drive
AWAY_SHARE = 0.9  # of the distance at the start: a car that never came nearer drove the wrong way
CIRCLED_RAD = 2.5 * math.tau  # a car that turned further than this and did not arrive circles the goal
NEAR_TIMES = 12.0  # the radius of the goal: a car that never came nearer circles something else
# A car that ends this much further from a goal than it was at best did not lack time: it drove past the goal.
LOST_TIMES, LOST_M = 1.25, 0.5


def place_mistakes(
    assignment: Assignment, run: Run, drive: Drive, way: Way, visits: Sequence[Visit]
) -> Iterator[Mistake]:
    """Yield what probably went wrong on the way to the places."""
    turns = (*_GOAL_MEASURES, *_END_MEASURES)
    yield from command_mistakes(run, assignment.world, turns=turns, drives=_DRIVE_MEASURES)
    touched = list(_touched(assignment, run, way))
    if all(visit.done_s is not None for visit in visits):
        ending = list(_ending(assignment, run, drive, way, visits))
        later = _touched_last(run, visits)  # then it is the end that led the car there
        yield from [*ending, *touched] if later else [*touched, *ending]
    elif float(drive.path.along_m[-1]) < LEAST_M:
        yield from only_turned(run, _DRIVE_MEASURES)
        yield from touched  # otherwise `command_mistakes` says to drive; where to is the next question
    else:
        cause = _missed(assignment, run, drive, way, visits)
        # A car on the wrong way met the wall because of it; otherwise the wall may be why the goal was missed.
        yield from [cause, *touched] if cause.code in _WRONG_WAY else [*touched, cause]


def _touched(assignment: Assignment, run: Run, way: Way) -> Iterator[Mistake]:
    """Name the first thing that the car touched, and the first place to avoid that it entered."""
    spoilt = ("contacts", "clearance_m", *_GOAL_MEASURES)
    for contact in run.trajectory.contacts[:1]:
        time = number(contact.start_ns / 1e9, "s")
        if assignment.world.kind == "robot":
            yield mistake("place_hit", spoilt, time=time, what=name_of(contact.wall))
            continue
        wall = say(f"wall.{contact.wall}")
        yield mistake("place_wall", spoilt, time=time, wall=wall)
    avoid = () if assignment.places is None else assignment.places.avoid
    for i in entered(avoid, way)[:1]:
        region = avoid[i - 1]
        at = f"({number(region.x_m, 'm')}, {number(region.y_m, 'm')})"
        yield mistake("place_entered", ("entered", "clearance_m"), at=at)


def _touched_last(run: Run, visits: Sequence[Visit]) -> bool:
    """Whether the car first touched something when it had been at all goals."""
    done_s = max(visit.done_s or 0.0 for visit in visits)
    return any(contact.start_ns / 1e9 > done_s for contact in run.trajectory.contacts[:1])


def _missed(assignment: Assignment, run: Run, drive: Drive, way: Way, visits: Sequence[Visit]) -> Mistake:
    """Say why the car did not reach the first goal that it missed."""
    first = next(visit for visit in visits if visit.done_s is None)
    values = {
        "reached": sum(visit.done_s is not None for visit in visits),
        "goals": len(visits),
        "goal": first.number,
        "nearest": _nearest(first),
        "allowed": _goal_extent(first),
    }
    spoilt = (*_GOAL_MEASURES, *_END_MEASURES)
    if first.entered_s is not None:
        return _entered_in_vain(visits, first)
    if way.put:
        return mistake("teleported", spoilt, topic=assignment.world.cmd_vel_topic)
    if _ignores_the_pose(assignment, run):
        return mistake("place_no_feedback", spoilt, topic=_pose_topic(assignment), **values)
    if drive.moving_at_end and _circles(drive, first):
        return mistake("place_circled", (*spoilt, "settled"), **values)
    standing = _standing_at(way, visits)
    if standing is not None and standing.number < first.number:
        return mistake("place_stuck", spoilt, at=standing.number, goal=first.number)
    last_m = _final_distance_m(way, first)
    stayed_away = first.nearest_m > AWAY_SHARE * first.first_m and values["reached"] == 0
    if stayed_away and not _was_approaching(first, last_m):
        code = "path_backwards" if share_backwards(run) > _MOSTLY else "place_away"
        return mistake(code, spoilt, first=number(first.first_m, "m"), **values)
    passed = last_m > LOST_TIMES * first.nearest_m + LOST_M and not _touched_before(run, way, first)
    if drive.cut_short and passed:
        return mistake("place_lost", spoilt, **values)
    if drive.cut_short:
        lasting = (*spoilt, "settled")
        return swings(run, lasting) or mistake("place_too_slow", lasting, **values)
    return mistake("place_missed", spoilt, **values)


def _touched_before(run: Run, way: Way, visit: Visit) -> bool:
    """Whether the car touched something before it was nearest to a goal."""
    region = visit.goal.region
    nearest_s = way.t_s[int(np.argmin(exact.hypot(way.x_m - region.x_m, way.y_m - region.y_m)))]
    return any(contact.start_ns / 1e9 < nearest_s for contact in run.trajectory.contacts[:1])


def _standing_at(way: Way, visits: Sequence[Visit]) -> Visit | None:
    """Return the visited goal at which the car stands in the end."""
    done = [visit for visit in visits if visit.done_s is not None]
    ends = (float(way.x_m[-1]), float(way.y_m[-1]))
    return next((one for one in done if way.rests and outside_m(one.goal.region, *ends) <= 0.0), None)


def _nearest(visit: Visit) -> Text | str:
    """Return the least distance of the car from the middle of a circle, or from the edge of a box."""
    if visit.goal.region.kind == "circle":
        return number(visit.nearest_m, "m")
    return say("place.edge", value=number(visit.outside_m, "m"))


def _goal_extent(visit: Visit) -> Text:
    """Return how large the goal is, in the words of `_nearest`."""
    region = visit.goal.region
    if region.kind == "circle":
        return say("place.within", value=number(region.radius_m, "m"))
    return say("place.box", width=number(region.width_m, "m"), height=number(region.height_m, "m"))


def _entered_in_vain(visits: Sequence[Visit], first: Visit) -> Mistake:
    """Say why a goal that the car entered does not count: it came too late, left too soon or broke the order."""
    goal = first.goal
    came_s = first.entered_s or 0.0
    if goal.by_s is not None and came_s > goal.by_s:
        came, by = number(came_s, "s"), number(goal.by_s, "s")
        return mistake("place_late", _GOAL_MEASURES, goal=first.number, came=came, by=by)
    if first.stayed_s < goal.hold_s:
        stayed, hold = number(first.stayed_s, "s"), number(goal.hold_s, "s")
        return mistake("place_not_held", _GOAL_MEASURES, goal=first.number, stayed=stayed, hold=hold)
    came_in = sorted(
        (visit for visit in visits if visit.entered_s is not None), key=lambda visit: visit.entered_s or 0.0
    )
    order = " → ".join(str(visit.number) for visit in came_in)
    wanted = " → ".join(str(visit.number) for visit in visits)
    return mistake("place_order", _GOAL_MEASURES, order=order, wanted=wanted)


def _ignores_the_pose(assignment: Assignment, run: Run) -> bool:
    """Whether the cases start at different places, and the script never subscribes to the car's pose."""
    starts = {case.start for case in assignment.cases}
    suffix = _pose_topic(assignment).removeprefix("/turtle1")  # the pose of another turtle counts as well
    return len(starts) > 1 and not any(name.endswith(suffix) for name in run.outcome.heard)


def _pose_topic(assignment: Assignment) -> str:
    """Return the topic on which the world publishes where the car is."""
    is_robot = assignment.world.kind == "robot"
    return assignment.world.topics.get("/odom", "/odom") if is_robot else "/turtle1/pose"


def _circles(drive: Drive, goal: Visit) -> bool:
    """Whether the car, driving to the end, went round and round near a goal."""
    turned = float(np.ptp(drive.path.heading_rad))
    region = goal.goal.region
    radius_m = region.radius_m or exact.hypot(region.width_m, region.height_m) / 2.0
    return turned > CIRCLED_RAD and goal.nearest_m < NEAR_TIMES * radius_m


def _final_distance_m(way: Way, visit: Visit) -> float:
    """Return how far from the middle of a goal the car's way ends."""
    region = visit.goal.region
    return exact.hypot(float(way.x_m[-1]) - region.x_m, float(way.y_m[-1]) - region.y_m)


def _was_approaching(visit: Visit, last_m: float) -> bool:
    """Whether the car was still coming nearer to a goal at the end of its way, however slowly."""
    return last_m <= visit.nearest_m + LEAST_M and visit.nearest_m < visit.first_m - LEAST_M


def _ending(
    assignment: Assignment, run: Run, drive: Drive, way: Way, visits: Sequence[Visit]
) -> Iterator[Mistake]:
    """Say what was wrong after the car had visited all goals."""
    if drive.moving_at_end:
        yield mistake("place_never_stops", ("settled", *_END_MEASURES))
        return
    off_m = _final_distance_m(way, visits[-1])
    if fits(assignment, "end_off_m", off_m) is False:
        yield mistake("place_left", ("end_off_m",), away=number(off_m, "m"))
    wanted_deg = None if assignment.places is None else assignment.places.end_heading_deg
    if wanted_deg is not None:
        looks_deg = math.remainder(math.degrees(way.end_rad), 360.0)
        error_deg = abs(math.remainder(looks_deg - wanted_deg, 360.0))
        if fits(assignment, "heading_error_deg", error_deg) is False:
            looks, wanted = number(looks_deg, "deg"), number(wanted_deg, "deg")
            off_deg = math.remainder(looks_deg - math.degrees(wanted_deg), 360.0)
            as_radians = abs(off_deg) < _SAME_HEADING_DEG  # the number was taken for radians
            reason = say("detail.as_radians", number=f"{wanted_deg:g}") if as_radians else EMPTY
            yield mistake("place_heading", ("heading_error_deg",), looks=looks, wanted=wanted, reason=reason)
