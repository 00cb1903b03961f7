"""Mistakes told by the shape of a polygon."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from grader.checks.drive import Drive
from grader.checks.driven_polygon import DrivenPolygon
from grader.checks.measure import Mistake
from grader.checks.mistakes.commands import command_mistakes
from grader.checks.mistakes.script import script_mistakes
from grader.checks.quantity import listed, number
from grader.checks.wanted_polygon import FULL_TURN_DEG, WantedPolygon
from grader.contracts.outcome import RunStatus
from grader.contracts.trajectory import Floats
from grader.contracts.verdict import Run
from grader.geometry.figure import PolygonFigure
from grader.geometry.segmentation import Segments
from grader.messages import say

ONE_RADIAN_DEG = math.degrees(1.0)
SAME_DEG = 4.0  # corners this close to a telling value are taken to be it
RADIAN_OFF_DEG = 2.0  # whoever turns by a radian does it exactly; 54° is a tick of a 10 Hz timer too far
FAST_TURN_RADPS = 12.0  # nobody means to turn this fast: a number of degrees
CORNER_OFF_DEG = 3.0
CURVED_SHARE = 0.1
MOSTLY_ROUND_SHARE = 0.25  # from here on the angles and lengths of the corners follow from the arcs
UNEQUAL_SHARE = 0.04
LENGTH_OFF_PCT = 4.0
_LENGTHS = ("side_spread_pct", "side_error_pct")
_SHAPE = ("sides", "corner_deg", *_LENGTHS, "gap_pct", "curved_pct", "opposite_corners", "settled")


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """What a recogniser looks at. `corners_deg` is positive in the sense most corners have."""

    run: Run
    wanted: WantedPolygon
    drive: Drive
    segments: Segments
    figure: PolygonFigure | None
    corners_deg: Floats

    @property
    def sides(self) -> int:
        return self.wanted.sides

    @property
    def ideal_deg(self) -> float:
        return self.wanted.corner_deg


def polygon_mistakes(
    run: Run, topic: str, wanted: WantedPolygon, driven: DrivenPolygon | None
) -> tuple[Mistake, ...]:
    """Return what probably went wrong in a figure that should have been `wanted`."""
    found = [*script_mistakes(run.outcome)]
    if driven is None:
        return tuple(found)
    figure = driven.figure
    corners = np.degrees(figure.corners_rad) if figure is not None else np.empty(0)
    corners = corners * (-1.0 if float(np.sum(corners)) < 0.0 else 1.0)
    seen = _Seen(run, wanted, driven.drive, driven.segments, figure, corners)
    found += _wall(seen)
    found += _degrees(seen)
    found += command_mistakes(run, topic)
    cut = _cut_at_the_end(seen)
    if cut:
        text = say("mistake.time_was_up", time=number(run.outcome.duration_ns / 1e9, "s"))
        found.append(Mistake("time_was_up", text, ("settled", "gap_pct", *_LENGTHS)))
    found += _shape(seen)
    if not cut:
        found += _ending(seen)
    return tuple(found)


def _wall(seen: _Seen) -> Iterator[Mistake]:
    """A wall touched while the figure was driven; later ones did not spoil it."""
    end = seen.figure.end if seen.figure is not None else len(seen.drive.path) - 1
    contacts = seen.run.trajectory.contacts
    if contacts and contacts[0].start_ns <= int(seen.drive.t_ns[end]):
        wall = contacts[0]
        yield Mistake(
            "wall_hit",
            say("mistake.wall_hit", time=number(wall.start_ns / 1e9, "s"), wall=say(f"wall.{wall.wall}")),
            _SHAPE,
        )


def _degrees(seen: _Seen) -> Iterator[Mistake]:
    """A number of degrees where radians belong: a furious turn rate, or a turn that goes on and on."""
    fastest = max((abs(command.w_radps) for command in seen.run.trajectory.commands), default=0.0)
    widest = max((abs(turn.angle_rad) for turn in seen.segments.turns if turn is not None), default=0.0)
    unfinished = seen.figure is None or len(seen.figure.sides_m) < seen.sides
    if fastest >= FAST_TURN_RADPS:
        text = say("mistake.degrees_as_radians", rate=number(fastest, ""), ideal=_degree(seen.ideal_deg))
        yield Mistake("degrees_as_radians", text, _SHAPE)
    elif math.degrees(widest) > 1.25 * FULL_TURN_DEG and unfinished and not _circling(seen):
        text = say(
            "mistake.endless_turn", turned=_degree(math.degrees(widest)), ideal=_degree(seen.ideal_deg)
        )
        yield Mistake("endless_turn", text, _SHAPE)


def _circling(seen: _Seen) -> bool:
    curved_m = sum(turn.length_m for turn in seen.segments.turns if turn is not None)
    return curved_m > 0.5 * float(seen.drive.path.along_m[-1])


def _shape(seen: _Seen) -> Iterator[Mistake]:
    figure = seen.figure
    if figure is None:
        if float(seen.drive.path.along_m[-1]) > 0.1 and _circling(seen):
            yield Mistake("arcs", say("mistake.arcs", share="100 %"), _SHAPE)
        return
    if figure.curved_share > MOSTLY_ROUND_SHARE:
        yield _arcs(figure)
    yield from _angles(seen, figure)
    yield from _count(seen, figure)
    if CURVED_SHARE < figure.curved_share <= MOSTLY_ROUND_SHARE:
        yield _arcs(figure)
    yield from _sides(figure) if seen.wanted.lengths_m is None else _lengths(seen.wanted, figure)


def _arcs(figure: PolygonFigure) -> Mistake:
    share = number(100.0 * figure.curved_share, "%")
    return Mistake("arcs", say("mistake.arcs", share=share), ("curved_pct", *_LENGTHS, "gap_pct"))


def _angles(seen: _Seen, figure: PolygonFigure) -> Iterator[Mistake]:
    """Name the one thing that is wrong with the corners, if anything."""
    corners, ideal = seen.corners_deg, seen.ideal_deg
    spoilt = ("corner_deg", "gap_pct", "sides", "opposite_corners")
    values = {"corners": listed(corners, "deg"), "ideal": _degree(ideal), "sides": seen.sides}
    if len(corners) == 0:
        if len(figure.sides_m) == 1:
            yield Mistake("no_turns", say("mistake.no_turns", **values), _SHAPE)
        return
    mean = float(np.mean(corners))
    uniform = float(np.ptp(corners)) <= 2.0 * SAME_DEG
    off = np.abs(corners - ideal) > CORNER_OFF_DEG
    if bool((corners < 0.0).any()):
        yield Mistake("zigzag", say("mistake.zigzag", **values), spoilt)
    elif not off.any():
        return
    elif figure.repeated and _telling_angle(seen, mean) == "interior_angle":
        # a hexagon's interior angle drives a triangle, as often as the loop was meant for the hexagon
        yield Mistake("interior_angle", say("mistake.interior_angle", mean=_degree(mean), **values), spoilt)
    elif _is_other_figure(seen, figure, mean) and uniform:
        yield _other_figure(seen, figure)
    elif uniform and (telling := _telling_angle(seen, mean)) is not None:
        yield Mistake(telling, say(f"mistake.{telling}", mean=_degree(mean), **values), spoilt)
    elif bool(off.all()) and abs(int(np.sum(np.sign(corners - ideal)))) == len(corners):
        code = "turns_too_far" if mean > ideal else "turns_too_short"
        yield Mistake(code, say(f"mistake.{code}", excess=_degree(abs(mean - ideal)), **values), spoilt)
    else:
        worst = int(np.argmax(np.abs(corners - ideal)))
        text = say("mistake.one_corner_off", number=worst + 1, angle=_degree(float(corners[worst])), **values)
        yield Mistake("one_corner_off", text, spoilt)


def _telling_angle(seen: _Seen, mean: float) -> str | None:
    """Return the mistake whose angle `mean` is nearest to, if any is near."""
    telling = {"one_radian": (ONE_RADIAN_DEG, RADIAN_OFF_DEG)}
    if seen.sides != 4:  # a square's interior and exterior angles are the same
        telling["interior_angle"] = (180.0 - seen.ideal_deg, SAME_DEG)
    near = {
        code: abs(mean - angle) for code, (angle, within) in telling.items() if abs(mean - angle) <= within
    }
    return min(near, key=lambda code: near[code], default=None)


def _is_other_figure(seen: _Seen, figure: PolygonFigure, mean: float) -> bool:
    """Whether a complete regular figure with another number of sides was driven."""
    count = len(figure.sides_m)
    closed = figure.gap_m <= 0.1 * figure.perimeter_m
    return count not in (seen.sides, 0) and closed and abs(mean - FULL_TURN_DEG / count) <= SAME_DEG


def _other_figure(seen: _Seen, figure: PolygonFigure) -> Mistake:
    text = say(
        "mistake.other_figure",
        count=len(figure.sides_m),
        corners=_degree(float(np.mean(seen.corners_deg))),
        figure=say(seen.wanted.figure),
        sides=seen.sides,
        ideal=_degree(seen.ideal_deg),
    )
    return Mistake("other_figure", text, _SHAPE)


def _count(seen: _Seen, figure: PolygonFigure) -> Iterator[Mistake]:
    """One side too few or too many, with corners that are right."""
    count, corners = len(figure.sides_m), seen.corners_deg
    right = len(corners) > 0 and bool((np.abs(corners - seen.ideal_deg) <= 2.0 * CORNER_OFF_DEG).all())
    if not right or count == seen.sides:
        return
    code = ("too_slow" if seen.drive.cut_short else "sides_missing") if count < seen.sides else "sides_extra"
    text = say(f"mistake.{code}", count=count, sides=seen.sides)
    yield Mistake(code, text, ("sides", "gap_pct", "settled"))


def _sides(figure: PolygonFigure) -> Iterator[Mistake]:
    sides = np.asarray(figure.sides_m)
    if len(sides) < 2 or float(np.ptp(sides)) <= UNEQUAL_SHARE * float(np.mean(sides)):
        return
    odd = int(np.argmax(np.abs(sides - np.median(sides))))
    text = say(
        "mistake.unequal_sides",
        number=odd + 1,
        length=number(float(sides[odd]), "m"),
        lengths=listed(sides, "m"),
    )
    yield Mistake("unequal_sides", text, ("side_spread_pct", "gap_pct"))


def _lengths(wanted: WantedPolygon, figure: PolygonFigure) -> Iterator[Mistake]:
    """Sides of other lengths than the assignment fixes."""
    error_pct = wanted.side_error_pct(figure.sides_m)
    if len(figure.sides_m) != wanted.sides or error_pct <= LENGTH_OFF_PCT:
        return
    text = say(
        "mistake.wrong_lengths",
        lengths=listed(figure.sides_m, "m"),
        wanted=listed(wanted.aligned(figure.sides_m), "m"),
    )
    yield Mistake("wrong_lengths", text, ("side_error_pct", "gap_pct"))


def _cut_at_the_end(seen: _Seen) -> bool:
    """Whether the horizon came during the last side or turn, so that the script may have meant to stop."""
    figure = seen.figure
    if figure is None or seen.run.outcome.status is not RunStatus.INTERRUPTED or not seen.drive.moving_at_end:
        return False
    if len(figure.sides_m) != seen.sides or figure.repeated or figure.overrun:
        return False
    if (closing := seen.segments.turns[-1]) is not None:
        return abs(math.degrees(closing.angle_rad)) <= seen.ideal_deg + CORNER_OFF_DEG
    return figure.sides_m[-1] <= max(figure.sides_m[:-1])


def _ending(seen: _Seen) -> Iterator[Mistake]:
    repeated = seen.figure is not None and seen.figure.repeated
    overrun = seen.figure is not None and seen.figure.overrun
    if overrun or (not repeated and (seen.drive.moving_at_end or seen.drive.commanded_at_end)):
        yield Mistake("never_stops", say("mistake.never_stops"), ("settled", "sides", "gap_pct"))


def _degree(value: float) -> str:
    return number(value, "deg")
