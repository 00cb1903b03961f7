"""What a camera above turtlesim's window sees: the line that was driven, and the turtle. As PNG, drawn by hand."""

import math
from typing import Final

from grader.contracts.assignment import WINDOW_M
from grader.formats.png import png_of
from grader.sim.car import PlanarPose

SIZE: Final = 222
"""Width and height of the picture, in pixels: one is 5 cm."""

_GROUND, _LINE, _BODY, _NOSE = range(4)
_PALETTE: Final = bytes((69, 86, 255, 179, 184, 255, 40, 120, 60, 240, 230, 80))
_BODY_M: Final = 0.25
_NOSE_M: Final = 0.35
_PIXEL_M: Final = WINDOW_M / SIZE


class TopView:
    """The ground as pixels, row by row from the top."""

    def __init__(self) -> None:
        self._ground = bytearray(SIZE * SIZE)

    def driven(self, pose: PlanarPose) -> None:
        """Draw that the turtle was there."""
        place = _pixel(pose[0], pose[1])
        if place is not None:
            self._ground[place] = _LINE

    def png(self, pose: PlanarPose) -> bytes:
        """Return the picture with the turtle in `pose`."""
        picture = bytearray(self._ground)
        x, y, heading = pose
        reach = round(_BODY_M / _PIXEL_M)
        for dx in range(-reach, reach + 1):
            for dy in range(-reach, reach + 1):
                if math.hypot(dx, dy) <= reach:
                    _dot(picture, x + dx * _PIXEL_M, y + dy * _PIXEL_M, _BODY)
        for step in range(round(_NOSE_M / _PIXEL_M)):
            _dot(
                picture,
                x + step * _PIXEL_M * math.cos(heading),
                y + step * _PIXEL_M * math.sin(heading),
                _NOSE,
            )
        return png_of(SIZE, SIZE, bytes(picture), _PALETTE)


def _pixel(x_m: float, y_m: float) -> int | None:
    if not (0.0 <= x_m <= WINDOW_M and 0.0 <= y_m <= WINDOW_M):
        return None
    column = min(int(x_m / _PIXEL_M), SIZE - 1)
    row = min(int((WINDOW_M - y_m) / _PIXEL_M), SIZE - 1)
    return row * SIZE + column


def _dot(pixels: bytearray, x_m: float, y_m: float, color: int) -> None:
    place = _pixel(x_m, y_m)
    if place is not None:
        pixels[place] = color
