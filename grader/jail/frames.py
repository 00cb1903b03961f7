"""Cut the bytes a confined process sends into frames, trusting none of them."""

import struct
from typing import Final

from grader.contracts.errors import ProtocolError
from grader.jail import policy

_HEADER: Final = struct.Struct("<I")


def pack(body: bytes) -> bytes:
    """Return `body` as a frame: its length as u32, little-endian, then itself."""
    return _HEADER.pack(len(body)) + body


class FrameReader:
    """Collects bytes in pieces of any size and gives back frames.

    A frame's length is checked before anything is kept for it, and the number of frames and bytes of a whole
    run is bounded.
    """

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._position = 0
        self._frames = 0
        self._received_bytes = 0

    @property
    def pending_bytes(self) -> int:
        """Bytes received that have not been given back."""
        return len(self._buffer) - self._position

    def feed(self, data: bytes) -> None:
        """Take `data` as received.

        Raises:
            ProtocolError: the run has sent more than `policy.CHANNEL_MAX_BYTES`.
        """
        self._received_bytes += len(data)
        if self._received_bytes > policy.CHANNEL_MAX_BYTES:
            raise ProtocolError(f"more than {policy.CHANNEL_MAX_BYTES} bytes were sent")
        del self._buffer[: self._position]
        self._position = 0
        self._buffer += data

    def next(self) -> bytes | None:
        """Return the body of the next frame, or None while it is not complete.

        Raises:
            ProtocolError: its length is impossible, or the run has sent more than `policy.FRAMES_MAX`.
        """
        start = self._position + _HEADER.size
        if len(self._buffer) < start:
            return None
        (length,) = _HEADER.unpack_from(self._buffer, self._position)
        if not 1 <= length <= policy.FRAME_MAX_BYTES:
            raise ProtocolError(f"a frame announced a length of {length} bytes")
        if len(self._buffer) < start + length:
            return None
        if self._frames == policy.FRAMES_MAX:
            raise ProtocolError(f"more than {policy.FRAMES_MAX} messages were sent")
        self._frames += 1
        self._position = start + length
        return bytes(self._buffer[start : self._position])
