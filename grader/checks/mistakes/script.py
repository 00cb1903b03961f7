"""Mistakes told by how the script ended."""

from grader.checks.measure import Mistake
from grader.contracts.outcome import RunOutcome, RunStatus
from grader.messages import say
from grader.messages.details import explained
from grader.messages.exceptions import meaning

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
        text = say(f"mistake.{code}", detail=explained(outcome.status, outcome.detail))
        return (Mistake(code, text),)
    if (thread := noted(outcome, "thread_exception")) is not None:
        return (Mistake("thread_crashed", say("mistake.thread_crashed", detail=thread)),)
    return ()


def noted(outcome: RunOutcome, code: str) -> str | None:
    """Return the text of the first note of that code, or None."""
    return next((note.text for note in outcome.notes if note.code == code), None)


def _killed(outcome: RunOutcome) -> Mistake:
    return Mistake("killed", say("mistake.killed", signal=outcome.signal or "?"))
