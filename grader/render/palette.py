"""Colours, line styles and marks that the plots share.

The hues are those of Okabe and Ito's palette ("Color Universal Design", 2008), told apart by readers of any
colour vision; each difference that matters also has its own line style or marker.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path

from grader.contracts.figure import Point
from grader.render.scene import Scene

INK = "#222222"
MUTED = "#6b6b6b"
FAINT = "#c9c9c9"
GRID = "#ececec"
PAPER = "#ffffff"

PASSED = "#0072B2"  # blue
FAILED = "#D55E00"  # vermillion
PASSED_TINT = "#dcebf5"
FAILED_TINT = "#fbe6d9"
START = "#009E73"  # bluish green
COMMAND = "#E69F00"  # orange
IDEAL = "#d6d6d6"
WALL = "#555555"

FAILED_DASHES = (0, (3.2, 1.4))
_DART = np.array([(1.0, 0.0), (-0.75, 0.68), (-0.38, 0.0), (-0.75, -0.68), (1.0, 0.0)])


def colour_of(ok: bool | None) -> str:
    """Return the colour of something within tolerance, out of it, or without one."""
    if ok is None:
        return INK
    return PASSED if ok else FAILED


def draw_start(axes: Axes, at: Point, heading_rad: float, scene: Scene) -> None:
    """Mark the start by a dart that points along the car's heading."""
    cosine, sine = np.cos(heading_rad), np.sin(heading_rad)
    dart = Path(_DART @ np.array([[cosine, sine], [-sine, cosine]]), closed=True)
    axes.plot(
        [at[0]], [at[1]], marker=dart, ls="none", color=START, ms=18, mec="white", mew=1.0, zorder=8,
        label=scene.word("start"),
    )  # fmt: skip


def draw_end(axes: Axes, at: Point, scene: Scene) -> None:
    """Mark the last place of the car."""
    axes.plot(
        [at[0]], [at[1]], "s", ls="none", color=INK, ms=6.5, mec="white", zorder=7,
        label=scene.word("stop"),
    )  # fmt: skip
