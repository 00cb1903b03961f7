"""Marks that plan view and dial share: where the car started and where it came to rest."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path

from grader.contracts.figure import Point
from grader.render import palette
from grader.render.scene import Scene

_DART = np.array([(1.0, 0.0), (-0.75, 0.68), (-0.38, 0.0), (-0.75, -0.68), (1.0, 0.0)])


def draw_start(axes: Axes, at: Point, heading_rad: float, scene: Scene) -> None:
    """Mark the start by a dart that points along the car's heading."""
    cosine, sine = np.cos(heading_rad), np.sin(heading_rad)
    dart = Path(_DART @ np.array([[cosine, sine], [-sine, cosine]]), closed=True)
    axes.plot(
        [at[0]], [at[1]], marker=dart, ls="none", color=palette.START, ms=18, mec="white", mew=1.0, zorder=8,
        label=scene.word("start"),
    )  # fmt: skip


def draw_end(axes: Axes, at: Point, scene: Scene) -> None:
    """Mark the last place of the car."""
    axes.plot(
        [at[0]], [at[1]], "s", ls="none", color=palette.INK, ms=6.5, mec="white", zorder=7,
        label=scene.word("stop"),
    )  # fmt: skip
