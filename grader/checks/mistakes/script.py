"""Mistakes told by how the script ended."""

import re

from grader.checks.measure import Mistake, mistake
from grader.contracts.outcome import RunOutcome, RunStatus, StudentError
from grader.contracts.text import Text
from grader.messages import join, say
from grader.messages.details import explained
from grader.messages.exceptions import meaning

_IN_THREAD = re.compile(r".*, line (\d+): (\w+)(?:: (.*))?", re.DOTALL)
_SPACE = Text(zh="", en=" ")

_ENDINGS = {
    RunStatus.STALLED: "stalled",
    RunStatus.CPU_LIMIT: "cpu_limit",
    RunStatus.MEMORY_LIMIT: "memory_limit",
    RunStatus.OUTPUT_LIMIT: "output_limit",
    RunStatus.FORBIDDEN: "forbidden",
    RunStatus.PROTOCOL: "forbidden",
}


def script_mistakes(outcome: RunOutcome) -> tuple[Mistake, ...]:
    """Return the mistake that ended the script, or one of its threads, before its time, if any."""
    error = outcome.error
    if outcome.status is RunStatus.CRASHED:
        return (Mistake(*meaning(error, "crashed")) if error is not None else _killed(outcome),)
    if outcome.status is RunStatus.SYNTAX_ERROR and error is not None:
        return (Mistake(*meaning(error, "syntax_error")),)
    if outcome.status in _ENDINGS:
        code = _ENDINGS[outcome.status]
        return (mistake(code, detail=explained(outcome.status, outcome.detail)),)
    if (thread := noted(outcome, "thread_exception")) is not None:
        return (Mistake("thread_crashed", _in_thread(thread)),)
    return ()


def noted(outcome: RunOutcome, code: str) -> str | None:
    """Return the text of the first note of that code, or None."""
    return next((note.text for note in outcome.notes if note.code == code), None)


def _in_thread(note: str) -> Text:
    """Return what became of a thread and, where its exception is known, what that means."""
    told = say("mistake.thread_crashed", detail=note)
    found = _IN_THREAD.fullmatch(note)
    if found is None:
        return told
    error = StudentError(type=found[2], message=found[3] or "", line=int(found[1]), traceback="")
    code, reason = meaning(error, "crashed")
    return told if code == "crashed" else join([told, reason], _SPACE)


def _killed(outcome: RunOutcome) -> Mistake:
    return mistake("killed", signal=outcome.signal or "?")
