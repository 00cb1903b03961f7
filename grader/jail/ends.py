"""Whose doing the end of a confined process was, told from what the kernel says of it."""

import os
import signal
from typing import Final, TypeAlias

from grader.contracts.record import record
from grader.jail.clocks import Clocks
from grader.jail.report import Verdict

Judgement: TypeAlias = tuple[Verdict, int | None, str | None, str]
"""Verdict, exit code, name of the fatal signal, sentence: as in `JailReport`."""

_OUT_OF_MEMORY: Final = (signal.SIGABRT, signal.SIGSEGV, signal.SIGBUS)
"""How C code ends that does not expect an allocation to fail."""
_NEARLY_ALL: Final = 0.9


@record
class End:
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


def judge(end: End, clocks: Clocks, memory_bytes: int, *, cut_frame: bool) -> Judgement:
    """Judge a process that no limit of the grader's own ended; `cut_frame`: its last frame is incomplete."""
    if os.WIFEXITED(end.wait_status):
        if cut_frame:
            return Verdict.PROTOCOL, os.WEXITSTATUS(end.wait_status), None, "the last frame is incomplete"
        return Verdict.FINISHED, os.WEXITSTATUS(end.wait_status), None, ""
    number = os.WTERMSIG(end.wait_status)
    name = _name_of(number)
    if number == signal.SIGXCPU:
        return Verdict.CPU_LIMIT, None, None, clocks.cpu_text
    if number == signal.SIGSYS:
        return Verdict.FORBIDDEN, None, name, "a system call of another architecture was made"
    if number != signal.SIGKILL:
        if number in _OUT_OF_MEMORY and end.peak_bytes >= _NEARLY_ALL * memory_bytes:
            return Verdict.MEMORY_LIMIT, None, name, f"{name} with all memory in use"
        return Verdict.CRASHED, None, name, f"the process was ended by {name}"
    verdict, detail = _judge_kill(end, clocks, memory_bytes)
    return verdict, None, name if verdict is Verdict.INFRASTRUCTURE else None, detail


def _name_of(number: int) -> str:
    """Return the name of a signal; most real-time signals have only a number."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _judge_kill(end: End, clocks: Clocks, memory_bytes: int) -> tuple[Verdict, str]:
    """Say whose SIGKILL it was: the script cannot send one."""
    if not end.by_itself:
        return Verdict.FINISHED, ""
    if clocks.exhausted(end.cpu_ns):
        return Verdict.CPU_LIMIT, clocks.cpu_text
    if end.peak_bytes >= memory_bytes:  # the host, short of memory, ends the hungriest first
        return Verdict.MEMORY_LIMIT, "the host ran out of memory, and this script had its fill"
    return Verdict.INFRASTRUCTURE, "the process was killed from outside the grader"
