"""Why a script did not answer requests to its services: what `service` and `agent` both recognise."""

from collections.abc import Iterator, Sequence

from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import script_mistakes
from grader.contracts.outcome import RunOutcome, RunStatus, ServiceResult
from grader.contracts.scoring import Run
from grader.messages.quantity import number

_OWN_TYPES = (
    "rcl_interfaces/",
    "lifecycle_msgs/",
    "action_msgs/",
)  # offered by every node, or by the library
_MAX_NAMED = 4


def unanswered(run: Run, calls: Sequence[ServiceResult]) -> tuple[Mistake, ...]:
    """Return what ended the script, or what kept the first unanswered call from its answer; else nothing."""
    outcome = run.outcome
    found = [*script_mistakes(run)]
    if found:
        return tuple(found)
    if not outcome.nodes:
        code = "init_without_node" if outcome.status is RunStatus.INTERRUPTED else "nothing_ran"
        return (mistake(code),)
    return tuple(_unanswered(calls, outcome))


def _unanswered(calls: Sequence[ServiceResult], outcome: RunOutcome) -> Iterator[Mistake]:
    """Yield why the first call without an answer got none."""
    result = next((each for each in calls if each.answered_ns is None), None)
    if result is None:
        return
    if result.sent_ns is None:
        yield _not_offered(result, outcome, frozenset(each.call.service for each in calls))
    elif outcome.status is RunStatus.FINISHED:
        yield mistake("not_spinning", ended=number(outcome.duration_ns / 1e9, "s"))
    else:
        yield mistake("service_silent", service=result.call.service)


def _not_offered(result: ServiceResult, outcome: RunOutcome, wanted: frozenset[str]) -> Mistake:
    own = [
        endpoint
        for endpoint in outcome.endpoints
        if endpoint.kind == "service" and not endpoint.type.startswith(_OWN_TYPES)
    ]
    call = result.call
    named = [endpoint for endpoint in own if endpoint.name == call.service]
    if named and named[0].type == call.type:
        return mistake("not_spinning", ended=number(outcome.duration_ns / 1e9, "s"))
    if named:
        return mistake("wrong_service_type", service=call.service, type=named[0].type, wanted=call.type)
    own = [endpoint for endpoint in own if endpoint.name not in wanted]  # other tools
    if own:
        used = ", ".join(f"{endpoint.name} ({endpoint.type})" for endpoint in own[:_MAX_NAMED])
        return mistake("wrong_service_name", used=used, service=call.service)
    return mistake("no_service", service=call.service, type=call.type)
