"""Mistakes that a polygon's measures do not show: a car that never turned, degrees, angles that tell a mistake."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from grader.checks.drive import FAST_TURN_RADPS, fastest_radps, is_drive, is_turn, moves_of, with_ends
from grader.checks.kinds.polygon.figures import SAME_DEG, DrivenPolygon, WantedPolygon
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import command_mistakes, noted, only_turned, time_was_up
from grader.checks.scoring import fits
from grader.contracts.assignment import Assignment
from grader.contracts.scoring import Run
from grader.geometry import exact
from grader.messages import say
from grader.messages.quantity import listed, number

ONE_RADIAN_DEG = math.degrees(1.0)
# A turn by 1 rad by mistake is exact: 54° is something else, such as one tick of 10 Hz too many.
RADIAN_OFF_DEG = 2.0
_SEEN_M = 0.1
_SLOW_M = 1.5  # a car that has driven less by the horizon may still be on its first side
_LENGTHS = ("side_spread_pct", "side_error_pct")
_CORNERS = ("corner_deg", "gap_pct", "sides", "opposite_corners")
_EQUAL_RATIO = 1.02  # of the longest to the shortest drive: a third of what costs points
_SHAPE = ("sides", "corner_deg", *_LENGTHS, "gap_pct", "curved_pct", "opposite_corners", "settled")

# A rate that is several times the error of the heading gets this high without degrees, where theta jumps by 2π.
_FAST_BY_POSE_RADPS = 40.0


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """What a recogniser looks at."""

    assignment: Assignment
    run: Run
    wanted: WantedPolygon
    driven: DrivenPolygon

    @property
    def ideal(self) -> str:
        """The wanted corner."""
        return number(self.wanted.corner_deg, "deg")

    @property
    def steers(self) -> bool:
        """Whether the script hears where the car is, so that it may steer by that."""
        return any(name.endswith("/pose") for name in self.run.outcome.heard)


def polygon_mistakes(
    assignment: Assignment, run: Run, wanted: WantedPolygon, driven: DrivenPolygon
) -> Iterator[Mistake]:
    """Yield what probably went wrong in a figure that should have been `wanted`."""
    seen, figure = _Seen(assignment, run, wanted, driven), driven.figure
    if noted(run.outcome, "lateral_command") is None:  # or a figure was meant to be driven sideways
        yield from _never_turned(seen)
    yield from list(_degrees(seen)) or only_turned(run, ("distance_m", *_SHAPE))
    yield from command_mistakes(run, assignment.world, turns=_CORNERS, drives=_spoilt_by_short_drives(run))
    yield from _known_angle(seen)
    yield from _wall(seen)
    if figure is None or not (figure.repeated or figure.overrun):
        yield from time_was_up(run, driven.drive, ("settled", "gap_pct", "sides", *_LENGTHS))


def _spoilt_by_short_drives(run: Run) -> tuple[str, ...]:
    """Return the measures that drives spoil when they end too early.

    Drives that come out equally long draw equal sides: if such a figure is not closed, it is for another reason.
    """
    drives = itertools.groupby(with_ends(run.trajectory), lambda one: is_drive(one[0]))
    lengths_m = [
        exact.total(abs(command.v_mps) * (until_ns - command.t_ns) for command, until_ns in drive) / 1e9
        for drives_on, drive in drives
        if drives_on
    ]
    equal = lengths_m and max(lengths_m) <= _EQUAL_RATIO * min(lengths_m)
    return ("distance_m", "side_error_pct") if equal else ("distance_m", *_LENGTHS, "gap_pct")


def _never_turned(seen: _Seen) -> Iterator[Mistake]:
    """Recognise a car that was never told to turn, and had the time for it."""
    drive, trajectory = seen.driven.drive, seen.run.trajectory
    moves, along_m = moves_of(trajectory), float(drive.path.along_m[-1])
    slow = drive.cut_short and not trajectory.contacts and along_m < _SLOW_M
    turned_deg = math.degrees(float(np.ptp(drive.path.heading_rad)))
    turned = any(map(is_turn, moves)) or turned_deg > SAME_DEG  # by turtlesim's own action
    if moves and along_m >= _SEEN_M and not (slow or turned or trajectory.jumps):
        yield mistake("no_turns", _SHAPE, ideal=seen.ideal, sides=seen.wanted.sides)


def _degrees(seen: _Seen) -> Iterator[Mistake]:
    """Recognise degrees where radians belong: a turn rate that nobody means."""
    fastest = fastest_radps(seen.run)
    if fastest >= (_FAST_BY_POSE_RADPS if seen.steers else FAST_TURN_RADPS):
        yield mistake("degrees_as_radians", _SHAPE, rate=number(fastest, ""), ideal=seen.ideal)


def _known_angle(seen: _Seen) -> Iterator[Mistake]:
    """Recognise corners that are all alike and tell why: the interior angle, or 1 rad."""
    corners, ideal_deg = seen.driven.corners_deg, seen.wanted.corner_deg
    off = [fits(seen.assignment, "corner_deg", corner) is False for corner in corners.tolist()]
    if not all(off) or not off or float(np.ptp(corners)) > 2.0 * SAME_DEG:
        return
    mean = exact.mean(corners)
    telling = {"one_radian": (ONE_RADIAN_DEG, RADIAN_OFF_DEG)}
    if seen.wanted.sides != 4:  # a square's interior and exterior angles are the same
        telling["interior_angle"] = (180.0 - ideal_deg, SAME_DEG)
    near = {
        code: abs(mean - angle) for code, (angle, within) in telling.items() if abs(mean - angle) <= within
    }
    if near:
        values = {"corners": listed(corners, "deg"), "mean": number(mean, "deg"), "sides": seen.wanted.sides}
        yield mistake(min(near, key=lambda code: near[code]), _CORNERS, ideal=seen.ideal, **values)


def _wall(seen: _Seen) -> Iterator[Mistake]:
    """Recognise a wall that was touched while the figure was driven. Later contacts did not spoil the figure."""
    figure, drive = seen.driven.figure, seen.driven.drive
    end = len(drive.path) - 1 if figure is None else figure.end
    for wall in seen.run.trajectory.contacts[:1]:
        if wall.start_ns <= int(drive.t_ns[end]):
            time = number(wall.start_ns / 1e9, "s")
            yield mistake("wall_hit", _SHAPE, time=time, wall=say(f"wall.{wall.wall}"))
