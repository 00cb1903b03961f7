"""One account out of two: every way in which a script's own word and the sandbox's can meet."""

import os
import sys
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import grader
from grader.contracts.errors import InfrastructureError
from grader.contracts.outcome import LogRecord, Note, RunOutcome, RunStatus, Stream
from grader.contracts.trajectory import Trajectory
from grader.grading.outcome import ended_by_the_clock, is_repeatable, merge
from grader.jail.ending import JailReport, RunEnd
from grader.sim.episode import EpisodeResult
from grader.sim.frames import (
    EXCEPTION,
    FINISHED,
    PRINTED_TOO_MUCH,
    STALLED,
    SYNTAX_ERROR,
    TOO_MANY_STEPS,
    Exit,
)

ROS = "/opt/ros/humble/local/lib/python3.10/dist-packages"
DIST = "/usr/lib/python3/dist-packages"
PYTHON = "/usr/lib/python3.10"
INTERRUPTED = Note(code="interrupted")
FORBIDDEN = Note(code="forbidden", text="subprocess.Popen: ls")
JAIL = JailReport(end=RunEnd.FINISHED, exit_code=0, stdout=Stream(text="out\n"), stderr=Stream(text="err\n"))


def trajectory() -> Trajectory:
    one = np.zeros(1)
    return Trajectory(
        t_ns=np.zeros(1, np.int64), x_m=one, y_m=one, heading_rad=one, v_mps=one, w_radps=one, end_ns=0
    )


EPISODE = EpisodeResult(
    trajectory=trajectory(),
    exit=None,
    violation=None,
    duration_ns=5,
    nodes=("/n",),
    endpoints=(),
    logs=(),
    logs_dropped=3,
    notes=(),
    command_count=7,
    nonfinite_commands=1,
    first_command_ns=1,
    last_command_ns=4,
    sim_steps=9,
)


def ended(reason: int = FINISHED, **fields: object) -> Exit:
    plain = Exit(
        t_ns=5,
        reason=reason,
        after_interrupt=False,
        exit_code=0,
        exception_type="",
        message="",
        line=0,
        detail="",
    )
    return plain._replace(**fields)


def raised(kind: str, message: str = "", **fields: object) -> Exit:
    return ended(EXCEPTION, exit_code=1, exception_type=kind, message=message, line=4, detail="tb", **fields)


def outcome(
    exit: Exit | None = None,
    end: RunEnd = RunEnd.FINISHED,
    *notes: Note,
    violation: str | None = None,
    **report: object,
) -> RunOutcome:
    episode = replace(EPISODE, exit=exit, violation=violation, notes=notes)
    return merge(episode, replace(JAIL, end=end, **report))


EXITS = {
    "none": None,
    "finished": ended(),
    "crashed": raised("ValueError", "no"),
    "out of memory": raised("MemoryError"),
    "stalled": ended(STALLED, detail="main waits", exit_code=1),
    "syntax": ended(SYNTAX_ERROR, exception_type="SyntaxError", message="bad", line=2, exit_code=1),
    "printed": ended(PRINTED_TOO_MUCH, exit_code=1),
    "steps": ended(TOO_MANY_STEPS, exit_code=1),
    "interrupted": ended(after_interrupt=True, exit_code=130),
    "crashed in finally": raised("ValueError", after_interrupt=True),
    "refused": raised("PermissionError", "[Errno 1] Operation not permitted: 'ls'"),
}
OWN_WORD = {
    "finished": RunStatus.FINISHED,
    "crashed": RunStatus.CRASHED,
    "out of memory": RunStatus.MEMORY_LIMIT,
    "stalled": RunStatus.STALLED,
    "syntax": RunStatus.SYNTAX_ERROR,
    "printed": RunStatus.OUTPUT_LIMIT,
    "steps": RunStatus.CPU_LIMIT,
    "interrupted": RunStatus.INTERRUPTED,
    "crashed in finally": RunStatus.INTERRUPTED,
    "refused": RunStatus.FORBIDDEN,
}
SEEN = {
    RunEnd.FINISHED: RunStatus.FINISHED,
    RunEnd.CRASHED: RunStatus.CRASHED,
    RunEnd.CPU_LIMIT: RunStatus.CPU_LIMIT,
    RunEnd.MEMORY_LIMIT: RunStatus.MEMORY_LIMIT,
    RunEnd.OUTPUT_LIMIT: RunStatus.OUTPUT_LIMIT,
    RunEnd.STALLED: RunStatus.STALLED,
    RunEnd.PROTOCOL: RunStatus.PROTOCOL,
    RunEnd.FORBIDDEN: RunStatus.FORBIDDEN,
}


def test_a_process_that_ends_before_the_script_begins_is_no_fault_of_the_script() -> None:
    silent = replace(EPISODE, heard=False)
    with pytest.raises(InfrastructureError, match="ended with 70 before the script began"):
        merge(silent, JailReport(end=RunEnd.FINISHED, exit_code=70))
    killed = merge(silent, JailReport(end=RunEnd.MEMORY_LIMIT))  # a file that is too much to compile
    assert killed.status is RunStatus.MEMORY_LIMIT


@pytest.mark.parametrize(
    ("name", "violation", "end"), list(product(EXITS, [None, "ENTITY.t is negative"], RunEnd))
)
def test_every_combination(name: str, violation: str | None, end: RunEnd) -> None:
    """Infrastructure beats tampering, tampering beats the script's word, its word beats the sandbox's."""
    if end is RunEnd.INFRASTRUCTURE:
        with pytest.raises(InfrastructureError, match="no reason given"):
            outcome(EXITS[name], end, FORBIDDEN, violation=violation)
        return
    found = outcome(EXITS[name], end, FORBIDDEN, violation=violation, exit_code=None, detail="why")
    if violation is not None:
        assert (found.status, found.detail, found.exit_code) == (RunStatus.PROTOCOL, violation, None)
        assert (found.stdout, found.stderr) == (Stream(), Stream())
        return
    assert found.status is (SEEN[end] if name == "none" else OWN_WORD[name])
    assert (found.stdout, found.stderr) == (JAIL.stdout, JAIL.stderr)
    assert found.signal is None
    assert (found.nodes, found.command_count, found.duration_ns) == (("/n",), 7, 5)
    if name == "none":
        assert (found.detail, found.exit_code) == ("why", None)


def test_the_table_of_verdicts_is_complete() -> None:
    assert set(SEEN) | {RunEnd.INFRASTRUCTURE} == set(RunEnd)
    assert {status for status in RunStatus if status.blame == "student"} <= {
        *SEEN.values(),
        *OWN_WORD.values(),
    }


@pytest.mark.parametrize("end", [RunEnd.CPU_LIMIT, RunEnd.STALLED, RunEnd.OUTPUT_LIMIT])
def test_killed_within_the_grace_after_the_horizon_is_interrupted(end: RunEnd) -> None:
    found = outcome(None, end, INTERRUPTED, detail="more than 1 s")
    assert (found.status, found.detail, found.notes) == (RunStatus.INTERRUPTED, "", ())


def test_an_error_after_ctrl_c_costs_nothing() -> None:
    found = outcome(EXITS["crashed in finally"], RunEnd.FINISHED, INTERRUPTED)
    assert (found.error, found.cleanup_error and found.cleanup_error.type) == (None, "ValueError")


# ---------------------------------------------------------------------------------------------- forbidden


@pytest.mark.parametrize(
    "exit",
    [
        raised("PermissionError", "[Errno 1] Operation not permitted: 'ls'"),
        raised("PermissionError"),
        raised("OSError", "[Errno 30] Read-only file system: 'out.txt'"),
        raised("URLError", "<urlopen error [Errno 1] Operation not permitted>"),
        raised("error", "[Errno 13] Permission denied"),
    ],
)
def test_a_refusal_that_ended_the_script_is_forbidden(exit: Exit) -> None:
    found = outcome(exit, RunEnd.FINISHED, FORBIDDEN)
    assert (found.status, found.detail) == (RunStatus.FORBIDDEN, "subprocess.Popen: ls")
    assert found.error is not None
    assert found.error.line == 4


@pytest.mark.parametrize(
    ("exit", "notes"),
    [
        (raised("PermissionError", "[Errno 1] Operation not permitted"), ()),
        (raised("PermissionError", "mine"), (Note(code="discovery", text="x"),)),
        (raised("ValueError", "no"), (FORBIDDEN,)),
        (raised("OSError", "[Errno 2] No such file or directory: 'x'"), (FORBIDDEN,)),
        (raised("OSError", "[Errno 111] Connection refused"), (FORBIDDEN,)),
    ],
)
def test_other_errors_are_crashes(exit: Exit, notes: tuple[Note, ...]) -> None:
    assert outcome(exit, RunEnd.FINISHED, *notes).status is RunStatus.CRASHED


def test_a_refusal_that_the_script_survived_is_only_a_note() -> None:
    found = outcome(ended(), RunEnd.FINISHED, FORBIDDEN)
    assert (found.status, found.detail, found.notes) == (RunStatus.FINISHED, "", (FORBIDDEN,))


def test_the_call_named_by_the_exception_is_told_else_the_last_one() -> None:
    notes = [
        Note(code="forbidden", text=text) for text in ("os.system: ls", "open for writing: a.txt", "os.fork")
    ]
    exit = raised("PermissionError", "[Errno 13] Permission denied: 'a.txt'")
    assert outcome(exit, RunEnd.FINISHED, *notes).detail == "open for writing: a.txt"
    assert outcome(raised("PermissionError"), RunEnd.FINISHED, *notes).detail == "os.fork"


# ------------------------------------------------------------------------------------------------- memory

NO_MEMORY = Note(code="thread_exception", text="Thread-1 (work), line 12: MemoryError")


@pytest.mark.parametrize(
    ("exit", "end"),
    [
        (ended(), RunEnd.FINISHED),
        (ended(STALLED, detail="main waits"), RunEnd.FINISHED),
        (ended(after_interrupt=True), RunEnd.FINISHED),
        (None, RunEnd.CPU_LIMIT),
    ],
)
def test_a_thread_without_memory_explains_the_end(exit: Exit | None, end: RunEnd) -> None:
    found = outcome(exit, end, NO_MEMORY)
    assert (found.status, found.detail) == (RunStatus.MEMORY_LIMIT, NO_MEMORY.text)


@pytest.mark.parametrize(
    ("exit", "text", "status"),
    [
        (raised("ValueError", "no"), NO_MEMORY.text, RunStatus.CRASHED),
        (ended(), "Thread-1, line 3: ValueError: MemoryError", RunStatus.FINISHED),
        (ended(), "Thread-1, line 3: MemoryErrorOfMine", RunStatus.FINISHED),
    ],
)
def test_other_ends_and_other_threads(exit: Exit, text: str, status: RunStatus) -> None:
    assert outcome(exit, RunEnd.FINISHED, Note(code="thread_exception", text=text)).status is status


# ------------------------------------------------------------------------------------ the same every time


@pytest.mark.parametrize("exit", [None, ended(), ended(exit_code=3)])
@pytest.mark.parametrize(
    ("end", "exit_code"), [(RunEnd.FINISHED, 0), (RunEnd.FINISHED, None), (RunEnd.CPU_LIMIT, None)]
)
def test_tampering_looks_the_same_however_far_the_process_came(
    exit: Exit | None, end: RunEnd, exit_code: int | None
) -> None:
    found = outcome(exit, end, violation="x", exit_code=exit_code, stdout=Stream(text="some"))
    assert found == outcome(exit, RunEnd.FINISHED, violation="x", exit_code=0)


def test_output_that_depends_on_the_moment_of_a_kill_is_left_out() -> None:
    busy = outcome(None, RunEnd.CPU_LIMIT, settled=False)
    assert (busy.stdout, busy.stderr, busy.status) == (Stream(), Stream(), RunStatus.CPU_LIMIT)
    assert outcome(None, RunEnd.CPU_LIMIT).stdout == JAIL.stdout
    assert not is_repeatable(EPISODE, replace(JAIL, settled=False))
    assert not is_repeatable(replace(EPISODE, violation="x"), JAIL)
    assert is_repeatable(EPISODE, JAIL)


def test_a_signal_is_named_only_when_it_ended_the_script() -> None:
    assert outcome(None, RunEnd.CRASHED, signal="SIGSEGV", exit_code=None).signal == "SIGSEGV"
    assert outcome(ended(), RunEnd.CRASHED, signal="SIGSEGV").signal is None
    assert outcome(None, RunEnd.FORBIDDEN, signal="SIGSYS").signal is None


@pytest.mark.parametrize(
    ("raw", "shown"),
    [
        ("<__main__.Car object at 0x7f1c2d3e4f50>", "<__main__.Car object at 0x…>"),
        ("<function f at 0x55aa> and <f at 0x1>", "<function f at 0x…> and <f at 0x…>"),
        ("colour #0x7f, at 0x10, at 0xZZ>", "colour #0x7f, at 0x10, at 0xZZ>"),
        ("0x7f1c2d3e4f50", "0x7f1c2d3e4f50"),
        (f"({Path(grader.__file__).parent}/shim/rclpy/__init__.py)", f"({ROS}/rclpy/__init__.py)"),
        (f"{Path(os.__file__).parents[1]}/python3{sys.version_info.minor}.zip", "/usr/lib/python310.zip"),
        (f"from '{np.__file__}', '{os.__file__}'", f"from '{DIST}/numpy/__init__.py', '{PYTHON}/os.py'"),
    ],
)
def test_addresses_and_folders_of_the_host_are_masked_and_nothing_else(raw: str, shown: str) -> None:
    episode = replace(
        EPISODE,
        exit=raised("ValueError", raw)._replace(detail=raw),
        logs=(LogRecord(t_ns=1, level=20, name="n", message=raw),),
        notes=(Note(code="thread_exception", text=raw),),
    )
    found = merge(episode, replace(JAIL, stdout=Stream(text=raw, dropped_bytes=2), stderr=Stream(text=raw)))
    assert found.error is not None
    assert (found.error.message, found.error.traceback, found.logs[0].message) == (shown, shown, shown)
    assert (found.stdout, found.stderr.text) == (Stream(text=shown, dropped_bytes=2), shown)
    assert found.notes[0].text == shown
    stalled = merge(replace(EPISODE, exit=ended(STALLED, detail=raw)), JAIL)
    assert stalled.detail == shown


def test_jazzys_modules_are_shown_in_its_folders() -> None:
    raw = f"({Path(grader.__file__).parent}/shim/rclpy/__init__.py, {os.__file__})"
    episode = replace(EPISODE, exit=raised("ImportError", raw))
    found = merge(episode, JAIL, "jazzy")
    assert found.error is not None
    home = "/opt/ros/jazzy/lib/python3.12/site-packages"
    assert found.error.message == f"({home}/rclpy/__init__.py, /usr/lib/python3.12/os.py)"


def test_a_counted_limit_is_told_by_what_the_grader_allowed() -> None:
    episode = replace(
        EPISODE, exit=ended(TOO_MANY_STEPS, detail="from the script", exit_code=1), most_steps=99
    )
    found = merge(episode, JAIL)
    assert (found.status, found.detail) == (RunStatus.CPU_LIMIT, "more than 99 steps were made")


def test_only_what_a_clock_ended_is_tried_once_more() -> None:
    killed = replace(JAIL, end=RunEnd.CPU_LIMIT)
    assert ended_by_the_clock(EPISODE, killed)
    assert not ended_by_the_clock(replace(EPISODE, notes=(INTERRUPTED,)), killed)
    assert not ended_by_the_clock(replace(EPISODE, exit=ended(TOO_MANY_STEPS)), killed)
    assert not ended_by_the_clock(EPISODE, replace(JAIL, end=RunEnd.STALLED))


def test_what_was_caught_is_told_unless_something_else_failed() -> None:
    caught = Note(code="caught", text="line 4: NameError: name 'x' is not defined")
    failed = Note(
        code="thread_exception", text="Thread-1 (drive), line 9: ZeroDivisionError: division by zero"
    )
    late = ended(EXCEPTION, after_interrupt=True)
    for exit_frame, told in ((ended(FINISHED), True), (late, True), (ended(EXCEPTION), False)):
        found = merge(replace(EPISODE, exit=exit_frame, notes=(caught,)), JAIL)
        assert (caught in found.notes) is told
    assert merge(replace(EPISODE, exit=ended(FINISHED), notes=(caught, failed)), JAIL).notes == (failed,)


def test_a_thread_that_fails_after_ctrl_c_is_not_told() -> None:
    failed = Note(code="thread_exception", text="Thread-1 (drive), line 8: RCLError: Failed to publish")
    early = replace(failed, text="Thread-2 (drive), line 9: ZeroDivisionError: division by zero")
    found = merge(
        replace(EPISODE, exit=ended(after_interrupt=True), notes=(early, INTERRUPTED, failed)), JAIL
    )
    assert found.notes == (early,)
