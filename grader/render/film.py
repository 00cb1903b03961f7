"""Pictures of a PyBullet world one after the other, as one animated PNG (W3C, "PNG", third edition, 11.3.5)."""

import struct
import zlib
from collections.abc import Iterator, Sequence
from itertools import count, pairwise
from typing import Final

from grader.contracts.trajectory import Picture

_SIGNATURE: Final = b"\x89PNG\r\n\x1a\n"
_LAST_MS: Final = 2_000
"""How long the last one stays before it begins anew."""


def film(pictures: Sequence[Picture]) -> bytes:
    """Return the pictures, one at least and all of one size, each shown until the time of the next.

    They are PNG files as the grader itself writes them.
    """
    numbers = count()
    shown_ms = [max(round((after.t_ns - before.t_ns) / 1e6), 1) for before, after in pairwise(pictures)]
    parts = []
    for number, (picture, ms) in enumerate(zip(pictures, [*shown_ms, _LAST_MS], strict=True)):
        chunks = dict(_chunks(picture.png))
        if number == 0:
            parts += [(b"IHDR", chunks[b"IHDR"]), (b"acTL", struct.pack(">II", len(pictures), 0))]
        size = struct.unpack(">II", chunks[b"IHDR"][:8])
        parts.append(
            (b"fcTL", struct.pack(">IIIIIHHBB", next(numbers), *size, 0, 0, min(ms, 0xFFFF), 1_000, 0, 0))
        )
        data = chunks[b"IDAT"]
        parts.append((b"IDAT", data) if number == 0 else (b"fdAT", struct.pack(">I", next(numbers)) + data))
    return _SIGNATURE + b"".join(_chunk(*part) for part in (*parts, (b"IEND", b"")))


def _chunks(png: bytes) -> Iterator[tuple[bytes, bytes]]:
    at = len(_SIGNATURE)
    while at < len(png):
        (length,) = struct.unpack_from(">I", png, at)
        yield png[at + 4 : at + 8], png[at + 8 : at + 8 + length]
        at += length + 12


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
