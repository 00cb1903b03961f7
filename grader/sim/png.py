"""PNG files, written by hand: a picture of a few thousand pixels needs no library."""

import struct
import zlib
from typing import Final

TRUE_COLOUR, PALETTE = 2, 3
_SIGNATURE: Final = b"\x89PNG\r\n\x1a\n"


def png_of(width: int, height: int, pixels: bytes, palette: bytes = b"") -> bytes:
    """Return a file of a picture.

    Args:
        width: in pixels.
        height: in pixels.
        pixels: row by row from the top; three bytes each, red, green, blue, or one, a place in the palette.
        palette: three bytes for each colour; empty: the pixels are colours themselves.
    """
    stride = width if palette else 3 * width
    rows = b"".join(b"\0" + pixels[start : start + stride] for start in range(0, stride * height, stride))
    head = struct.pack(">IIBBBBB", width, height, 8, PALETTE if palette else TRUE_COLOUR, 0, 0, 0)
    parts = [(b"IHDR", head), (b"IDAT", zlib.compress(rows, 6)), (b"IEND", b"")]
    if palette:
        parts.insert(1, (b"PLTE", palette))
    return _SIGNATURE + b"".join(_chunk(*part) for part in parts)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
