"""Mistakes told by a node that should have logged and stayed alive."""

from collections.abc import Iterator

from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes.script import script_mistakes
from grader.contracts.outcome import RunOutcome, RunStatus
from grader.messages.quantity import number


def node_mistakes(outcome: RunOutcome) -> tuple[Mistake, ...]:
    """Return what probably went wrong with a first node."""
    found = [*script_mistakes(outcome)]
    if not found and not outcome.nodes:
        code = "init_without_node" if outcome.status is RunStatus.INTERRUPTED else "nothing_ran"
        found.append(mistake(code))
    elif outcome.nodes:
        found += _logging(outcome)
        if outcome.status is RunStatus.FINISHED:
            ended = number(outcome.duration_ns / 1e9, "s")
            found.append(mistake("not_spinning", ("alive",), ended=ended))
    return tuple(found)


def _logging(outcome: RunOutcome) -> Iterator[Mistake]:
    if any(record.level_name == "INFO" for record in outcome.logs):
        return
    if outcome.logs:
        levels = sorted({record.level_name for record in outcome.logs})
        yield mistake("wrong_level", ("info_logs",), levels=", ".join(levels))
    elif outcome.stdout.text.strip():
        yield mistake("printed", ("info_logs",))
    elif outcome.status in (RunStatus.FINISHED, RunStatus.INTERRUPTED):
        yield mistake("never_logged", ("info_logs",))
