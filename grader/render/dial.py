"""Turning in place as a dial: the heading winds outwards as time passes."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from grader.contracts.figure import FigureSketch
from grader.contracts.trajectory import Floats
from grader.messages import quantity
from grader.render import palette
from grader.render.palette import draw_end, draw_start
from grader.render.scene import Scene
from grader.render.typeface import drawable

_INNER = 0.62
_PER_TURN = 0.17
_MOST_OUTER = 1.0
_REMARK_CHARACTERS = 40
_ARC_STEP_RAD = np.deg2rad(2.0)


def draw_dial(axes: Axes, scene: Scene) -> None:
    """Draw the angle turned as a spiral from the starting heading, one winding per turn."""
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlim(-1.32, 1.32)
    axes.set_ylim(-1.32, 1.32)
    axes.axis("off")
    track = scene.trajectory
    if track is None:
        return
    sketch = scene.sketch or FigureSketch(view="heading")
    start = float(track.heading_rad[0])
    turned = track.heading_rad - start
    pitch = _pitch(turned)
    _spokes(axes, start)
    if sketch.wanted_turn_deg is not None:
        sense = np.sign(turned[np.abs(turned).argmax()])
        _draw_wanted(axes, scene, start, sense * np.deg2rad(sketch.wanted_turn_deg), pitch)
    ok = sketch.corners[0].ok if sketch.corners else None
    style = palette.FAILED_DASHES if ok is False else "-"
    xs, ys = _spiral(start, turned, pitch)
    axes.plot(xs, ys, color=_colour(ok), lw=2.8, ls=style, zorder=4, label=scene.word("turned"))
    draw_end(axes, (float(xs[-1]), float(ys[-1])), scene)
    draw_start(axes, (float(xs[0]), float(ys[0])), start, scene)
    _words(axes, scene, sketch, float(np.rad2deg(turned[-1])))
    axes.legend(
        loc="upper center",
        bbox_to_anchor=(0.5, -0.04),
        ncols=4,
        frameon=False,
        fontsize=9.5,
        handlelength=2.2,
    )


def _colour(ok: bool | None) -> str:
    return palette.PASSED if ok is None else palette.colour_of(ok)


def _words(axes: Axes, scene: Scene, sketch: FigureSketch, turned_deg: float) -> None:
    """Write the turn that was counted, else the last heading's, and the sketch's remarks into the middle."""
    ok = sketch.corners[0].ok if sketch.corners else None
    total_deg = sketch.corners[0].angle_deg if sketch.corners else turned_deg
    total = f"{'✗ ' if ok is False else ''}{quantity.signed(total_deg, 'deg')}"
    axes.text(0, 0.08, total, ha="center", va="center", fontsize=19, color=_colour(ok))
    axes.text(0, -0.12, scene.word("turned"), ha="center", va="center", fontsize=10, color=palette.MUTED)
    for i, label in enumerate(sketch.labels):
        text = drawable(label.text.get(scene.language), _REMARK_CHARACTERS)
        axes.text(0, -0.32 - 0.12 * i, text, ha="center", fontsize=10, color=palette.colour_of(label.ok))


def _pitch(turned: Floats) -> float:
    """Return the growth of the radius per radian, so that all windings fit."""
    most = float(np.abs(turned).max()) or 1.0
    return min(_PER_TURN / (2 * np.pi), (_MOST_OUTER - _INNER) / most)


def _spiral(start: float, turned: Floats, pitch: float) -> tuple[Floats, Floats]:
    """Return the points of the spiral in time order; turning back runs back along it."""
    samples = [turned[:1]]
    for i in np.flatnonzero(np.abs(np.diff(turned)) > 1e-9):
        count = max(int(abs(turned[i + 1] - turned[i]) // _ARC_STEP_RAD), 1)
        samples.append(turned[i] + (turned[i + 1] - turned[i]) * np.arange(1, count + 1) / count)
    angles = np.concatenate(samples)
    radii = _INNER + pitch * np.abs(angles)
    return radii * np.cos(start + angles), radii * np.sin(start + angles)


def _spokes(axes: Axes, start: float) -> None:
    axes.add_patch(Circle((0, 0), 1.08, fc="#fafafa", ec=palette.FAINT, lw=1.0, zorder=0.5))
    for degrees in range(0, 360, 30):
        angle = np.deg2rad(degrees)
        inner = 1.05 if degrees % 90 else 1.02
        axes.plot(
            [inner * np.cos(angle), 1.08 * np.cos(angle)], [inner * np.sin(angle), 1.08 * np.sin(angle)],
            color=palette.FAINT, lw=1.4, solid_capstyle="butt", zorder=1,
        )  # fmt: skip
        if degrees % 90 == 0:
            axes.text(
                1.2 * np.cos(angle), 1.18 * np.sin(angle), f"{degrees}°", ha="center", va="center",
                fontsize=9.5, color=palette.MUTED,
            )  # fmt: skip
    reach = np.array([0.45, 1.08])
    axes.plot(reach * np.cos(start), reach * np.sin(start), color=palette.START, lw=1.0, ls=":", zorder=2)


def _draw_wanted(axes: Axes, scene: Scene, start: float, wanted: float, pitch: float) -> None:
    xs, ys = _spiral(start, np.array([0.0, wanted]), pitch)
    axes.plot(
        xs, ys, color=palette.IDEAL, lw=9, solid_capstyle="butt", zorder=1.5, label=scene.word("one_turn")
    )
