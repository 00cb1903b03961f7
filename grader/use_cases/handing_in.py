"""Handing in: whose work a file is, whether it may come in now, its form; then it is stored and queued."""

import logging
import re
from dataclasses import dataclass, replace
from datetime import datetime

from grader.contracts.assignment import SUFFIXES, Input
from grader.contracts.errors import InfrastructureError, RefusedError, SandboxError
from grader.contracts.grading import SyntaxProblem
from grader.contracts.identity import Caller, Role, is_person_id
from grader.contracts.outcome import StudentError
from grader.contracts.submission import NewSubmission, Submission
from grader.contracts.upload import check_name, check_source, in_utf8
from grader.formats.packages.bundle import bundled, files_of
from grader.messages.exceptions import meaning
from grader.operation.logs import note
from grader.render.escape import visible_line
from grader.use_cases.assignments import is_own, require_published
from grader.use_cases.services import Services

_log = logging.getLogger(__name__)
_LONGEST_NAME = 100
_LONGEST_LINE = 200
_RETRY_AFTER_S = 5
_MOST_CHECKED = 40  # modules of a package; a grading says what is wrong with others
_UNTOLD = ("unknown_assignment", "too_many_at_once", "too_many_open")  # nothing about what was handed in
_USUAL_S = 0.25  # so long a check counts as one more upload


@dataclass(frozen=True, slots=True, kw_only=True)
class Upload:
    """A file as somebody hands it in; nothing of it is checked yet.

    Attributes:
        student: whose work it is; empty: the caller's own.
        arrived_at: before the file was read. Dates and limits go by it, so that a busy service makes nobody late.
        key: sent again with the same upload by clients that got no answer; it is then stored once.
    """

    assignment: str
    student: str
    file_name: str
    content: bytes
    arrived_at: datetime
    key: str | None = None


def hand_in(services: Services, caller: Caller, upload: Upload) -> tuple[Submission, bool]:
    """Check an upload, store it and queue it for grading.

    Returns:
        The submission, and whether it is an earlier one: the same was sent again.

    Raises:
        RefusedError: it is not accepted, and nothing was stored.
    """
    student = _submitter(services, caller, upload.student)
    owner = f"{caller.course}/{student}"
    services.allowances.uploads.take(owner)
    try:
        submission, repeated = _taken_in(services, caller, upload, student, owner)
    except RefusedError as refusal:
        _note_refusal(services, caller, upload, student, refusal)
        raise
    note(
        submission=submission.id,
        assignment=submission.assignment,
        code="repeated" if repeated else "accepted",
    )
    services.doorbell.ring()
    return submission, repeated


def _taken_in(
    services: Services, caller: Caller, upload: Upload, student: str, owner: str
) -> tuple[Submission, bool]:
    new = NewSubmission(
        course=caller.course,
        student=student,
        assignment=upload.assignment,
        file_name=upload.file_name,
        source=upload.content,
        key=upload.key,
        ruled=caller.role is Role.STUDENT,
        by=None if student == caller.person or caller.course is None else caller.signature,
    )
    with services.allowances.uploads_at_once.one_more(owner):
        checked = _checked(services, caller, new, owner, upload.arrived_at)
        submission, repeated = services.intake.accept(checked, upload.arrived_at)
    if new.ruled and new.course is not None:
        services.courses.begin(
            new.course, [assignment.id for assignment in services.assignments.of(new.course).all()]
        )
    return submission, repeated


def _note_refusal(
    services: Services, caller: Caller, upload: Upload, student: str, refusal: RefusedError
) -> None:
    """Keep that a student's upload was refused, where it was for an assignment that the student sees."""
    course, line = caller.course, refusal.members.get("line")
    if course is None or caller.role is not Role.STUDENT or refusal.code in _UNTOLD:
        return
    name = shown_name(upload.file_name)
    services.refused.add(course, student, upload.assignment, refusal.code, name, line)


def _checked(
    services: Services, caller: Caller, new: NewSubmission, owner: str, arrived_at: datetime
) -> NewSubmission:
    """Return `new` as it is stored: for a published assignment, its name and content checked."""
    published = require_published(services, caller, new.assignment, "unknown_assignment", field="assignment")
    if new.key is None and (refusal := services.intake.refusal(new, arrived_at)) is not None:
        raise refusal.error()  # one with a key may be an upload that was accepted before
    name = _checked_name(new.file_name, published.input)
    source = _checked_content(services, owner, new.source, name, published.input)
    if services.intake.open_count(new.student, new.course) >= services.settings.max_open_submissions:
        raise RefusedError("too_many_open", retry_after_s=_RETRY_AFTER_S, field="student")
    return replace(
        new,
        source=source,
        file_name=name,
        assignment_version=published.version,
        distro=published.distro,
        runs_as=published.runs_as,
        own=is_own(services, caller.course, published.id),
    )


def checked_student(student: str) -> str:
    """Return a well-formed student id. Raises RefusedError: it is not one."""
    if not is_person_id(student):
        raise RefusedError("invalid_student", field="student")
    return student


def _submitter(services: Services, caller: Caller, student: str) -> str:
    """Return whose work an upload is, given what its form says.

    Raises RefusedError: it names nobody, or somebody the caller may not hand in for.
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


def shown_name(file_name: str) -> str:
    """Return the last part of a name that a browser sent, one printable line."""
    return visible_line(re.split(r"[/\\]", file_name)[-1].strip(), _LONGEST_NAME)


def _checked_name(file_name: str, kind: Input) -> str:
    """Return the last part of the name the student's browser sent, one printable line.

    Raises RefusedError: it is not the name of what the assignment asks for, a Python script or a text.
    """
    name = shown_name(file_name)
    check_name(name, SUFFIXES[kind])
    return name


def _checked_content(services: Services, owner: str, source: bytes, file_name: str, kind: Input) -> bytes:
    """Return what is stored of an upload: its bytes, of a zip the package in it, of a text its UTF-8.

    Refuse what could not run at all.

    Raises RefusedError: too large, empty, not UTF-8, not text, not Python, or no package.
    """
    limit = upload_limit(services, kind)
    if len(source) > limit:
        raise too_large(limit)
    if kind == "package":
        return _checked_package(services, owner, source)
    if kind == "text":
        source = in_utf8(source)
    check_source(source, limit)
    if kind != "text":
        _check_syntax(services, owner, source, file_name)
    return source


def upload_limit(services: Services, kind: Input) -> int:
    """Return how many bytes an upload of a kind may have."""
    settings = services.settings
    return settings.max_package_bytes if kind == "package" else settings.max_upload_bytes


def most_upload_bytes(services: Services) -> int:
    """Return how many bytes of an upload are read before its assignment is known."""
    return max(services.settings.max_package_bytes, services.settings.max_upload_bytes)


def _checked_package(services: Services, owner: str, source: bytes) -> bytes:
    """Return the package in a zip; the syntax of its modules is checked, setup.py's, too.

    Raises RefusedError: there is none, or a module is not Python.
    """
    stored = bundled(source)
    modules = {path: content for path, content in files_of(stored).items() if path.endswith(".py")}
    for path in sorted(modules)[:_MOST_CHECKED]:
        if modules[path].strip():
            _check_syntax(services, owner, modules[path], path)
    return stored


def _check_syntax(services: Services, owner: str, source: bytes, file_name: str) -> None:
    """Refuse what is not Python. A check that keeps a process busy for long counts as uploads of `owner`.

    Raises RefusedError: ``syntax_error``.
    """
    try:
        problem = services.preflight.check(
            source, file_name, lambda busy_s: services.allowances.uploads.charge(owner, busy_s / _USUAL_S)
        )
    except (InfrastructureError, SandboxError) as error:
        _log.warning("a file was taken without a look at its syntax: %s", error)
        return  # no fault of the file: grading will look at it again
    if problem is not None:
        raise syntax_refusal(problem, file_name)


def too_large(limit: int) -> RefusedError:
    """Return the refusal of a file of more than `limit` bytes."""
    kib = limit // 1024
    return RefusedError.saying(
        "too_large",
        zh=f"文件最大 {kib} KiB。",
        en=f"A file may have at most {kib} KiB.",
        field="file",
    )


def syntax_refusal(problem: SyntaxProblem, file_name: str) -> RefusedError:
    """Return the refusal of a file that is not Python, in a beginner's words."""
    kind, _, message = visible_line(problem.message, _LONGEST_LINE).partition(": ")
    shown = f'  File "{file_name}", line {problem.line}\n    {problem.text.strip()}\n'
    error = StudentError(type=kind, message=message or kind, line=problem.line, traceback=shown)
    _, text = meaning(error, "syntax_error")
    if "/" in file_name:  # of a package
        text = text.about(file_name)
    return RefusedError(
        "syntax_error",
        text,
        field="file",
        line=problem.line,
        column=problem.column,
        text=visible_line(problem.text.rstrip("\r\n"), _LONGEST_LINE) or None,
    )
