"""Merge what the episode saw and what the sandbox saw into one account of a run.

The script's own EXIT frame is believed for *how* it ended (it can only make its own feedback worse: the episode
takes a syntax error, which costs no attempt, only as the first frame); limits, signals and tampering are the
sandbox's to say, and count only when the script had not ended before.

The account is the same each time a script is graded. What would depend on the moment of a kill is left out:
the exit code and the output of a process that was ended for tampering, and the output of one that was still
printing when a clock ended it. The trajectory of such a script is kept, because its driving earns points.
"""

import os
import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from grader.contracts.assignment import Distro
from grader.contracts.errors import InfrastructureError
from grader.contracts.outcome import LogRecord, Note, RunOutcome, RunStatus, Stream, StudentError
from grader.jail.ending import JailReport, RunEnd
from grader.jail.layers import standard_library
from grader.sim.episode import EpisodeResult
from grader.sim.frames import (
    EXCEPTION,
    FINISHED,
    INTERRUPTED_NOTE,
    PRINTED_TOO_MUCH,
    STALLED,
    SYNTAX_ERROR,
    TOO_MANY_STEPS,
    Exit,
)

FORBIDDEN_NOTE = "forbidden"
"""Names a call that is refused."""

THREAD_NOTE = "thread_exception"
"""Names the exception that ended a thread."""

CAUGHT_NOTE = "caught"
"""Names an error of the script's own text that something has caught."""

_STATUS_OF_KILL = {
    RunEnd.CRASHED: RunStatus.CRASHED,
    RunEnd.CPU_LIMIT: RunStatus.CPU_LIMIT,
    RunEnd.MEMORY_LIMIT: RunStatus.MEMORY_LIMIT,
    RunEnd.OUTPUT_LIMIT: RunStatus.OUTPUT_LIMIT,
    RunEnd.STALLED: RunStatus.STALLED,
    RunEnd.PROTOCOL: RunStatus.PROTOCOL,
    RunEnd.FORBIDDEN: RunStatus.FORBIDDEN,
}
_STATUS_OF_END = {
    STALLED: RunStatus.STALLED,
    SYNTAX_ERROR: RunStatus.SYNTAX_ERROR,
    FINISHED: RunStatus.FINISHED,
    PRINTED_TOO_MUCH: RunStatus.OUTPUT_LIMIT,
    TOO_MANY_STEPS: RunStatus.CPU_LIMIT,
}
_LESS_THAN_MEMORY = (RunStatus.FINISHED, RunStatus.INTERRUPTED, RunStatus.STALLED, RunStatus.CPU_LIMIT)
"""Ends that are explained by a thread that ran out of memory."""

_REFUSED: Final = re.compile(r"\[Errno (?:1|13|30)\]")
"""EPERM, EACCES, EROFS: an exception that wraps a PermissionError quotes it (``<urlopen error [Errno 1] …``)."""

_THREAD_OUT_OF_MEMORY: Final = re.compile(r".*, line \d+: MemoryError(?::|$)")
_ADDRESS: Final = re.compile(r" at 0x[0-9a-f]+>")
_MASKED: Final = " at 0x…>"
_ZIPPED: Final = os.path.join(
    os.path.dirname(standard_library()), "python{}{}.zip".format(*sys.version_info[:2])
)
_INSTALLED_HERE: Final = (
    str(Path(__file__).resolve().parents[1] / "shim"),
    os.path.dirname(os.path.dirname(np.__file__)),
    standard_library(),
    _ZIPPED,
)
_AT_HOME: Final[dict[Distro, tuple[str, ...]]] = {
    "humble": (
        "/opt/ros/humble/local/lib/python3.10/dist-packages",
        "/usr/lib/python3/dist-packages",
        "/usr/lib/python3.10",
        "/usr/lib/python310.zip",
    ),
    "jazzy": (
        "/opt/ros/jazzy/lib/python3.12/site-packages",
        "/usr/lib/python3/dist-packages",
        "/usr/lib/python3.12",
        "/usr/lib/python312.zip",
    ),
}
"""Folders of modules: ``cannot import name 'Node' from 'rclpy' (…)`` names one."""


def merge(episode: EpisodeResult, jail: JailReport, distro: Distro = "humble") -> RunOutcome:
    """Return the run's outcome, with texts as on a PC with `distro`.

    Raises InfrastructureError: the sandbox says that the host, not the script, was at fault.
    """
    if jail.end is RunEnd.INFRASTRUCTURE:
        raise InfrastructureError(f"the sandbox failed: {jail.detail or 'no reason given'}")
    if jail.end is RunEnd.FINISHED and not episode.heard and episode.violation is None:
        raise InfrastructureError(
            f"the sandbox's process ended with {jail.exit_code} before the script began"
        )
    status = _status(episode, jail)
    exit_frame = episode.exit if episode.violation is None else None
    error = _error(exit_frame, distro)
    after_interrupt = exit_frame is not None and exit_frame.after_interrupt
    stdout, stderr = _streams(episode, jail, distro)
    return RunOutcome(
        status=status,
        duration_ns=episode.duration_ns,
        exit_code=_exit_code(status, episode, jail),
        signal=jail.signal if status is RunStatus.CRASHED and exit_frame is None else None,
        error=None if after_interrupt else error,
        cleanup_error=error if after_interrupt else None,
        detail=masked(_detail(status, episode, jail), distro),
        stdout=stdout,
        stderr=stderr,
        nodes=episode.nodes,
        endpoints=episode.endpoints,
        logs=tuple(_masked_log(record, distro) for record in episode.logs),
        logs_dropped=episode.logs_dropped,
        notes=tuple(replace(note, text=masked(note.text, distro)) for note in _shown_notes(episode)),
        command_count=episode.command_count,
        nonfinite_commands=episode.nonfinite_commands,
        first_command_ns=episode.first_command_ns,
        last_command_ns=episode.last_command_ns,
    )


def _shown_notes(episode: EpisodeResult) -> Iterator[Note]:
    """Yield the notes that a report may show.

    A thread that fails after Ctrl+C, as at home, is no mistake; what was caught matters if nothing else failed.
    """
    exit_frame, interrupted = episode.exit, False
    failed = exit_frame is not None and exit_frame.reason == EXCEPTION and not exit_frame.after_interrupt
    failed = failed or any(note.code == THREAD_NOTE for note in episode.notes)
    for note in episode.notes:
        interrupted = interrupted or note.code == INTERRUPTED_NOTE
        failed_late = interrupted and note.code == THREAD_NOTE
        told_otherwise = failed and note.code == CAUGHT_NOTE
        if note.code != INTERRUPTED_NOTE and not failed_late and not told_otherwise:
            yield note


# ------------------------------------------------------------------------------------------------ status


def _status(episode: EpisodeResult, jail: JailReport) -> RunStatus:
    if episode.violation is not None:
        return RunStatus.PROTOCOL
    status = (
        _own_account(episode, episode.exit) if episode.exit is not None else _seen_from_outside(episode, jail)
    )
    if status in _LESS_THAN_MEMORY and _thread_without_memory(episode) is not None:
        return RunStatus.MEMORY_LIMIT
    return status


def _own_account(episode: EpisodeResult, exit_frame: Exit) -> RunStatus:
    if exit_frame.reason == PRINTED_TOO_MUCH:
        return RunStatus.OUTPUT_LIMIT
    if exit_frame.after_interrupt:
        return RunStatus.INTERRUPTED
    if exit_frame.reason != EXCEPTION:
        return _STATUS_OF_END[exit_frame.reason]
    if exit_frame.exception_type == MemoryError.__name__:
        return RunStatus.MEMORY_LIMIT
    return RunStatus.CRASHED if _refused_call(episode) is None else RunStatus.FORBIDDEN


def _seen_from_outside(episode: EpisodeResult, jail: JailReport) -> RunStatus:
    if any(note.code == INTERRUPTED_NOTE for note in episode.notes):
        return RunStatus.INTERRUPTED  # would not end after Ctrl+C; at home a second one would follow
    return _STATUS_OF_KILL.get(jail.end, RunStatus.FINISHED)


def _refused_call(episode: EpisodeResult) -> str | None:
    """Return the call whose refusal ended the script: the one the exception names, else the last refused."""
    ended = episode.exit
    if ended is None or ended.reason != EXCEPTION:
        return None
    if ended.exception_type != PermissionError.__name__ and not _REFUSED.search(ended.message):
        return None
    calls = [note.text for note in episode.notes if note.code == FORBIDDEN_NOTE]
    named = [call for call in calls if (target := call.partition(": ")[2]) and repr(target) in ended.message]
    return next(reversed(named or calls), None)


def _thread_without_memory(episode: EpisodeResult) -> str | None:
    noted = (note.text for note in episode.notes if note.code == THREAD_NOTE)
    return next((text for text in noted if _THREAD_OUT_OF_MEMORY.match(text)), None)


def _detail(status: RunStatus, episode: EpisodeResult, jail: JailReport) -> str:
    if episode.violation is not None:
        return episode.violation
    if status is RunStatus.FORBIDDEN and episode.exit is not None:
        return _refused_call(episode) or ""
    if status is RunStatus.MEMORY_LIMIT and (thread := _thread_without_memory(episode)) is not None:
        return thread
    if episode.exit is not None:
        if episode.exit.reason == TOO_MANY_STEPS and status is RunStatus.CPU_LIMIT:
            return f"more than {episode.most_steps} steps were made"
        return episode.exit.detail if episode.exit.reason in (STALLED, PRINTED_TOO_MUCH) else ""
    return "" if status is RunStatus.INTERRUPTED else jail.detail


# ------------------------------------------------------------------------------- exit code, error, output


def _exit_code(status: RunStatus, episode: EpisodeResult, jail: JailReport) -> int | None:
    """Return the exit code; None of a process that was, or may have been, ended before it could exit."""
    if status in (RunStatus.PROTOCOL, RunStatus.OUTPUT_LIMIT):
        return None
    return episode.exit.exit_code if episode.exit is not None else jail.exit_code


def _error(exit_frame: Exit | None, distro: Distro) -> StudentError | None:
    if exit_frame is None or exit_frame.reason not in (EXCEPTION, SYNTAX_ERROR):
        return None
    return StudentError(
        type=exit_frame.exception_type,
        message=masked(exit_frame.message, distro),
        line=exit_frame.line or None,
        traceback=masked(exit_frame.detail, distro),
    )


def ended_by_the_clock(episode: EpisodeResult, jail: JailReport) -> bool:
    """Return whether a clock ended the script: on a host that is less busy it might have come further."""
    return episode.exit is None and _status(episode, jail) is RunStatus.CPU_LIMIT


def is_repeatable(episode: EpisodeResult, jail: JailReport) -> bool:
    """Return whether the script would print the same if it were run again."""
    return jail.settled and episode.violation is None


def _streams(episode: EpisodeResult, jail: JailReport, distro: Distro) -> tuple[Stream, Stream]:
    if not is_repeatable(episode, jail):
        return Stream(), Stream()
    return masked_stream(jail.stdout, distro), masked_stream(jail.stderr, distro)


# ------------------------------------------------------------------------------- what differs between hosts


def masked(text: str, distro: Distro) -> str:
    """Return `text` with object addresses as ``0x…`` and modules where they are on a student's PC."""
    if " at 0x" in text:
        text = _ADDRESS.sub(_MASKED, text)
    for here, at_home in zip(_INSTALLED_HERE, _AT_HOME[distro], strict=True):
        text = text.replace(here, at_home)
    return text


def masked_stream(stream: Stream, distro: Distro) -> Stream:
    """Return `stream` masked, as ``<node at 0x7f1c…>`` becomes ``<node at 0x…>``."""
    return replace(stream, text=masked(stream.text, distro))


def _masked_log(record: LogRecord, distro: Distro) -> LogRecord:
    message = masked(record.message, distro)
    return record if message is record.message else replace(record, message=message)
