"""Plan view: the path over the ideal figure, with the measured sides and corners."""

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon, Rectangle

from grader.contracts.figure import FigureSketch, Point, SketchCorner, SketchSide
from grader.contracts.trajectory import Floats, Trajectory
from grader.render import palette
from grader.render.placing import Board, Label
from grader.render.scene import Scene
from grader.render.typeface import drawable

WINDOW_M = 499 / 45
"""Side of turtlesim's window: 500 pixels at 45 pixels per metre (turtlesim's turtle_frame.cpp)."""

_NANO = 1e-9
_LEAST_EXTENT_M = 1.2
_MARGIN = 0.16
_TIME_STEPS_S = (1, 2, 5, 10, 15, 30, 60, 120)
_MOST_TIME_MARKS = 7
_MARK_DISTANCE_PX = 22.0
_INK_STEP_PX = 5.0
_ARROWS_WITHOUT_SIDES = 5
_NO_SKETCH = FigureSketch()


def draw_plan(axes: Axes, scene: Scene) -> None:
    """Draw the plan view; `axes` must already have its final place in the figure."""
    track = scene.trajectory
    if track is None:
        _say_no_motion(axes, scene)
        return
    sketch = scene.sketch or _NO_SKETCH
    path = _path(track)
    _frame(axes, path, sketch)
    _walls(axes, scene)
    _ideal(axes, sketch, scene)
    _draw_path(axes, track, path, sketch, scene)
    for side in sketch.sides:
        _draw_side(axes, side)
    _legend_of_verdicts(axes, sketch, scene)
    _arrows(axes, path, sketch)
    _gap(axes, sketch)
    _corners(axes, sketch)
    _ends(axes, track, scene)
    _label_all(axes, track, path, sketch, scene)
    if not scene.moved:
        _say_no_motion(axes, scene)
    _legend(axes)


def _path(track: Trajectory) -> Floats:
    """Return (n, 2) positions; a row of NaN breaks the line before each teleport."""
    points = np.column_stack((track.x_m, track.y_m))
    return np.insert(points, list(track.jumps), np.nan, axis=0) if track.jumps else points


def _frame(axes: Axes, path: Floats, sketch: FigureSketch) -> None:
    """Fix limits: equal scales, everything inside, the panel filled."""
    corners = [
        *sketch.ideal_m,
        *(side.start_m for side in sketch.sides),
        *(side.end_m for side in sketch.sides),
    ]
    points = np.vstack([path[np.isfinite(path).all(axis=1)], np.array(corners, dtype=float).reshape(-1, 2)])
    low, high = points.min(axis=0), points.max(axis=0)
    middle, extent = (low + high) / 2, np.maximum(high - low, 0.0)
    extent = np.maximum(extent, _LEAST_EXTENT_M * 0.5) * (1 + 2 * _MARGIN)
    box = axes.bbox
    aspect = box.width / box.height
    height = max(extent[1], extent[0] / aspect, _LEAST_EXTENT_M)
    half = np.array([height * aspect, height]) / 2
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
    axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
    axes.grid(color=palette.GRID, lw=0.8, zorder=0)
    axes.set_axisbelow(True)
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")


def _walls(axes: Axes, scene: Scene) -> None:
    if not scene.walls:
        return
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    if x0 > 0 and y0 > 0 and x1 < WINDOW_M and y1 < WINDOW_M:
        return
    for x, y, width, height in ((-50, -50, 50, 120), (WINDOW_M, -50, 50, 120)):
        axes.add_patch(
            Rectangle((x, y), width, height, fc="#f0f0f0", ec="none", hatch="////", lw=0, zorder=0.5)
        )
        axes.add_patch(
            Rectangle((y, x), height, width, fc="#f0f0f0", ec="none", hatch="////", lw=0, zorder=0.5)
        )
    edge = Rectangle((0, 0), WINDOW_M, WINDOW_M, fc="none", ec=palette.WALL, lw=2.4, zorder=2)
    edge.set_label(scene.word("wall"))
    axes.add_patch(edge)


def _ideal(axes: Axes, sketch: FigureSketch, scene: Scene) -> None:
    if len(sketch.ideal_m) < 2:
        return
    points = [*sketch.ideal_m, sketch.ideal_m[0]] if sketch.ideal_closed else list(sketch.ideal_m)
    if sketch.ideal_closed:
        axes.add_patch(Polygon(list(sketch.ideal_m), closed=True, fc="#f6f6f6", ec="none", zorder=1))
    xs, ys = zip(*points, strict=True)
    axes.plot(
        xs, ys, color=palette.IDEAL, lw=8, solid_joinstyle="miter", solid_capstyle="butt", zorder=1.5,
        label=scene.word("ideal"),
    )  # fmt: skip


def _draw_path(axes: Axes, track: Trajectory, path: Floats, sketch: FigureSketch, scene: Scene) -> None:
    begin, end = _judged(track, sketch)
    shift = (
        np.searchsorted(np.array(track.jumps, dtype=int), [begin, end], side="right")
        if track.jumps
        else [0, 0]
    )
    first, last = begin + int(shift[0]), end + int(shift[1])
    rest = [path[: first + 1], path[last:]]
    if any(
        len(part) > 1 and np.ptp(part[np.isfinite(part).all(axis=1)], axis=0).max() > 0.01 for part in rest
    ):
        for i, part in enumerate(rest):
            label = scene.word("path_rest") if i == 0 else None
            axes.plot(part[:, 0], part[:, 1], color=palette.FAINT, lw=1.2, zorder=2.5, label=label)
    judged = path[first : last + 1]
    axes.plot(
        judged[:, 0], judged[:, 1], color=palette.INK, lw=1.3, zorder=3, solid_joinstyle="round",
        label=scene.word("path"),
    )  # fmt: skip


def _judged(track: Trajectory, sketch: FigureSketch) -> tuple[int, int]:
    """Return the first and the last index of the judged part."""
    last = len(track) - 1
    begin = int(np.searchsorted(track.t_ns, sketch.begin_ns, side="right")) - 1
    end = last if sketch.end_ns is None else int(np.searchsorted(track.t_ns, sketch.end_ns, side="left"))
    return min(max(begin, 0), last), min(max(end, begin, 0), last)


def _draw_side(axes: Axes, side: SketchSide) -> None:
    (x0, y0), (x1, y1) = side.start_m, side.end_m
    if side.ok is None:
        return
    style = "-" if side.ok else palette.FAILED_DASHES
    axes.plot([x0, x1], [y0, y1], color=palette.verdict(side.ok), lw=2.8, ls=style, zorder=4)


def _legend_of_verdicts(axes: Axes, sketch: FigureSketch, scene: Scene) -> None:
    verdicts = {side.ok for side in sketch.sides} | {corner.ok for corner in sketch.corners}
    if True in verdicts:
        axes.plot(
            [], [], color=palette.PASSED, lw=2.8, marker="o", mfc="white", ms=6, label=scene.word("side_ok")
        )
    if False in verdicts:
        axes.plot(
            [], [], color=palette.FAILED, lw=2.8, ls=palette.FAILED_DASHES, marker="X", ms=8, mec="white",
            label=scene.word("side_bad"),
        )  # fmt: skip


def _arrows(axes: Axes, path: Floats, sketch: FigureSketch) -> None:
    for start, end, colour in _arrow_places(path, sketch):
        axes.annotate(
            "", xy=end, xytext=start, zorder=5,
            arrowprops={"arrowstyle": "-|>,head_length=0.55,head_width=0.28", "color": colour, "lw": 1.2,
                        "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip


def _arrow_places(path: Floats, sketch: FigureSketch) -> list[tuple[Point, Point, str]]:
    if sketch.sides:
        return [
            (_between(s.start_m, s.end_m, 0.52), _between(s.start_m, s.end_m, 0.6), palette.verdict(s.ok))
            for s in sketch.sides
            if s.length_m > 0.15
        ]
    points = path[np.isfinite(path).all(axis=1)]
    travelled = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    if travelled[-1] < 0.15:
        return []
    places = []
    for share in (np.arange(_ARROWS_WITHOUT_SIDES) + 0.5) / _ARROWS_WITHOUT_SIDES:
        near = np.interp(
            [share * travelled[-1], (share + 0.01) * travelled[-1]], travelled, np.arange(len(points))
        )
        x, y = (np.interp(near, np.arange(len(points)), points[:, axis]) for axis in (0, 1))
        places.append(((float(x[0]), float(y[0])), (float(x[1]), float(y[1])), palette.INK))
    return places


def _between(start: Point, end: Point, share: float) -> Point:
    return start[0] + (end[0] - start[0]) * share, start[1] + (end[1] - start[1]) * share


def _gap(axes: Axes, sketch: FigureSketch) -> None:
    if sketch.gap is None:
        return
    (x0, y0), (x1, y1) = sketch.gap.start_m, sketch.gap.end_m
    axes.plot([x0, x1], [y0, y1], color=palette.verdict(sketch.gap.ok), lw=1.6, ls=":", zorder=4.5)


def _corners(axes: Axes, sketch: FigureSketch) -> None:
    for corner in sketch.corners:
        x, y = corner.at_m
        if corner.ok is False:
            axes.plot([x], [y], "X", color=palette.FAILED, ms=9, mec="white", mew=0.8, zorder=6)
        else:
            axes.plot([x], [y], "o", mec=palette.verdict(corner.ok), mfc="white", mew=1.6, ms=6, zorder=6)


def _ends(axes: Axes, track: Trajectory, scene: Scene) -> None:
    """Mark the start with the car's heading, and where it came to rest."""
    heading_deg = float(np.rad2deg(track.heading_rad[0]))
    axes.plot(
        track.x_m[-1:], track.y_m[-1:], "s", color=palette.INK, ms=6.5, mec="white", zorder=7,
        label=scene.word("stop"),
    )  # fmt: skip
    axes.plot(
        track.x_m[:1], track.y_m[:1], marker=(3, 0, heading_deg - 90), ls="none", color=palette.START, ms=15,
        mec="white", mew=1.2, zorder=8, label=scene.word("start"),
    )  # fmt: skip
    for contact in track.contacts:
        i = min(int(np.searchsorted(track.t_ns, contact.start_ns)), len(track) - 1)
        axes.plot(
            track.x_m[i : i + 1],
            track.y_m[i : i + 1],
            "*",
            color=palette.FAILED,
            ms=13,
            mec="white",
            zorder=7,
        )


def _label_all(axes: Axes, track: Trajectory, path: Floats, sketch: FigureSketch, scene: Scene) -> None:
    pixels = axes.transData.transform(path[np.isfinite(path).all(axis=1)])
    board = Board(axes, _dense(pixels))
    board.block((float(track.x_m[0]), float(track.y_m[0])), 15)
    board.block((float(track.x_m[-1]), float(track.y_m[-1])), 10)
    for corner in sketch.corners:
        board.block(corner.at_m, 8)
    centre = _centre(path, sketch)
    board.put(_corner_label(sketch, i, centre) for i in range(len(sketch.corners)))
    board.put(_side_label(side, centre) for side in sketch.sides)
    if sketch.gap is not None:
        length = f"{sketch.gap.length_m:.2f}"
        middle = _between(sketch.gap.start_m, sketch.gap.end_m, 0.5)
        colour = palette.verdict(sketch.gap.ok)
        text = scene.word("gap", length=length)
        board.put([Label(at_m=middle, text=text, away=_away(middle, centre), colour=colour, boxed=True)])
    board.put(
        Label(
            at_m=label.at_m,
            text=drawable(label.text.get(scene.language), 40),
            away=_away(label.at_m, centre),
            colour=palette.verdict(label.ok),
        )
        for label in sketch.labels
    )
    board.put(_time_marks(axes, track, sketch, centre))


def _dense(pixels: Floats) -> Floats:
    """Return points along the polyline at most `_INK_STEP_PX` apart, without those that coincide."""
    parts = [pixels[:1]]
    for start, end in pairwise(pixels[np.r_[True, np.hypot(*np.diff(pixels, axis=0).T) > 0.5]]):
        count = max(int(np.hypot(*(end - start)) // _INK_STEP_PX), 1)
        parts.append(start + (end - start) * (np.arange(1, count + 1)[:, None] / count))
    return np.vstack(parts)


def _centre(path: Floats, sketch: FigureSketch) -> Point:
    points = np.array(sketch.ideal_m) if len(sketch.ideal_m) > 2 else path[np.isfinite(path).all(axis=1)]
    x, y = (points.min(axis=0) + points.max(axis=0)) / 2
    return float(x), float(y)


def _away(point: Point, centre: Point) -> Point:
    x, y = point[0] - centre[0], point[1] - centre[1]
    return (x, y) if abs(x) + abs(y) > 1e-6 else (0.0, 1.0)


def _side_label(side: SketchSide, centre: Point) -> Label:
    middle = _between(side.start_m, side.end_m, 0.5)
    along = np.array(side.end_m) - np.array(side.start_m)
    normal = np.array([-along[1], along[0]])
    outward = normal if float(normal @ np.array(_away(middle, centre))) >= 0 else -normal
    mark = "✗ " if side.ok is False else ""
    away = (float(outward[0]), float(outward[1])) if float(np.hypot(*outward)) > 1e-6 else (0.0, 1.0)
    return Label(
        at_m=middle, text=f"{mark}{side.length_m:.2f} m", away=away, colour=palette.verdict(side.ok),
        size_pt=10.5, boxed=side.ok is False,
    )  # fmt: skip


def _corner_label(sketch: FigureSketch, i: int, centre: Point) -> Label:
    corner: SketchCorner = sketch.corners[i]
    x, y = _away(corner.at_m, centre)
    mark = "✗ " if corner.ok is False else ""
    return Label(
        at_m=corner.at_m, text=f"{mark}{corner.angle_deg:.1f}°", away=(-x, -y),
        colour=palette.verdict(corner.ok), size_pt=10.0, boxed=corner.ok is False,
    )  # fmt: skip


def _time_marks(axes: Axes, track: Trajectory, sketch: FigureSketch, centre: Point) -> list[Label]:
    """Draw a dot every few seconds where the car was driving; return the dots' labels."""
    seconds = track.t_ns * _NANO
    duration = float(seconds[-1] - seconds[0])
    step = next((s for s in _TIME_STEPS_S if duration / s <= _MOST_TIME_MARKS), 300)
    labels: list[Label] = []
    ends = [(float(track.x_m[i]), float(track.y_m[i])) for i in (0, -1)]
    used = [axes.transData.transform(at) for at in (*ends, *(corner.at_m for corner in sketch.corners))]
    for time in np.arange(step, duration + 1e-9, step):
        at = tuple(float(np.interp(time, seconds, values)) for values in (track.x_m, track.y_m))
        pixel = axes.transData.transform(at)
        if min(float(np.hypot(*(pixel - other))) for other in used) < _MARK_DISTANCE_PX:
            continue
        used.append(pixel)
        axes.plot([at[0]], [at[1]], "o", color=palette.MUTED, ms=4.2, mec="white", mew=0.8, zorder=5.5)
        x, y = _away((at[0], at[1]), centre)
        labels.append(
            Label(at_m=(at[0], at[1]), text=f"{time:g} s", away=(-x, -y), colour=palette.MUTED, size_pt=8.5)
        )
    return labels


def _say_no_motion(axes: Axes, scene: Scene) -> None:
    axes.text(
        0.5, 0.72, scene.word("no_motion"), transform=axes.transAxes, ha="center", color=palette.FAILED,
        fontsize=14,
    )  # fmt: skip


def _legend(axes: Axes) -> None:
    handles, names = axes.get_legend_handles_labels()
    axes.legend(
        handles, names, loc="upper center", bbox_to_anchor=(0.5, -0.09), frameon=False, fontsize=9.5,
        ncols=len(names) if len(names) <= 4 else (len(names) + 1) // 2, handlelength=2.2, columnspacing=1.8,
        handletextpad=0.7,
    )  # fmt: skip
