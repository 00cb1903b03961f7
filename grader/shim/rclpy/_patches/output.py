"""What the script prints, counted: a run that prints too much ends at the same byte each time.

The sandbox bounds output as well, but notices a flood only when it comes round to reading it. Counting here
covers `print`, the streams and the loggers; a script that writes to a descriptor itself meets the sandbox.
"""

from __future__ import annotations

import os
import sys
from io import BufferedWriter, RawIOBase, TextIOWrapper

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, NoReturn

_write = os.write


class OutputBudget:
    """Bytes the run may still print, on all streams together."""

    def __init__(self) -> None:
        self.most_bytes: int | None = None
        self._left: int | None = None
        self._end: Callable[[], NoReturn] | None = None

    def limit(self, most_bytes: int | None, end: Callable[[], NoReturn]) -> None:
        """Have `end` called, which does not return, once more than `most_bytes` (None: any) are printed."""
        self.most_bytes = self._left = most_bytes
        self._end = end

    def write(self, descriptor: int, data: Any) -> int:
        """Write `data`, or what the budget still allows of it and then end the run.

        Raises OSError: the descriptor is closed.
        """
        if self._left is None or self._end is None:
            return _write(descriptor, data)
        view = memoryview(data)
        if len(view) <= self._left:
            written = _write(descriptor, view)
            self._left -= written
            return written
        while self._left:
            self._left -= _write(descriptor, view[: self._left])
        return self._end()


budget = OutputBudget()


class _Raw(RawIOBase):
    """A descriptor for writing whose bytes are counted."""

    mode = "wb"

    def __init__(self, descriptor: int, name: str) -> None:
        super().__init__()
        self.name = name
        self._descriptor = descriptor

    def fileno(self) -> int:
        return self._descriptor

    def writable(self) -> bool:
        return True

    def write(self, data: Any, /) -> int:
        return budget.write(self._descriptor, memoryview(data).cast("B"))


def open_streams() -> None:
    """Give the script counted streams, encoded as on a PC.

    Flushed line by line, as on a terminal: what was printed survives a kill at the CPU limit.
    """
    for descriptor, name, errors in ((1, "stdout", "strict"), (2, "stderr", "backslashreplace")):
        raw = BufferedWriter(_Raw(descriptor, f"<{name}>"))
        stream = TextIOWrapper(raw, "utf-8", errors, line_buffering=True)
        setattr(stream, "mode", "w")  # noqa: B010 - as the interpreter's own streams have it
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)
