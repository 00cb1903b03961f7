"""Mistakes of a drive in a room, recognised from what was touched and where the robot ended."""

import itertools
from collections.abc import Iterator

from grader.checks.drive import Drive, is_motion, share_backwards
from grader.checks.kinds.room.way import WallFollowing
from grader.checks.measure import UNMEASURED, Measures, Mistake, mistake
from grader.checks.mistakes import only_turned, robot_mistakes
from grader.checks.scoring import fits
from grader.checks.surroundings import name_of
from grader.contracts.assignment import Assignment
from grader.contracts.scoring import Run
from grader.contracts.trajectory import Contact
from grader.messages.quantity import number

_SCAN = "sensor_msgs/msg/LaserScan"
_REACTION_NS = 500_000_000  # two scans
_TOUCH = ("contacts", "clearance_m", "ahead_m", "settled", "band_pct", "band_m", "moving_s", "covered_pct")
_MANY_COMMANDS = 3  # a script that publishes once has another fault


def room_mistakes(
    assignment: Assignment,
    run: Run,
    drive: Drive | None,
    measures: Measures,
    band: WallFollowing | None = None,
) -> Iterator[Mistake]:
    """Yield what probably went wrong in a room."""
    yield from robot_mistakes(run, assignment.world)
    yield from only_turned(run, _TOUCH)
    if drive is not None:
        strayed = list(_strayed(assignment, measures, band))
        beside_line = strayed if "line_pct" in measures else []  # the line leads past the walls
        yield from beside_line
        yield from _touched(run)
        yield from _ended(assignment, drive, measures)
        yield from () if beside_line else strayed


def _touched(run: Run) -> Iterator[Mistake]:
    for contact in run.trajectory.contacts[:1]:
        values = {"time": number(contact.start_ns / 1e9, "s"), "what": name_of(contact.wall)}
        if not run.outcome.hears:
            yield mistake("room_blind", _TOUCH, **values)
        elif (silent_ns := _silent_since(run, contact)) is not None:
            yield mistake("room_no_stop", _TOUCH, since=number(silent_ns / 1e9, "s"), **values)
        elif any(one.type == _SCAN for one in run.outcome.endpoints) and _drove_on(run, contact):
            code = "path_backwards" if share_backwards(run) > 0.5 else "room_drove_on"
            yield mistake(code, _TOUCH, **values)
        else:
            yield mistake("room_hit", _TOUCH, **values)


def _silent_since(run: Run, contact: Contact) -> int | None:
    """Return when the last command before a contact was sent, if it was a motion and long before; else None."""
    before = [each for each in run.trajectory.commands if each.t_ns <= contact.start_ns]
    if len(before) < _MANY_COMMANDS or not is_motion(before[-1]):
        return None
    silent_ns = contact.start_ns - before[-1].t_ns
    return before[-1].t_ns if silent_ns > 2 * _REACTION_NS else None


def _drove_on(run: Run, contact: Contact) -> bool:
    """Whether the robot was never told to slow down or to turn until it had touched something."""
    until_ns = contact.start_ns + _REACTION_NS
    commands = [each for each in run.trajectory.commands if each.t_ns <= until_ns]
    moving = next((i for i, each in enumerate(commands) if is_motion(each)), len(commands))
    rates, speeds = {each.w_radps for each in commands[moving:]}, [each.v_mps for each in commands[moving:]]
    return len(rates) == 1 and all(one <= other for one, other in itertools.pairwise(speeds))


def _ended(assignment: Assignment, drive: Drive, measures: Measures) -> Iterator[Mistake]:
    """Recognise a robot that did not stop where it should have."""
    if fits(assignment, "settled", measures["settled"].value) is False:
        yield mistake("room_never_stops", ("settled",))
    wanted = assignment.item_on("ahead_m")
    ahead = measures.get("ahead_m", UNMEASURED).value
    if wanted is None or fits(assignment, "ahead_m", ahead) is not False or drive.moving_at_end:
        return
    too_far = wanted.high is not None and ahead > wanted.high
    yield mistake("room_too_early" if too_far else "room_too_late", ("ahead_m",), ahead=number(ahead, "m"))


def _strayed(assignment: Assignment, measures: Measures, band: WallFollowing | None) -> Iterator[Mistake]:
    kept = measures.get("band_pct")
    if band is not None and kept is not None and fits(assignment, "band_pct", kept.value) is False:
        spoilt = ("band_pct", "band_m")
        yield mistake("room_strays", spoilt, **kept.details)
    on_line = measures.get("line_pct")
    if on_line is not None and fits(assignment, "line_pct", on_line.value) is False:
        yield mistake("room_off_line", ("line_pct", "line_covered_pct"), share=number(on_line.value, "%"))
        return
    done = measures.get("line_covered_pct")
    if done is not None and fits(assignment, "line_covered_pct", done.value) is False:
        yield mistake("room_line_left", ("line_covered_pct",), share=number(done.value, "%"))
