"""Taking a file in: bounded while it arrives, then checked before anything is stored."""

import logging
import re
from collections.abc import Callable, Coroutine
from datetime import datetime
from typing import Any

from fastapi import Request, Response
from fastapi.routing import APIRoute

from grader.contracts.assignment import SUFFIXES, Input
from grader.contracts.errors import InfrastructureError, RefusedError, SandboxError, SubmissionError
from grader.contracts.grading import SyntaxProblem
from grader.contracts.identity import Caller, is_person_id
from grader.contracts.outcome import StudentError
from grader.contracts.text import Text
from grader.contracts.upload import check_source
from grader.messages.exceptions import meaning
from grader.render.escape import visible_line
from grader.routes.bodies import media_type, too_large, with_file
from grader.use_cases.services import Services

_log = logging.getLogger(__name__)
_LONGEST_NAME = 100
_LONGEST_LINE = 200


class UploadRoute(APIRoute):
    """A route whose body is refused by type before, and by size while, it is read.

    The form's parser alone would spool any amount to disk before the endpoint saw the first byte.
    """

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Put the two checks before FastAPI's own handler."""
        handle = super().get_route_handler()

        async def bounded(request: Request) -> Response:
            if media_type(request.headers) != "multipart/form-data":
                raise RefusedError("unsupported_media_type")
            request.state.arrived_at = request.app.state.services.clock()
            limit = request.app.state.services.settings.max_upload_bytes
            return await handle(with_file(request, limit))

        return bounded


def arrival_of(request: Request) -> datetime:
    """Return the instant at which a request to an `UploadRoute` came in, before its body was read.

    Dates and limits are judged by it, so that a busy service makes nobody late.
    """
    instant: datetime = request.state.arrived_at
    return instant


async def arrival(request: Request) -> datetime:
    """Return `arrival_of`: as a dependency, on the event loop, for it waits for nothing."""
    return arrival_of(request)


def checked_student(student: str) -> str:
    """Return a well-formed student id.

    Raises:
        RefusedError: it is not one.
    """
    if not is_person_id(student):
        raise RefusedError("invalid_student", field="student")
    return student


def submitter(services: Services, caller: Caller, student: str) -> str:
    """Return whose work an upload is, given what its form says.

    Raises:
        RefusedError: it names nobody, or somebody the caller may not hand in for.
    """
    if caller.course is None or caller.person is None:
        return checked_student(student)
    if student in ("", caller.person):
        return caller.person
    if not caller.is_instructor:
        raise RefusedError("forbidden", field="student")
    if services.courses.member(caller.course, checked_student(student)) is None:
        raise RefusedError("unknown_student", field="student")
    return student


def checked_name(file_name: str | None, kind: Input) -> str:
    """Return the last part of the name the student's browser sent, one printable line.

    Raises:
        RefusedError: it is not the name of what the assignment asks for, a Python script or a text.
    """
    name = visible_line(re.split(r"[/\\]", file_name or "")[-1].strip(), _LONGEST_NAME)
    endings = SUFFIXES[kind]
    if not name.lower().endswith(endings) or name.lower() in endings:
        shown = name or "—"
        raise RefusedError(
            "wrong_file_type",
            Text(
                zh=f"收到的文件名是 {shown}，这个作业要交的文件以 {' 或 '.join(endings)} 结尾。",
                en=f"The file is called {shown}; this assignment takes names that end in {' or '.join(endings)}.",
            ),
            field="file",
        )
    return name


def check_content(services: Services, source: bytes, file_name: str, kind: Input) -> None:
    """Refuse what could not run at all.

    Raises:
        RefusedError: too large, empty, not UTF-8, not text, or not Python.
    """
    limit = services.settings.max_upload_bytes
    if len(source) > limit:
        raise too_large(limit)
    try:
        check_source(source, limit)
    except SubmissionError as error:
        raise RefusedError(error.code, Text(zh=error.zh, en=str(error)), field="file") from error
    if kind == "text":
        return
    try:
        problem = services.preflight.check(source, file_name)
    except (InfrastructureError, SandboxError) as error:
        _log.warning("a file was taken without a look at its syntax: %s", error)
        return  # no fault of the file: grading will look at it again
    if problem is not None:
        raise _syntax_error(problem)


def _syntax_error(problem: SyntaxProblem) -> RefusedError:
    kind, _, message = visible_line(problem.message, _LONGEST_LINE).partition(": ")
    error = StudentError(type=kind, message=message or kind, line=problem.line, traceback="")
    _, text = meaning(error, "syntax_error")
    return RefusedError(
        "syntax_error",
        text,
        field="file",
        line=problem.line,
        column=problem.column,
        text=visible_line(problem.text.rstrip("\r\n"), _LONGEST_LINE) or None,
    )
