"""The log: one record a line on stderr, as text for people or as JSON for machines.

Fields say which request, upload or grading a line belongs to. They are bound once, where the work begins, and
stand on every line that is written until it ends, also by code that knows nothing of them.

No record can forge another: in JSON everything beyond printable ASCII is an escape, in text a message's control
characters are, and the lines of a traceback are indented behind a bar.
"""

import logging
import sys
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from datetime import datetime
from typing import TYPE_CHECKING, TextIO

from grader.contracts.python import UTC
from grader.contracts.submission import Claim
from grader.render.escape import visible, visible_line

if TYPE_CHECKING:
    from grader.operation.settings import LogFormat, LogLevel

_CHATTY = (
    "alembic",
    "asyncio",
    "httpcore",
    "httpx",
    "matplotlib",
    "multipart",
    "procrastinate",
    "python_multipart",
)
"""Libraries whose `info` is about themselves, not about the service."""

_FIELDS = (
    "request_id", "submission", "attempt", "assignment", "worker",
    "method", "route", "status", "duration_ms", "code", "instance",
)  # fmt: skip
"""Names of the fields, in the order in which lines show them."""

Field = str | int | float
_bound: ContextVar[dict[str, Field] | None] = ContextVar("grader_log_fields", default=None)

_NEXT_LINE = "\n    | "
_OWN_ATTRIBUTES = (*vars(logging.makeLogRecord({})), "asctime", "message")


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
    bound = _bound.get()
    if bound is not None:
        bound.update(fields)


def current() -> Mapping[str, Field]:
    """Return the fields of the unit of work under way."""
    return _bound.get() or {}


def configure(log_format: "LogFormat", level: "LogLevel") -> None:
    """Send every log record of this process, of libraries too, to stderr in one format."""
    root = logging.getLogger()
    root.handlers = [handler(log_format, sys.stderr)]
    root.setLevel(level.upper())
    logging.captureWarnings(True)
    for name in _CHATTY:
        logging.getLogger(name).setLevel(logging.DEBUG if level == "debug" else logging.WARNING)


def handler(log_format: "LogFormat", stream: TextIO) -> logging.Handler:
    """Return a handler that writes records with their context to `stream`."""
    handler = logging.StreamHandler(stream)
    handler.addFilter(_InContext())
    handler.setFormatter(_TextFormatter() if log_format == "text" else _json())
    return handler


class _InContext(logging.Filter):
    """Puts the fields of the unit of work under way on each record; never drops one."""

    def filter(self, record: logging.LogRecord) -> bool:
        for name, value in current().items():
            record.__dict__.setdefault(name, value)
        return True


class _TextFormatter(logging.Formatter):
    """One line: instant, level, logger, message, then the fields; a traceback follows indented."""

    def format(self, record: logging.LogRecord) -> str:
        at = datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds")
        values = record.__dict__
        fields = "".join(
            f" {name}={visible_line(str(values[name]))}"
            for name in _FIELDS
            if values.get(name) not in (None, "")
        )
        line = f"{at} {record.levelname:<7} {record.name}: {visible_line(record.getMessage())}{fields}"
        if record.exc_info:
            line += _indented(self.formatException(record.exc_info))
        return line + _indented(record.stack_info) if record.stack_info else line


def _indented(text: str) -> str:
    return "".join(_NEXT_LINE + line for line in visible(text).split("\n"))


def _json() -> logging.Formatter:
    from pythonjsonlogger.json import JsonFormatter  # text does without it

    return JsonFormatter(
        "%(levelname)s %(name)s %(message)s",
        timestamp="time",
        rename_fields={
            "levelname": "level",
            "name": "logger",
            "exc_info": "exception",
            "stack_info": "stack",
        },
        reserved_attrs=[*_OWN_ATTRIBUTES, "color_message"],  # uvicorn repeats its messages in colour
        json_ensure_ascii=True,
    )
