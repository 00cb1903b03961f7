"""Mistakes told by how the script ended."""

import re

from grader.checks.measure import Mistake
from grader.contracts.outcome import RunOutcome, RunStatus, StudentError
from grader.messages import say
from grader.messages.details import explained

_FLOAT_FIELD = re.compile(r"The '(\w+)' field must be of type 'float'")
_MISSPELT = re.compile(r"'(\w+)' object has no attribute '(\w+)'")
_DISK_FULL = "[Errno 28]"
_NO_TERMINAL = ("(25, ", "setupterm:")  # of termios and curses, whose exceptions are both called `error`
_MODULE = re.compile(r"No module named '(\w+)")
_MISSING = {
    **dict.fromkeys(("rospy", "roslib", "rosbag", "roslaunch"), "ros_1"),
    **dict.fromkeys(("getch", "keyboard", "msvcrt", "pygame", "pynput", "readchar"), "no_terminal"),
}
_MESSAGE_CLASSES = {"Twist", "Vector3"}

_ENDINGS = {
    RunStatus.SYNTAX_ERROR: "syntax_error",
    RunStatus.STALLED: "stalled",
    RunStatus.CPU_LIMIT: "cpu_limit",
    RunStatus.MEMORY_LIMIT: "memory_limit",
    RunStatus.OUTPUT_LIMIT: "output_limit",
    RunStatus.FORBIDDEN: "forbidden",
    RunStatus.PROTOCOL: "forbidden",
}


def script_mistakes(outcome: RunOutcome) -> tuple[Mistake, ...]:
    """Return the mistake that ended the script, or one of its threads, before its time, if any."""
    if outcome.status is RunStatus.CRASHED:
        return (_crash(outcome),)
    if outcome.status in _ENDINGS:
        code = _ENDINGS[outcome.status]
        line = outcome.error.line if outcome.error is not None else None
        problem = outcome.error.message if outcome.error is not None else ""
        detail = explained(outcome.status, outcome.detail)
        text = say(f"mistake.{code}", line=line or "?", problem=problem, detail=detail)
        return (Mistake(code, text),)
    if (thread := noted(outcome, "thread_exception")) is not None:
        return (Mistake("thread_crashed", say("mistake.thread_crashed", detail=thread)),)
    return ()


def noted(outcome: RunOutcome, code: str) -> str | None:
    """Return the text of the first note of that code, or None."""
    return next((note.text for note in outcome.notes if note.code == code), None)


def _crash(outcome: RunOutcome) -> Mistake:
    error = outcome.error
    if error is None:
        return Mistake("killed", say("mistake.killed", signal=outcome.signal or "?"))
    code, values = _exception(error)
    text = say(
        f"mistake.{code}",
        line=error.line or "?",
        type=error.type,
        problem=_first_line(error.message),
        **values,
    )
    return Mistake(code, text)


def _exception(error: StudentError) -> tuple[str, dict[str, str]]:
    """Return the code that fits an exception and the values its text needs beside line, type and problem."""
    if error.type == "AssertionError" and (field := _FLOAT_FIELD.search(error.message)):
        return "int_in_float", {"field": field[1]}
    if error.type == "AttributeError" and (misspelt := _MISSPELT.search(error.message)):
        if misspelt[1] in _MESSAGE_CLASSES:
            return "unknown_field", {"owner": misspelt[1], "field": misspelt[2]}
        return "crashed", {}
    if error.type == "TypeError" and ("qos_profile" in error.message or "queue_size" in error.message):
        return "missing_qos", {}
    if error.type == "OSError" and error.message.startswith(_DISK_FULL):
        return "disk_full", {}
    if error.type == "error" and error.message.startswith(_NO_TERMINAL):
        return "no_terminal", {}
    if error.type == "ModuleNotFoundError" and (missing := _MODULE.search(error.message)):
        return _MISSING.get(missing[1], "missing_module"), {}
    plain = {
        "NotInitializedException": "not_initialized",
        "EOFError": "no_input",
        "FileNotFoundError": "missing_file",
        "TclError": "no_display",
        "NameError": "unknown_name",
        "ModuleNotFoundError": "missing_module",
    }
    return plain.get(error.type, "crashed"), {}


def _first_line(message: str) -> str:
    return message.strip().splitlines()[0][:200] if message.strip() else ""
