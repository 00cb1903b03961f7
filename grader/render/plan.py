"""Plan view: the path over the ideal figure, with the measured sides and corners."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon, Rectangle

from grader.contracts.assignment import WINDOW_M
from grader.contracts.figure import FigureSketch, SketchSide
from grader.contracts.robot import BACK_M, FRONT_M, HALF_WIDTH_M
from grader.contracts.trajectory import Floats, Trajectory
from grader.render import palette
from grader.render.annotations import annotate, position
from grader.render.palette import draw_end, draw_start
from grader.render.scene import Scene

_LEAST_EXTENT_M = 1.2
_MARGIN = 0.16
_NO_SKETCH = FigureSketch()
_OUTLINE_M = np.array(
    [(FRONT_M, HALF_WIDTH_M), (BACK_M, HALF_WIDTH_M), (BACK_M, -HALF_WIDTH_M), (FRONT_M, -HALF_WIDTH_M)]
)


def draw_plan(axes: Axes, scene: Scene) -> None:
    """Draw the plan view; `axes` must already have its final place in the figure."""
    track = scene.trajectory
    if track is None or not _finite(_path(track)).size:
        axes.axis("off")
        _say_no_motion(axes, scene)
        return
    sketch = scene.sketch or _NO_SKETCH
    path = _path(track)
    _frame(axes, path, sketch)
    _walls(axes, scene)
    _room(axes, sketch)
    _robot(axes, track, sketch)
    _ideal(axes, sketch, scene)
    _regions(axes, sketch)
    _commanded(axes, sketch, scene)
    _draw_path(axes, track, path, sketch, scene)
    for side in sketch.sides:
        _draw_side(axes, side)
    _legend_of_fits(axes, sketch, scene)
    _gap(axes, sketch)
    _corners(axes, sketch)
    _ends(axes, track, scene)
    annotate(axes, track, sketch, scene)
    if not scene.moved:
        _say_no_motion(axes, scene)
    _legend(axes)


def _path(track: Trajectory) -> Floats:
    """Return (n, 2) positions; a row of NaN breaks the line before each teleport."""
    points = np.column_stack((track.x_m, track.y_m))
    return np.insert(points, list(track.jumps), np.nan, axis=0) if track.jumps else points


def _finite(points: Floats) -> Floats:
    return np.asarray(points[np.isfinite(points).all(axis=1)])


def _frame(axes: Axes, path: Floats, sketch: FigureSketch) -> None:
    """Fix limits: equal scales, everything inside, the panel filled."""
    corners = [
        *sketch.ideal_m,
        *sketch.commanded_m,
        *(side.start_m for side in sketch.sides),
        *(side.end_m for side in sketch.sides),
        *(point for region in sketch.regions for point in region.outline_m),
        *(point for solid in sketch.solids for point in solid.outline_m),
    ]
    points = np.vstack([_finite(path), np.array(corners, dtype=float).reshape(-1, 2)])
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


def _room(axes: Axes, sketch: FigureSketch) -> None:
    """Draw what stands in a robot's room, and the lines on its floor."""
    for solid in sketch.solids:
        face = {"line": palette.INK, "ramp": "#e8e4da"}.get(solid.kind, "#c4c4c4")
        edge = "none" if solid.kind == "line" else palette.WALL
        hatch = "////" if solid.kind == "ramp" else None
        axes.add_patch(
            Polygon(list(solid.outline_m), closed=True, fc=face, ec=edge, lw=0.9, hatch=hatch, zorder=1.1)
        )


def _robot(axes: Axes, track: Trajectory, sketch: FigureSketch) -> None:
    """Draw the robot in its room, as large as it is: where it first touched something, and where it ended."""
    if not sketch.solids:
        return
    touched = [contact.start_ns for contact in track.contacts][:1]
    samples = [int(np.searchsorted(track.t_ns, t_ns)) for t_ns in touched]
    last = len(track) - 1
    for sample, colour in [*((min(each, last), palette.FAILED) for each in samples), (last, palette.INK)]:
        heading = float(track.heading_rad[sample])
        turn = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]])
        outline = _OUTLINE_M @ turn + (track.x_m[sample], track.y_m[sample])
        axes.add_patch(Polygon(outline, closed=True, fc="#dfe6ea", ec=colour, lw=1.2, zorder=2.8))


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


def _commanded(axes: Axes, sketch: FigureSketch, scene: Scene) -> None:
    """Draw the path as commanded, where the turtle drove another."""
    if sketch.commanded_m:
        xs, ys = zip(*sketch.commanded_m, strict=True)
        axes.plot(xs, ys, color=palette.COMMAND, lw=1.4, ls="--", zorder=2.2, label=scene.word("commanded"))


def _regions(axes: Axes, sketch: FigureSketch) -> None:
    """Draw the places to visit, named in their middle, and those to avoid, hatched."""
    for region in sketch.regions:
        colour = palette.colour_of(region.ok)
        if region.avoid:
            colour = palette.WALL if region.ok else palette.FAILED
        style = "-" if region.ok else palette.FAILED_DASHES
        hatch = "////" if region.avoid else None
        patch = Polygon(
            list(region.outline_m), closed=True, fc="#f6f6f6", ec=colour, lw=1.8, ls=style, hatch=hatch,
            zorder=1.2,
        )  # fmt: skip
        axes.add_patch(patch)


def _draw_path(axes: Axes, track: Trajectory, path: Floats, sketch: FigureSketch, scene: Scene) -> None:
    begin, end = _counted(track, sketch)
    shift = (
        np.searchsorted(np.array(track.jumps, dtype=int), [begin, end], side="right")
        if track.jumps
        else [0, 0]
    )
    first, last = begin + int(shift[0]), end + int(shift[1])
    rest = [path[: first + 1], path[last:]]
    if any(len(part) > 1 and np.ptp(_finite(part), axis=0).max() > 0.01 for part in rest):
        for i, part in enumerate(rest):
            label = scene.word("path_rest") if i == 0 else None
            axes.plot(part[:, 0], part[:, 1], color=palette.FAINT, lw=1.2, zorder=2.5, label=label)
    counted = path[first : last + 1]
    axes.plot(
        counted[:, 0], counted[:, 1], color=palette.INK, lw=1.3, zorder=3, solid_joinstyle="round",
        label=scene.word("path"),
    )  # fmt: skip


def _counted(track: Trajectory, sketch: FigureSketch) -> tuple[int, int]:
    """Return the first and the last index of the counted part."""
    last = len(track) - 1
    begin = int(np.searchsorted(track.t_ns, sketch.begin_ns, side="right")) - 1
    end = last if sketch.end_ns is None else int(np.searchsorted(track.t_ns, sketch.end_ns, side="left"))
    return min(max(begin, 0), last), min(max(end, begin, 0), last)


def _draw_side(axes: Axes, side: SketchSide) -> None:
    (x0, y0), (x1, y1) = side.start_m, side.end_m
    if side.ok is None:
        return
    style = "-" if side.ok else palette.FAILED_DASHES
    axes.plot([x0, x1], [y0, y1], color=palette.colour_of(side.ok), lw=2.8, ls=style, zorder=4)


def _legend_of_fits(axes: Axes, sketch: FigureSketch, scene: Scene) -> None:
    fits = {side.ok for side in sketch.sides} | {corner.ok for corner in sketch.corners}
    if True in fits:
        axes.plot(
            [], [], color=palette.PASSED, lw=2.8, marker="o", mfc="white", ms=6, label=scene.word("side_ok")
        )
    if False in fits:
        axes.plot(
            [], [], color=palette.FAILED, lw=2.8, ls=palette.FAILED_DASHES, marker="X", ms=8, mec="white",
            label=scene.word("side_bad"),
        )  # fmt: skip


def _gap(axes: Axes, sketch: FigureSketch) -> None:
    if sketch.gap is None or sketch.gap.ok:
        return
    (x0, y0), (x1, y1) = sketch.gap.start_m, sketch.gap.end_m
    axes.plot([x0, x1], [y0, y1], color=palette.colour_of(sketch.gap.ok), lw=1.6, ls=":", zorder=4.5)


def _corners(axes: Axes, sketch: FigureSketch) -> None:
    for corner in sketch.corners:
        x, y = corner.at_m
        if corner.ok is False:
            axes.plot([x], [y], "X", color=palette.FAILED, ms=9, mec="white", mew=0.8, zorder=6)
        else:
            axes.plot([x], [y], "o", mec=palette.colour_of(corner.ok), mfc="white", mew=1.6, ms=6, zorder=6)


def _ends(axes: Axes, track: Trajectory, scene: Scene) -> None:
    """Mark contacts with walls, the last place and the start with the car's heading."""
    for contact in track.contacts:
        x, y = position(track, contact.start_ns)
        axes.plot([x], [y], "*", color=palette.FAILED, ms=14, mec="white", zorder=7.5)
    draw_end(axes, (float(track.x_m[-1]), float(track.y_m[-1])), scene)
    draw_start(axes, (float(track.x_m[0]), float(track.y_m[0])), float(track.heading_rad[0]), scene)


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
