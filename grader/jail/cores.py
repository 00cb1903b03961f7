"""Keep on one core what takes turns: this process and a confined one, or the threads of that. For speed only.

Waking a thread on another core has to wait until that core has left its sleep: on a virtual machine a question
and its answer take half a millisecond, but some 15 us on one core. The kernel's scheduler does not see that the
two never run at the same time, and spreads them. Where the host allows no affinity, nothing happens here.
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
    """A core for every thread of the process `pid`, and at times for this thread too."""

    def __init__(self, pid: int) -> None:
        self._pid = pid
        self._claim: _socket.socket | None = None
        self._core: int | None = None
        self._before: set[int] = set()
        self._is_shared = self._has_threads = False

    def share(self) -> None:
        """Keep both processes on one core that no other pair uses. Idempotent."""
        if self._is_shared or (core := self._take_core(beside_us=False)) is None:
            return
        try:
            os.sched_setaffinity(0, {core})
            self._is_shared = True
        except OSError:
            self.leave()

    def part(self) -> None:
        """Free this process from the core; the other one, too, unless its threads take turns."""
        if not self._has_threads:
            self.leave()
        elif self._is_shared:
            self._is_shared = False
            with suppress(OSError):
                os.sched_setaffinity(0, self._before)

    def gather(self) -> None:
        """Keep the threads of the other process on one core until `leave`: only one of them runs at a time."""
        self._has_threads = True
        self._take_core(beside_us=True)

    def leave(self) -> None:
        """Free both processes from their core. Idempotent."""
        if self._claim is None:
            return
        self._claim.close()
        self._claim = self._core = None
        with suppress(OSError):
            if self._is_shared:
                self._is_shared = False
                os.sched_setaffinity(0, self._before)
            self._move(self._pid, self._before)

    def _take_core(self, *, beside_us: bool) -> int | None:
        """Keep the other process on a core that is free; return that core, None if there is none."""
        if self._claim is not None or not hasattr(os, "sched_setaffinity"):
            return self._core
        try:
            self._before = os.sched_getaffinity(0)
            self._core = self._claim_one(beside_us=beside_us)
            if self._core is not None:
                self._move(self._pid, {self._core})
        except OSError:
            self.leave()
        return self._core

    def _claim_one(self, *, beside_us: bool) -> int | None:
        """Claim a core, the present one or, `beside_us`, another, if it is free; None when every one is taken."""
        here = libc.present_core()
        for core in sorted(self._before, key=lambda core: ((core == here) is beside_us, core)):
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
        """Restrict every thread of `pid` to `cores`, which the threads that it starts later inherit."""
        for thread in os.listdir(f"/proc/{pid}/task"):
            with suppress(ProcessLookupError):  # it has ended meanwhile; the others must move all the same
                os.sched_setaffinity(int(thread), cores)
