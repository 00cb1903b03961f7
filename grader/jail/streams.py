"""Bounded capture of what a script prints: the head and the tail are kept, the middle is counted."""

import os
from collections import deque

from grader.contracts.outcome import Stream
from grader.jail import policy

_READ_BYTES = 65_536
_READS_PER_DRAIN = 8


class Capture:
    """Reads one pipe without blocking and keeps its first and last 64 KiB.

    What comes after `limit_bytes` is counted but not kept: where a flood is cut then depends on the script,
    not on how fast it was read.

    Attributes:
        total_bytes: everything read so far.
        ended: every writer has closed its end.
    """

    def __init__(self, descriptor: int, limit_bytes: int) -> None:
        self.descriptor = descriptor
        self._limit_bytes = limit_bytes
        self.total_bytes = 0
        self.ended = False
        self._head = bytearray()
        self._tail: deque[bytes] = deque()
        self._tail_bytes = 0
        os.set_blocking(descriptor, False)

    def drain(self) -> bool:
        """Take what the pipe holds; return whether there was anything (at most half a MiB per call)."""
        for turn in range(_READS_PER_DRAIN):
            try:
                data = os.read(self.descriptor, _READ_BYTES)
            except BlockingIOError:
                return turn > 0
            if not data:
                self.ended = True
                return turn > 0
            self._keep(data)
        return True

    def _keep(self, data: bytes) -> None:
        within_limit = max(0, self._limit_bytes - self.total_bytes)
        self.total_bytes += len(data)
        data = data[:within_limit]
        room = policy.STREAM_HEAD_BYTES - len(self._head)
        self._head += data[:room]
        rest = data[room:] if room else data
        if not rest:
            return
        self._tail.append(rest)
        self._tail_bytes += len(rest)
        while self._tail_bytes - len(self._tail[0]) >= policy.STREAM_TAIL_BYTES:
            self._tail_bytes -= len(self._tail.popleft())

    def close(self) -> None:
        """Close the pipe; what was captured stays."""
        os.close(self.descriptor)

    def stream(self) -> Stream:
        """Return the captured text, decoded with replacement."""
        tail = b"".join(self._tail)[-policy.STREAM_TAIL_BYTES :]
        dropped = min(self.total_bytes, self._limit_bytes) - len(self._head) - len(tail)
        head = bytes(self._head)
        if not dropped:
            return Stream(text=(head + tail).decode(errors="replace"))
        marker = f"\n… {dropped} bytes left out …\n"
        text = head.decode(errors="replace") + marker + tail.decode(errors="replace")
        return Stream(text=text, dropped_bytes=dropped)
