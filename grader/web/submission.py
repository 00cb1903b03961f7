"""The page of one submission: progress, then the result with its replay, and the data both are drawn from."""

from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import JSONResponse

from grader.contracts.assignment import Assignment
from grader.contracts.errors import RefusedError
from grader.contracts.figure import FigureSketch
from grader.contracts.judgement import judged
from grader.contracts.report import report_from
from grader.contracts.submission import StoredReport, Submission, SubmissionState
from grader.render.labels import status_word
from grader.routes import recordings
from grader.routes.dependencies import ServicesDep, SubmissionId
from grader.routes.judgement_views import ManualItemView, manual_items
from grader.routes.submission_document import lateness
from grader.use_cases.assignments import published
from grader.use_cases.services import Services
from grader.use_cases.visibility import shown_list
from grader.web import access
from grader.web.access import Visitor, VisitorDep
from grader.web.pages import language_of, page
from grader.web.result import StreamText, figure_parts, result_page, stream_text
from grader.web.sketches import figure_document, measured_figure, run_of
from grader.web.words import say

router = APIRouter(prefix="/submissions/{submission_id}", include_in_schema=False)
_OPEN = (SubmissionState.QUEUED, SubmissionState.RUNNING)
_REPLAY_WORDS = ("play", "pause", "time", "still", "plan", "v", "w", "turned", "heading")
Case = Annotated[str | None, Query(max_length=64)]


@router.get("")
def read(
    request: Request,
    services: ServicesDep,
    visitor: VisitorDep,
    submission_id: SubmissionId,
    case: Case = None,
) -> Response:
    """Show where a submission stands, and its grading once there is one."""
    submission, stored = access.seen(services, visitor, submission_id)
    assignment = published(services, submission.assignment)
    return page(
        request,
        "submission.html",
        submission=submission,
        assignment=assignment,
        open=submission.state in _OPEN,
        position=_position(services, submission),
        attempts=_attempts(services, visitor, submission),
        late=lateness(submission, services.rules.of(submission.course)),
        corrections=_corrections(request, visitor, submission, stored),
        **_result(request, services, assignment, stored, case),
    )


@router.get("/state.json")
def read_state(
    request: Request, services: ServicesDep, visitor: VisitorDep, submission_id: SubmissionId
) -> Response:
    """Say where a submission stands: what the progress display asks for again and again."""
    submission, _ = access.seen(services, visitor, submission_id)
    state = status_word(submission.state, language_of(request))
    document = {
        "open": submission.state in _OPEN,
        "state": submission.state.value,
        "text": state,
        "position": _position(services, submission),
    }
    return JSONResponse(document, headers={"Cache-Control": "no-store"})


@router.get("/trajectory.json")
def read_trajectory(
    services: ServicesDep,
    visitor: VisitorDep,
    submission_id: SubmissionId,
    case: Case = None,
    accept_encoding: Annotated[str | None, Header()] = None,
) -> Response:
    """Return what the car did, as `grader.routes.recordings` does."""
    access.seen(services, visitor, submission_id)
    response = recordings.trajectory(services, submission_id, case, accept_encoding)
    response.headers["Cache-Control"] = "private, no-cache"
    return response


@router.get("/sketch.json")
def read_sketch(
    request: Request,
    services: ServicesDep,
    visitor: VisitorDep,
    submission_id: SubmissionId,
    case: Case = None,
) -> Response:
    """Return what the checks saw in the motion; an empty object when they cannot say."""
    _, stored = access.seen(services, visitor, submission_id)
    run = None if stored is None else run_of(judged(stored), case)
    figure = (
        None
        if stored is None or run is None
        else measured_figure(services, access.visitor_of(request).caller, stored, run)
    )
    document = {} if figure is None else figure_document(figure, language_of(request))
    return JSONResponse(document, headers={"Cache-Control": "private, no-cache"})


@router.get("/plot.png")
async def read_plot(
    request: Request,
    services: ServicesDep,
    visitor: VisitorDep,
    submission_id: SubmissionId,
    case: Case = None,
) -> Response:
    """Return the picture of one run, for browsers without scripts and for comparing."""
    await run_in_threadpool(access.seen, services, visitor, submission_id)
    return await recordings.picture(
        services, submission_id, visitor.caller, language_of(request), "png", case
    )


def _attempts(services: Services, visitor: Visitor, submission: Submission) -> tuple[Submission, ...]:
    """Return the student's submissions to the same assignment, newest first."""
    own = services.submissions.of_student(submission.student, submission.assignment, course=submission.course)
    return shown_list(services, visitor.caller, own)


def _corrections(
    request: Request, visitor: Visitor, submission: Submission, stored: StoredReport | None
) -> list[ManualItemView]:
    """Return the items in the order of the report, for whoever may correct what the machine gave; else none."""
    if stored is None or not visitor.caller.is_instructor:
        return []
    return manual_items(submission, stored, report_from(stored.content), language_of(request)).items


def _position(services: Services, submission: Submission) -> int | None:
    return services.queue.position(submission.id) if submission.state is SubmissionState.QUEUED else None


def _only_talks(figure: FigureSketch | None) -> bool:
    """Whether the exercise is about log messages: then there is no motion to replay."""
    return figure is not None and figure.view == "log"


def _cut_output(services: Services, stored: StoredReport) -> dict[str, tuple[StreamText, StreamText]]:
    """Return by case what a script had printed that was ended while it was still printing.

    How much it is depends on the moment, so that the report has none of it.
    """
    measured = services.past_gradings.measurements(stored)
    cut = () if measured is None else measured.cut_output
    return {one.case: (stream_text(one.stdout), stream_text(one.stderr)) for one in cut}


def _result(
    request: Request,
    services: Services,
    assignment: Assignment | None,
    stored: StoredReport | None,
    case: str | None,
) -> dict[str, Any]:
    if stored is None:
        return {"result": None, "replay": False}
    language = language_of(request)
    report = judged(stored)
    run = run_of(report, case)
    if run is None and case is not None:
        raise RefusedError("no_trajectory", field="case", allowed=list(stored.cases))
    figure = (
        None if run is None else measured_figure(services, access.visitor_of(request).caller, stored, run)
    )
    names = {name: say(f"figure.{name}", language) for name in ("side", "corner", "gap")}
    return {
        "result": result_page(report, assignment, language),
        "run": run,
        "cut": _cut_output(services, stored),
        "parts": () if figure is None else figure_parts(figure, language, names),
        "replay": run is not None and run.case in stored.cases and not _only_talks(figure),
        "replay_words": {word: say(f"replay.{word}", language) for word in _REPLAY_WORDS},
    }
