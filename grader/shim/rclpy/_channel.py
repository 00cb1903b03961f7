"""The channel to the episode as a plain descriptor: neither `socket` nor its imports are needed."""

from __future__ import annotations

import os

_end_process = os._exit
_read, _write = os.read, os.write


class Descriptor:
    """What the link reads from and writes to.

    When the episode has closed its end, nobody wants to know more: the process ends.
    """

    def __init__(self, number: int) -> None:
        self._number = number

    def sendall(self, data: bytes, /) -> None:
        view = memoryview(data)
        try:
            while view:
                view = view[_write(self._number, view) :]
        except OSError:
            _end_process(0)

    def recv(self, size: int, /) -> bytes:
        data = _read(self._number, size)
        if not data:
            _end_process(0)
        return data
