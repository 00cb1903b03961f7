"""Mistakes recognised from how a driven path differs from the wanted one."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from grader.checks.drive import Drive
from grader.checks.kinds.path.driven import (
    UNFINISHED_SHARE,
    DrivenStretch,
    Figure,
    as_turned_deg,
    begun_off,
    corners_deg,
    figure_in,
    inner_corners_m,
    roughly_off,
)
from grader.checks.kinds.path.wanted import Stretch
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import asleep, command_mistakes, lost_at_home, script_mistakes
from grader.checks.scoring import fits
from grader.contracts.assignment import Assignment, WantedPath
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.messages import say
from grader.messages.quantity import number
from grader.messages.script import ScriptText

FULL_CIRCLE_DEG = 350.0  # from here on an arc is called a circle
BEGUN_SHARE = 0.05  # of the size: a drive this near to the first part is that part, and no more
SAME_SHARE = 0.15  # of the wanted length: shares that differ by more are of different parts
OVERLONG_SHARE = 1.15  # of the wanted length: a longer drive has something else in it
FAR_SHARE = 0.06  # of the size: a drive nearer than this is the wanted path, driven badly
_SHAPE = (
    "off_pct",
    "mean_off_pct",
    "covered_pct",
    "corner_error_deg",
    "length_error_pct",
    "radius_error_pct",
    "round_pct",
    "gap_pct",
)
MUCH_BETTER_SHARE = 0.6  # of the rough distance: an explanation that leaves more is not matched closely
LEFT_SHARE = 0.25  # of the distance: an explanation must leave less
_OF_ARCS = ("round_pct", "off_pct", "mean_off_pct", "covered_pct", "gap_pct")
_DRIVES = ("distance_m", *_SHAPE)


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """What a recogniser looks at."""

    assignment: Assignment
    run: Run
    drive: Drive
    figure: Figure
    stretches: list[DrivenStretch]

    @property
    def driven_share(self) -> float:
        """How much of the wanted length was driven."""
        wanted_m = self.figure.track.length_m * self.figure.placed.scale
        return self.figure.end_m / wanted_m if wanted_m > 0.0 else 0.0

    @property
    def is_begun(self) -> bool:
        """Whether the drive is right as far as it goes, so that the next step is to drive on."""
        wanted = self.assignment.path
        if wanted is None:
            return False
        if wanted.any_scale:
            return self.figure.covered_share >= self.driven_share - BEGUN_SHARE
        return begun_off(self.drive, wanted, self.assignment.world.start) < BEGUN_SHARE

    @property
    def is_too_little(self) -> bool:
        """Whether much of the wanted length was not driven, and costs points."""
        short = self.driven_share < UNFINISHED_SHARE
        return short and self.loses("covered_pct", 100.0 * self.figure.covered_share)

    @property
    def is_missing_alone(self) -> bool:
        """Whether the missing part is the only fault: then the driven and the covered share agree.

        This matters for a trace only: of other paths each piece is checked by itself.
        """
        if self.drive.cut_short or all(each.kind != "trace" for each in self.figure.track.stretches):
            return True
        return abs(self.driven_share - self.figure.covered_share) <= SAME_SHARE

    def loses(self, measure: str, value: float) -> bool:
        """Whether a value of `measure` costs points."""
        return fits(self.assignment, measure, value) is False


def named_corner(driven_deg: float, wanted_deg: float) -> dict[str, str | Text]:
    """Return how far a corner was turned and was to be turned, for a sentence about it."""
    turned_deg = as_turned_deg(driven_deg)
    driven = number(abs(turned_deg), "deg")
    return {
        "driven": driven if turned_deg * wanted_deg >= 0.0 else say("corner.other_way", angle=driven),
        "wanted": number(abs(wanted_deg), "deg"),
    }


def name_of(stretch: Stretch) -> Text:
    """Return what a piece is called: line 2, circle 1."""
    kind = "line" if stretch.kind == "line" else "arc"
    if kind == "arc" and abs(stretch.angle_deg) >= FULL_CIRCLE_DEG:
        kind = "circle"
    return say(f"path.{kind}", number=stretch.number)


def path_mistakes(
    assignment: Assignment,
    run: Run,
    drive: Drive | None,
    figure: Figure | None,
    stretches: list[DrivenStretch],
) -> tuple[Mistake, ...]:
    """Return what probably went wrong on the way."""
    found = [*script_mistakes(run), *asleep(run)]
    if drive is None:
        return tuple(found)
    found += command_mistakes(run, assignment.world, turns=_SHAPE, drives=_DRIVES)
    found += _wall(run)
    if figure is not None:
        seen = _Seen(assignment, run, drive, figure, stretches)
        found += _shape(seen)
        found += _ending(seen)
    found += lost_at_home(run)
    return tuple(found)


def _wall(run: Run) -> Iterator[Mistake]:
    for contact in run.trajectory.contacts[:1]:
        time, wall = number(contact.start_ns / 1e9, "s"), say(f"wall.{contact.wall}")
        yield mistake("wall_hit", _SHAPE, time=time, wall=wall)


def _shape(seen: _Seen) -> Iterator[Mistake]:
    """Name the one difference that explains the others best, then those of single pieces."""
    size = seen.figure.size_m
    away = seen.figure.apart_m
    if size <= 0.0:
        return
    off = seen.loses("off_pct", 100.0 * away / size)
    # Without such an item, too: pieces that are all wrong have one cause.
    asked = off or seen.assignment.item_on("off_pct") is None
    if not seen.figure.begun and asked and (code := _other_way(seen, away / size)) is not None:
        yield mistake(code, _SHAPE)
        return
    corners = inner_corners_m(seen.figure, seen.drive)
    count, wanted = len(corners or ()) + 1, len(seen.figure.track.stretches)
    if off and corners is not None and count != wanted and not seen.drive.cut_short:
        yield mistake("path_count", _SHAPE, count=count, wanted=wanted)
        return
    of_pieces = list(_pieces(seen))
    if seen.is_too_little and (seen.is_begun or (not of_pieces and seen.is_missing_alone)):
        yield from _unfinished(seen)
        return
    yield from of_pieces
    if off and seen.driven_share > OVERLONG_SHARE:
        yield mistake("path_too_long", _SHAPE, share=number(100.0 * seen.driven_share, "%"))
    elif off:
        yield mistake("path_apart", _SHAPE, away=number(away, "m"))


def _other_way(seen: _Seen, share: float) -> str | None:
    """Return how the whole path differs: mirrored, reversed, or of another size or place."""
    wanted = seen.assignment.path
    if wanted is None or share < FAR_SHARE:
        return None
    freer: dict[str, WantedPath] = {
        "path_mirrored": replace(wanted, mirror=True),
        "path_reversed": replace(wanted, any_direction=True),
        "path_elsewhere": replace(wanted, any_start=True),
        "path_size": replace(wanted, any_scale=True),
    }
    start = seen.assignment.world.start
    rough = roughly_off(seen.drive, wanted, start)
    for code, other in freer.items():
        # comparing at equal distances is cheap, and rules out most explanations
        if other == wanted or roughly_off(seen.drive, other, start) > MUCH_BETTER_SHARE * rough:
            continue
        figure = figure_in(seen.drive, other, start)
        if figure is None or figure.size_m <= 0.0 or not 0.2 < figure.placed.scale < 5.0:
            continue
        left = figure.apart_m / figure.size_m
        if left < LEFT_SHARE * share and not seen.loses("off_pct", 100.0 * left):
            return code
    return None


def _unfinished(seen: _Seen) -> Iterator[Mistake]:
    share = number(100.0 * seen.figure.covered_share, "%")
    code = "path_too_slow" if seen.drive.cut_short else "path_unfinished"
    yield mistake(code, (*_SHAPE, "settled"), share=share)


def _pieces(seen: _Seen) -> Iterator[Mistake]:
    """Tell of pieces that are not as they should be: circles, then corners, then lines."""
    scale, figure = seen.figure.placed.scale, seen.figure
    if len(seen.stretches) < len(figure.track.stretches):
        return
    yield from _arcs(seen, scale)
    corners = corners_deg(seen.stretches, mirrored=figure.placed.mirrored)
    worst = max(range(len(corners)), key=lambda i: abs(corners[i][0] - corners[i][1]), default=None)
    if worst is not None:
        driven, wanted = corners[worst]
        if seen.loses("corner_error_deg", abs(driven - wanted)):
            yield mistake(
                "path_corner",
                ("corner_error_deg", "off_pct", "mean_off_pct", "covered_pct", "gap_pct"),
                number=worst + 1,
                **named_corner(driven, wanted),
            )
    for each in _by_error(seen.stretches, "line", scale):
        error = abs(each.length_m - scale * each.wanted.length_m) / (scale * each.wanted.length_m)
        if seen.loses("length_error_pct", 100.0 * error):
            yield mistake(
                "path_length",
                ("length_error_pct", "off_pct", "mean_off_pct", "covered_pct", "gap_pct"),
                piece=name_of(each.wanted),
                driven=number(each.length_m, "m"),
                wanted=number(scale * each.wanted.length_m, "m"),
            )
            return


def _arcs(seen: _Seen, scale: float) -> Iterator[Mistake]:
    """Say the first that holds: an arc to the wrong side, a piece that is no arc, an arc of another radius."""
    arcs = [each for each in _by_error(seen.stretches, "arc", scale) if not math.isnan(each.radius_m)]
    mirror = -1.0 if seen.figure.placed.mirrored else 1.0
    for each in arcs:
        if each.swept_rad * each.wanted.angle_deg * mirror < 0.0:
            yield mistake("path_sense", _SHAPE, piece=name_of(each.wanted))
            return
    for each in arcs:
        if seen.loses("round_pct", 100.0 * each.deviation_m / each.radius_m):
            told, piece = number(each.deviation_m, "m"), name_of(each.wanted)
            yield mistake("path_not_round", ("radius_error_pct", *_OF_ARCS), piece=piece, deviation=told)
            return
    for each in arcs:
        wanted_m = scale * each.wanted.radius_m
        if seen.loses("radius_error_pct", 100.0 * abs(each.radius_m - wanted_m) / wanted_m):
            yield mistake(
                "path_radius",
                ("radius_error_pct", *_OF_ARCS),
                piece=name_of(each.wanted),
                driven=number(each.radius_m, "m"),
                wanted=number(wanted_m, "m"),
            )
            return


def _by_error(stretches: list[DrivenStretch], kind: str, scale: float) -> list[DrivenStretch]:
    """Return the pieces of a kind, the one that is furthest off first."""

    def error(each: DrivenStretch) -> float:
        driven = each.length_m if kind == "line" else each.radius_m
        wanted = scale * (each.wanted.length_m if kind == "line" else each.wanted.radius_m)
        return 0.0 if math.isnan(driven) or wanted <= 0.0 else abs(driven - wanted) / wanted

    return sorted((each for each in stretches if each.wanted.kind == kind), key=error, reverse=True)


def _ending(seen: _Seen) -> Iterator[Mistake]:
    """Tell of what was driven after the path."""
    if seen.figure.repeated:
        return
    publisher = ScriptText(seen.run.source).publisher or "publisher"
    if seen.drive.moving_at_end:
        yield mistake("never_stops", ("settled",), publisher=publisher)
    elif seen.figure.overrun:
        after_m = float(np.max(seen.drive.path.along_m)) - seen.figure.end_m
        yield mistake("drove_on", ("settled", "gap_pct"), distance=number(after_m, "m"))
