"""How one confined process ended, and what it used."""

from dataclasses import field
from enum import StrEnum

from grader.contracts.outcome import Stream
from grader.contracts.record import record


class Verdict(StrEnum):
    """How the process ended, seen from outside."""

    FINISHED = "finished"  # it exited, or was closed by the episode after its last frame
    CRASHED = "crashed"  # a fatal signal
    CPU_LIMIT = "cpu_limit"
    MEMORY_LIMIT = "memory_limit"
    OUTPUT_LIMIT = "output_limit"
    STALLED = "stalled"  # every thread slept in the kernel while the episode waited for it
    PROTOCOL = "protocol"  # a frame of impossible length, or half a frame at the end
    FORBIDDEN = "forbidden"  # ended by the system call filter
    INFRASTRUCTURE = "infrastructure"


@record
class JailReport:
    """The account of one run.

    `cpu_ns`, `wall_ns` and `peak_bytes` are measurements, and so are the streams unless `settled`.

    Attributes:
        exit_code: None unless the process exited by itself.
        signal: name of the signal that ended it by its own doing, or None.
        detail: one plain English sentence, empty when there is nothing to say.
        cpu_ns: user and system time of all threads.
        wall_ns: from the start of the script to the end of the process.
        peak_bytes: largest resident set, the warm interpreter included.
        settled: whether `stdout` and `stderr` would be the same if the script ran again. They are not when
            a script was still busy printing at the moment at which a clock ended it.
    """

    verdict: Verdict
    exit_code: int | None = None
    signal: str | None = None
    detail: str = ""
    cpu_ns: int = 0
    peak_bytes: int = 0
    wall_ns: int = 0
    stdout: Stream = field(default_factory=Stream)
    stderr: Stream = field(default_factory=Stream)
    settled: bool = True
