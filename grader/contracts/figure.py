"""The measured figure: what the checks saw in a motion, ready to be drawn.

The checks compute it (`grader.checks.sketch`), the renderers draw it; neither imports the other.
Points are (x, y) in metres in turtlesim's frame, in the order driven.
"""

from typing import Literal

from grader.contracts.record import Record
from grader.contracts.text import Text

Point = tuple[float, float]

View = Literal["path", "heading", "log", "frames", "talk"]

PictureForm = Literal["png", "svg"]
"""File format of a drawn figure."""


class SketchSide(Record):
    """A detected straight run.

    Attributes:
        start_m, end_m: its end points.
        length_m: the length the rubric judged (net along the run).
        ok: within tolerance; None when the rubric does not judge it.
    """

    start_m: Point
    end_m: Point
    length_m: float
    ok: bool | None = None


class SketchCorner(Record):
    """A detected turn between two runs.

    Attributes:
        at_m: where the car turned.
        angle_deg: exterior angle, counter-clockwise positive.
        ok: within tolerance; None when the rubric does not judge it.
    """

    at_m: Point
    angle_deg: float
    ok: bool | None = None


class SketchLabel(Record):
    """A remark at a point, e.g. the gap at the end of an open figure."""

    at_m: Point
    text: Text
    ok: bool | None = None


class SketchRegion(Record):
    """A part of the field that the assignment names.

    Attributes:
        outline_m: its corners, or points of its circle.
        at_m: where its name stands.
        text: its name; short.
        ok: of a place to visit: it was visited; of one to avoid: the car stayed away.
        avoid: it is one to avoid.
    """

    outline_m: tuple[Point, ...]
    at_m: Point
    text: Text
    ok: bool
    avoid: bool = False


class SketchSolid(Record):
    """Something that stands in a robot's room, or a line on its floor.

    Attributes:
        kind: as a `Solid`'s, or ``line``.
        outline_m: its corners, or points of its circle, seen from above.
    """

    kind: str
    outline_m: tuple[Point, ...]


class FigureSketch(Record):
    """What a plot shows beside the bare path.

    Attributes:
        view: ``path`` (plan view), ``heading`` (turning in place: heading over time), ``log`` (log lines
            over time), ``talk`` (a conversation over time).
        sides, corners: as detected, in the order driven; at most a few dozen of each.
        ideal_m: vertices of the wanted figure, fitted to the motion (rotated, translated, scaled); empty
            when there is none.
        ideal_closed: whether the last vertex of `ideal_m` joins the first.
        gap: from the start to the end point of a figure that should close; drawn unless it is ok.
        labels: further remarks; few and short.
        begin_ns, end_ns: the part of the trajectory that was judged; the rest is drawn faded. None: up to
            the trajectory's own end.
        regions: places to visit or to avoid; at most a few dozen.
        solids: what stands in a robot's room; none in turtlesim's window.
        commanded_m: the path as commanded, where the turtle drove another (`Trajectory.commanded`).
        wanted_turn_deg: turn that earns full credit in the ``heading`` view, or None.
    """

    view: View = "path"
    sides: tuple[SketchSide, ...] = ()
    corners: tuple[SketchCorner, ...] = ()
    ideal_m: tuple[Point, ...] = ()
    ideal_closed: bool = True
    gap: SketchSide | None = None
    labels: tuple[SketchLabel, ...] = ()
    begin_ns: int = 0
    end_ns: int | None = None
    wanted_turn_deg: float | None = None
    regions: tuple[SketchRegion, ...] = ()
    solids: tuple[SketchSolid, ...] = ()
    commanded_m: tuple[Point, ...] = ()
