"""PNG files of the grader's own, written and read without a library: a file is a row of named chunks."""

import struct
import zlib
from collections.abc import Iterable, Iterator
from typing import Final

_TRUE_COLOUR, _PALETTE = 2, 3
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
    head = struct.pack(">IIBBBBB", width, height, 8, _PALETTE if palette else _TRUE_COLOUR, 0, 0, 0)
    parts = [(b"IHDR", head), (b"IDAT", zlib.compress(rows, 6)), (b"IEND", b"")]
    if palette:
        parts.insert(1, (b"PLTE", palette))
    return file_of(parts)


def file_of(chunks: Iterable[tuple[bytes, bytes]]) -> bytes:
    """Return the file that consists of chunks: kind and content of each."""
    return _SIGNATURE + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )


def chunks_of(png: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Yield the chunks of a file that `file_of` made: kind and content of each."""
    at = len(_SIGNATURE)
    while at < len(png):
        (length,) = struct.unpack_from(">I", png, at)
        yield png[at + 4 : at + 8], png[at + 8 : at + 8 + length]
        at += length + 12
