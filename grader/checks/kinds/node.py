"""Check ``node``: a node starts, logs, and stays alive until Ctrl+C."""

from collections.abc import Iterator

from grader.checks.measure import Check, Findings, Measure, MeasureKind, Mistake, mistake
from grader.checks.mistakes import script_mistakes, without_node
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch
from grader.contracts.outcome import RunOutcome, RunStatus
from grader.contracts.scoring import Run
from grader.messages.quantity import number

MEASURES = {
    "nodes": MeasureKind(form="count"),
    "info_logs": MeasureKind(form="count"),
    "alive": MeasureKind(form="flag"),
}


def examine(assignment: Assignment, run: Run) -> Findings:
    """Count nodes and INFO messages and see whether the script was still running at the horizon."""
    outcome = run.outcome
    infos = [record for record in outcome.logs if record.level_name == "INFO"]
    return Findings(
        measures={
            "nodes": Measure(float(len(outcome.nodes)), {"names": ", ".join(outcome.nodes[:4]) or "—"}),
            "info_logs": Measure(float(len(infos)), {"first": infos[0].message[:80] if infos else "—"}),
            "alive": Measure(_alive(outcome), {"seconds": number(outcome.duration_ns / 1e9, "s")}),
        },
        mistakes=node_mistakes(run),
    )


def _alive(outcome: RunOutcome) -> float:
    """An exception in the clean-up after Ctrl+C does not matter: `outcome.cleanup_error` costs nothing."""
    return 1.0 if outcome.status is RunStatus.INTERRUPTED else 0.0


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the view of log lines over time."""
    return FigureSketch(view="log")


def node_mistakes(run: Run) -> tuple[Mistake, ...]:
    """Return what probably went wrong with a first node."""
    outcome = run.outcome
    found = [*script_mistakes(run)]
    if not found and not outcome.nodes:
        interrupted = outcome.status is RunStatus.INTERRUPTED
        found.append(mistake("init_without_node") if interrupted else without_node(run))
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


CHECK = Check(kind="node", measures=MEASURES, examine=examine, sketch=sketch)
