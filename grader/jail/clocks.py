"""The clocks of one run: how much CPU time, real sleep and wall time it has used, and when it was last busy."""

import time
from typing import Final

from grader.contracts.limits import Limits
from grader.jail import policy
from grader.jail.process import ProcessHandle
from grader.jail.report import Verdict

TICK_NS: Final = 5_000_000
"""How often they are read while nothing happens."""


class Clocks:
    """Reads the clocks of a process; `verdict` says when one has run out."""

    def __init__(self, process: ProcessHandle, limits: Limits) -> None:
        self._process = process
        self._limits = limits
        self._start_ns = time.monotonic_ns()
        self._wall_deadline_ns = self._start_ns + int(limits.wall_s * 1e9)
        self._cpu_grant_ns = int(limits.cpu_s * 1e9)
        self._cpu_deadline_ns = process.cpu_ns() + self._cpu_grant_ns
        self._last_look_ns: int | None = None
        self._idle_ns = 0
        self._busy = False
        self._busy_cpu_ns = self._busy_idle_ns = 0

    @property
    def wall_ns(self) -> int:
        """Time since the start."""
        return time.monotonic_ns() - self._start_ns

    @property
    def cpu_text(self) -> str:
        """What to say of a script that has used up its CPU time."""
        return f"more than {self._limits.cpu_s:g} s of CPU time were used"

    def limit_cpu(self, extra_s: float) -> None:
        """Leave at most `extra_s` more CPU seconds from now, and never more than there was."""
        deadline_ns = self._process.cpu_ns() + int(extra_s * 1e9)
        if deadline_ns < self._cpu_deadline_ns:
            self._cpu_deadline_ns, self._cpu_grant_ns = deadline_ns, int(extra_s * 1e9)

    def note_life(self) -> None:
        """Note that the script sent or printed something."""
        self._busy = True

    def forget_look(self) -> None:
        """Count no sleep up to now: the script was not the one to wait for."""
        self._last_look_ns = None

    def look(self) -> int:
        """Return the CPU time used so far, and remember it if the script was busy since the last look."""
        cpu_ns = self._process.cpu_ns()
        if self._busy:
            self._busy, self._busy_cpu_ns, self._busy_idle_ns = False, cpu_ns, self._idle_ns
        return cpu_ns

    def verdict(self) -> tuple[Verdict, str] | None:
        """Return the limit that has been passed, with a sentence, or None."""
        cpu_ns = self.look()
        if cpu_ns > self._cpu_deadline_ns:
            return Verdict.CPU_LIMIT, self.cpu_text
        if time.monotonic_ns() > self._wall_deadline_ns:
            return Verdict.INFRASTRUCTURE, f"no end after {self._limits.wall_s:g} s"
        return None

    def sleeps_for_ever(self) -> bool:
        """Add up how long the script was seen asleep although the episode waits for it; is it too long?"""
        now_ns = time.monotonic_ns()
        if self._last_look_ns is not None and self._process.sleeps():
            # No more than a few ticks at a time: this process, or the whole machine, may have been paused.
            self._idle_ns += min(now_ns - self._last_look_ns, 4 * TICK_NS)
        self._last_look_ns = now_ns
        return self._idle_ns > policy.IDLE_LIMIT_NS

    def exhausted(self, cpu_ns: int) -> bool:
        """Return whether a process that stood at `cpu_ns` had no CPU time left."""
        return cpu_ns >= self._cpu_deadline_ns

    def was_quiet(self, verdict: Verdict) -> bool:
        """Return whether a script ended by a clock had been silent for the second half of its time.

        Then what it had sent and printed does not depend on the moment of the kill.
        """
        if self._busy:
            return False
        if verdict is Verdict.STALLED:
            return self._idle_ns - self._busy_idle_ns >= policy.IDLE_LIMIT_NS // 2
        return self._cpu_deadline_ns - self._busy_cpu_ns >= self._cpu_grant_ns // 2
