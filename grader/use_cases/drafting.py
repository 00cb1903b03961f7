"""What somebody is writing for an assignment: kept for them while they write, and read by Python's compiler."""

from grader.contracts.errors import InfrastructureError, RefusedError, SandboxError
from grader.contracts.identity import Caller
from grader.contracts.upload import decoded
from grader.use_cases.callers import name_of
from grader.use_cases.handing_in import syntax_refusal, too_large
from grader.use_cases.practising import practisable
from grader.use_cases.services import Services


def draft_of(services: Services, caller: Caller, assignment_id: str) -> str | None:
    """Return what the caller was last writing; None: nothing.

    Raises RefusedError: the caller may not practise the assignment.
    """
    practisable(services, caller, assignment_id)
    return services.drafts.of(caller.course or "", caller.person or "", assignment_id)


def keep_draft(services: Services, caller: Caller, assignment_id: str, content: bytes) -> RefusedError | None:
    """Keep what the caller is writing; return what Python has against it, if there is time to ask.

    The untouched starter is not kept.

    Raises RefusedError: the caller may not practise the assignment, or writes too much or too fast.
    """
    practisable(services, caller, assignment_id)
    services.allowances.drafts.take(name_of(caller) or "")
    most = services.settings.max_upload_bytes
    if len(content) > most:
        raise too_large(most)
    starter = services.assignments.of(caller.course).starter(assignment_id)
    text = None if content == starter else decoded(content)
    services.drafts.keep(services.signature(caller), assignment_id, text)
    return _objection(services, caller, content, f"{assignment_id}.py")


def _objection(services: Services, caller: Caller, content: bytes, file_name: str) -> RefusedError | None:
    try:
        problem = services.preflight.check(
            content,
            file_name,
            lambda busy_s: services.allowances.drafts.charge(name_of(caller) or "", busy_s),
            patience_s=0.0,  # uploads come first
        )
    except (InfrastructureError, SandboxError):
        return None
    return None if problem is None else syntax_refusal(problem, file_name)
