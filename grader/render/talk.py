"""A conversation over time: a lane for each topic, service and action, with what was said and who said it."""

from collections.abc import Sequence
from typing import Final

from matplotlib.axes import Axes

from grader.contracts.conversation import Saying
from grader.render import palette
from grader.render.scene import Scene
from grader.render.typeface import clipped, drawable

_MOST_LANES: Final = 12
_NANO: Final = 1e-9
_NAME_COLUMNS: Final = 26
_TEXT_COLUMNS: Final = 70
_LABELS: Final = 2  # sayings of a lane that are written out: the first one, and the first that has no answer


def _lanes(scene: Scene) -> dict[str, list[Saying]]:
    """Return what was said by topic, service or action, in the order in which they first occur."""
    lanes: dict[str, list[Saying]] = {}
    for saying in scene.trajectory.sayings if scene.trajectory is not None else ():
        lanes.setdefault(saying.name, []).append(saying)
    return dict(list(lanes.items())[:_MOST_LANES])


def lane_count(scene: Scene) -> int:
    """Return the number of lanes that `draw_talk` leaves room for."""
    return max(len(_lanes(scene)), 2)


def draw_talk(axes: Axes, scene: Scene) -> None:
    """Draw a lane for each topic and service: to the script a triangle, from it a dot, a call from end to end."""
    lanes = _lanes(scene)
    end_s = max(scene.outcome.duration_ns * _NANO, 1e-3)
    axes.set_xlim(-0.01 * end_s, 1.02 * end_s)
    axes.set_ylim(-lane_count(scene) + 0.4, 0.7)
    axes.set_yticks([-i for i in range(len(lanes))])
    axes.set_yticklabels([clipped(drawable(name), _NAME_COLUMNS) for name in lanes])
    axes.set_xlabel(scene.word("time_axis"))
    axes.grid(axis="x", color=palette.GRID, lw=0.8)
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    for i, said in enumerate(lanes.values()):
        axes.axhline(-i, color=palette.FAINT, lw=0.8, zorder=1)
        for saying in said:
            _mark(axes, saying, -i)
        _label(axes, said, -i, end_s)


def _mark(axes: Axes, saying: Saying, y: float) -> None:
    at_s = saying.t_ns * _NANO
    if saying.way in ("in", "out"):
        marker, colour = ("v", palette.COMMAND) if saying.way == "in" else ("o", palette.PASSED)
        axes.plot([at_s], [y], marker, color=colour, ms=6, mec="white", mew=0.6, zorder=4)
    elif saying.until_ns is None:
        axes.plot([at_s], [y], "X", color=palette.FAILED, ms=8, mec="white", zorder=4)
    else:
        colour = palette.COMMAND if saying.way == "call" else palette.PASSED
        until_s = saying.until_ns * _NANO
        axes.annotate(
            "", xy=(until_s, y), xytext=(at_s, y), zorder=3,
            arrowprops={"arrowstyle": "->", "color": colour, "lw": 1.6, "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip
        axes.plot([at_s], [y], "s", color=colour, ms=5, zorder=4)


def _label(axes: Axes, said: Sequence[Saying], y: float, end_s: float) -> None:
    silent = [each for each in said if each.way in ("call", "ask") and each.until_ns is None]
    for saying in list(dict.fromkeys([said[0], *silent[:1]]))[:_LABELS]:
        at_s = saying.t_ns * _NANO
        left = at_s < 0.5 * end_s
        axes.annotate(
            clipped(drawable(saying.text), _TEXT_COLUMNS), xy=(at_s, y), xytext=(0, 9), textcoords="offset points",
            va="bottom", ha="left" if left else "right", fontsize=9.0, color=palette.INK, zorder=5,
        )  # fmt: skip
