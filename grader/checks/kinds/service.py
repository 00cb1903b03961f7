"""Check ``service``: the script offers services and answers the assignment's calls."""

from collections.abc import Iterator, Mapping
from typing import Any

from grader.checks.measure import UNMEASURED, Check, Findings, Measure, MeasureKind, Mistake, Option, mistake
from grader.checks.mistakes import script_mistakes
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch
from grader.contracts.outcome import RunOutcome, RunStatus, ServiceResult
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.messages.quantity import number

MEASURES = {
    "nodes": MeasureKind(form="count"),
    "offered": MeasureKind(form="flag"),
    "answered": MeasureKind(form="flag"),
    "entries": MeasureKind(form="count"),
    "alive": MeasureKind(form="flag"),
}
_LISTED = 6
_LONGEST = 40


def examine(assignment: Assignment, run: Run) -> Findings:
    """See whether each call found its service and was answered, and what the answers hold."""
    offered = bool(run.calls) and all(result.sent_ns is not None for result in run.calls)
    answered = offered and all(result.answered_ns is not None for result in run.calls)
    names = ", ".join(dict.fromkeys(result.call.service for result in run.calls))
    alive = run.outcome.status is RunStatus.INTERRUPTED
    nodes = run.outcome.nodes
    measures = {
        "nodes": Measure(float(len(nodes)), {"names": ", ".join(nodes[:4]) or "—"}),
        "offered": Measure(float(offered), {"names": names}),
        "answered": Measure(float(answered), {"names": names}),
        "entries": _entries(assignment, run.calls) if answered else UNMEASURED,
        "alive": Measure(float(alive), {"seconds": number(run.outcome.duration_ns / 1e9, "s")}),
    }
    return Findings(measures, service_mistakes(run, str(assignment.options.get("list_field", ""))))


def listed_entries(values: Mapping[str, Any] | None, field: str) -> list[str]:
    """Return the distinct texts, blank ones left out, of the list `field` of a response."""
    found = (values or {}).get(field)
    texts = [str(each).strip() for each in found] if isinstance(found, list) else []
    return list(dict.fromkeys(text for text in texts if text))


def _entries(assignment: Assignment, calls: tuple[ServiceResult, ...]) -> Measure:
    """Count the entries of the answer that has fewest."""
    field = str(assignment.options.get("list_field", ""))
    fewest = min((listed_entries(result.values, field) for result in calls), key=len)
    shown = ", ".join(text[:_LONGEST] for text in fewest[:_LISTED]) or "—"
    return Measure(float(len(fewest)), {"field": field, "texts": shown})


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the view of log lines over time."""
    return FigureSketch(view="log")


def _problem_with_list_field(value: Option) -> Text | None:
    good = isinstance(value, str) and value.isidentifier()
    return None if good else Text(zh="要填一个字段名", en="must be the name of a field")


_NO_FIELD = Text(
    zh="缺少：测量值 'entries' 数的是这个字段的项数",
    en="missing; the measure 'entries' counts the entries of this field",
)


def _consult(assignment: Assignment) -> tuple[tuple[str, Text], ...]:
    if not assignment.calls:
        return (("calls", Text(zh="缺少：写明要调用哪些服务", en="missing; say which services are called")),)
    if assignment.item_on("entries") is not None and "list_field" not in assignment.options:
        return (("options.list_field", _NO_FIELD),)
    return ()


_OWN_TYPES = (
    "rcl_interfaces/",
    "lifecycle_msgs/",
    "action_msgs/",
)  # offered by every node, or by the library
_MAX_NAMED = 4


def service_mistakes(run: Run, list_field: str) -> tuple[Mistake, ...]:
    """Return why the assignment's calls were not answered, or not with what was wanted."""
    outcome = run.outcome
    found = [*script_mistakes(run)]
    if found:
        return tuple(found)
    if not outcome.nodes:
        code = "init_without_node" if outcome.status is RunStatus.INTERRUPTED else "nothing_ran"
        return (mistake(code),)
    return tuple(_unanswered(run, outcome)) or tuple(_empty(run, list_field))


def _unanswered(run: Run, outcome: RunOutcome) -> Iterator[Mistake]:
    """Say of the first call without an answer what kept it from one."""
    result = next((each for each in run.calls if each.answered_ns is None), None)
    if result is None:
        return
    if result.sent_ns is None:
        yield _not_offered(result, outcome)
    elif outcome.status is RunStatus.FINISHED:
        yield mistake("not_spinning", ended=number(outcome.duration_ns / 1e9, "s"))
    else:
        yield mistake("service_silent", service=result.call.service)


def _not_offered(result: ServiceResult, outcome: RunOutcome) -> Mistake:
    own = [
        endpoint
        for endpoint in outcome.endpoints
        if endpoint.kind == "service" and not endpoint.type.startswith(_OWN_TYPES)
    ]
    wanted = result.call
    named = [endpoint for endpoint in own if endpoint.name == wanted.service]
    if named and named[0].type == wanted.type:
        return mistake("not_spinning", ended=number(outcome.duration_ns / 1e9, "s"))
    if named:
        return mistake("wrong_service_type", service=wanted.service, type=named[0].type, wanted=wanted.type)
    if own:
        used = ", ".join(f"{endpoint.name} ({endpoint.type})" for endpoint in own[:_MAX_NAMED])
        return mistake("wrong_service_name", used=used, service=wanted.service)
    return mistake("no_service", service=wanted.service, type=wanted.type)


def _empty(run: Run, list_field: str) -> Iterator[Mistake]:
    if list_field and any(not (result.values or {}).get(list_field) for result in run.calls):
        yield mistake("empty_answer", ("entries",), field=list_field)


CHECK = Check(
    kind="service",
    measures=MEASURES,
    optional={"list_field": _problem_with_list_field},
    consult=_consult,
    examine=examine,
    sketch=sketch,
)
