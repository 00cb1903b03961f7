"""PNG files written by hand, read by a library."""

import io

import numpy as np
from matplotlib.image import imread

from grader.formats.png import png_of


def read(data: bytes) -> np.ndarray:
    return np.round(np.asarray(imread(io.BytesIO(data), format="png"))[:, :, :3] * 255.0).astype(np.uint8)


def test_colours_survive() -> None:
    pixels = np.arange(3 * 4 * 3, dtype=np.uint8).reshape(3, 4, 3) * 7
    assert (read(png_of(4, 3, pixels.tobytes())) == pixels).all()


def test_a_palette_is_looked_up() -> None:
    palette = bytes((10, 20, 30, 200, 100, 50))
    shown = read(png_of(2, 1, bytes((1, 0)), palette))
    assert shown.tolist() == [[[200, 100, 50], [10, 20, 30]]]
