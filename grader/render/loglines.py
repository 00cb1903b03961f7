"""Log messages over time, for exercises in which nothing moves."""

from matplotlib.axes import Axes

from grader.contracts.outcome import Blame, LogRecord
from grader.render import palette
from grader.render.labels import status_word
from grader.render.scene import Scene
from grader.render.typeface import clipped, drawable

_MOST_LINES = 12
_FEWEST_ROWS = 2
_NANO = 1e-9
_TEXT_COLUMNS = 78
_MARKERS = {10: ("o", palette.MUTED), 20: ("o", palette.PASSED), 30: ("^", palette.COMMAND)}
_SEVERE = ("X", palette.FAILED)


def row_count(scene: Scene) -> int:
    """Return the number of rows that `draw_log` leaves room for."""
    return min(max(len(scene.outcome.logs), _FEWEST_ROWS), _MOST_LINES)


def draw_log(axes: Axes, scene: Scene) -> None:
    """Draw the run as a bar along time and one row for each log message, at most `_MOST_LINES`."""
    outcome = scene.outcome
    logs = outcome.logs[:_MOST_LINES]
    end_s = max(outcome.duration_ns * _NANO, 1e-3)
    rows = row_count(scene)
    axes.set_xlim(-0.02 * end_s, 1.02 * end_s)
    axes.set_ylim(-rows - 0.8, 0.9)
    axes.set_yticks([])
    axes.set_xlabel(scene.word("time_axis"))
    axes.grid(axis="x", color=palette.GRID, lw=0.8)
    axes.spines["left"].set_visible(False)
    normal = outcome.blame is Blame.NOBODY
    fill, edge = (palette.PASSED_TINT, palette.PASSED) if normal else (palette.FAILED_TINT, palette.FAILED)
    axes.barh(0.35, end_s, height=0.5, color=fill, edgecolor=edge, lw=1.0, zorder=2)
    names = ", ".join(outcome.nodes) or scene.word("running")
    text = f"{names}  {status_word(outcome.status, scene.language)}"
    axes.text(
        end_s / 2, 0.35, clipped(drawable(text), 100), ha="center", va="center", fontsize=10.5, zorder=3
    )
    for i, record in enumerate(logs):
        _row(axes, record, -i - 0.7, end_s)
    _remark(axes, scene, len(logs), rows)


def _row(axes: Axes, record: LogRecord, y: float, end_s: float) -> None:
    seconds = record.t_ns * _NANO
    marker, colour = _MARKERS.get(record.level, _SEVERE)
    axes.plot([seconds, seconds], [y, 0.1], color=palette.FAINT, lw=0.9, zorder=1)
    axes.plot([seconds], [y], marker, color=colour, ms=8, mec="white", zorder=4)
    text = f"{seconds:.3f} s  {record.level_name}  [{record.name}]  {record.message}"
    left = seconds < 0.4 * end_s
    axes.annotate(
        clipped(drawable(text), _TEXT_COLUMNS), xy=(seconds, y), xytext=(10 if left else -10, 0),
        textcoords="offset points", va="center", ha="left" if left else "right",
        fontsize=10.5, color=palette.INK, zorder=5,
        bbox={"boxstyle": "square,pad=0.15", "fc": "white", "ec": "none"},
    )  # fmt: skip


def _remark(axes: Axes, scene: Scene, shown: int, rows: int) -> None:
    left_out = len(scene.outcome.logs) + scene.outcome.logs_dropped - shown
    if not shown:
        axes.text(0.5, 0.5, scene.word("no_logs"), transform=axes.transAxes, ha="center", fontsize=14,
                  color=palette.FAILED)  # fmt: skip
    elif left_out:
        axes.text(0.5, -rows - 0.5, scene.word("more_logs", count=left_out), ha="center", fontsize=10,
                  transform=axes.get_yaxis_transform(), color=palette.MUTED)  # fmt: skip
