"""Mistakes that are recognised by how a driven path differs from the wanted one."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from grader.checks.drive import Drive, coasts, share_backwards
from grader.checks.kinds.path.driven import (
    UNFINISHED_SHARE,
    DrivenStretch,
    Figure,
    as_turned_deg,
    corners_deg,
    end_ns,
    figure_in,
    inner_corners,
    roughly_off,
)
from grader.checks.kinds.path.wanted import Stretch
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import command_mistakes, no_final_stop, only_turned
from grader.checks.scoring import fits
from grader.contracts.assignment import Assignment, WantedPath
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.messages import say
from grader.messages.quantity import number

FULL_CIRCLE_DEG = 350.0  # from here on an arc is called a circle
BEGUN_SHARE = 0.05  # of the size: a drive this near to the first part is that part, and no more
SAME_SHARE = 0.15  # of the wanted length: driven and covered shares that differ by more are not the same part
OVERLONG_SHARE = 1.15  # of the wanted length: a longer drive has something else in it as well
FAR_SHARE = 0.06  # of the size: a drive that is nearer is the wanted one, driven badly
# A path driven the other way round, or elsewhere, is tried twice: roughly, and closely where that is promising.
MUCH_BETTER_SHARE = 0.6  # of the rough distance: a variant that leaves more is not tried closely
LEFT_SHARE = 0.25  # of the close distance: a variant that leaves no more explains the drive
BACK_SHARE = 0.5  # of the way: a car that backed up for more was driven backwards
SIZE_FACTOR = 5.0  # a variant that is larger or smaller by more fits by chance
_SHAPE_MEASURES = (
    "off_pct",
    "mean_off_pct",
    "covered_pct",
    "corner_error_deg",
    "length_error_pct",
    "radius_error_pct",
    "round_pct",
    "touch_pct",
    "gap_pct",
)
_WHOLE_MEASURES = ("off_pct", "mean_off_pct", "covered_pct", "gap_pct")
_ARC_MEASURES = ("round_pct", *_WHOLE_MEASURES)
_DRIVE_MEASURES = ("distance_m", *_SHAPE_MEASURES)


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """What the recognition of a mistake may look at."""

    assignment: Assignment
    run: Run
    drive: Drive
    figure: Figure
    stretches: list[DrivenStretch]

    @property
    def driven_share(self) -> float:
        """The driven length as a share of the wanted one."""
        wanted_m = self.figure.track.length_m * self.figure.placed.scale
        return self.figure.end_m / wanted_m if wanted_m > 0.0 else 0.0

    @property
    def is_begun(self) -> bool:
        """Whether the drive is right as far as it goes: then the next step is to drive on."""
        wanted = self.assignment.path
        if wanted is None:
            return False
        if wanted.any_scale:
            return self.figure.covered_share >= self.driven_share - BEGUN_SHARE
        return self.figure.begun > 0.0

    @property
    def is_too_little(self) -> bool:
        """Whether much of the wanted length is missing, and that costs points."""
        short = self.driven_share < UNFINISHED_SHARE
        return short and self.loses("covered_pct", 100.0 * self.figure.covered_share)

    @property
    def is_only_incomplete(self) -> bool:
        """Whether nothing else tells that more is wrong than the missing part.

        Lines and arcs are compared piece by piece. A trace has no pieces: it is only incomplete if the driven
        share is the covered one.
        """
        if self.drive.cut_short or all(each.kind != "trace" for each in self.figure.track.stretches):
            return True
        return abs(self.driven_share - self.figure.covered_share) <= SAME_SHARE

    def loses(self, measure: str, value: float) -> bool:
        """Whether a value of `measure` costs points."""
        return fits(self.assignment, measure, value) is False


def named_corner(driven_deg: float, wanted_deg: float) -> dict[str, str | Text]:
    """Return the driven and the wanted angle of a corner, as fields of a sentence."""
    turned_deg = as_turned_deg(driven_deg)
    driven = number(abs(turned_deg), "deg")
    return {
        "driven": driven if turned_deg * wanted_deg >= 0.0 else say("corner.other_way", angle=driven),
        "wanted": number(abs(wanted_deg), "deg"),
    }


def name_of(stretch: Stretch) -> Text:
    """Return the name of a piece: line 2, circle 1."""
    kind = "line" if stretch.kind == "line" else "arc"
    if kind == "arc" and abs(stretch.angle_deg) >= FULL_CIRCLE_DEG:
        kind = "circle"
    return say(f"path.{kind}", number=stretch.number)


def path_mistakes(
    assignment: Assignment,
    run: Run,
    drive: Drive,
    figure: Figure | None,
    stretches: list[DrivenStretch],
) -> Iterator[Mistake]:
    """Yield what probably went wrong on the way."""
    yield from command_mistakes(run, assignment.world, turns=_SHAPE_MEASURES, drives=_DRIVE_MEASURES)
    yield from only_turned(run, _DRIVE_MEASURES)
    yield from _wall(assignment, run, drive, figure)
    if figure is not None:
        seen = _Seen(assignment, run, drive, figure, stretches)
        yield from _shape(seen)
        yield from _ending(seen)


def _wall(assignment: Assignment, run: Run, drive: Drive, figure: Figure | None) -> Iterator[Mistake]:
    until_ns = math.inf if figure is None or not figure.overrun else end_ns(figure, drive)
    for contact in run.trajectory.contacts[:1]:
        if contact.start_ns > until_ns:
            return  # the figure was complete
        time, wall = number(contact.start_ns / 1e9, "s"), say(f"wall.{contact.wall}")
        yield mistake("wall_hit", _SHAPE_MEASURES, time=time, wall=wall)


def _shape(seen: _Seen) -> Iterator[Mistake]:
    """Name the first difference that explains all others; if there is none, those of single pieces."""
    size = seen.figure.size_m
    away = seen.figure.apart_m
    if size <= 0.0:
        return
    off = seen.loses("off_pct", 100.0 * away / size)
    # A rubric without `off_pct` scores the pieces: one cause may spoil them all, so it is looked for as well.
    has_one_cause = off or seen.assignment.item_on("off_pct") is None
    if not seen.figure.begun and has_one_cause and (other := _other_way(seen, away / size)) is not None:
        yield other
        return
    if off and (closer := _backwards(seen)) is not None:
        yield closer
        return
    corners = inner_corners(seen.figure, seen.drive)
    count, wanted = len(corners or ()) + 1, len(seen.figure.track.stretches)
    if off and corners is not None and count != wanted and not seen.drive.cut_short:
        yield mistake("path_count", _SHAPE_MEASURES, count=count, wanted=wanted)
        return
    of_pieces = list(_pieces(seen))
    if seen.is_too_little and (seen.is_begun or (not of_pieces and seen.is_only_incomplete)):
        yield from _unfinished(seen)
        return
    yield from of_pieces
    if off and seen.driven_share > OVERLONG_SHARE:
        yield mistake("path_too_long", _SHAPE_MEASURES, share=number(100.0 * seen.driven_share, "%"))
    elif off:
        yield mistake("path_apart", _SHAPE_MEASURES, away=number(away, "m"))


def _other_way(seen: _Seen, share: float) -> Mistake | None:
    """Return what the whole path was driven as instead: mirrored, from its end, elsewhere or in another size."""
    wanted = seen.assignment.path
    if wanted is None or share < FAR_SHARE:
        return None
    variants: dict[str, WantedPath] = {  # the first that fits is told
        "path_mirrored": replace(wanted, mirror=True),
        "path_reversed": replace(wanted, any_direction=True),
        "path_elsewhere": replace(wanted, any_start=True),
        "path_size": replace(wanted, any_scale=True),
    }
    start = seen.assignment.world.start
    rough = roughly_off(seen.drive, wanted, start)
    for code, other in variants.items():
        # Comparing points at equal distances is cheap, and rules most variants out.
        if other == wanted or roughly_off(seen.drive, other, start) > MUCH_BETTER_SHARE * rough:
            continue
        figure = figure_in(seen.drive, other, start)
        if figure is None or figure.size_m <= 0.0:
            continue
        if not 1.0 / SIZE_FACTOR < figure.placed.scale < SIZE_FACTOR:
            continue
        left = figure.apart_m / figure.size_m
        if left < LEFT_SHARE * share and not seen.loses("off_pct", 100.0 * left):
            return other_size(figure) if code == "path_size" else mistake(code, _SHAPE_MEASURES)
    return None


def other_size(figure: Figure) -> Mistake:
    """Say that the path is right but for its size."""
    return mistake("path_size", _SHAPE_MEASURES, factor=number(100.0 * figure.placed.scale, "%"))


def _backwards(seen: _Seen) -> Mistake | None:
    """Recognise a path that was mostly driven backing up, though no piece of it asks for that."""
    wanted = seen.assignment.path
    if wanted is None or wanted.by_solution or any(piece.length_m < 0.0 for piece in wanted.pieces):
        return None
    mostly = share_backwards(seen.run) > BACK_SHARE
    return mistake("path_backwards", _SHAPE_MEASURES) if mostly else None


def _unfinished(seen: _Seen) -> Iterator[Mistake]:
    share = number(100.0 * seen.figure.covered_share, "%")
    code = "path_too_slow" if seen.drive.cut_short else "path_unfinished"
    yield mistake(code, (*_SHAPE_MEASURES, "settled"), share=share)


def _pieces(seen: _Seen) -> Iterator[Mistake]:
    """Name the wrong pieces: arcs first, then the worst corner, then the worst line."""
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
                ("corner_error_deg", *_WHOLE_MEASURES),
                number=worst + 1,
                **named_corner(driven, wanted),
            )
    for each in _by_error(seen.stretches, "line", scale):
        error = abs(each.length_m - scale * each.wanted.length_m) / (scale * each.wanted.length_m)
        if seen.loses("length_error_pct", 100.0 * error):
            excess_m = each.length_m - scale * each.wanted.length_m
            if each is seen.stretches[-1] and excess_m > 0.0 and coasts(seen.run, seen.drive, excess_m):
                spoilt = ("length_error_pct", *_WHOLE_MEASURES)
                yield no_final_stop(seen.run, number(excess_m, "m"), spoilt)
                return
            yield mistake(
                "path_length",
                ("length_error_pct", *_WHOLE_MEASURES),
                piece=name_of(each.wanted),
                driven=number(each.length_m, "m"),
                wanted=number(scale * each.wanted.length_m, "m"),
            )
            return


def _arcs(seen: _Seen, scale: float) -> Iterator[Mistake]:
    """Name the first of these: an arc that bends the wrong way, one that is not round, one of another radius."""
    arcs = [each for each in _by_error(seen.stretches, "arc", scale) if not math.isnan(each.radius_m)]
    mirror = -1.0 if seen.figure.placed.mirrored else 1.0
    for each in arcs:
        if each.swept_rad * each.wanted.angle_deg * mirror < 0.0:
            yield mistake("path_sense", _SHAPE_MEASURES, piece=name_of(each.wanted))
            return
    for each in arcs:
        if seen.loses("round_pct", 100.0 * each.deviation_m / each.radius_m):
            yield mistake(
                "path_not_round",
                ("radius_error_pct", *_ARC_MEASURES),
                piece=name_of(each.wanted),
                deviation=number(each.deviation_m, "m"),
            )
            return
    for each in arcs:
        wanted_m = scale * each.wanted.radius_m
        if seen.loses("radius_error_pct", 100.0 * abs(each.radius_m - wanted_m) / wanted_m):
            yield mistake(
                "path_radius",
                ("radius_error_pct", *_ARC_MEASURES),
                piece=name_of(each.wanted),
                driven=number(each.radius_m, "m"),
                wanted=number(wanted_m, "m"),
            )
            return


def _by_error(stretches: list[DrivenStretch], kind: str, scale: float) -> list[DrivenStretch]:
    """Return the pieces of a kind, the one with the largest error first."""

    def error(each: DrivenStretch) -> float:
        driven = each.length_m if kind == "line" else each.radius_m
        wanted = scale * (each.wanted.length_m if kind == "line" else each.wanted.radius_m)
        return 0.0 if math.isnan(driven) or wanted <= 0.0 else abs(driven - wanted) / wanted

    return sorted((each for each in stretches if each.wanted.kind == kind), key=error, reverse=True)


def _ending(seen: _Seen) -> Iterator[Mistake]:
    """Say what was driven before and after the path."""
    if seen.figure.approach_m > 0.0:
        yield mistake("approach", ("gap_pct",), distance=number(seen.figure.approach_m, "m"))
    if seen.figure.repeated:
        return
    if seen.drive.moving_at_end:
        yield mistake("never_stops", ("settled",))
    elif seen.figure.overrun:
        after_m = float(np.max(seen.drive.path.along_m)) - seen.figure.end_m
        spoilt = ("settled", "gap_pct", "off_pct")
        yield mistake("drove_on", spoilt, distance=number(after_m, "m"))
