"""Mistakes recognised from the shape of a polygon."""

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from grader.checks.drive import (
    FAST_TURN_RADPS,
    coasts,
    fastest_radps,
    is_arc,
    is_drive,
    is_motion,
    is_turn,
    motions_of,
    moves_of,
    share_backwards,
    times_begun,
    with_ends,
)
from grader.checks.kinds.polygon.figures import FULL_TURN_DEG, SAME_DEG, DrivenPolygon, WantedPolygon
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import (
    MANY_MOTIONS,
    TOO_BRIEF_NS,
    command_mistakes,
    no_final_stop,
    noted,
    only_turned,
    swings,
)
from grader.checks.scoring import fits
from grader.contracts.assignment import Assignment
from grader.contracts.outcome import RunStatus
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text
from grader.contracts.trajectory import Floats
from grader.geometry import exact
from grader.geometry.figure import PolygonFigure
from grader.geometry.path import MIN_TURN_RAD, median
from grader.messages import say
from grader.messages.quantity import listed, number

ONE_RADIAN_DEG = math.degrees(1.0)
NEAR_DEG = 6.0  # corners this close to the wanted ones show that this figure was meant
# A turn by 1 rad by mistake is exact: 54° is something else, such as one tick of 10 Hz too many.
RADIAN_OFF_DEG = 2.0
_SEEN_M = 0.1
_SLOW_M = 1.5  # a car that has driven less by the horizon may still be on its first side
# From this share of arcs on, they explain wrong angles and lengths, so they are mentioned first.
MOSTLY_ROUND_SHARE = 0.25
_LENGTHS = ("side_spread_pct", "side_error_pct")
_COASTED = ("settled", "gap_pct", *_LENGTHS)
_TURNS = ("corner_deg", "sides", "gap_pct", "opposite_corners")
_DRIVES = ("distance_m", *_LENGTHS, "gap_pct")
_EQUAL_DRIVES = ("distance_m", "side_error_pct")
_EQUAL_RATIO = 1.02  # of the longest to the shortest drive: a third of what costs points
_SHAPE = ("sides", "corner_deg", *_LENGTHS, "gap_pct", "curved_pct", "opposite_corners", "settled")
_FAR_OFF_DEG = 15.0  # turns this much too short lead the car away from the wanted figure
_CORNER_RAD = math.radians(30.0)  # less is a correction of the heading on the way
_LONGER = 1.5  # times the first side: otherwise all sides may just be too long

# A rate that is several times the error of the heading gets this high without degrees, where theta jumps by 2π.
_FAST_BY_POSE_RADPS = 40.0

# The most that slipping adds to the mean corner of a script that steers by its heading.
_SLIP_DEG = 12.0

_BACKED = 0.2  # of the way: less corrects a side that was too long


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """What a recogniser looks at."""

    assignment: Assignment
    run: Run
    wanted: WantedPolygon
    driven: DrivenPolygon

    @property
    def sides(self) -> int:
        return self.wanted.sides

    @property
    def rigid(self) -> bool:
        """Whether the car does exactly as it is told."""
        return self.assignment.world.profile == "nominal"

    @property
    def steers(self) -> bool:
        """Whether the script hears where the car is, so that it may steer by that."""
        return any(name.endswith("/pose") for name in self.run.outcome.heard)

    @property
    def ideal_deg(self) -> float:
        return self.wanted.corner_deg

    @property
    def has_wrong_corner(self) -> bool:
        """Whether a corner of the figure costs points."""
        return any(self.loses("corner_deg", corner) for corner in self.driven.corners_deg.tolist())

    def loses(self, measure: str, value: float) -> bool:
        """Whether a value of `measure` costs points."""
        return fits(self.assignment, measure, value) is False


def polygon_mistakes(
    assignment: Assignment, run: Run, wanted: WantedPolygon, driven: DrivenPolygon
) -> Iterator[Mistake]:
    """Yield what probably went wrong in a figure that should have been `wanted`."""
    seen = _Seen(assignment, run, wanted, driven)
    if noted(run.outcome, "lateral_command") is None:  # or a figure was meant to be driven sideways
        yield from _never_turned(seen)
    yield from list(_degrees(seen)) or only_turned(run, ("distance_m", *_SHAPE))
    yield from _kept_driving(seen)
    yield from _kept_turning(seen)
    yield from command_mistakes(run, assignment.world, turns=_TURNS, drives=_spoilt_by_short_drives(run))
    yield from _brief_drives(seen)
    yield from _wrong_turns(seen)
    yield from _wall(seen)
    cut = _cut_at_the_end(seen)
    if cut:
        yield mistake(
            "time_was_up",
            ("settled", "gap_pct", *_LENGTHS),
            time=number(run.outcome.duration_ns / 1e9, "s"),
        )
    yield from _shape(seen)
    if not cut:
        yield from _ending(seen)


def _drives_m(run: Run, since_ns: int = 0) -> list[float]:
    """Return the lengths of the drives that were commanded, with a stop or a turn between one and the next."""
    commanded = (one for one in with_ends(run.trajectory) if one[0].t_ns >= since_ns)
    drives = itertools.groupby(commanded, lambda one: is_drive(one[0]))
    return [
        exact.total(abs(command.v_mps) * (until_ns - command.t_ns) for command, until_ns in drive) / 1e9
        for drives_on, drive in drives
        if drives_on
    ]


def _spoilt_by_short_drives(run: Run) -> tuple[str, ...]:
    """Return the measures that drives spoil when they end too early.

    Drives that come out equally long draw equal sides: if such a figure is not closed, it is for another reason.
    """
    lengths_m = _drives_m(run)
    equal = lengths_m and max(lengths_m) <= _EQUAL_RATIO * min(lengths_m)
    return _EQUAL_DRIVES if equal else _DRIVES


def _never_turned(seen: _Seen) -> Iterator[Mistake]:
    """Recognise sides driven one behind the other, whatever came later: without a turn no figure can come."""
    commands = seen.run.trajectory.commands
    moves = moves_of(seen.run.trajectory)
    if not moves or seen.driven.drive.path.along_m[-1] < _SEEN_M or seen.run.trajectory.jumps:
        return
    turning = [command.t_ns for command in moves if is_turn(command)]
    contacts = seen.run.trajectory.contacts
    if not turning:
        if math.degrees(float(np.ptp(seen.driven.drive.path.heading_rad))) > SAME_DEG:
            return  # turned by turtlesim's own action
        if not _on_first_side(seen):
            once = times_begun(map(is_motion, commands)) == 1
            if once and contacts and _goes_on(seen, contacts[0].start_ns):
                return  # `_wall` says what by pose never ended
            yield mistake("no_turns", _SHAPE, ideal=_degree(seen.ideal_deg), sides=seen.sides)
        return
    drives = times_begun(is_motion(command) for command in commands if command.t_ns < turning[0])
    hit = bool(contacts) and contacts[0].start_ns <= turning[0]
    if drives <= 1 and not hit:
        return
    turns = times_begun(map(is_turn, commands))
    over = seen.run.outcome.status is RunStatus.FINISHED or is_turn(moves[-1])
    at_last = hit and turns == 1 and over
    if at_last or (drives > 1 and (hit or turns == 1)):
        wall = say("detail.wall_hit") if hit else EMPTY
        ideal = _degree(seen.ideal_deg)
        yield mistake("turns_behind_loop", _SHAPE, count=drives, wall=wall, ideal=ideal, sides=seen.sides)


def _on_first_side(seen: _Seen) -> bool:
    """Whether the car was so slow that the first side, and no turn, was all it had time for."""
    drive = seen.driven.drive
    return drive.cut_short and not seen.run.trajectory.contacts and float(drive.path.along_m[-1]) < _SLOW_M


def _kept_driving(seen: _Seen) -> Iterator[Mistake]:
    """Recognise a linear speed that was set for the sides and never taken back for the turns."""
    moves = moves_of(seen.run.trajectory)
    turns = [command for command in moves if is_turn(command)]
    sides = {command.v_mps for command in moves if not is_turn(command)}
    if len(turns) > 1 and len(sides) == 1 and all(command.v_mps in sides for command in turns):
        rates = {command.w_radps for command in turns}
        if len(rates) == 1:
            yield mistake(
                "kept_driving",
                _SHAPE,
                speed=number(sides.pop(), "1"),
                rate=number(rates.pop(), "1"),
            )


def _kept_turning(seen: _Seen) -> Iterator[Mistake]:
    """Recognise a turn rate that stayed set while the sides were driven; the turns themselves are on the spot."""
    figure = seen.driven.figure
    end_ns = math.inf if figure is None else int(seen.driven.drive.t_ns[figure.end])
    commands = [command for command in moves_of(seen.run.trajectory) if command.t_ns <= end_ns]
    on_the_spot = any(is_turn(command) and not command.v_mps for command in commands)
    sides = [command for command in commands if is_drive(command)]
    rates = {command.w_radps for command in sides} - {0.0}
    if on_the_spot and len(rates) == 1 and seen.run.trajectory.contacts == ():
        bent = sum(command.w_radps != 0.0 for command in sides)
        if bent > len(sides) / 2:
            yield mistake("kept_turning", _SHAPE, rate=number(rates.pop(), "1"))


def _brief_drives(seen: _Seen) -> Iterator[Mistake]:
    """Recognise drives that all end as soon as they have begun."""
    drives = itertools.groupby(with_ends(seen.run.trajectory), lambda one: is_drive(one[0]))
    lasted_ns = [sum(until - one.t_ns for one, until in drive) for drives_on, drive in drives if drives_on]
    if len(lasted_ns) > MANY_MOTIONS and max(lasted_ns) < TOO_BRIEF_NS:
        yield mistake("stop_in_loop", _SHAPE, times=len(lasted_ns))
    elif lasted_ns and max(lasted_ns) < TOO_BRIEF_NS:
        yield mistake("drives_too_brief", _SHAPE, longest=number(max(lasted_ns) / 1e6, "ms"))


def _wrong_turns(seen: _Seen) -> Iterator[Mistake]:
    """Recognise turns that are all far too short, or too long, before the car meets a wall: they lead it there.

    Short ones may also lead it round.
    """
    contacts, figure = seen.run.trajectory.contacts, seen.driven.figure
    until_ns = contacts[0].start_ns if contacts else seen.run.outcome.duration_ns
    right_corners = len(seen.driven.corners_deg) > 0 and not seen.has_wrong_corner
    is_round = figure is None or (figure.curved_share > MOSTLY_ROUND_SHARE and not right_corners)
    round_by_corners = seen.rigid and is_round
    looks = contacts or (round_by_corners and not any(map(is_arc, seen.run.trajectory.commands)))
    turned = _commanded_turns(seen, until_ns) if looks else []
    most_deg = seen.ideal_deg - _FAR_OFF_DEG if contacts else seen.ideal_deg / 2.0
    if len(turned) < 2 or max(turned) - min(turned) > SAME_DEG:
        return
    far = bool(contacts) and min(turned) > seen.ideal_deg + _FAR_OFF_DEG
    if max(turned) > most_deg and not far:
        return
    ideal, mean = seen.ideal_deg, exact.mean(turned)
    inner = far and _known_angle(seen, mean) is not None  # the interior angle of a figure
    yield mistake(
        "interior_angle" if inner else "turns_too_far" if far else "turns_too_short",
        _SHAPE,
        mean=_degree(mean),
        sides=seen.sides,
        corners=listed(turned, "deg"),
        ideal=_degree(ideal),
        radians=number(math.radians(ideal), "rad", 4),
        excess=_degree(abs(ideal - mean)),
        advice=_turn_advice(seen, "shorter" if far else "longer"),
    )


def _commanded_turns(seen: _Seen, until_ns: int) -> list[float]:
    """Return how far each turn on the spot that ended before `until_ns` was commanded to go, in degrees."""
    turned: list[float] = []
    going = False
    for command, end_ns in with_ends(seen.run.trajectory):
        if end_ns > until_ns:
            break
        turning = is_turn(command) and not is_drive(command)
        if turning:
            angle = math.degrees(abs(command.w_radps)) * (end_ns - command.t_ns) / 1e9
            if going:
                turned[-1] += angle
            else:
                turned.append(angle)
        going = turning
    return turned


def _wall(seen: _Seen) -> Iterator[Mistake]:
    """Recognise a wall that was touched while the figure was driven. Later contacts did not spoil the figure."""
    end = seen.driven.figure.end if seen.driven.figure is not None else len(seen.driven.drive.path) - 1
    contacts = seen.run.trajectory.contacts
    if contacts and contacts[0].start_ns <= int(seen.driven.drive.t_ns[end]):
        wall = contacts[0]
        figure, arcs = seen.driven.figure, any(map(is_arc, moves_of(seen.run.trajectory)))
        if arcs and figure is not None and figure.curved_share > MOSTLY_ROUND_SHARE:
            return  # `_shape` says what led it there
        code = "side_goes_on" if _goes_on(seen, wall.start_ns) else "wall_hit"
        yield mistake(code, _SHAPE, time=number(wall.start_ns / 1e9, "s"), wall=say(f"wall.{wall.wall}"))


def _goes_on(seen: _Seen, hit_ns: int) -> bool:
    """Whether a script that steers by the pose drove into a wall in its first side, or in a much longer one."""
    if not seen.steers:
        return False
    path, until = seen.driven.drive.path, int(np.searchsorted(seen.driven.drive.t_ns, hit_ns))
    headings, along = path.heading_rad[: until + 1], path.along_m[: until + 1]
    turned = np.flatnonzero(np.abs(headings - headings[-1]) > _CORNER_RAD)
    if len(turned) == 0:
        return True
    last_m = float(along[-1] - along[turned[-1]])
    first = np.flatnonzero(np.abs(headings - headings[0]) > _CORNER_RAD)
    return last_m > _LONGER * float(along[first[0]])


def _degrees(seen: _Seen) -> Iterator[Mistake]:
    """Recognise degrees where radians belong: a turn rate that nobody means, or a turn that does not end."""
    fastest = fastest_radps(seen.run)
    widest = max(
        (abs(turn.angle_rad) for turn in seen.driven.segments.turns if turn is not None), default=0.0
    )
    unfinished = seen.driven.figure is None or len(seen.driven.figure.sides_m) < seen.sides
    by_pose = seen.steers
    if fastest >= (_FAST_BY_POSE_RADPS if by_pose else FAST_TURN_RADPS):
        yield mistake("degrees_as_radians", _SHAPE, rate=number(fastest, ""), ideal=_degree(seen.ideal_deg))
    elif (
        _is_endless(seen, widest, by_pose)
        and unfinished
        and not _circling(seen)
        and not _left_out_drives(seen)
    ):
        code = "endless_turn_by_pose" if by_pose else "endless_turn"
        yield mistake(code, _SHAPE, turned=_degree(math.degrees(widest)), ideal=_degree(seen.ideal_deg))
    elif math.degrees(widest) > FULL_TURN_DEG - seen.ideal_deg / 2 and unfinished and _drove_first(seen):
        turned = _degree(math.degrees(widest))
        yield mistake("turned_instead", _SHAPE, turned=turned, ideal=_degree(seen.ideal_deg))


def _is_endless(seen: _Seen, widest_rad: float, by_pose: bool) -> bool:
    """Whether the car turned in one place for far too long: by time in one go, by pose also with pauses."""
    if not by_pose:
        motions = motions_of(seen.run.trajectory)
        widest_rad = max((abs(one.w_radps) * (lasted_ns / 1e9) for one, lasted_ns in motions), default=0.0)
    return math.degrees(widest_rad) > 1.25 * FULL_TURN_DEG


def _left_out_drives(seen: _Seen) -> bool:
    """Whether the script came to the end of its turns, and had commanded no drive between them."""
    moves, commands = moves_of(seen.run.trajectory), seen.run.trajectory.commands
    over = seen.run.outcome.status is RunStatus.FINISHED or not is_motion(commands[-1])
    return bool(moves) and over and not any(map(is_drive, moves))


def _drove_first(seen: _Seen) -> bool:
    """Whether the script commanded drives and then turns on the spot, with no more than jolts between these."""
    moves = moves_of(seen.run.trajectory)
    turned_ns = next((command.t_ns for command in moves if is_turn(command)), 0)
    longest_m, after_m = (max(_drives_m(seen.run, since), default=0.0) for since in (0, turned_ns))
    return longest_m > _SEEN_M >= after_m and not any(map(is_arc, moves))


def _circling(seen: _Seen) -> bool:
    curved_m = exact.total(turn.length_m for turn in seen.driven.segments.turns if turn is not None)
    return curved_m > 0.5 * float(seen.driven.drive.path.along_m[-1])


def _shape(seen: _Seen) -> Iterator[Mistake]:
    figure = seen.driven.figure
    if figure is None:
        if float(seen.driven.drive.path.along_m[-1]) > 0.1 and _circling(seen):
            yield mistake("arcs_by_pose" if seen.steers else "arcs", _SHAPE, share="100 %")
        elif _is_one_side(seen):
            yield mistake("sides_missing", ("sides", "gap_pct", "settled"), count=1, sides=seen.sides)
        return
    if figure.curved_share > MOSTLY_ROUND_SHARE or (
        _drives_blindly(seen) and not (seen.steers and _is_beyond_slip(seen, figure))
    ):
        yield _arcs(seen, figure)
    elif _is_astray(figure) and max(figure.bows) > 0.0:
        yield _astray(seen, figure)
    yield from _backed_sides(seen)
    wrong = (_angles(seen, figure), _count(seen, figure))
    # Where cars slip, a corner says less than the count.
    for mistakes in wrong if seen.rigid else reversed(wrong):
        yield from mistakes
    if figure.curved_share <= MOSTLY_ROUND_SHARE and seen.loses("curved_pct", 100.0 * figure.curved_share):
        yield _arcs(seen, figure)
    yield from _sides(seen, figure) if seen.wanted.lengths_m is None else _lengths(seen, figure)


def _is_one_side(seen: _Seen) -> bool:
    """Whether the car, correcting its heading on the way, drove one side and then stood still."""
    drive, headings = seen.driven.drive, seen.driven.drive.path.heading_rad
    straight = float(np.ptp(headings)) < _CORNER_RAD and float(drive.path.along_m[-1]) > _SEEN_M
    turned = any(map(is_turn, moves_of(seen.run.trajectory)))
    return straight and turned and not drive.cut_short and not seen.run.trajectory.contacts


def _drives_blindly(seen: _Seen) -> bool:
    """Whether the corners fail on a car that slips, and no command ever corrects the heading on the way."""
    blind = seen.run.trajectory.commands and not any(map(is_arc, moves_of(seen.run.trajectory)))
    return bool(blind) and seen.has_wrong_corner and not seen.rigid


def _is_beyond_slip(seen: _Seen, figure: PolygonFigure) -> bool:
    """Whether sides are missing, or the corners are off by more than slipping explains."""
    corners = seen.driven.corners_deg
    off_deg = abs(exact.mean(corners) - seen.ideal_deg) if len(corners) else 0.0
    return off_deg > _SLIP_DEG or len(figure.sides_m) != seen.sides


def _arcs(seen: _Seen, figure: PolygonFigure) -> Mistake:
    """Say how much was no straight side: arcs that were commanded, a car that slips, or turns within sides."""
    if _is_astray(figure):
        return _astray(seen, figure)
    code = "crooked" if seen.rigid else "slipped"
    if any(map(is_arc, moves_of(seen.run.trajectory))):
        code = "arcs_by_pose" if seen.steers else "arcs"
    all_of_it = figure.curved_share > MOSTLY_ROUND_SHARE or max(figure.bows) > 0.0
    spoilt = _SHAPE if all_of_it else ("curved_pct", *_LENGTHS, "gap_pct")
    return mistake(code, spoilt, share=number(100.0 * figure.curved_share, "%"))


def _is_astray(figure: PolygonFigure) -> bool:
    """Whether the car left its sides for detours more than it bent them to arcs."""
    return figure.strayed_share > 0.5 * figure.curved_share


def _astray(seen: _Seen, figure: PolygonFigure) -> Mistake:
    heading_rad = seen.driven.drive.path.heading_rad
    strayed = [one for one in seen.driven.segments.straights if one.strayed_m > 0.0]
    along_it = all(float(np.ptp(heading_rad[one.first : one.last + 1])) < MIN_TURN_RAD for one in strayed)
    code = "overshot" if along_it else "astray"
    return mistake(code, _SHAPE, share=number(100.0 * figure.strayed_share, "%"))


def _long_way(seen: _Seen, values: Mapping[str, object]) -> Mistake:
    """Recognise corners that go the long way round: by a wrong difference of angles, or for too long."""
    turned = listed(seen.driven.turned_deg, "deg")
    return mistake("long_way", ("opposite_corners",), turned=turned, **values)


def _backed_sides(seen: _Seen) -> Iterator[Mistake]:
    """Recognise corners that are off because some of the sides were backed: what is drawn is then no turn."""
    speeds = [one.v_mps for one in moves_of(seen.run.trajectory) if is_drive(one)]
    changes = sum(before * after < 0.0 for before, after in itertools.pairwise(speeds))
    off = any(seen.loses("corner_deg", corner) for corner in seen.driven.corners_deg.tolist())
    if off and changes > 1 and _BACKED < share_backwards(seen.run) < 1.0 - _BACKED:
        yield mistake("to_and_fro", ("corner_deg", "gap_pct", "sides", "opposite_corners"), times=changes)


def _angles(seen: _Seen, figure: PolygonFigure) -> Iterator[Mistake]:
    """Name the one mistake that explains the corners best, if any is wrong."""
    corners, ideal = seen.driven.corners_deg, seen.ideal_deg
    spoilt = ("corner_deg", "gap_pct", "sides", "opposite_corners")
    values = {"corners": listed(corners, "deg"), "ideal": _degree(ideal), "sides": seen.sides}
    values["radians"] = number(math.radians(ideal), "rad", 4)
    if len(corners) == 0:
        return
    mean = exact.mean(corners)
    uniform = float(np.ptp(corners)) <= 2.0 * SAME_DEG
    off = np.array([seen.loses("corner_deg", corner) for corner in corners.tolist()])
    back = float(np.min(np.abs(corners))) > 180.0 - SAME_DEG  # to which side, is chance
    if back or (bool((corners < 0.0).any()) and _both_ways(seen)):
        yield mistake("zigzag", spoilt, **values)
    elif not off.any() and bool(seen.driven.long_way.any()):
        yield _long_way(seen, values)
    elif not off.any():
        # within the corners' band, but the figure does not close
        if uniform and _known_angle(seen, mean) == "one_radian" and seen.loses("gap_pct", _gap_pct(figure)):
            yield mistake("one_radian", ("gap_pct",), mean=_degree(mean), **values)
    elif figure.repeated and _known_angle(seen, mean) == "interior_angle":
        # a hexagon's interior angle drives a triangle, as often as the loop was meant for the hexagon
        yield mistake("interior_angle", spoilt, mean=_degree(mean), **values)
    elif seen.driven.is_other(seen.wanted):
        yield _other_figure(seen, figure)
    elif uniform and (telling := _known_angle(seen, mean)) is not None:
        yield mistake(telling, spoilt, mean=_degree(mean), **values)
    elif (off.all() or _alike(corners - ideal)) and abs(int(np.sum(np.sign(corners - ideal)))) == len(
        corners
    ):
        code = "turns_too_far" if mean > ideal else "turns_too_short"
        advice = _turn_advice(seen, "shorter" if mean > ideal else "longer")
        yield mistake(code, spoilt, excess=_degree(abs(mean - ideal)), advice=advice, **values)
    else:
        worst = int(np.argmax(np.abs(corners - ideal)))
        advice = _turn_advice(seen, "alike")
        angle = _degree(float(corners[worst]))
        yield mistake("one_corner_off", spoilt, number=worst + 1, angle=angle, advice=advice, **values)


def _turn_advice(seen: _Seen, by_time: str) -> Text:
    """Return what to do about turns that end by the heading, or what to do about others."""
    if seen.steers:
        return say("polygon.turn.by_heading", ideal=_degree(seen.ideal_deg))
    return say(f"polygon.turn.{by_time}")


def _both_ways(seen: _Seen) -> bool:
    """Whether the script turned left and right; else a corner to the other side is a turn of more than half."""
    rates = [command.w_radps for command in moves_of(seen.run.trajectory) if is_turn(command)]
    return not rates or min(rates) < 0.0 < max(rates)


def _alike(errors: Floats) -> bool:
    """Whether all errors are about as large, so that they have one cause."""
    return float(np.min(np.abs(errors))) > 0.5 * float(np.max(np.abs(errors)))


def _gap_pct(figure: PolygonFigure) -> float:
    return 100.0 * figure.gap_m / figure.perimeter_m if figure.perimeter_m > 0.0 else math.nan


def _known_angle(seen: _Seen, mean: float) -> str | None:
    """Return the mistake that makes corners of about `mean`, if there is one."""
    telling = {"one_radian": (ONE_RADIAN_DEG, RADIAN_OFF_DEG)}
    if seen.sides != 4:  # a square's interior and exterior angles are the same
        telling["interior_angle"] = (180.0 - seen.ideal_deg, SAME_DEG)
    near = {
        code: abs(mean - angle) for code, (angle, within) in telling.items() if abs(mean - angle) <= within
    }
    return min(near, key=lambda code: near[code], default=None)


def _other_figure(seen: _Seen, figure: PolygonFigure) -> Mistake:
    return mistake(
        "other_figure",
        _SHAPE,
        count=len(figure.sides_m),
        corners=_degree(exact.mean(seen.driven.corners_deg)),
        figure=say(seen.wanted.figure),
        sides=seen.sides,
        ideal=_degree(seen.ideal_deg),
    )


def _count(seen: _Seen, figure: PolygonFigure) -> Iterator[Mistake]:
    """Recognise missing or extra sides where the corners are right."""
    count, corners = len(figure.sides_m), seen.driven.corners_deg
    near_deg = NEAR_DEG if seen.rigid else 2.0 * _SLIP_DEG
    near = bool((np.abs(corners - seen.ideal_deg) <= near_deg).all())
    right = near if len(corners) else _on_first_side(seen) or _is_one_side(seen)
    if not right or count == seen.sides:
        return
    code = (
        ("too_slow" if seen.driven.drive.cut_short else "sides_missing")
        if count < seen.sides
        else "sides_extra"
    )
    spoilt = ("sides", "gap_pct", "settled", *(_LENGTHS if code == "too_slow" else ()))
    yield mistake(code, spoilt, count=count, sides=seen.sides)


def _sides(seen: _Seen, figure: PolygonFigure) -> Iterator[Mistake]:
    sides = np.asarray(figure.sides_m)
    if figure.perimeter_m <= 0.0 or not seen.loses(
        "side_spread_pct", 100.0 * float(np.ptp(sides)) / exact.mean(sides)
    ):
        return
    apart = sides - median(figure.sides_m)
    odd = int(np.argmax(np.abs(apart)))
    over_m = float(apart[odd])
    if odd == len(sides) - 1 and over_m > 0.0 and coasts(seen.run, seen.driven.drive, over_m):
        yield no_final_stop(seen.run, number(over_m, "m"), _COASTED)
        return
    others = np.delete(sides, odd)
    if seen.loses("side_spread_pct", 100.0 * float(np.ptp(others)) / exact.mean(others)):
        longest, shortest = number(float(np.max(sides)), "m"), number(float(np.min(sides)), "m")
        what = say("polygon.sides_differ", longest=longest, shortest=shortest)
    else:
        what = say("polygon.odd_side", number=odd + 1, length=number(float(sides[odd]), "m"))
    lengths, advice = listed(sides, "m"), say(f"polygon.sides.{'by_place' if seen.steers else 'by_time'}")
    yield mistake("unequal_sides", ("side_spread_pct", "gap_pct"), what=what, lengths=lengths, advice=advice)


def _lengths(seen: _Seen, figure: PolygonFigure) -> Iterator[Mistake]:
    """Recognise sides whose lengths are not those that the assignment fixes."""
    wanted, error_pct = seen.wanted, seen.wanted.side_error_pct(figure.sides_m)
    if len(figure.sides_m) != wanted.sides or not seen.loses("side_error_pct", error_pct):
        return
    yield mistake(
        "wrong_lengths",
        ("side_error_pct", "gap_pct"),
        lengths=listed(figure.sides_m, "m"),
        wanted=listed(wanted.aligned(figure.sides_m), "m"),
    )


def _cut_at_the_end(seen: _Seen) -> bool:
    """Whether the horizon came during the last side or turn, so that the script may have meant to stop."""
    figure = seen.driven.figure
    if (
        figure is None
        or seen.run.outcome.status is not RunStatus.INTERRUPTED
        or not seen.driven.drive.moving_at_end
    ):
        return False
    if len(figure.sides_m) != seen.sides or figure.repeated or figure.overrun:
        return False
    if (closing := seen.driven.segments.turns[-1]) is not None:
        return abs(math.degrees(closing.angle_rad)) <= seen.ideal_deg + SAME_DEG
    return figure.sides_m[-1] <= max(figure.sides_m[:-1])


def _ending(seen: _Seen) -> Iterator[Mistake]:
    """Recognise what was driven before and after the figure."""
    drive, figure = seen.driven.drive, seen.driven.figure
    if figure is not None and figure.approach_m > 0.0:
        told = mistake("approach", ("gap_pct",), distance=number(figure.approach_m, "m"))
        yield replace(told, apart=True)
    repeated, overrun = (figure.repeated, figure.overrun) if figure is not None else (False, False)
    if figure is not None and figure.apart:
        turned = _degree(abs(math.degrees(figure.last_turned_rad)))
        yield mistake("laps_apart", ("settled", "gap_pct"), turned=turned, ideal=_degree(seen.ideal_deg))
    elif drive.moving_at_end and (figure is None or len(figure.sides_m) < seen.sides):
        lasting = ("settled", "sides", "gap_pct")
        yield swings(seen.run, lasting) or mistake("never_finished", lasting)
    elif (overrun and drive.cut_short) or (not repeated and drive.moving_at_end):
        yield mistake("never_stops", ("settled", "sides", "gap_pct"))
    elif figure is not None and overrun:
        after_m = float(drive.path.along_m[-1] - drive.path.along_m[figure.end])
        yield mistake("drove_on", ("settled", "gap_pct"), distance=number(after_m, "m"))
    elif seen.driven.turned_on and (turn := seen.driven.segments.turns[-1]) is not None:
        excess_deg = abs(math.degrees(turn.angle_rad)) - seen.ideal_deg
        if excess_deg > 0.0 and coasts(seen.run, seen.driven.drive, math.radians(excess_deg), turning=True):
            yield no_final_stop(seen.run, _degree(excess_deg), _COASTED)
            return
        turned = _degree(seen.driven.sense * math.degrees(turn.angle_rad))
        yield mistake("turned_on", ("settled",), turned=turned, ideal=_degree(seen.ideal_deg))


def _degree(value: float) -> str:
    return number(value, "deg")
