"""Fields of log lines that say which request, upload or grading a line belongs to.

They are bound once, where the work begins. `grader.operation.logs` adds them to every line that is written until
the work ends, also by code that knows nothing of them.
"""

from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar

from grader.contracts.submission import Claim

FIELDS = (
    "request_id", "submission", "attempt", "assignment", "worker",
    "method", "route", "status", "duration_ms", "code", "instance",
)  # fmt: skip
"""Names of the fields, in the order in which lines show them."""

Field = str | int | float
_bound: ContextVar[dict[str, Field] | None] = ContextVar("grader_log_fields", default=None)


def begin(**fields: Field) -> None:
    """Bind these fields, and no earlier ones, for the rest of the current task or thread."""
    _bound.set(fields)


@contextmanager
def bound(**fields: Field) -> Iterator[None]:
    """Add `fields` to every line that is written inside the context."""
    token = _bound.set({**(_bound.get() or {}), **fields})
    try:
        yield
    finally:
        _bound.reset(token)


def about(claim: Claim) -> AbstractContextManager[None]:
    """Add the fields of a claim to every line that is written inside the context."""
    return bound(
        submission=claim.submission_id,
        attempt=claim.attempt,
        assignment=claim.assignment,
        worker=claim.worker,
    )


def note(**fields: Field) -> None:
    """Add fields to the unit of work under way, now that they are known; outside of one, do nothing.

    This changes the bound mapping itself. An endpoint runs in a thread with a copy of its request's context, which
    shares the mapping, so the request's own log line gets these fields, too.
    """
    known = _bound.get()
    if known is not None:
        known.update(fields)


def current() -> Mapping[str, Field]:
    """Return the fields of the unit of work under way."""
    return _bound.get() or {}
