"""Check ``service``: the script offers services and answers the assignment's calls."""

from collections.abc import Iterator, Mapping
from typing import Any

from grader.checks.measure import UNMEASURED, Check, Measure, MeasureKind, Measures, Mistake, Option, mistake
from grader.checks.offers import unanswered
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch
from grader.contracts.outcome import RunStatus, ServiceResult
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.messages.quantity import number

MEASURES = {
    "nodes": MeasureKind(form="count"),
    "offered": MeasureKind(form="flag"),
    "answered": MeasureKind(form="flag"),
    "entries": MeasureKind(form="count"),
    "alive": MeasureKind(form="flag", of="node"),
}
_SHOWN_ENTRIES = 6
_SHOWN_CHARACTERS = 40
_NO_FIELD = Text(
    zh="缺少：测量值 'entries' 数的是这个字段的项数",
    en="missing; the measure 'entries' counts the entries of this field",
)


def measure(assignment: Assignment, run: Run) -> Measures:
    """See whether each call found its service and was answered, and what the answers hold."""
    offered = bool(run.calls) and all(result.sent_ns is not None for result in run.calls)
    answered = offered and all(result.answered_ns is not None for result in run.calls)
    names = ", ".join(dict.fromkeys(result.call.service for result in run.calls))
    alive = run.outcome.status is RunStatus.INTERRUPTED
    nodes = run.outcome.nodes
    return {
        "nodes": Measure(float(len(nodes)), {"names": ", ".join(nodes[:4]) or "—"}),
        "offered": Measure(float(offered), {"names": names}),
        "answered": Measure(float(answered), {"names": names}),
        "entries": _entries(assignment, run.calls) if answered else UNMEASURED,
        "alive": Measure(float(alive), {"seconds": number(run.outcome.duration_ns / 1e9, "s")}),
    }


def explain(assignment: Assignment, run: Run, measures: Measures) -> tuple[Mistake, ...]:
    """Return what probably went wrong."""
    return _mistakes(run, str(assignment.options.get("list_field", "")))


def listed_entries(values: Mapping[str, Any] | None, field: str) -> list[str]:
    """Return the distinct texts, blank ones left out, of the list `field` of a response."""
    found = (values or {}).get(field)
    texts = [str(each).strip() for each in found] if isinstance(found, list) else []
    return list(dict.fromkeys(text for text in texts if text))


def _entries(assignment: Assignment, calls: tuple[ServiceResult, ...]) -> Measure:
    """Count the entries of the answer that has fewest."""
    field = str(assignment.options.get("list_field", ""))
    fewest = min((listed_entries(result.values, field) for result in calls), key=len)
    shown = ", ".join(text[:_SHOWN_CHARACTERS] for text in fewest[:_SHOWN_ENTRIES]) or "—"
    return Measure(float(len(fewest)), {"field": field, "texts": shown})


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the view of log lines over time."""
    return FigureSketch(view="log")


def _problem_with_list_field(value: Option) -> Text | None:
    good = isinstance(value, str) and value.isidentifier()
    return None if good else Text(zh="要填一个字段名", en="must be the name of a field")


def _consult(assignment: Assignment) -> tuple[tuple[str, Text], ...]:
    if not assignment.calls:
        return (("calls", Text(zh="缺少：写明要调用哪些服务", en="missing; say which services are called")),)
    if assignment.item_on("entries") is not None and "list_field" not in assignment.options:
        return (("options.list_field", _NO_FIELD),)
    return ()


def _mistakes(run: Run, list_field: str) -> tuple[Mistake, ...]:
    """Return why the assignment's calls were not answered, or not with what was wanted."""
    return unanswered(run, run.calls) or tuple(_empty(run, list_field))


def _empty(run: Run, list_field: str) -> Iterator[Mistake]:
    if list_field and any(not listed_entries(result.values, list_field) for result in run.calls):
        yield mistake("empty_answer", ("entries",), field=list_field)


CHECK = Check(
    kind="service",
    measures=MEASURES,
    optional={"list_field": _problem_with_list_field},
    consult=_consult,
    measure=measure,
    explain=explain,
    sketch=sketch,
)
