"""Check ``node``: a node starts, logs, and stays alive until Ctrl+C."""

from grader.checks.measure import Check, Findings, Measure, MeasureKind
from grader.checks.mistakes.node import node_mistakes
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch
from grader.contracts.outcome import RunOutcome, RunStatus
from grader.contracts.verdict import Run
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
        mistakes=node_mistakes(outcome),
    )


def _alive(outcome: RunOutcome) -> float:
    """An exception in the clean-up after Ctrl+C does not matter: `outcome.cleanup_error` costs nothing."""
    return 1.0 if outcome.status is RunStatus.INTERRUPTED else 0.0


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the view of log lines over time."""
    return FigureSketch(view="log")


CHECK = Check(kind="node", measures=MEASURES, examine=examine, sketch=sketch)
