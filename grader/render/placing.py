"""Labels that do not cover each other nor the path: greedy placement around their anchors."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from matplotlib.text import Annotation

from grader.contracts.figure import Point
from grader.contracts.trajectory import Floats
from grader.render import palette

Box = tuple[float, float, float, float]
"""Left, bottom, right and top, in pixels. Thousands are tried for one picture, so they are plain numbers."""

# Places that are tried around an anchor: directions, off the preferred one, and distances.
_ANGLES_DEG = (0, 25, -25, 50, -50, 80, -80, 115, -115, 150, -150, 180)
_GAPS_PT = (6, 10, 15, 22, 32, 46)
_PADDING_PX = 2.0
_INK_CLEARANCE_PX = 4.0
_FRAME_PX = 5.0

# What a place costs. To cover another label or to leave the panel costs most, because then something cannot be
# read. To cover a point of the path costs as much as 17 px of distance.
_PRICE_COVERED = 60.0  # for a whole label
_PRICE_OUTSIDE = 80.0  # for a whole label
_PRICE_PER_INK = 1.2  # for each point of the path, which stand 5 px apart
_PRICE_PER_PX = 0.07
_PRICE_PER_TURN = 0.35  # for each direction further down the list


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
        taken: boxes already used.
    """

    axes: Axes
    ink_px: Floats
    taken: list[Box] = field(default_factory=list)

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
        padding = _PADDING_PX + (_FRAME_PX if label.boxed else 0.0)
        half = np.array([size.width / 2 + padding, size.height / 2 + padding])
        places = _candidates(label.away, half, scale)
        page = self.axes.bbox.extents
        box, least = page, float("inf")
        for offset, price in places:
            if price < least:  # the price is a lower bound: covering something only adds to it
                tried = _box(anchor + offset, half)
                cost = self._cost(tried, page) + price
                if cost < least:
                    box, least = tried, cost
        left, bottom, right, top = box
        centre = np.array([left + right, bottom + top]) / 2
        text.set_position(tuple((centre - anchor) / scale))
        self.taken.append(box)

    def block(self, at_m: Point, half_px: float) -> None:
        """Keep labels off a marker."""
        centre = np.asarray(self.axes.transData.transform(at_m))
        self.taken.append(_box(centre, np.array([half_px, half_px])))

    def _cost(self, box: Box, page: Box) -> float:
        covered = sum(_overlap(box, other) for other in self.taken)
        left, bottom, right, top = box
        x_px, y_px = self.ink_px[:, 0], self.ink_px[:, 1]
        inside = (
            (x_px > left - _INK_CLEARANCE_PX)
            & (x_px < right + _INK_CLEARANCE_PX)
            & (y_px > bottom - _INK_CLEARANCE_PX)
            & (y_px < top + _INK_CLEARANCE_PX)
        )
        area = (right - left) * (top - bottom)
        outside = area - _overlap(box, page)
        unreadable = (_PRICE_COVERED * covered + _PRICE_OUTSIDE * outside) / area
        return unreadable + _PRICE_PER_INK * float(inside.sum())


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
        path_effects=[] if label.boxed else [withStroke(linewidth=2.5, foreground=palette.PAPER)],
        zorder=9,
    )


def _candidates(away: Point, half: Floats, scale: float) -> Iterator[tuple[Floats, float]]:
    """Yield offsets of the box's centre in pixels, each with the price of leaving the preferred place."""
    preferred = float(np.arctan2(away[1], away[0]))
    for gap in _GAPS_PT:
        for j, degrees in enumerate(_ANGLES_DEG):
            angle = preferred + np.deg2rad(degrees)
            direction = np.array([np.cos(angle), np.sin(angle)])
            reaches = half / np.maximum(np.abs(direction), 1e-9)
            # Past the nearer of the box's sides it clears the anchor, past both also a corner's two lines.
            for reach in (reaches.min(), min(reaches.max(), 2 * half.max())):
                distance = gap * scale + float(reach)
                yield direction * distance, _PRICE_PER_PX * distance + _PRICE_PER_TURN * j


def _box(centre: Floats, half: Floats) -> Box:
    (left, bottom), (right, top) = (centre - half).tolist(), (centre + half).tolist()
    return left, bottom, right, top


def _overlap(one: Box, other: Box) -> float:
    left, bottom, right, top = one
    other_left, other_bottom, other_right, other_top = other
    width = min(right, other_right) - max(left, other_left)
    height = min(top, other_top) - max(bottom, other_bottom)
    return max(width, 0.0) * max(height, 0.0)
