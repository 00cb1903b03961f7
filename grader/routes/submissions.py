"""Uploads, and what became of them."""

from dataclasses import replace
from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Depends, File, Form, Header, Path, Response, UploadFile, status

from grader.contracts.errors import RefusedError, SubmissionError, UploadRefusedError
from grader.contracts.identity import Caller, Role
from grader.contracts.rules import Refusal
from grader.contracts.submission import NewSubmission, StoredReport, Submission, SubmissionState
from grader.contracts.text import Language, Text
from grader.routes.access import ENTRY_PROBLEMS, CallerDep, ServicesDep
from grader.routes.language import requested_language
from grader.routes.problems import responses
from grader.routes.published import require_published
from grader.routes.submission_document import Place, receipt, view
from grader.routes.submission_views import Receipt, SubmissionView
from grader.routes.uploads import UploadRoute, arrival, check_content, checked_name, submitter
from grader.telemetry.context import note
from grader.use_cases import visibility
from grader.use_cases.services import Services

uploads = APIRouter(prefix="/api/v1/submissions", tags=["submissions"], route_class=UploadRoute)

SubmissionId = Annotated[
    str,
    Path(
        description="As the upload was answered with.",
        max_length=64,
        examples=["0197c2f0-8a1b-7c3d-9e4f-5a6b7c8d9e0f"],
    ),
]
UploadedFile = Annotated[
    UploadFile, File(description="The script as it runs at home, or a text; at most 256 KiB.")
]
AssignmentField = Annotated[str, Form(description="Id of the assignment.", examples=["square"])]
StudentField = Annotated[
    str,
    Form(
        description="Student id. In a course it is the caller's when left out; only instructors may hand in for "
        "somebody else.",
        examples=["20260123"],
    ),
]
IdempotencyKey = Annotated[
    str | None,
    Header(
        max_length=255,
        description="Sent again with the same upload when there was no answer: it is then stored once.",
    ),
]
LanguageDep = Annotated[Language, Depends(requested_language)]
_RETRY_AFTER_S = 5


def require_sight(services: ServicesDep, caller: CallerDep, submission_id: SubmissionId) -> None:
    """Dependency of everything that shows one submission.

    Raises:
        RefusedError: there is none of that id, or it is somebody else's: a caller cannot tell which.
    """
    submission = services.submissions.get(submission_id)
    if submission is None or not caller.may_see(submission.course, submission.student):
        raise RefusedError("submission_not_found")
    note(submission=submission.id, assignment=submission.assignment)


SIGHT = Depends(require_sight)
router = APIRouter(prefix="/api/v1/submissions", tags=["submissions"], dependencies=[SIGHT])


@uploads.post(
    "",
    status_code=status.HTTP_202_ACCEPTED,
    response_model=Receipt,
    summary="Upload a script",
    response_description="Stored and queued; Location says where to ask for the result.",
    responses={
        202: {"headers": {"Location": {"description": "The submission.", "schema": {"type": "string"}}}},
        **responses(
            *ENTRY_PROBLEMS,
            "forbidden",
            "malformed_body",
            "too_large",
            "unsupported_media_type",
            "wrong_file_type",
            "invalid_request",
            "invalid_student",
            "unknown_student",
            "not_open_yet",
            "closed",
            "no_attempts_left",
            "no_attempts_today",
            "unknown_assignment",
            "empty",
            "not_utf8",
            "contains_nul",
            "syntax_error",
            "key_reused",
            "too_many_open",
        ),
    },
)
def upload(  # noqa: PLR0913
    services: ServicesDep,
    caller: CallerDep,
    arrived_at: Annotated[datetime, Depends(arrival)],
    *,
    file: UploadedFile,
    assignment: AssignmentField,
    student: StudentField = "",
    idempotency_key: IdempotencyKey = None,
) -> Response:
    """Check a file's form, store it and queue it for grading.

    Nothing of it is executed by the service itself; its syntax is checked in a confined process.
    """
    added = hand_in(services, caller, arrived_at, file, assignment, student, idempotency_key)
    # checked when it was made: to be checked again, it would wait for a thread twice
    return Response(
        added.model_dump_json(),
        status_code=status.HTTP_202_ACCEPTED,
        headers={"Location": added.status_url},
        media_type="application/json",
    )


def hand_in(  # noqa: PLR0913, PLR0917
    services: Services,
    caller: Caller,
    arrived_at: datetime,
    file: UploadFile,
    assignment: str,
    student: str,
    key: str | None = None,
) -> Receipt:
    """Take in what a form brought: check it, store it, queue it.

    Raises:
        RefusedError: it is refused; nothing was stored.
    """
    student = submitter(services, caller, student)
    services.upload_limit.take(f"{caller.course}/{student}")
    new = NewSubmission(
        course=caller.course,
        student=student,
        assignment=assignment,
        file_name=file.filename or "",
        source=b"",
        received_at=arrived_at,
        key=key,
        ruled=caller.role is Role.STUDENT,
        by=None if student == caller.person or caller.course is None else caller.signature,
    )
    submission, repeated = _store(services, new, file)
    code = "repeated" if repeated else "accepted"
    note(submission=submission.id, assignment=submission.assignment, code=code)
    services.doorbell.ring()
    return receipt(submission, repeated=repeated)


def _store(services: Services, new: NewSubmission, file: UploadFile) -> tuple[Submission, bool]:
    """Check a file and store it; return its submission, and whether that is an earlier one."""
    published = require_published(services, new.assignment, "unknown_assignment", field="assignment")
    if new.key is None:  # else it may be one that was accepted before
        _require_accepted(services.submissions.refusal(new))
    name = checked_name(file.filename, published.input)
    source = file.file.read(services.settings.max_upload_bytes + 1)
    check_content(services, source, name, published.input)
    if services.submissions.open_count(new.student, new.course) >= services.settings.max_open_submissions:
        raise RefusedError("too_many_open", retry_after_s=_RETRY_AFTER_S, field="student")
    new = replace(new, file_name=name, source=source, assignment_version=published.version)
    try:
        return services.submissions.accept(new)
    except UploadRefusedError as error:
        raise _refused(error.refusal) from None
    except SubmissionError as error:
        raise RefusedError(error.code) from None


@router.get(
    "/{submission_id}",
    summary="A submission and its grading",
    responses=responses(*ENTRY_PROBLEMS, "submission_not_found", "invalid_request"),
)
def read(
    services: ServicesDep,
    caller: CallerDep,
    response: Response,
    language: LanguageDep,
    submission_id: SubmissionId,
) -> SubmissionView:
    """Return where a submission stands; once graded, with score, rubric items, feedback and what ran."""
    submission, report = visibility.shown(services, caller, *found(services, submission_id))
    waiting = submission.state is SubmissionState.QUEUED
    position = services.queue.position(submission_id) if waiting else None
    response.headers.update(
        {"Content-Language": language, "Vary": "Accept-Language", "Cache-Control": "no-store"}
    )
    known = services.rules.of(submission.course)
    place = Place(position, services.watching.estimates.finish(submission, position))
    return view(submission, report, place, known, language)


@router.get(
    "/{submission_id}/report",
    summary="The graded report, byte for byte",
    response_class=Response,
    responses={
        200: {
            "description": "Canonical JSON in both languages; its SHA-256 is the ETag.",
            "content": {"application/json": {"schema": {"type": "object"}}},
        },
        **responses(*ENTRY_PROBLEMS, "submission_not_found", "not_graded_yet", "invalid_request"),
    },
)
def read_report(services: ServicesDep, caller: CallerDep, submission_id: SubmissionId) -> Response:
    """Return the report as it was graded: the same bytes for the same file and assignment.

    While rubric items are hidden, students get a copy without them.
    """
    _, report = graded(services, submission_id, caller)
    return Response(report.content, media_type="application/json", headers={"ETag": f'"{report.sha256}"'})


@router.get(
    "/{submission_id}/source",
    summary="The file as it was handed in",
    response_class=Response,
    responses={
        200: {
            "description": "Byte for byte; its SHA-256 is the ETag.",
            "content": {"text/plain": {"schema": {"type": "string"}}},
        },
        **responses(*ENTRY_PROBLEMS, "submission_not_found", "invalid_request"),
    },
)
def read_source(services: ServicesDep, submission_id: SubmissionId) -> Response:
    """Return what the student uploaded: a script, or the answer to a question."""
    submission, source = services.submissions.get(submission_id), services.submissions.source(submission_id)
    if submission is None or source is None:
        raise RefusedError("submission_not_found")
    headers = {"ETag": f'"{submission.sha256}"', "Cache-Control": "private, no-cache"}
    return Response(source, media_type="text/plain; charset=utf-8", headers=headers)


def found(services: Services, submission_id: str) -> tuple[Submission, StoredReport | None]:
    """Return a submission and its grading, if there is one yet.

    Raises:
        RefusedError: there is no such submission.
    """
    pair = services.submissions.with_report(submission_id)
    if pair is None:
        raise RefusedError("submission_not_found")
    return pair


def graded(
    services: Services, submission_id: str, caller: Caller | None = None
) -> tuple[Submission, StoredReport]:
    """Return a submission and its latest grading, as `caller` may see it when one is named.

    Raises:
        RefusedError: there is no such submission, or no grading yet.
    """
    submission, report = found(services, submission_id)
    if report is None:
        state = submission.state.value
        detail = Text(zh=f"提交的状态是 {state}。", en=f"The submission is {state}.")
        raise RefusedError("not_graded_yet", detail, retry_after_s=_RETRY_AFTER_S)
    if caller is not None:
        submission, shown = visibility.shown(services, caller, submission, report)
        report = shown or report
    return submission, report


def _require_accepted(refusal: Refusal | None) -> None:
    if refusal is not None:
        raise _refused(refusal)


def _refused(refusal: Refusal) -> RefusedError:
    if refusal.until is None:
        return RefusedError(refusal.code)
    until = refusal.until.isoformat(timespec="seconds")
    detail = Text(zh=f"{until} 之后可以提交。", en=f"Uploads are accepted from {until} on.")
    return RefusedError(refusal.code, detail)
