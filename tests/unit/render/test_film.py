"""The moving picture of a PyBullet world, read back by another library."""

import io

from PIL import Image

from grader.contracts.trajectory import Picture
from grader.formats.png import png_of
from grader.render.film import film

COLOURS = [(255, 0, 0), (0, 255, 0), (0, 0, 255)]


def test_it_shows_each_picture_until_the_next() -> None:
    made = [
        Picture(t_ns=number * 500_000_000, png=png_of(4, 3, bytes(colour) * 12))
        for number, colour in enumerate(COLOURS)
    ]
    with Image.open(io.BytesIO(film(made))) as read:
        assert (read.n_frames, read.size, read.info["loop"]) == (3, (4, 3), 0)
        for number, colour in enumerate(COLOURS):
            read.seek(number)
            assert read.convert("RGB").getpixel((3, 2)) == colour
            assert read.info["duration"] == (2_000 if number == 2 else 500)


def test_one_picture_stands_still() -> None:
    with Image.open(io.BytesIO(film([Picture(t_ns=0, png=png_of(2, 2, bytes(12)))]))) as read:
        assert (read.format, read.size) == ("PNG", (2, 2))
