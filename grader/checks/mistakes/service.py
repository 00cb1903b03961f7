"""Mistakes told by a node that should have answered service calls."""

from collections.abc import Iterator

from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes.script import script_mistakes
from grader.contracts.outcome import RunOutcome, RunStatus
from grader.contracts.services import ServiceResult
from grader.contracts.verdict import Run
from grader.messages.quantity import number

_OWN_TYPES = (
    "rcl_interfaces/",
    "lifecycle_msgs/",
    "action_msgs/",
)  # offered by every node, or by the library
_MAX_NAMED = 4


def service_mistakes(run: Run, list_field: str) -> tuple[Mistake, ...]:
    """Return why the assignment's calls were not answered, or not with what was wanted."""
    outcome = run.outcome
    found = [*script_mistakes(outcome)]
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
