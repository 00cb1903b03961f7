"""Merge what the episode saw and what the sandbox saw into one account of a run.

The script's own EXIT frame is believed for *how* it ended (it can only make its own feedback worse); limits,
signals and tampering are the sandbox's to say, and count only when the script had not ended before.
"""

from grader.contracts.errors import InfrastructureError
from grader.contracts.outcome import RunOutcome, RunStatus, StudentError
from grader.jail.report import JailReport, Verdict
from grader.sim.episode import EpisodeResult
from grader.sim.frames import EXCEPTION, FINISHED, STALLED, SYNTAX_ERROR, Exit

INTERRUPTED_NOTE = "interrupted"
"""Sent by the shim when the horizon's Ctrl+C is raised."""

_KILLED = {
    Verdict.CRASHED: RunStatus.CRASHED,
    Verdict.CPU_LIMIT: RunStatus.CPU_LIMIT,
    Verdict.MEMORY_LIMIT: RunStatus.MEMORY_LIMIT,
    Verdict.OUTPUT_LIMIT: RunStatus.OUTPUT_LIMIT,
    Verdict.STALLED: RunStatus.STALLED,
    Verdict.PROTOCOL: RunStatus.PROTOCOL,
    Verdict.FORBIDDEN: RunStatus.FORBIDDEN,
}
_ENDED = {STALLED: RunStatus.STALLED, SYNTAX_ERROR: RunStatus.SYNTAX_ERROR, FINISHED: RunStatus.FINISHED}


def merge(episode: EpisodeResult, jail: JailReport) -> RunOutcome:
    """Return the run's outcome.

    Raises:
        InfrastructureError: the sandbox says that the host, not the script, was at fault.
    """
    if jail.verdict is Verdict.INFRASTRUCTURE:
        raise InfrastructureError(f"the sandbox failed: {jail.detail or 'no reason given'}")
    status = _status(episode, jail)
    exit_frame = episode.exit
    error = _error(exit_frame)
    after_interrupt = exit_frame is not None and exit_frame.after_interrupt
    return RunOutcome(
        status=status,
        duration_ns=episode.duration_ns,
        exit_code=exit_frame.exit_code if exit_frame is not None else jail.exit_code,
        signal=jail.signal if status is RunStatus.CRASHED else None,
        error=None if after_interrupt else error,
        cleanup_error=error if after_interrupt else None,
        detail=_detail(status, episode, jail),
        stdout=jail.stdout,
        stderr=jail.stderr,
        nodes=episode.nodes,
        endpoints=episode.endpoints,
        logs=episode.logs,
        logs_dropped=episode.logs_dropped,
        notes=tuple(note for note in episode.notes if note.code != INTERRUPTED_NOTE),
        command_count=episode.command_count,
        nonfinite_commands=episode.nonfinite_commands,
        first_command_ns=episode.first_command_ns,
        last_command_ns=episode.last_command_ns,
    )


def _status(episode: EpisodeResult, jail: JailReport) -> RunStatus:
    if episode.violation is not None:
        return RunStatus.PROTOCOL
    exit_frame = episode.exit
    if exit_frame is not None:
        if exit_frame.after_interrupt:
            return RunStatus.INTERRUPTED
        if exit_frame.reason == EXCEPTION:
            out_of_memory = exit_frame.exception_type == MemoryError.__name__
            return RunStatus.MEMORY_LIMIT if out_of_memory else RunStatus.CRASHED
        return _ENDED[exit_frame.reason]
    if any(note.code == INTERRUPTED_NOTE for note in episode.notes):
        return RunStatus.INTERRUPTED  # would not end after Ctrl+C; at home a second one would follow
    return _KILLED.get(jail.verdict, RunStatus.FINISHED)


def _error(exit_frame: Exit | None) -> StudentError | None:
    if exit_frame is None or exit_frame.reason not in (EXCEPTION, SYNTAX_ERROR):
        return None
    return StudentError(
        type=exit_frame.exception_type,
        message=exit_frame.message,
        line=exit_frame.line or None,
        traceback=exit_frame.detail,
    )


def _detail(status: RunStatus, episode: EpisodeResult, jail: JailReport) -> str:
    if episode.violation is not None:
        return episode.violation
    if episode.exit is not None:
        return episode.exit.detail if episode.exit.reason == STALLED else ""
    return "" if status is RunStatus.INTERRUPTED else jail.detail
