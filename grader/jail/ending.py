"""How a run ends: the clocks that can end it, what the kernel says of its end, and the account that is kept.

The sandbox only says *how* a process ended (`RunEnd`). What that means for the student is decided in
`grader.grading.outcome`, together with what the simulator saw.
"""

import os
import signal
import time
from typing import Final, NamedTuple

from grader.contracts.assignment import Limits
from grader.contracts.outcome import Stream
from grader.contracts.python import StrEnum
from grader.contracts.record import Record, field
from grader.jail import bounds
from grader.jail.process import ProcessHandle

TICK_NS: Final = 5_000_000
"""How often the clocks are read while nothing happens."""

_OUT_OF_MEMORY: Final = (signal.SIGABRT, signal.SIGSEGV, signal.SIGBUS)
"""Signals by which C code ends that does not handle a failed allocation."""
_NEARLY_ALL: Final = 0.9


class RunEnd(StrEnum):
    """How a confined process ended, seen from outside."""

    FINISHED = "finished"  # it exited, or was closed by the episode after its last frame
    CRASHED = "crashed"  # a fatal signal
    CPU_LIMIT = "cpu_limit"
    MEMORY_LIMIT = "memory_limit"
    OUTPUT_LIMIT = "output_limit"
    STALLED = "stalled"  # every thread slept in the kernel while the episode waited for it
    PROTOCOL = "protocol"  # a frame of impossible length, or half a frame at the end
    FORBIDDEN = "forbidden"  # ended by the system call filter, or for its number of threads
    INFRASTRUCTURE = "infrastructure"


class Ending(NamedTuple):
    """How a run ended and what is known about it: the first four fields of its `JailReport`."""

    end: RunEnd
    detail: str = ""
    exit_code: int | None = None
    signal: str | None = None


class JailReport(Record):
    """The account of one run.

    `cpu_ns`, `wall_ns` and `peak_bytes` are measurements, and so are the streams unless `settled`.

    Attributes:
        detail: one plain English sentence, empty when there is nothing to say.
        exit_code: None unless the process exited by itself.
        signal: name of the signal that ended it by its own doing, or None.
        cpu_ns: user and system time of all threads.
        wall_ns: from the start of the script to the end of the process.
        peak_bytes: largest resident set, the warm interpreter included.
        settled: whether `stdout` and `stderr` would be the same if the script ran again. They are not when
            a script was still busy printing at the moment at which a clock ended it.
    """

    end: RunEnd
    detail: str = ""
    exit_code: int | None = None
    signal: str | None = None
    cpu_ns: int = 0
    peak_bytes: int = 0
    wall_ns: int = 0
    stdout: Stream = field(default_factory=Stream)
    stderr: Stream = field(default_factory=Stream)
    settled: bool = True


class Clocks:
    """How much CPU time, real sleep and wall time a run has used, and when it was last busy.

    The wall limit is the script's, as the CPU limit is: it ends what waits without computing. Time in which the
    host let the script or the grader wait for a processor does not count towards it.
    """

    def __init__(self, process: ProcessHandle, limits: Limits) -> None:
        self._process = process
        self._limits = limits
        self._start_ns = self._last_ns = time.monotonic_ns()
        self._wall_grant_ns = int(limits.wall_s * 1e9)
        self._wall_deadline_ns = self._start_ns + self._wall_grant_ns
        self._longest_ns = int(bounds.longest_run_s(limits.wall_s) * 1e9)
        self._half_ns = self._start_ns + self._wall_grant_ns // 2
        self._cpu_grant_ns = int(limits.cpu_s * 1e9)
        self._cpu_deadline_ns = process.cpu_ns() + self._cpu_grant_ns
        self._next_count_ns = 0
        self._progress = (0, 0)  # beyond the wall limit: when CPU time last grew, and to what
        self._work_ns: int | None = None  # CPU time of the thread that serves the script
        self._work_start_ns = 0
        self._paused_ns = 0
        self._pressed_ns: int | None = None  # what the host had waited for its disks at half time
        self._last_look_ns: int | None = None
        self._idle_ns = 0
        self._busy = False
        self._busy_cpu_ns = self._busy_idle_ns = 0
        self._looked_cpu_ns = 0

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
        """Do not count sleep up to now: nobody was waiting for the script."""
        self._last_look_ns = None

    def look(self) -> int:
        """Return the CPU time used so far, and remember it if the script was busy since the last look."""
        self._looked_cpu_ns = cpu_ns = self._process.cpu_ns()
        if self._busy:
            self._busy, self._busy_cpu_ns, self._busy_idle_ns = False, cpu_ns, self._idle_ns
        return cpu_ns

    def passed_limit(self) -> Ending | None:
        """Return the end that a passed limit means, or None while there is time left."""
        cpu_ns = self.look()
        if cpu_ns > self._cpu_deadline_ns:
            return Ending(RunEnd.CPU_LIMIT, self.cpu_text)
        now_ns, work_ns = time.monotonic_ns(), time.thread_time_ns()
        self._note_pause(now_ns, work_ns)
        if work_ns - self._work_start_ns > bounds.WORK_PER_CPU * self._limits.cpu_s * 1e9:
            return Ending(
                RunEnd.CPU_LIMIT, "answering its messages took too much of the simulator's CPU time"
            )
        if now_ns >= self._next_count_ns:
            self._next_count_ns = now_ns + TICK_NS
            # Where the kernel counts them, it has refused one before. Elsewhere the host would run out of them.
            if self._process.threads() > self._limits.threads + 1:
                return Ending(RunEnd.FORBIDDEN, f"more than {self._limits.threads} threads ran at once")
        if now_ns > self._half_ns and self._pressed_ns is None:
            self._pressed_ns = disk_pressure_ns()
        return self._at_wall_limit(now_ns, cpu_ns) if now_ns > self._wall_deadline_ns else None

    def _note_pause(self, now_ns: int, work_ns: int) -> None:
        """Add up how long this side neither computed nor waited for the script: the host kept it waiting."""
        if self._work_ns is None:
            self._work_ns = self._work_start_ns = work_ns
        paused_ns = now_ns - self._last_ns - (work_ns - self._work_ns)
        if paused_ns > 4 * TICK_NS:  # it waits for the script a tick at a time
            self._paused_ns += paused_ns
        self._last_ns, self._work_ns = now_ns, work_ns

    def _at_wall_limit(self, now_ns: int, cpu_ns: int) -> Ending | None:
        """Extend the wall limit by the time that the host kept the run waiting; else return why the run ends."""
        elapsed_ns = now_ns - self._start_ns
        host_ns = min(self._paused_ns + self._waited_ns(elapsed_ns, cpu_ns), elapsed_ns)
        if cpu_ns > self._progress[1]:
            self._progress = (now_ns, cpu_ns)
        starved = now_ns - self._progress[0] > bounds.STARVED_NS
        left_ns = self._wall_grant_ns + host_ns - elapsed_ns
        enough = bounds.ENOUGH_SILENT_CPU if self.was_quiet(RunEnd.CPU_LIMIT) else bounds.ENOUGH_CPU
        enough_s = enough * self._limits.cpu_s
        if left_ns > 0 and self._used_ns(cpu_ns) > enough_s * 1e9:
            spent = f"{enough_s:g} s of CPU time"  # not what was used, which differs from time to time
            return Ending(RunEnd.CPU_LIMIT, f"no end after {spent}, for which a busy host took long")
        if left_ns > 0 and not starved and elapsed_ns < self._longest_ns:
            self._wall_deadline_ns = now_ns + min(max(left_ns, TICK_NS), bounds.STARVED_NS // 2)
            return None
        if left_ns > 0:
            return Ending(RunEnd.INFRASTRUCTURE, f"no end after {elapsed_ns / 1e9:.0f} s on a busy host")
        if disk_pressure_ns() - (self._pressed_ns or 0) > (now_ns - self._half_ns) // 2:
            return Ending(
                RunEnd.INFRASTRUCTURE, f"no end after {elapsed_ns / 1e9:.0f} s: the host's disk is slow"
            )
        return Ending(
            RunEnd.STALLED, f"no end after {self._limits.wall_s:g} s, most of which the script spent waiting"
        )

    def _used_ns(self, cpu_ns: int) -> int:
        return cpu_ns - self._cpu_deadline_ns + self._cpu_grant_ns

    def _waited_ns(self, elapsed_ns: int, cpu_ns: int) -> int:
        """Return how long the script was ready and got no processor."""
        waited_ns = self._process.waited_ns()
        if waited_ns is not None:
            return waited_ns
        idle_ns = elapsed_ns - self._used_ns(cpu_ns)
        return idle_ns if os.getloadavg()[0] > (os.cpu_count() or 1) else 0

    def sleeps_for_ever(self) -> bool:
        """Add up how long the script slept while the episode waited for it; return whether that is too long."""
        now_ns = time.monotonic_ns()
        if self._last_look_ns is not None and self._process.sleeps():
            # Add a few ticks at most: this process, or the whole machine, may have been paused since.
            self._idle_ns += min(now_ns - self._last_look_ns, 4 * TICK_NS)
        self._last_look_ns = now_ns
        return self._idle_ns > bounds.IDLE_LIMIT_NS

    def exhausted(self, cpu_ns: int) -> bool:
        """Return whether a process that stood at `cpu_ns` had no CPU time left."""
        return cpu_ns >= self._cpu_deadline_ns

    def was_quiet(self, end: RunEnd) -> bool:
        """Return whether a script ended by a clock had been silent for the second half of its time.

        Then what it had sent and printed does not depend on the moment of the kill.
        """
        if self._busy:
            return False
        if end is RunEnd.STALLED:
            return self._idle_ns - self._busy_idle_ns >= bounds.IDLE_LIMIT_NS // 2
        return self._looked_cpu_ns - self._busy_cpu_ns >= self._used_ns(self._looked_cpu_ns) // 2


def disk_pressure_ns() -> int:
    """Return how long so far something on this host waited for a disk or for memory; 0 where it is not counted."""
    total_us = 0
    for kind in ("io", "memory"):
        try:
            with open(f"/proc/pressure/{kind}", encoding="ascii") as file:
                total_us += int(file.readline().rpartition("=")[2])
        except (OSError, ValueError):
            continue
    return total_us * 1000


class KernelAccount(Record):
    """What the kernel says of a process that was reaped.

    Attributes:
        wait_status: as `os.waitpid` returns it.
        by_itself: it had ended before the grader ended it.
        cpu_ns: user and system time it had used just before.
        peak_bytes: its largest resident set.
    """

    wait_status: int
    by_itself: bool
    cpu_ns: int
    peak_bytes: int


def explain(account: KernelAccount, clocks: Clocks, memory_bytes: int, *, cut_frame: bool) -> Ending:
    """Return how a process ended that reached no limit of the grader's own.

    `memory_bytes`: private memory it was granted. `cut_frame`: the last frame it sent is incomplete.
    """
    if os.WIFEXITED(account.wait_status):
        code = os.WEXITSTATUS(account.wait_status)
        if cut_frame:
            return Ending(RunEnd.PROTOCOL, "the last frame is incomplete", exit_code=code)
        return Ending(RunEnd.FINISHED, exit_code=code)
    number = os.WTERMSIG(account.wait_status)
    if number == signal.SIGKILL:
        return _explain_kill(account, clocks, memory_bytes)
    if number == signal.SIGXCPU:
        return Ending(RunEnd.CPU_LIMIT, clocks.cpu_text)
    name = _name_of(number)
    if number == signal.SIGSYS:
        return Ending(RunEnd.FORBIDDEN, "a system call of another architecture was made", signal=name)
    if number in _OUT_OF_MEMORY and account.peak_bytes >= _NEARLY_ALL * memory_bytes:
        return Ending(RunEnd.MEMORY_LIMIT, f"{name} with all memory in use", signal=name)
    return Ending(RunEnd.CRASHED, f"the process was ended by {name}", signal=name)


def _explain_kill(account: KernelAccount, clocks: Clocks, memory_bytes: int) -> Ending:
    """Return who sent SIGKILL. It was not the script: the system call filter refuses that."""
    if not account.by_itself:
        return Ending(RunEnd.FINISHED)
    if clocks.exhausted(account.cpu_ns):
        return Ending(RunEnd.CPU_LIMIT, clocks.cpu_text)
    if account.peak_bytes >= memory_bytes:  # a host that is short of memory ends the largest process first
        return Ending(RunEnd.MEMORY_LIMIT, "the host ran out of memory, and this script had its fill")
    return Ending(RunEnd.INFRASTRUCTURE, "the process was killed from outside the grader", signal="SIGKILL")


def _name_of(number: int) -> str:
    """Return the name of a signal; most real-time signals have only a number."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
