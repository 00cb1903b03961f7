"""Uploads, and what became of them."""

from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Depends, File, Form, Header, Response, UploadFile, status
from pydantic import BaseModel, Field

from grader.contracts.submission import SubmissionState
from grader.routes.dependencies import ENTRY_PROBLEMS, CallerDep, LanguageDep, ServicesDep, SubmissionId
from grader.routes.middleware import UploadRoute, arrival
from grader.routes.problems import responses
from grader.routes.submission_views import EXAMPLE_ID, SUBMISSIONS, SubmissionView, submission_view
from grader.use_cases import submissions
from grader.use_cases.handing_in import Upload, hand_in
from grader.use_cases.visibility import graded

uploads = APIRouter(prefix="/api/v1/submissions", tags=["submissions"], route_class=UploadRoute)

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


router = APIRouter(prefix="/api/v1/submissions", tags=["submissions"])


class Receipt(BaseModel):
    """Answer to an upload: it is stored, and will be graded even if the service is stopped now."""

    id: str = Field(examples=[EXAMPLE_ID])
    status: SubmissionState = Field(examples=["queued"])
    status_url: str = Field(
        description="Ask here how it went; the same as in Location.", examples=[SUBMISSIONS + EXAMPLE_ID]
    )
    assignment: str = Field(examples=["square"])
    student: str = Field(examples=["20260123"])
    sha256: str = Field(description="Of the uploaded bytes.", examples=["9f86d081884c7d65" * 4])
    received_at: datetime = Field(examples=["2026-03-02T08:00:00Z"])
    repeated: bool = Field(
        description="This is an earlier submission: the same was sent again. It cost no attempt.",
        examples=[False],
    )


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
    new = Upload(
        assignment=assignment,
        student=student,
        file_name=file.filename or "",
        content=file.file.read(services.settings.max_upload_bytes + 1),
        arrived_at=arrived_at,
        key=idempotency_key,
    )
    submission, repeated = hand_in(services, caller, new)
    added = Receipt(
        id=submission.id,
        status=submission.state,
        status_url=SUBMISSIONS + submission.id,
        assignment=submission.assignment,
        student=submission.student,
        sha256=submission.sha256,
        received_at=submission.received_at,
        repeated=repeated,
    )
    # checked when it was made: to be checked again, it would wait for a thread twice
    return Response(
        added.model_dump_json(),
        status_code=status.HTTP_202_ACCEPTED,
        headers={"Location": added.status_url},
        media_type="application/json",
    )


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
    found = submissions.read(services, caller, submission_id)
    response.headers.update(
        {"Content-Language": language, "Vary": "Accept-Language", "Cache-Control": "no-store"}
    )
    return submission_view(found, language)


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
    _, report = graded(services, caller, submission_id)
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
def read_source(services: ServicesDep, caller: CallerDep, submission_id: SubmissionId) -> Response:
    """Return what the student uploaded: a script, or the answer to a question."""
    submission, source = submissions.read_source(services, caller, submission_id)
    headers = {"ETag": f'"{submission.sha256}"', "Cache-Control": "private, no-cache"}
    return Response(source, media_type="text/plain; charset=utf-8", headers=headers)
