"""What is written on the plan view: arrows, measures of sides and corners, time marks."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes

from grader.contracts.assignment import WINDOW_M
from grader.contracts.figure import FigureSketch, Point, SketchCorner, SketchSide
from grader.contracts.trajectory import Floats, Trajectory
from grader.messages import quantity
from grader.render import palette
from grader.render.placing import Board, Label
from grader.render.scene import Scene
from grader.render.typeface import drawable

_NANO = 1e-9
_TIME_STEPS_S = (5, 2, 10, 1, 15, 30, 60)  # the first that gives a fair number of marks is taken
_FEWEST_TIME_MARKS, _MOST_TIME_MARKS = 2, 8
_MARK_DISTANCE_PX = 20.0
_INK_STEP_PX = 5.0
_ARROWS_WITHOUT_SIDES = 5
_LEAST_ARROW_M = 0.15
_REMARK_CHARACTERS = 40

Arrow = tuple[Point, Point, str]


def annotate(axes: Axes, track: Trajectory, sketch: FigureSketch, scene: Scene) -> None:
    """Draw arrows and labels; the limits of `axes` must be final.

    Labels are placed in the order of their weight: corners, sides, the gap, remarks, time marks.
    """
    points = np.column_stack((track.x_m, track.y_m))
    points = points[np.isfinite(points).all(axis=1)]
    for start, tip, colour in _arrows(points, sketch):
        axes.annotate(
            "", xy=tip, xytext=start, zorder=5,
            arrowprops={"arrowstyle": "-|>,head_length=0.55,head_width=0.28", "color": colour, "lw": 1.2,
                        "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip
    board = Board(axes, _ink(axes, points, sketch, scene.walls))
    _block(board, track, points, sketch)
    centre = _centre(points, sketch)
    signed = len({corner.angle_deg > 0 for corner in sketch.corners}) > 1
    board.put(_corner_label(corner, centre, signed) for corner in sketch.corners)
    board.put(_side_label(side, centre) for side in sketch.sides)
    board.put(_remarks(sketch, scene, centre))
    marks = _time_marks(axes, track, sketch)
    axes.plot(
        [at[0] for at, _ in marks], [at[1] for at, _ in marks], "o", ls="none", color=palette.MUTED, ms=4.4,
        mec="white", mew=0.8, zorder=5.5,
    )  # fmt: skip
    board.put(_time_label(at, seconds, centre) for at, seconds in marks)


def _arrows(points: Floats, sketch: FigureSketch) -> Iterator[Arrow]:
    """Yield tail, tip and colour: one on each side, else some along the path."""
    if sketch.sides:
        for side in sketch.sides:
            if side.length_m > _LEAST_ARROW_M:
                tail, tip = (_between(side.start_m, side.end_m, share) for share in (0.52, 0.6))
                yield tail, tip, palette.colour_of(side.ok)
        return
    travelled = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    if travelled[-1] < _LEAST_ARROW_M:
        return
    for share in (np.arange(_ARROWS_WITHOUT_SIDES) + 0.5) / _ARROWS_WITHOUT_SIDES:
        near = np.array([share, share + 0.01]) * travelled[-1]
        (x0, x1), (y0, y1) = (np.interp(near, travelled, points[:, axis]).tolist() for axis in (0, 1))
        yield (x0, y0), (x1, y1), palette.INK


def _ink(axes: Axes, points: Floats, sketch: FigureSketch, walls: bool) -> Floats:
    """Return pixels that labels must not cover: path, sides, gap and walls."""
    lines = [points]
    if sketch.gap is not None and not sketch.gap.ok:
        lines.append(np.array([sketch.gap.start_m, sketch.gap.end_m]))
    lines += [np.array([side.start_m, side.end_m]) for side in sketch.sides]
    if walls:
        lines.append(WINDOW_M * np.array([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)]))
    pixels = np.vstack([_dense(axes.transData.transform(line)) for line in lines])
    box = axes.bbox
    within = (pixels > [box.x0 - 5, box.y0 - 5]) & (pixels < [box.x1 + 5, box.y1 + 5])
    return np.asarray(pixels[within.all(axis=1)])


def _dense(pixels: Floats) -> Floats:
    """Return points along the polyline at most `_INK_STEP_PX` apart, without those that coincide."""
    parts = [pixels[:1]]
    for start, end in pairwise(pixels[np.r_[True, np.hypot(*np.diff(pixels, axis=0).T) > 0.5]]):
        count = max(int(np.hypot(*(end - start)) // _INK_STEP_PX), 1)
        parts.append(start + (end - start) * (np.arange(1, count + 1)[:, None] / count))
    return np.vstack(parts)


def _block(board: Board, track: Trajectory, points: Floats, sketch: FigureSketch) -> None:
    board.block(_point(points[0]), 15)
    board.block(_point(points[-1]), 10)
    for corner in sketch.corners:
        board.block(corner.at_m, 8)
    for contact in track.contacts:
        board.block(position(track, contact.start_ns), 10)


def position(track: Trajectory, t_ns: int) -> Point:
    """Return where the car was at `t_ns`."""
    return float(np.interp(t_ns, track.t_ns, track.x_m)), float(np.interp(t_ns, track.t_ns, track.y_m))


def _point(row: Floats) -> Point:
    return float(row[0]), float(row[1])


def _between(start: Point, end: Point, share: float) -> Point:
    return start[0] + (end[0] - start[0]) * share, start[1] + (end[1] - start[1]) * share


def _centre(points: Floats, sketch: FigureSketch) -> Point:
    shape = np.array(sketch.ideal_m) if len(sketch.ideal_m) > 2 else points
    return _point((shape.min(axis=0) + shape.max(axis=0)) / 2)


def _away(point: Point, centre: Point) -> Point:
    x, y = point[0] - centre[0], point[1] - centre[1]
    return (x, y) if abs(x) + abs(y) > 1e-6 else (0.0, 1.0)


def _side_label(side: SketchSide, centre: Point) -> Label:
    """Return the length, to stand outside the figure."""
    middle = _between(side.start_m, side.end_m, 0.5)
    x, y = side.start_m[1] - side.end_m[1], side.end_m[0] - side.start_m[0]
    out_x, out_y = _away(middle, centre)
    side_of = 1.0 if x * out_x + y * out_y >= 0 else -1.0
    away = (side_of * x, side_of * y) if abs(x) + abs(y) > 1e-6 else (0.0, 1.0)
    text = f"{'✗ ' if side.ok is False else ''}{quantity.number(side.length_m, 'm')}"
    colour = palette.colour_of(side.ok)
    return Label(at_m=middle, text=text, away=away, colour=colour, size_pt=10.5, boxed=side.ok is False)


def _corner_label(corner: SketchCorner, centre: Point, signed: bool) -> Label:
    """Return the exterior angle, to stand inside the figure; signed when not all turns go one way."""
    x, y = _away(corner.at_m, centre)
    angle_deg = corner.angle_deg
    angle = quantity.signed(angle_deg, "deg") if signed else quantity.number(abs(angle_deg), "deg")
    text = f"{'✗ ' if corner.ok is False else ''}{angle}"
    colour = palette.colour_of(corner.ok)
    return Label(at_m=corner.at_m, text=text, away=(-x, -y), colour=colour, boxed=corner.ok is False)


def _remarks(sketch: FigureSketch, scene: Scene, centre: Point) -> Iterator[Label]:
    if (gap := sketch.gap) is not None and not gap.ok:
        middle = _between(gap.start_m, gap.end_m, 0.5)
        text = scene.word("gap", length=quantity.number(gap.length_m, "m"))
        colour = palette.colour_of(gap.ok)
        yield Label(at_m=middle, text=text, away=_away(middle, centre), colour=colour, boxed=gap.ok is False)
    for region in sketch.regions:
        if not region.avoid:
            text = (
                f"{'' if region.ok else '✗ '}{drawable(region.text.get(scene.language), _REMARK_CHARACTERS)}"
            )
            top = max(y for _, y in region.outline_m)
            colour = palette.colour_of(region.ok)
            yield Label(at_m=(region.at_m[0], top), text=text, away=(0.0, 1.0), colour=colour)
    for label in sketch.labels:
        text = drawable(label.text.get(scene.language), _REMARK_CHARACTERS)
        yield Label(
            at_m=label.at_m, text=text, away=_away(label.at_m, centre), colour=palette.colour_of(label.ok)
        )


def _time_marks(axes: Axes, track: Trajectory, sketch: FigureSketch) -> list[tuple[Point, int]]:
    """Return places and seconds of the time marks, every 5 s where that gives a fair number."""
    last_ns = int(track.t_ns[-1]) if sketch.end_ns is None else min(sketch.end_ns, int(track.t_ns[-1]))
    ends = [position(track, t_ns) for t_ns in (0, last_ns)]
    best: list[tuple[Point, int]] = []
    for step_s in _TIME_STEPS_S:
        if last_ns * _NANO / step_s > 4 * _MOST_TIME_MARKS:
            continue
        times = range(step_s, int(last_ns * _NANO) + 1, step_s)
        marks = _apart(axes, [(position(track, round(t / _NANO)), t) for t in times], ends)
        if _FEWEST_TIME_MARKS <= len(marks) <= _MOST_TIME_MARKS:
            return marks
        if len(best) < len(marks) <= _MOST_TIME_MARKS:
            best = marks
    return best


def _apart(axes: Axes, marks: list[tuple[Point, int]], taken: list[Point]) -> list[tuple[Point, int]]:
    """Return the marks that stand clear of `taken` and of each other."""
    used = [axes.transData.transform(at) for at in taken]
    kept = []
    for at, seconds in marks:
        pixel = axes.transData.transform(at)
        if min(float(np.hypot(*(pixel - other))) for other in used) >= _MARK_DISTANCE_PX:
            used.append(pixel)
            kept.append((at, seconds))
    return kept


def _time_label(at: Point, seconds: int, centre: Point) -> Label:
    x, y = _away(at, centre)
    return Label(at_m=at, text=f"{seconds} s", away=(-x, -y), colour=palette.MUTED, size_pt=8.5)
