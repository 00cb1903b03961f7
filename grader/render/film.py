"""Pictures of a PyBullet world as one animated PNG (W3C, "PNG", third edition, 11.3.5)."""

import struct
from collections.abc import Sequence
from itertools import count, pairwise
from typing import Final

from grader.contracts.trajectory import Picture
from grader.formats.png import chunks_of, file_of

_LAST_MS: Final = 2_000
"""How long the last picture stays before the film starts again."""


def film(pictures: Sequence[Picture]) -> bytes:
    """Return a film of the pictures, each shown until the time of the next.

    There is at least one. All have the same size, and `grader.formats.png` wrote them.
    """
    numbers = count()
    shown_ms = [max(round((after.t_ns - before.t_ns) / 1e6), 1) for before, after in pairwise(pictures)]
    parts = []
    for number, (picture, ms) in enumerate(zip(pictures, [*shown_ms, _LAST_MS], strict=True)):
        chunks = dict(chunks_of(picture.png))
        if number == 0:
            parts += [(b"IHDR", chunks[b"IHDR"]), (b"acTL", struct.pack(">II", len(pictures), 0))]
        size = struct.unpack(">II", chunks[b"IHDR"][:8])
        parts.append(
            (b"fcTL", struct.pack(">IIIIIHHBB", next(numbers), *size, 0, 0, min(ms, 0xFFFF), 1_000, 0, 0))
        )
        data = chunks[b"IDAT"]
        parts.append((b"IDAT", data) if number == 0 else (b"fdAT", struct.pack(">I", next(numbers)) + data))
    return file_of([*parts, (b"IEND", b"")])
