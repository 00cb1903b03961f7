"""What happened when a script ran: how it ended, what it said, what it connected to, what it answered."""

import re
from collections.abc import Mapping

from grader.contracts.python import StrEnum
from grader.contracts.record import Record, field

SHOWN_CHARACTERS = 16_384
"""How much of each captured stream a page or a JSON document shows; the report has more."""

SHOWN_LOGS = 200
"""How many messages of a run are shown, from the first one on; the report has all."""


_FRAME = re.compile(r'^ *File "([^"\n]*)", line (\d+)', re.MULTILINE)
LOG_LEVELS: Mapping[int, str] = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}


class Blame(StrEnum):
    """Whose fault the end of a run is. A fault of the grader has no outcome: the script is run again."""

    NOBODY = "nobody"
    STUDENT = "student"


class RunStatus(StrEnum):
    """How one run of a script ended."""

    FINISHED = "finished"  # main returned, or SystemExit
    INTERRUPTED = "interrupted"  # still running at the horizon and ended by the virtual Ctrl+C: normal
    SYNTAX_ERROR = "syntax_error"
    CRASHED = "crashed"  # uncaught exception, or a fatal signal
    STALLED = "stalled"  # every thread waits for something that can never happen
    CPU_LIMIT = "cpu_limit"
    MEMORY_LIMIT = "memory_limit"
    OUTPUT_LIMIT = "output_limit"
    FORBIDDEN = "forbidden"  # asked for something the sandbox refuses
    PROTOCOL = "protocol"  # tampered with the channel to the simulator

    @property
    def blame(self) -> Blame:
        """Whose fault this status is."""
        return Blame.NOBODY if self in (RunStatus.FINISHED, RunStatus.INTERRUPTED) else Blame.STUDENT


class Stream(Record):
    """Captured text of one output stream, decoded with replacement; the middle of a long one is dropped."""

    text: str = ""
    dropped_bytes: int = 0


class StudentError(Record):
    """The exception that ended the script, in the student's own terms.

    Attributes:
        type: exception class name, e.g. ``AssertionError``.
        message: its text, bounded.
        line: 1-based line in the student's file of the innermost student frame, or None.
        traceback: the student's frames only, as Python prints them.
    """

    type: str
    message: str
    line: int | None
    traceback: str

    @property
    def file(self) -> str:
        """The file that `line` is in, as the traceback names it; empty where it names none at that line."""
        return next(
            (name for name, line in reversed(_FRAME.findall(self.traceback)) if line == str(self.line)), ""
        )


class Endpoint(Record):
    """A publisher, subscription, service or client that the script created.

    Attributes:
        kind: ``publisher``, ``subscription``, ``service`` or ``client``.
        count: messages published or requests sent (0 for the others).
    """

    kind: str
    node: str
    name: str
    type: str
    count: int = 0


class LogRecord(Record):
    """One message that reached /rosout. `level` is a key of `LOG_LEVELS`."""

    t_ns: int
    level: int
    name: str
    message: str

    @property
    def level_name(self) -> str:
        """The level as rcutils prints it."""
        return LOG_LEVELS.get(self.level, str(self.level))


class Note(Record):
    """Something worth telling the student that costs nothing, by a stable code, with bounded text."""

    code: str
    text: str = ""


class RunOutcome(Record):
    """Everything about one run except where the car went. Deterministic: no wall-clock quantity.

    Attributes:
        duration_ns: virtual time at which the script ended.
        first_command_ns / last_command_ns: virtual instants of velocity commands, or None.
        detail: one plain sentence from the machinery (which call waits for what, which call was refused).
        cleanup_error: exception raised after the virtual Ctrl+C; costs nothing.
        nodes: fully qualified names in order of creation.
        logs: at most 2000 records; `logs_dropped` counts the rest.
        command_count: velocity commands accepted by the car's topic.
        nonfinite_commands: commands with a NaN or infinite component (taken as zero).
    """

    status: RunStatus
    duration_ns: int
    exit_code: int | None = None
    signal: str | None = None
    error: StudentError | None = None
    cleanup_error: StudentError | None = None
    detail: str = ""
    stdout: Stream = field(default_factory=Stream)
    stderr: Stream = field(default_factory=Stream)
    nodes: tuple[str, ...] = ()
    endpoints: tuple[Endpoint, ...] = ()
    logs: tuple[LogRecord, ...] = ()
    logs_dropped: int = 0
    notes: tuple[Note, ...] = ()
    command_count: int = 0
    nonfinite_commands: int = 0
    first_command_ns: int | None = None
    last_command_ns: int | None = None

    @property
    def blame(self) -> Blame:
        """Whose fault the end of the run is."""
        return self.status.blame

    @property
    def heard(self) -> tuple[str, ...]:
        """The topics that the script subscribed to."""
        return tuple(endpoint.name for endpoint in self.endpoints if endpoint.kind == "subscription")

    @property
    def hears(self) -> bool:
        """Whether the script subscribed to anything."""
        return bool(self.heard)
