"""What log lines are about: a request, an upload, a grading.

The fields are bound once, where the work begins; `grader.operation.logs` puts them on every line written inside,
also by code that knows nothing of them.
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
    """Begin a unit of work that lasts as long as the current task or thread, with these fields only."""
    _bound.set(fields)


@contextmanager
def bound(**fields: Field) -> Iterator[None]:
    """Put `fields` on every line that is written inside the context."""
    token = _bound.set({**(_bound.get() or {}), **fields})
    try:
        yield
    finally:
        _bound.reset(token)


def about(claim: Claim) -> AbstractContextManager[None]:
    """Put on every line that is written inside the context which grading it is about."""
    return bound(
        submission=claim.submission_id,
        attempt=claim.attempt,
        assignment=claim.assignment,
        worker=claim.worker,
    )


def note(**fields: Field) -> None:
    """Add to the unit of work under way what was only found out now; outside of one, do nothing.

    Endpoints run in threads with a copy of their request's context: the mapping is shared on purpose, so that the
    request's own line has these fields, too.
    """
    known = _bound.get()
    if known is not None:
        known.update(fields)


def current() -> Mapping[str, Field]:
    """Return the fields of the unit of work under way."""
    return _bound.get() or {}
