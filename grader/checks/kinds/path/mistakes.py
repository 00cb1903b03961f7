"""What a driven path's pieces are called, and mistakes that its measures do not show."""

import math
from collections.abc import Iterator

from grader.checks.drive import Drive
from grader.checks.kinds.path.driven import Figure, as_turned_deg, end_ns
from grader.checks.kinds.path.wanted import Stretch
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import command_mistakes, only_turned, time_was_up
from grader.contracts.assignment import Assignment
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.messages import say
from grader.messages.quantity import number

FULL_CIRCLE_DEG = 350.0  # from here on an arc is called a circle
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
_DRIVE_MEASURES = ("distance_m", *_SHAPE_MEASURES)


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


def path_mistakes(assignment: Assignment, run: Run, drive: Drive, figure: Figure | None) -> Iterator[Mistake]:
    """Yield what probably went wrong on the way."""
    yield from command_mistakes(run, assignment.world, turns=_SHAPE_MEASURES, drives=_DRIVE_MEASURES)
    yield from only_turned(run, _DRIVE_MEASURES)
    until_ns = math.inf if figure is None or not figure.overrun else end_ns(figure, drive)
    for contact in run.trajectory.contacts[:1]:
        if contact.start_ns <= until_ns:  # else the figure was complete
            time, wall = number(contact.start_ns / 1e9, "s"), say(f"wall.{contact.wall}")
            yield mistake("wall_hit", _SHAPE_MEASURES, time=time, wall=wall)
    if figure is None or not (figure.repeated or figure.overrun):
        yield from time_was_up(run, drive, ("settled", *_SHAPE_MEASURES))
