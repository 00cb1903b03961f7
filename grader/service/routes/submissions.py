"""Uploads, and what became of them.

What a script wrote is shown in bounded length and with no invisible characters in it.
"""

import hashlib
import math
from collections.abc import Mapping
from contextlib import nullcontext
from datetime import datetime
from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends, File, Form, Header, Query, Request, Response, UploadFile, status
from fastapi.responses import PlainTextResponse
from pydantic import BeforeValidator, Field
from pydantic_core import PydanticCustomError

from grader.contracts.outcome import SHOWN_CHARACTERS, SHOWN_LOGS, Blame, RunStatus
from grader.contracts.record import to_plain
from grader.contracts.report import GradeStatus
from grader.contracts.rubric import ItemStatus
from grader.contracts.submission import Submission, SubmissionFilter, SubmissionState
from grader.contracts.text import Language
from grader.contracts.validation_words import NO_FILE
from grader.formats.packages.bundle import is_package
from grader.render.escape import visible
from grader.render.steps import HintStep
from grader.service.requests.dependencies import (
    COSTLY,
    SUBMISSIONS,
    CredentialsDep,
    ErrandDep,
    LanguageDep,
    QueryWhole,
    ServicesDep,
    SubmissionId,
    is_held,
    on_one_snapshot,
)
from grader.service.requests.middleware import UploadRoute, arrival_of, known_parts
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases import submissions
from grader.use_cases.bodies import Instant
from grader.use_cases.handing_in import Upload, hand_in, most_upload_bytes
from grader.use_cases.receipts import receipt_of
from grader.use_cases.submissions import ShownSubmission
from grader.use_cases.visibility import graded

router = APIRouter(prefix="/api/v1/submissions", tags=["submissions"])
uploads = APIRouter(
    prefix="/api/v1/submissions",
    tags=["submissions"],
    route_class=UploadRoute,
    dependencies=[Depends(known_parts)],
)
_UNKNOWN_S = 2  # where nobody can say when a grading will be done
_LATEST_S = 30
_EXAMPLE_ID = "0197c2f0-8a1b-7c3d-9e4f-5a6b7c8d9e0f"


def _file(value: object) -> object:
    if isinstance(value, str):
        raise PydanticCustomError(*NO_FILE)
    return value


UploadedFile = Annotated[
    UploadFile,
    BeforeValidator(_file),
    File(description="The script as it runs at home, or a text; at most 256 KiB."),
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


class Receipt(View):
    """Answer to an upload: it is stored, and will be graded even if the service is stopped now."""

    id: str = Field(examples=[_EXAMPLE_ID])
    status: SubmissionState = Field(examples=["queued"])
    status_url: str = Field(
        description="Ask here how it went; the same as in Location.", examples=[SUBMISSIONS + _EXAMPLE_ID]
    )
    assignment: str = Field(examples=["square"])
    student: str = Field(examples=["20260123"])
    sha256: str = Field(description="Of the uploaded bytes.", examples=["9f86d081884c7d65" * 4])
    received_at: datetime = Field(examples=["2026-03-02T08:00:00Z"])
    repeated: bool = Field(
        description="This is an earlier submission: the same was sent again. It cost no attempt.",
        examples=[False],
    )


class Links(View):
    """Where the rest of a submission is."""

    self: str = Field(description="This document.", examples=[SUBMISSIONS + _EXAMPLE_ID])
    report: str = Field(
        description="The report, byte for byte.", examples=[f"{SUBMISSIONS}{_EXAMPLE_ID}/report"]
    )
    trajectory: str = Field(
        description="What the car did.", examples=[f"{SUBMISSIONS}{_EXAMPLE_ID}/trajectory"]
    )
    plot: str = Field(description="The same as a picture.", examples=[f"{SUBMISSIONS}{_EXAMPLE_ID}/plot.png"])


class SeenItemView(View):
    """One line of the checklist: what was seen."""

    id: str = Field(examples=["sides"])
    title: str = Field(examples=["Number of sides"])
    status: ItemStatus = Field(examples=["passed"])
    measured: float | None = Field(description="Null when nothing could be measured.", examples=[4.0])
    target: float | None = Field(examples=[4.0])
    tolerance: float | None = Field(examples=[0.0])
    unit: str = Field(description="`m`, `deg`, `s`, `%` or empty.", examples=[""])
    message: str = Field(
        description="What was seen; of an item that a person judged, their comment.",
        examples=["The path has 4 sides."],
    )
    hint: str = Field(description="One next step; empty when there is nothing to do.", examples=[""])


class RubricItemView(SeenItemView):
    """One line of the checklist, judged."""

    points: float = Field(description="Most it can earn.", examples=[5.0])
    earned: float = Field(examples=[5.0])


class ChangedLineView(View):
    """A line before and after a change; null: there was none, or there is none any more."""

    number: int = Field(description="Of the line; of a new one, of the line that it follows.", examples=[12])
    before: str | None = Field(examples=["    msg.angular.z = 90.0"])
    after: str | None = Field(examples=["    msg.angular.z = 1.5708"])


class StepView(View):
    """One thing to do, as far as the rules let it be told: what is not told is empty."""

    fact: str = Field(description="What was measured.", examples=["Corners: 57.3°, wanted 90°."])
    line: str = Field(description="Where it comes from.", examples=["Look at line 12: msg.angular.z = 90.0"])
    change: str = Field(description="What to write instead, and the scores without and with it.")
    lines: list[ChangedLineView] = Field(description="The same, line by line.")


class StreamView(View):
    """Captured text, control characters shown as escapes. It is the student's: escape it for HTML."""

    text: str = Field(examples=["[INFO] [1700000000.000000000] [square_mover]: side 1\n"])
    dropped: int = Field(description="Bytes or characters left out of the middle or end.", examples=[0])


class StudentErrorView(View):
    """The exception that ended the script, with the student's own lines only."""

    type: str = Field(examples=["AssertionError"])
    message: str
    line: int | None = Field(description="Line of the student's file.", examples=[17])
    traceback: str


class EndpointView(View):
    """A publisher, subscription, service or client of the script."""

    kind: str = Field(examples=["publisher"])
    node: str = Field(examples=["/square_mover"])
    name: str = Field(examples=["/turtle1/cmd_vel"])
    type: str = Field(examples=["geometry_msgs/msg/Twist"])
    count: int = Field(description="Messages published or requests sent.", examples=[160])


class LogView(View):
    """One message that reached /rosout."""

    t_s: float = Field(description="Virtual seconds since the start.", examples=[1.5])
    level: int = Field(description="10 debug, 20 info, 30 warning, 40 error, 50 fatal.", examples=[20])
    name: str = Field(examples=["square_mover"])
    message: str = Field(examples=["side 1"])


class RunView(View):
    """What happened in one run of the script."""

    case: str = Field(examples=["default"])
    status: RunStatus = Field(examples=["interrupted"])
    blame: Blame = Field(description="Whose fault the end of the run is.", examples=["nobody"])
    duration_s: float = Field(description="Virtual seconds the script ran.", examples=[60.0])
    exit_code: int | None
    signal: str | None
    error: StudentErrorView | None
    cleanup_error: StudentErrorView | None = Field(description="Raised after Ctrl+C; costs nothing.")
    detail: str
    stdout: StreamView
    stderr: StreamView
    nodes: list[str] = Field(examples=[["/square_mover"]])
    endpoints: list[EndpointView]
    logs: list[LogView] = Field(description="The first ones; all of them are in the report.")
    logs_dropped: int
    command_count: int = Field(description="Velocity commands the car received.", examples=[160])
    nonfinite_commands: int
    trajectory_sha256: str


class SubmissionView(View):
    """Where a submission stands, and its grading once there is one."""

    id: str = Field(examples=[_EXAMPLE_ID])
    student: str = Field(examples=["20260123"])
    assignment: str = Field(examples=["square"])
    file_name: str = Field(examples=["square_mover.py"])
    sha256: str = Field(description="Of the uploaded bytes.")
    size_bytes: int = Field(examples=[1834])
    status: SubmissionState = Field(
        description="`queued` and `running` are on the way. `infrastructure_error` is the service's own "
        "fault: it costs no points and no attempt.",
        examples=["graded"],
    )
    queue_position: int | None = Field(description="Submissions before this one while it waits.")
    estimated_finish_at: datetime | None = Field(
        description="From how long gradings took lately; null when it is graded or nobody can say."
    )
    received_at: datetime
    queued_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    tries: int = Field(description="How often grading was begun since it was queued.", examples=[1])
    verdict: GradeStatus | None = Field(description="How grading ended.", examples=["graded"])
    score: float | None = Field(
        description="With the points that people gave; null while something waits for them.", examples=[10.0]
    )
    max_score: float | None = Field(examples=[10.0])
    to_judge: int | None = Field(description="Rubric items that wait for a person; null: none ever did.")
    late_s: float = Field(description="Seconds after the student's due date.", examples=[0.0])
    kept_share: float = Field(description="Of the points, after lateness.", examples=[1.0])
    kept_score: float | None = Field(description="The score after lateness.", examples=[10.0])
    summary: str = Field(description="One sentence for the student.")
    hint: str = Field(description="The one next step that matters most.")
    mistakes: list[str] = Field(description="Codes of recognised mistakes, likeliest first.")
    steps: list[StepView] = Field(
        description="Changes that were tried and gain points, in the order in which they are to be made. They "
        "come some time after the marks; empty until then, and where none gains."
    )
    rubric: list[RubricItemView]
    runs: list[RunView]
    report_sha256: str | None = Field(description="Equal for equal files and assignments.")
    graded_at: datetime | None
    grader_version: str | None = Field(examples=["0.1.0"])
    assignment_version: int | None = Field(examples=[1])
    links: Links


class SubmissionLine(View):
    """One submission in a list."""

    id: str = Field(examples=[_EXAMPLE_ID])
    student: str = Field(examples=["20260123"])
    assignment: str = Field(examples=["square"])
    file_name: str = Field(examples=["square_mover.py"])
    sha256: str = Field(description="Of the uploaded bytes.")
    size_bytes: int = Field(examples=[1834])
    status: SubmissionState = Field(validation_alias="state", examples=["graded"])
    received_at: datetime
    finished_at: datetime | None
    verdict: GradeStatus | None = Field(examples=["graded"])
    score: float | None = Field(description="Before lateness.", examples=[10.0])
    max_score: float | None = Field(examples=[10.0])
    to_judge: int | None
    report_sha256: str | None


class SubmissionPage(View):
    """Submissions, oldest first."""

    submissions: list[SubmissionLine]
    next_after: str | None = Field(description="The parameter `after` of the next page; null: no more.")


@router.get(
    "",
    summary="The class's submissions",
    responses=responses("invalid_request", "unknown_assignment", "unknown_student"),
)
def read_all(  # noqa: PLR0913
    errand: ErrandDep,
    response: Response,
    *,
    student: Annotated[str | None, Query(max_length=64)] = None,
    assignment: Annotated[str | None, Query(max_length=64)] = None,
    state: Annotated[SubmissionState | None, Query(alias="status")] = None,
    since: Annotated[
        Instant | None,
        Query(description="Received then or later; without an offset on the clock of the course."),
    ] = None,
    after: Annotated[UUID | None, Query(description="From `next_after`.")] = None,
    limit: Annotated[QueryWhole, Query(ge=1, le=1_000)] = 100,
) -> SubmissionPage:
    """Return every submission of the class, page by page; a student gets their own."""
    response.headers["Cache-Control"] = "no-store"
    wanted = SubmissionFilter(
        student=student,
        assignment=assignment,
        state=state,
        since=since,
        after=None if after is None else str(after),
    )
    page, more = submissions.listed(errand.services, errand.caller, wanted, limit)
    lines = [SubmissionLine.of(submission) for submission in page]
    return SubmissionPage(submissions=lines, next_after=more)


@uploads.post(
    "",
    status_code=status.HTTP_202_ACCEPTED,
    response_model=Receipt,
    summary="Upload a script",
    response_description="Stored and queued; Location says where to ask for the result.",
    responses={
        202: {"headers": {"Location": {"description": "The submission.", "schema": {"type": "string"}}}},
        **responses(
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
            "course_archived",
            "unknown_assignment",
            "empty",
            "not_utf8",
            "contains_nul",
            "bad_archive",
            "no_package",
            "syntax_error",
            "key_reused",
            "too_many_open",
        ),
    },
)
def upload(  # noqa: PLR0913
    errand: ErrandDep,
    request: Request,
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
        content=file.file.read(most_upload_bytes(errand.services) + 1),
        arrived_at=arrival_of(request),
        key=idempotency_key,
    )
    submission, repeated = hand_in(errand.services, errand.caller, new)
    added = _receipt(submission, repeated)
    # checked when it was made: to be checked again, it would wait for a thread twice
    return Response(
        added.model_dump_json(),
        status_code=status.HTTP_202_ACCEPTED,
        headers={"Location": added.status_url},
        media_type="application/json",
    )


def _receipt(submission: Submission, repeated: bool) -> Receipt:
    url = SUBMISSIONS + submission.id
    return Receipt.of(submission, status=submission.state, status_url=url, repeated=repeated)


@router.get(
    "/{submission_id}",
    summary="A submission and its grading",
    response_model=SubmissionView,
    responses={
        200: {
            "headers": {
                "ETag": {"description": "Of all but the estimate.", "schema": {"type": "string"}},
                "Retry-After": {
                    "description": "While it is open: seconds until there may be news.",
                    "schema": {"type": "integer"},
                },
            }
        },
        304: {"description": "Nothing changed since the answer with the ETag of If-None-Match."},
        **responses("submission_not_found", "invalid_request"),
    },
)
def read(  # noqa: PLR0913, PLR0917
    request: Request,
    services: ServicesDep,
    credentials: CredentialsDep,
    language: LanguageDep,
    submission_id: SubmissionId,
    if_none_match: Annotated[str | None, Header(max_length=1_000)] = None,
) -> Response:
    """Return where a submission stands; once graded, with score, rubric items, feedback and what ran.

    Whoever waits for the result follows the events, or asks again after the seconds of Retry-After.
    """
    with on_one_snapshot(request, services, credentials) as (errand, snapshot):
        shown = submissions.read(services, errand.caller, submission_id)
        snapshot.close()
        headers = _headers(shown, language, services.clock())
        if if_none_match is not None and is_held(if_none_match, headers["ETag"]):
            return Response(status_code=304, headers=headers)
        # whoever waits for the result asks often
        is_costly = shown.grading is not None
        costly = services.allowances.costly.one_more(errand.caller, f"submission {submission_id}")
        with costly if is_costly else nullcontext():
            content = _view(shown, language).model_dump_json()
    return Response(content, media_type="application/json", headers=headers)


def _headers(shown: ShownSubmission, language: Language, now: datetime) -> dict[str, str]:
    """Return the headers of a submission's answer. Its weak ETag leaves out the estimate, which always moves."""
    grading = shown.grading
    grading_state = None if grading is None else (grading.sha256, grading.judgements)
    explained = None if shown.told is None else (shown.told.report.hint, shown.told.steps)
    state = repr((shown.submission, grading_state, shown.position, shown.lateness, explained, language))
    headers = {
        "Content-Language": language,
        "Vary": "Accept-Language, Authorization",
        "Cache-Control": "private, no-cache",
        "ETag": f'W/"{hashlib.sha256(state.encode()).hexdigest()[:32]}"',
    }
    if submissions.is_open(shown.submission):
        finish = shown.estimated_finish_at
        soon_s = _UNKNOWN_S if finish is None else math.ceil((finish - now).total_seconds())
        headers["Retry-After"] = str(min(max(soon_s, 1), _LATEST_S))
    return headers


@router.get(
    "/{submission_id}/report",
    dependencies=[COSTLY],
    summary="The graded report, byte for byte",
    response_class=Response,
    responses={
        200: {
            "description": "Canonical JSON in both languages; its SHA-256 is the ETag.",
            "content": {"application/json": {"schema": {"type": "object"}}},
        },
        **responses("submission_not_found", "not_graded_yet", "invalid_request"),
    },
)
def read_report(errand: ErrandDep, submission_id: SubmissionId) -> Response:
    """Return the report as it was graded: the same bytes for the same file and assignment.

    While rubric items are hidden, students get a copy without them.
    """
    _, report = graded(errand.services, errand.caller, submission_id)
    return Response(report.content, media_type="application/json", headers={"ETag": f'"{report.sha256}"'})


@router.get(
    "/{submission_id}/source",
    summary="The file as it was handed in",
    response_class=Response,
    responses={
        200: {
            "description": "Byte for byte; its SHA-256 is the ETag.",
            "content": {
                "text/plain": {"schema": {"type": "string"}},
                "application/zip": {"schema": {"type": "string", "format": "binary"}},
            },
        },
        **responses("submission_not_found", "invalid_request"),
    },
)
def read_source(errand: ErrandDep, submission_id: SubmissionId) -> Response:
    """Return what the student uploaded: a script, the answer to a question, or a package as a zip."""
    submission, source = submissions.read_source(errand.services, errand.caller, submission_id)
    headers = {"ETag": f'"{submission.sha256}"'}
    kind = "application/zip" if is_package(source) else "text/plain; charset=utf-8"
    return Response(source, media_type=kind, headers=headers)


@router.get(
    "/{submission_id}/receipt",
    summary="A signed receipt",
    response_class=PlainTextResponse,
    responses=responses("submission_not_found", "invalid_request"),
)
def read_receipt(errand: ErrandDep, submission_id: SubmissionId) -> PlainTextResponse:
    """Return whose file came when, and its SHA-256, with a signature that staff can check later."""
    return PlainTextResponse(receipt_of(errand.services, errand.caller, submission_id))


def _view(read: ShownSubmission, language: Language) -> SubmissionView:
    """Return a submission and its latest grading in `language`."""
    submission, stored, lateness = read.submission, read.grading, read.lateness
    report: Mapping[str, Any] = {} if read.told is None else read.told.report.to_dict()
    steps = () if read.told is None else read.told.steps
    return SubmissionView.of(
        submission,
        status=submission.state,
        queue_position=read.position,
        estimated_finish_at=read.estimated_finish_at,
        late_s=lateness.late_s,
        kept_share=lateness.kept_share,
        kept_score=lateness.kept_score,
        summary=_in_language(report.get("summary"), language),
        hint=_in_language(report.get("hint"), language),
        mistakes=report.get("mistakes", []),
        steps=[_step_view(step, language) for step in steps],
        rubric=[item_view(item, language) for item in report.get("items", [])],
        runs=[run_view(run) for run in report.get("runs", [])],
        graded_at=None if stored is None else stored.finished_at,
        grader_version=report.get("grader_version"),
        assignment_version=report.get("assignment_version"),
        links=_links(SUBMISSIONS + submission.id),
    )


def _links(own: str) -> Links:
    return Links(self=own, report=f"{own}/report", trajectory=f"{own}/trajectory", plot=f"{own}/plot.png")


def _step_view(step: HintStep, language: Language) -> StepView:
    return StepView(
        fact=step.fact.get(language),
        line=step.line.get(language),
        change=step.change.get(language),
        lines=[ChangedLineView(**to_plain(line)) for line in step.lines],
    )


def _in_language(text: Mapping[str, str] | None, language: Language) -> str:
    return "" if text is None else text[language]


def item_view(item: Mapping[str, Any], language: Language) -> RubricItemView:
    """Return an item of a report's plain data in `language`."""
    texts = {name: _in_language(item[name], language) for name in ("title", "message", "hint")}
    return RubricItemView.model_validate({**item, **texts})


def run_view(run: Mapping[str, Any]) -> RunView:
    """Return a run of a report's plain data."""
    outcome = run["outcome"]
    status = RunStatus(outcome["status"])
    logs = outcome["logs"][:SHOWN_LOGS]
    changed = {
        "case": run["case"],
        "blame": status.blame,
        "duration_s": outcome["duration_ns"] / 1e9,
        "error": _error(outcome["error"]),
        "cleanup_error": _error(outcome["cleanup_error"]),
        "detail": visible(outcome["detail"]),
        "stdout": _stream(outcome["stdout"]),
        "stderr": _stream(outcome["stderr"]),
        "nodes": [visible(name) for name in outcome["nodes"]],
        "endpoints": [_visible_values(endpoint) for endpoint in outcome["endpoints"]],
        "logs": [_visible_values({**record, "t_s": record["t_ns"] / 1e9}) for record in logs],
        "logs_dropped": outcome["logs_dropped"] + len(outcome["logs"]) - len(logs),
        "trajectory_sha256": run["trajectory_sha256"],
    }
    return RunView.model_validate({**outcome, **changed})


def _visible_values(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: visible(value) if isinstance(value, str) else value for name, value in values.items()}


def _error(error: Mapping[str, Any] | None) -> StudentErrorView | None:
    return None if error is None else StudentErrorView.model_validate(_visible_values(error))


def _stream(stream: Mapping[str, Any]) -> StreamView:
    text = stream["text"]
    left_out = max(0, len(text) - SHOWN_CHARACTERS)
    return StreamView(text=visible(text[:SHOWN_CHARACTERS]), dropped=stream["dropped_bytes"] + left_out)
