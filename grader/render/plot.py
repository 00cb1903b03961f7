"""The plot of one run as PNG or SVG, good enough for a lesson's page.

No pyplot and no display: figures are drawn on canvases of their own, under settings that hold only while
drawing. The same scene gives the same bytes.
"""

import io
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imread

from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch, PictureForm
from grader.contracts.report import GradeReport
from grader.contracts.text import Language
from grader.contracts.trajectory import Trajectory
from grader.messages import quantity
from grader.render import palette
from grader.render.dial import draw_dial
from grader.render.loglines import draw_log, row_count
from grader.render.motion import draw_speed, draw_turned, draw_yaw_rate
from grader.render.plan import draw_plan
from grader.render.scene import Scene, compose
from grader.render.talk import draw_talk, lane_count
from grader.render.typeface import clipped, drawable, rc

_WIDTH_IN, _HEIGHT_IN = 12.0, 6.75
_LOG_ROW_IN = 0.34
_LANE_IN = 0.62
_DPI = 120
_LEFT = (0.062, 0.165, 0.49, 0.685)
_UPPER_RIGHT = (0.635, 0.54, 0.34, 0.31)
_LOWER_RIGHT = (0.635, 0.1, 0.34, 0.36)
_SUMMARY_COLUMNS = 130
_FRAME_ROWS, _FRAMES_ACROSS = 2, 3

_DRAWING = threading.Lock()
"""Matplotlib's settings belong to the process: one drawing at a time."""

_LOOK: dict[str, object] = {
    "font.size": 10.5,
    "axes.edgecolor": palette.FAINT,
    "axes.labelcolor": palette.MUTED,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.color": palette.MUTED,
    "ytick.color": palette.MUTED,
    "xtick.labelsize": 9.5,
    "ytick.labelsize": 9.5,
    "text.color": palette.INK,
    "hatch.color": palette.FAINT,
    "hatch.linewidth": 0.8,
    "svg.fonttype": "path",
    "svg.hashsalt": "grader",
    "path.simplify_threshold": 0.2,
}


def plot(  # noqa: PLR0913
    assignment: Assignment,
    report: GradeReport,
    trajectory: Trajectory | None,
    sketch: FigureSketch | None = None,
    language: Language = "zh",
    *,
    form: PictureForm = "png",
    case: str | None = None,
) -> bytes:
    """Return the plot of one of the report's runs, 1440 x 810 pixels (log lines: as high as they need).

    `trajectory`: of that run; None when the car was not recorded. `sketch`: the measured figure; None draws the
    bare path. In an SVG all text is outlines, so that it looks alike everywhere. `case`: which run; None: the
    first.

    Raises ValueError: the report has no such run.
    """
    scene = compose(assignment, report, trajectory, sketch, language, case)
    # Without these entries matplotlib writes its version and the time of day into the file.
    metadata = {"Software": None} if form == "png" else {"Date": None, "Creator": None}
    target = io.BytesIO()
    with _settings():
        _figure(scene).savefig(target, format=form, metadata=metadata)
    return target.getvalue()


@contextmanager
def _settings() -> Iterator[None]:
    with _DRAWING, style.context(["default", {**_LOOK, **rc()}]):
        yield


def _figure(scene: Scene) -> Figure:
    if scene.view == "log":
        return _log_figure(scene)
    if scene.view == "talk":
        return _talk_figure(scene)
    if scene.view == "frames":
        return _frames_figure(scene)
    figure = _sheet(scene, _HEIGHT_IN)
    left = figure.add_axes(_LEFT)
    if scene.view == "heading":
        draw_dial(left, scene)
        draw_turned(figure.add_axes(_UPPER_RIGHT), scene)
    else:
        draw_plan(left, scene)
        draw_speed(figure.add_axes(_UPPER_RIGHT), scene)
    upper = figure.axes[-1]
    upper.tick_params(labelbottom=False)
    lower = figure.add_axes(_LOWER_RIGHT, sharex=upper)
    draw_yaw_rate(lower, scene)
    _align(upper, lower)
    return figure


def _log_figure(scene: Scene) -> Figure:
    above_in, below_in, log_in = 1.1, 0.7, (row_count(scene) + 1.7) * _LOG_ROW_IN
    height_in = above_in + log_in + below_in
    figure = _sheet(scene, height_in)
    draw_log(figure.add_axes((0.035, below_in / height_in, 0.93, log_in / height_in)), scene)
    return figure


def _talk_figure(scene: Scene) -> Figure:
    above_in, below_in, lanes_in = 1.1, 0.7, (lane_count(scene) + 0.6) * _LANE_IN
    height_in = above_in + lanes_in + below_in
    figure = _sheet(scene, height_in)
    draw_talk(figure.add_axes((0.2, below_in / height_in, 0.77, lanes_in / height_in)), scene)
    return figure


def _frames_figure(scene: Scene) -> Figure:
    """Draw the pictures of a PyBullet world, three in a row, with their times."""
    figure = _sheet(scene, _HEIGHT_IN)
    pictures = scene.trajectory.pictures if scene.trajectory is not None else ()
    shown = min(_FRAME_ROWS * _FRAMES_ACROSS, len(pictures))
    chosen = [pictures[round(i * (len(pictures) - 1) / max(shown - 1, 1))] for i in range(shown)]
    for number, picture in enumerate(chosen):
        row, column = divmod(number, _FRAMES_ACROSS)
        axes = figure.add_axes((0.03 + 0.32 * column, 0.44 - 0.42 * row, 0.3, 0.37))
        axes.imshow(imread(io.BytesIO(picture.png), format="png"), interpolation="bilinear")
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set(visible=True, color=palette.FAINT)
        axes.set_title(quantity.number(picture.t_ns / 1e9, "s"), fontsize=10.5, color=palette.MUTED)
    return figure


def _sheet(scene: Scene, height_in: float) -> Figure:
    figure = Figure(figsize=(_WIDTH_IN, height_in), dpi=_DPI, facecolor=palette.PAPER)
    FigureCanvasAgg(figure)
    _heading(figure, scene, height_in)
    return figure


def _align(upper: Axes, lower: Axes) -> None:
    for axes in (upper, lower):
        axes.yaxis.set_label_coords(-0.13, 0.5)


def _heading(figure: Figure, scene: Scene, height_in: float) -> None:
    upper, lower = 1 - 0.44 / height_in, 1 - 0.76 / height_in
    figure.text(0.03, upper, clipped(drawable(scene.title), 60), fontsize=19, va="center")
    colour = palette.PASSED if scene.full else palette.FAILED
    mark = "✓ " if scene.full else ""
    figure.text(0.975, upper, f"{mark}{scene.score}", fontsize=17, va="center", ha="right", color=colour)
    summary = clipped(drawable(scene.summary), _SUMMARY_COLUMNS)
    figure.text(0.03, lower, summary, fontsize=10.5, va="center", color=palette.MUTED)
