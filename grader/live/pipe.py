"""Messages between the service and the process of a live car, over one stream socket. Both are trusted."""

import struct
from typing import Final, NamedTuple

OPEN, TEXT, CLOSE = 1, 2, 3
"""Kinds: a client came; a frame of it or for it; it is gone, or must go with the status in `slot`."""

HEAD: Final = struct.Struct("<IBIHH")
"""Bytes that follow, kind, client, slot, depth."""


class Parcel(NamedTuple):
    """One message. `slot` and `depth`: as in `grader.sim.rosbridge.bridge.Out`."""

    kind: int
    client: int
    slot: int = 0
    depth: int = 0
    text: bytes = b""


def pack(parcel: Parcel) -> bytes:
    """Return the bytes of a message."""
    kind, client, slot, depth, text = parcel
    return HEAD.pack(len(text), kind, client, slot, depth) + text


def unpack_head(head: bytes) -> tuple[int, Parcel]:
    """Return how many bytes of text follow, and the message without them."""
    length, kind, client, slot, depth = HEAD.unpack(head)
    return length, Parcel(kind, client, slot, depth)
