"""Why a script did not answer requests to its services: what `service` and `agent` both recognise."""

from collections.abc import Iterator, Sequence

from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import script_mistakes, without_added_node
from grader.contracts.outcome import RunOutcome, RunStatus, ServiceResult
from grader.contracts.scoring import Run
from grader.messages.quantity import number
from grader.messages.script import ScriptText

# Offered by every node, or by the library.
_OWN_TYPES = (
    "rcl_interfaces/",
    "lifecycle_msgs/",
    "action_msgs/",
)
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
    return tuple(_unanswered(calls, run))


def _unanswered(calls: Sequence[ServiceResult], run: Run) -> Iterator[Mistake]:
    """Yield why the first call without an answer got none."""
    outcome = run.outcome
    result = next((each for each in calls if each.answered_ns is None), None)
    if result is None:
        return
    call = result.call
    named = [one for one in outcome.endpoints if one.kind == "service" and one.name == call.service]
    if named and named[0].type != call.type:
        kind = named[0].type
        yield mistake("wrong_service_type", service=call.service, type=kind, wanted=call.type)
    elif result.sent_ns is None:
        yield _not_offered(result, outcome, frozenset(each.call.service for each in calls))
    elif outcome.status is RunStatus.FINISHED:
        yield mistake("not_spinning", ended=number(outcome.duration_ns / 1e9, "s"))
    else:
        silent = mistake("service_silent", service=call.service)
        yield without_added_node(ScriptText(run.source)) or silent


def _not_offered(result: ServiceResult, outcome: RunOutcome, wanted: frozenset[str]) -> Mistake:
    own = [
        endpoint
        for endpoint in outcome.endpoints
        if endpoint.kind == "service" and not endpoint.type.startswith(_OWN_TYPES)
    ]
    call = result.call
    if any(endpoint.name == call.service for endpoint in own):
        return mistake("not_spinning", ended=number(outcome.duration_ns / 1e9, "s"))
    own = [endpoint for endpoint in own if endpoint.name not in wanted]  # other tools
    if own:
        used = ", ".join(f"{endpoint.name} ({endpoint.type})" for endpoint in own[:_MAX_NAMED])
        return mistake("wrong_service_name", used=used, service=call.service)
    return mistake("no_service", service=call.service, type=call.type)
