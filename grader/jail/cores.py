"""Keep this process and a confined one on one core while they take turns. A matter of speed only.

Whoever wakes a process on another core waits until that core has left its sleep: on a virtual machine a question
and its answer take half a millisecond, and some 15 us on one core. The kernel's scheduler does not see that the
two never run at the same time, and spreads them. Where it does not let us say so, nothing happens here.
"""

import _socket
import os
from contextlib import suppress

from grader.jail import libc

_CLAIM = "\0grader/core/{}"
"""Name of the socket that stands for a core.

Such a name belongs to one process at a time, ends with it, and is seen by every grading process of the host (or of
the container), whoever started it."""


class SharedCore:
    """A core for two: this thread and every thread of the process `pid`."""

    def __init__(self, pid: int) -> None:
        self._pid = pid
        self._claim: _socket.socket | None = None
        self._before: set[int] = set()

    def share(self) -> None:
        """Bring both onto one core that no other pair shares; harmless when they are there."""
        if self._claim is not None or not hasattr(os, "sched_setaffinity"):
            return
        try:
            self._before = os.sched_getaffinity(0)
            core = self._claim_one()
            if core is not None:
                self._move(self._pid, {core})  # whose refusal leaves this process where it is
                os.sched_setaffinity(0, {core})
        except OSError:
            self.part()

    def part(self) -> None:
        """Let both go where the kernel likes; harmless when they may."""
        if self._claim is None:
            return
        self._claim.close()
        self._claim = None
        with suppress(OSError):
            os.sched_setaffinity(0, self._before)
            self._move(self._pid, self._before)

    def _claim_one(self) -> int | None:
        """Claim a core, the present one if it is free; None when every one is taken."""
        here = libc.present_core()
        for core in sorted(self._before, key=lambda core: (core != here, core)):
            claim = _socket.socket(_socket.AF_UNIX, _socket.SOCK_DGRAM)
            try:
                claim.bind(_CLAIM.format(core))
            except OSError:
                claim.close()
                continue
            self._claim = claim
            return core
        return None

    def _move(self, pid: int, cores: set[int]) -> None:
        """Let every thread of `pid` run on `cores`; those it starts later take after them."""
        for thread in os.listdir(f"/proc/{pid}/task"):
            with suppress(ProcessLookupError):  # it has ended meanwhile; the others must move all the same
                os.sched_setaffinity(int(thread), cores)
