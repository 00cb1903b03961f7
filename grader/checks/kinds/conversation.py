"""Check ``conversation``: nodes start, log and stay alive until Ctrl+C. What they say, items expect."""

from collections.abc import Iterator

from grader.checks.measure import Check, Measure, MeasureKind, Measures, Mistake, mistake
from grader.checks.mistakes import script_mistakes, without_node
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch
from grader.contracts.outcome import LogRecord, RunOutcome, RunStatus
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text
from grader.messages import say
from grader.messages.quantity import number

MEASURES = {
    "nodes": MeasureKind(form="count", of="node"),
    "info_logs": MeasureKind(form="count", of="node"),
    "alive": MeasureKind(form="flag", of="node"),
}


def measure(assignment: Assignment, run: Run) -> Measures:
    """Count nodes and INFO messages and see whether the script was still running at the horizon."""
    outcome = run.outcome
    infos = [record for record in _heard(outcome) if record.level_name == "INFO"]
    return {
        "nodes": Measure(float(len(outcome.nodes)), {"names": ", ".join(outcome.nodes[:4]) or "—"}),
        "info_logs": Measure(float(len(infos)), {"first": _first(infos)}),
        "alive": Measure(_alive(outcome), {"seconds": number(outcome.duration_ns / 1e9, "s")}),
    }


def explain(assignment: Assignment, run: Run, measures: Measures) -> tuple[Mistake, ...]:
    """Return what probably went wrong."""
    return node_mistakes(run)


def _first(infos: list[LogRecord]) -> Text:
    return say("node.first_log", text=infos[0].message[:80]) if infos else EMPTY


def _heard(outcome: RunOutcome) -> list[LogRecord]:
    """Return the messages that reached /rosout at home, too: not those that a script logs after Ctrl+C."""
    interrupted = outcome.status is RunStatus.INTERRUPTED
    return [record for record in outcome.logs if not interrupted or record.t_ns < outcome.duration_ns]


def _alive(outcome: RunOutcome) -> float:
    """An exception in the clean-up after Ctrl+C does not matter: `outcome.cleanup_error` costs nothing."""
    return 1.0 if outcome.status in (RunStatus.INTERRUPTED, RunStatus.STALLED) else 0.0


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the view of the path where the car was driven, else of what was said over time, else of log lines."""
    if run.trajectory.sayings and run.trajectory.commands:
        return FigureSketch()
    return FigureSketch(view="talk" if run.trajectory.sayings else "log")


def node_mistakes(run: Run) -> tuple[Mistake, ...]:
    """Return what probably went wrong with a first node."""
    outcome = run.outcome
    mistakes = [*script_mistakes(run)]
    if not mistakes and not outcome.nodes:
        interrupted = outcome.status is RunStatus.INTERRUPTED
        mistakes.append(mistake("init_without_node") if interrupted else without_node(run))
    elif outcome.nodes:
        mistakes += _logging(run)
        if outcome.status is RunStatus.FINISHED:
            ended = number(outcome.duration_ns / 1e9, "s")
            mistakes.append(mistake("not_spinning", ("alive",), ended=ended))
    return tuple(mistakes)


def _logging(run: Run) -> Iterator[Mistake]:
    outcome = run.outcome
    heard = _heard(outcome)
    if any(record.level_name == "INFO" for record in heard):
        return
    if heard:
        levels = sorted({record.level_name for record in heard})
        yield mistake("log_level", ("info_logs",), level=", ".join(levels), wanted="INFO")
    elif outcome.stdout.text.strip():
        yield mistake("printed", ("info_logs",))
    elif outcome.status in (RunStatus.FINISHED, RunStatus.INTERRUPTED):
        yield mistake("never_logged", ("info_logs",))


CHECK = Check(kind="conversation", measures=MEASURES, measure=measure, explain=explain, sketch=sketch)
