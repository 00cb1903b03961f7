"""Labels that do not cover each other nor the path: greedy placement around their anchors."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from matplotlib.axes import Axes
from matplotlib.text import Annotation
from matplotlib.transforms import Bbox

from grader.contracts.figure import Point
from grader.contracts.trajectory import Floats

_ANGLES_DEG = (0, 25, -25, 50, -50, 80, -80, 115, -115, 150, -150, 180)
_RADII_PT = (13, 19, 27, 38, 52)
_PADDING_PX = 3.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Label:
    """A text to be put near a point.

    Attributes:
        at_m: the anchor, in data coordinates.
        away: preferred direction from the anchor, any length but zero.
        boxed: framed, to stand out from the rest.
    """

    at_m: Point
    text: str
    away: Point
    colour: str
    size_pt: float = 10.0
    boxed: bool = False


@dataclass(slots=True)
class Board:
    """The plan view while labels are put on it.

    Attributes:
        axes: with final limits and position.
        ink_px: (n, 2) points of what must stay readable, in pixels.
        taken: boxes already used, in pixels.
    """

    axes: Axes
    ink_px: Floats
    taken: list[Bbox] = field(default_factory=list)

    def put(self, labels: Iterable[Label]) -> None:
        """Place `labels` in this order, each where it disturbs least."""
        for label in labels:
            self._put(label)

    def _put(self, label: Label) -> None:
        text = _annotation(self.axes, label)
        canvas = self.axes.figure.canvas
        size = text.get_window_extent(canvas.get_renderer())  # type: ignore[attr-defined]
        scale = self.axes.figure.dpi / 72
        anchor = self.axes.transData.transform(label.at_m)
        best = min(
            _candidates(label.away),
            key=lambda offset: self._cost(_box(anchor, offset, scale, size), offset),
        )
        text.set_position((best[0], best[1]))
        self.taken.append(_box(anchor, best, scale, size))

    def _cost(self, box: Bbox, offset: tuple[float, float, float]) -> float:
        covered = sum(_overlap(box, other) for other in self.taken)
        inside = (
            (self.ink_px[:, 0] > box.x0)
            & (self.ink_px[:, 0] < box.x1)
            & (self.ink_px[:, 1] > box.y0)
            & (self.ink_px[:, 1] < box.y1)
        )
        frame = self.axes.bbox
        area = box.width * box.height
        outside = area - _overlap(box, frame)
        return 20 * (covered + outside) / area + 0.6 * float(inside.sum()) + offset[2]


def _annotation(axes: Axes, label: Label) -> Annotation:
    frame = (
        {"boxstyle": "round,pad=0.22", "fc": "white", "ec": label.colour, "lw": 1.0} if label.boxed else None
    )
    return axes.annotate(
        label.text,
        xy=label.at_m,
        xytext=(0.0, 0.0),
        textcoords="offset points",
        ha="center",
        va="center",
        color=label.colour,
        fontsize=label.size_pt,
        bbox=frame,
        zorder=9,
    )


def _candidates(away: Point) -> Sequence[tuple[float, float, float]]:
    """Return offsets (x, y) in points, each with the price of leaving the preferred place."""
    preferred = float(np.arctan2(away[1], away[0]))
    offsets = []
    for i, radius in enumerate(_RADII_PT):
        for j, degrees in enumerate(_ANGLES_DEG):
            angle = preferred + np.deg2rad(degrees)
            # Text is wider than high: sideways it needs more room to clear its anchor.
            x = float(np.cos(angle)) * radius * 1.5
            offsets.append((x, float(np.sin(angle)) * radius, 1.2 * i + 0.35 * j))
    return offsets


def _box(anchor: Floats, offset: tuple[float, float, float], scale: float, size: Bbox) -> Bbox:
    half_width, half_height = size.width / 2 + _PADDING_PX, size.height / 2 + _PADDING_PX
    x, y = anchor[0] + offset[0] * scale, anchor[1] + offset[1] * scale
    return Bbox.from_extents(x - half_width, y - half_height, x + half_width, y + half_height)


def _overlap(one: Bbox, other: Bbox) -> float:
    width = min(one.x1, other.x1) - max(one.x0, other.x0)
    height = min(one.y1, other.y1) - max(one.y0, other.y0)
    return max(width, 0.0) * max(height, 0.0)
