"""The page of one submission: progress, then the result with its replay, and the data both are drawn from."""

from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from typing import Annotated, Any
from urllib.parse import quote

from fastapi import APIRouter, Depends, Form, Header, Query, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import HTMLResponse, JSONResponse, PlainTextResponse, RedirectResponse
from fastapi.sse import EventSourceResponse, ServerSentEvent

from grader.contracts.appeal import LONGEST_TEXT
from grader.contracts.assignment import Assignment
from grader.contracts.comment import LONGEST_COMMENT, Comment
from grader.contracts.errors import RefusedError
from grader.contracts.figure import FigureSketch
from grader.contracts.judgement import JudgedItem, judged
from grader.contracts.outcome import StudentError
from grader.contracts.progress import ExplanationStanding, Standing
from grader.contracts.report import report_from
from grader.contracts.submission import StoredReport, Submission
from grader.formats.packages.bundle import line_in_text, text_of
from grader.messages import on_page
from grader.render.steps import first_fact
from grader.service.requests.answers import plot, to_save, trajectory_answer
from grader.service.routes.events import LastEventId, events, owner_of, watched
from grader.service.web import access
from grader.service.web.access import (
    COSTLY,
    DRAWN,
    KnownDep,
    PageErrand,
    ServicesDep,
    SubmissionId,
    language_of,
)
from grader.service.web.comparison import DiffLine, changes
from grader.service.web.forms import OWN_FORM
from grader.service.web.line_links import lines_named
from grader.service.web.pages import fragment, page
from grader.service.web.result import (
    StreamText,
    figure_document,
    figure_parts,
    replay_words,
    result_page,
    stream_text,
)
from grader.service.web.source import SourceView, failing_lines, source_view
from grader.service.web.talk import talk_page
from grader.service.web.waiting import left_s, progress
from grader.use_cases import appealing, commenting, explaining, recordings, submissions
from grader.use_cases.assignments import item_title, published, terms_of
from grader.use_cases.following import Subject, SubjectWatch
from grader.use_cases.judging import judged_items, may_correct
from grader.use_cases.pinning import pinned_to
from grader.use_cases.practising import may_practise
from grader.use_cases.receipts import receipt_of
from grader.use_cases.regrading import look_at_changes
from grader.use_cases.services import Services
from grader.use_cases.teams import handed_in_for
from grader.use_cases.visibility import hiding

router = APIRouter(prefix="/submissions/{submission_id}", include_in_schema=False)
_WRITES_BAGS = find_spec("mcap") is not None
_FIGURE_WORDS = ("side", "corner", "gap", "goal", "avoid", "reached", "not_reached", "clear", "not_clear")
Case = Annotated[str | None, Query(max_length=64)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Changed:
    """What changed in a file since an earlier attempt. `lines` None: the files are too long to be compared."""

    since: Submission
    lines: Sequence[DiffLine] | None


@router.get("", dependencies=[COSTLY])
def read(errand: KnownDep, submission_id: SubmissionId, case: Case = None, *, same: bool = False) -> Response:
    """Show where a submission stands, and its grading once there is one. `same`: the file was sent again."""
    found = submissions.read(errand.services, errand.caller, submission_id)
    submission = found.submission
    access.require_own(errand.visitor, submission)
    assignment = published(errand.services, errand.caller, submission.assignment)
    return page(
        errand.request,
        "submission.html",
        submission=submission,
        pinned=pinned_to(errand.services, found),
        team=handed_in_for(errand.services, errand.caller, submission),
        assignment=assignment,
        progress=progress(
            submission.state,
            found.position,
            left_s(found.estimated_finish_at, errand.services.clock()),
            errand.language,
            is_open=submissions.is_open(submission),
        ),
        late=found.lateness,
        hiding=hiding(errand.services, submission),
        same=same,
        corrections=_corrections(errand, submission, found.grading),
        source=_source(errand.services, submission, found.grading),
        line_of=lambda error: _line_of(errand.services, submission, error),
        **_to_do(errand, submission, assignment, found.grading),
        **_beside(errand, submission),
        **_comments(errand, submission),
        told_changes=look_at_changes(errand.services, errand.caller, submission),
        item_title=partial(item_title, language=errand.language),
        **_appeals(errand, submission, found.grading),
        **_result(errand, assignment, found.grading, case),
    )


@router.post("/comments", dependencies=OWN_FORM)
def write_comment(
    errand: KnownDep,
    submission_id: SubmissionId,
    text: Annotated[str, Form(max_length=20_000)] = "",
    line: Annotated[str, Form(max_length=20)] = "",
) -> Response:
    """Keep what staff or the student write about a submission, and lead back to it."""
    number = None if not line.strip() else int(line) if line.strip().isdecimal() else 0  # there is no line 0
    added = commenting.add_comment(errand.services, errand.caller, submission_id, text, number)
    return RedirectResponse(f"/submissions/{submission_id}#comment-{added.number}", status_code=303)


@router.get("/source")
def download_source(errand: KnownDep, submission_id: SubmissionId) -> Response:
    """Send the file as it was handed in, to be kept: a browser must not show what a student wrote."""
    submission = access.require_sight(errand, submission_id)
    headers = {
        "Content-Disposition": f"attachment; filename*=UTF-8''{quote(submission.file_name, safe='')}",
        "X-Content-Type-Options": "nosniff",
    }
    content = errand.services.submissions.source(submission.id) or b""
    return Response(content, media_type="application/octet-stream", headers=headers)


@router.get("/receipt.txt")
def download_receipt(errand: KnownDep, submission_id: SubmissionId) -> Response:
    """Send the signed receipt, to be kept."""
    submission = access.require_sight(errand, submission_id)
    text = receipt_of(errand.services, errand.caller, submission.id)
    return PlainTextResponse(text, headers=to_save(f"receipt-{submission.id}.txt"))


@router.get("/state.json")
def read_state(errand: KnownDep, submission_id: SubmissionId) -> Response:
    """Say where a submission stands: what the progress display asks for again and again."""
    submission = access.require_sight(errand, submission_id)
    position, estimated_at = submissions.place(errand.services, submission)
    document = progress(
        submission.state,
        position,
        left_s(estimated_at, errand.services.clock()),
        errand.language,
        is_open=submissions.is_open(submission),
    )
    return JSONResponse(document, headers={"Cache-Control": "no-store"})


@asynccontextmanager
async def _watched_as(
    errand: PageErrand, subject: Subject, last_event_id: str | None
) -> AsyncIterator[SubjectWatch]:
    await run_in_threadpool(access.require_sight, errand, str(subject[1]))
    owner = owner_of(errand.caller, f"visitor {errand.visitor.student}")
    async with watched(errand.request, errand.services, subject, owner, last_event_id) as watch:
        yield watch


async def _watched(
    errand: KnownDep, submission_id: SubmissionId, last_event_id: LastEventId = None
) -> AsyncIterator[SubjectWatch]:
    async with _watched_as(errand, ("submission", submission_id), last_event_id) as watch:
        yield watch


async def _watched_explanation(
    errand: KnownDep, submission_id: SubmissionId, last_event_id: LastEventId = None
) -> AsyncIterator[SubjectWatch]:
    async with _watched_as(errand, ("explanation", submission_id), last_event_id) as watch:
        yield watch


def _explanation_event(standing: ExplanationStanding) -> ServerSentEvent:
    return ServerSentEvent(data={"open": not standing.is_final}, event="explanation", id=standing.mark)


@router.get("/events", response_class=EventSourceResponse)
async def follow(
    request: Request,
    services: ServicesDep,
    watch: Annotated[SubjectWatch, Depends(_watched)],
    last_event_id: LastEventId = None,
) -> AsyncIterator[ServerSentEvent]:
    """Send where the submission stands whenever that changes; ends when it is graded."""
    language, life_s = language_of(request), services.watching.limits.life_s

    def event_of(one: Standing) -> ServerSentEvent:
        left = left_s(one.estimated_at, services.clock())
        data = progress(one.state, one.position, left, language, is_open=not one.is_final)
        return ServerSentEvent(data=data, event="progress", id=one.mark)

    async for event in events(watch, last_event_id, life_s, event_of):
        yield event


@router.get("/trajectory.json", dependencies=[COSTLY])
def read_trajectory(
    errand: KnownDep,
    submission_id: SubmissionId,
    case: Case = None,
    accept_encoding: Annotated[str | None, Header()] = None,
) -> Response:
    """Return what the car did, for the replay."""
    access.require_sight(errand, submission_id)
    recording = recordings.trajectory(errand.services, errand.caller, submission_id, case)
    return trajectory_answer(recording, accept_encoding)


@router.get("/sketch.json", dependencies=[COSTLY])
def read_sketch(errand: KnownDep, submission_id: SubmissionId, case: Case = None) -> Response:
    """Return what the checks saw in the motion; an empty object when they cannot say."""
    _, stored = access.seen(errand, submission_id)
    run = None if stored is None else judged(stored).run_of(case)
    if stored is None or run is None:
        return JSONResponse({})
    figure = recordings.measured_figure(errand.services, errand.caller, stored, run)
    document = {} if figure is None else figure_document(figure, errand.language)
    return JSONResponse(document)


@router.get("/recording.mcap", dependencies=[COSTLY])
def read_bag(errand: KnownDep, submission_id: SubmissionId, case: Case = None) -> Response:
    """Return one run as a ROS bag, to be saved."""
    access.require_sight(errand, submission_id)
    bag = recordings.bag(errand.services, errand.caller, submission_id, case)
    headers = {"Content-Disposition": f'attachment; filename="{bag.name}"'}
    return Response(bag.content, media_type="application/octet-stream", headers=headers)


@router.get("/film.png", dependencies=[COSTLY])
def read_film(errand: KnownDep, submission_id: SubmissionId, case: Case = None) -> Response:
    """Return the pictures of a PyBullet world as one that moves."""
    access.require_sight(errand, submission_id)
    drawn = recordings.film(errand.services, errand.caller, submission_id, case)
    headers = {"ETag": f'"{drawn.tag}"'}
    return Response(drawn.content, media_type="image/png", headers=headers)


@router.get("/explanation", dependencies=[COSTLY])
def read_explanation(errand: KnownDep, submission_id: SubmissionId) -> Response:
    """Return the part of the page that says what was tried, nothing where none gains; 202 until then."""
    submission, stored = access.seen(errand, submission_id)
    told = _told(errand, submission, stored)
    if told["steps"] is None:
        return Response(status_code=202, headers={"Cache-Control": "no-store"})
    source = _source(errand.services, submission, stored)
    html = fragment(errand.request, "explanation.html", source=source, **told)
    return HTMLResponse(html.strip(), headers={"Cache-Control": "no-store"})


@router.get("/explanation/events", response_class=EventSourceResponse)
async def follow_explanation(
    services: ServicesDep, watch: Annotated[SubjectWatch, Depends(_watched_explanation)]
) -> AsyncIterator[ServerSentEvent]:
    """Say when the explanation is there, and end."""
    async for event in events(watch, None, services.watching.limits.life_s, _explanation_event):
        yield event


@router.get("/plot.png", dependencies=[DRAWN])
async def read_plot(errand: KnownDep, submission_id: SubmissionId, case: Case = None) -> Response:
    """Return the picture of one run, for browsers without scripts and for comparing."""
    await run_in_threadpool(access.require_sight, errand, submission_id)
    return await plot(errand, submission_id, case, errand.language, "png")


def _to_do(
    errand: PageErrand, submission: Submission, assignment: Assignment | None, stored: StoredReport | None
) -> dict[str, Any]:
    """Return what the page says of the next step."""
    services, caller = errand.services, errand.caller
    untouched = assignment is not None and submissions.is_untouched(services, submission)
    return {
        "untouched": untouched,
        **({"steps": ()} if untouched or stored is None else _told(errand, submission, stored)),
        "mendable": assignment is not None
        and services.practice.offered
        and may_practise(services, caller, assignment),
    }


def _told(errand: PageErrand, submission: Submission, stored: StoredReport | None) -> dict[str, Any]:
    """Return what `explanation.html` says of the lost points.

    `steps`: what was tried; None while it is looked for. `hint`: what the checks take for the cause. `fact`: what
    the first step will say, so that what stands first on the page does not get weaker; of an exception the hint
    stands first, which names its line.
    """
    steps = explaining.told_steps(errand.services, errand.caller, submission, stored)
    if stored is None:
        return {"steps": steps, "hint": "", "fact": ""}
    report = judged(stored)
    hint = report.hint.get(errand.language)
    if not report.mistakes:  # then the hint begins with what was measured
        return {"steps": steps, "hint": "", "fact": hint}
    crashed = any(run.outcome.error is not None for run in report.runs)
    return {"steps": steps, "hint": hint, "fact": "" if crashed else first_fact(report).get(errand.language)}


def _corrections(
    errand: PageErrand, submission: Submission, stored: StoredReport | None
) -> dict[str, JudgedItem]:
    """Return the items by id, for whoever may correct what the machine gave; else none."""
    if stored is None or not may_correct(errand.services, errand.caller, submission.assignment):
        return {}
    return {judged_item.id: judged_item for judged_item in judged_items(stored)}


def _source(services: Services, submission: Submission, stored: StoredReport | None) -> SourceView:
    runs = () if stored is None else report_from(stored.content).runs
    source = services.submissions.source(submission.id) or b""
    return source_view(source, failing_lines(source, runs))


def _line_of(services: Services, submission: Submission, error: StudentError) -> int:
    """Return the line of `source_view` at which an error with a line is."""
    source = services.submissions.source(submission.id) or b""
    return line_in_text(source, error.file, error.line or 0)


def _beside(errand: PageErrand, submission: Submission) -> dict[str, Any]:
    """Return what the page shows beside a submission: other attempts, other students, what the rules say now."""
    caller = errand.caller
    attempts = submissions.history(errand.services, caller, submission.student, submission.assignment)
    own = caller.course is not None and errand.visitor.student == submission.student
    return {
        "attempts": attempts,
        "changed": _changed(errand.services, submission, [attempt.submission for attempt in attempts]),
        "beside": submissions.student_in_class(errand.services, caller, submission)
        if errand.visitor.staff
        else None,
        "terms": terms_of(errand.services, caller, submission.assignment) if own else None,
        "course_progress": submissions.course_progress(errand.services, caller, submission.student)
        if own
        else None,
    }


def _comments(errand: PageErrand, submission: Submission) -> dict[str, Any]:
    """Return the comments by line, those about the whole under None, and what their authors are called."""
    comments = commenting.read_comments(errand.services, errand.caller, submission)
    by_line: dict[int | None, list[Comment]] = {}
    for comment in comments:
        by_line.setdefault(comment.line, []).append(comment)
    return {
        "comments": by_line,
        "authors": commenting.author_names(errand.services, comments, submission.course),
        "longest_comment": LONGEST_COMMENT,
        "may_comment": errand.caller.course is not None,
    }


def _appeals(errand: PageErrand, submission: Submission, stored: StoredReport | None) -> dict[str, Any]:
    """Return the appeals by item, and the items about which the visitor may ask now."""
    known = appealing.look(errand.services, errand.caller, submission)
    return {
        "appeals": known,
        "appealable": appealing.open_to(errand.services, errand.caller, submission, stored, known),
        "longest_appeal": LONGEST_TEXT,
    }


def _changed(services: Services, submission: Submission, attempts: Sequence[Submission]) -> Changed | None:
    """Return what differs from the student's attempt before this one; `attempts` are all, newest first."""
    earlier = attempts[[attempt.id for attempt in attempts].index(submission.id) + 1 :]
    if not earlier:
        return None
    before, after = (
        text_of(services.submissions.source(id_) or b"") for id_ in (earlier[0].id, submission.id)
    )
    return Changed(since=earlier[0], lines=changes(before, after))


def _is_replayed(figure: FigureSketch | None) -> bool:
    """Whether there is a motion to replay: no log messages alone, and no pictures of a PyBullet world."""
    return figure is None or figure.view not in ("log", "frames", "talk")


def _cut_output(services: Services, stored: StoredReport) -> dict[str, tuple[StreamText, StreamText]]:
    """Return by case what a script had printed when it was ended for printing too much.

    How much that is depends on the moment, so it is no part of the report.
    """
    measured = services.submissions.measurements(stored)
    cut = () if measured is None else measured.cut_output
    return {output.case: (stream_text(output.stdout), stream_text(output.stderr)) for output in cut}


def _result(
    errand: PageErrand, assignment: Assignment | None, stored: StoredReport | None, case: str | None
) -> dict[str, Any]:
    if stored is None:
        return {"result": None, "replay": False, "hinted": ()}
    language = errand.language
    report = judged(stored)
    run = report.run_of(case)
    if run is None and case is not None:
        raise RefusedError("no_trajectory", field="case", allowed=list(stored.cases))
    figure = None
    if run is not None:
        figure = recordings.measured_figure(errand.services, errand.caller, stored, run)
    names = {name: on_page(language, f"figure.{name}") for name in _FIGURE_WORDS}
    result = result_page(report, assignment, language)
    in_room = assignment is not None and assignment.world.kind == "robot"
    return {
        "result": result,
        "hinted": lines_named(result.hint),
        "pictures": [part for part in result.runs if in_room and part.case in stored.cases],
        "run": run,
        "cut": _cut_output(errand.services, stored),
        "parts": () if figure is None else figure_parts(figure, names),
        "replay": run is not None and run.case in stored.cases and _is_replayed(figure),
        "film": figure is not None and figure.view == "frames",
        "talk": None
        if run is None
        else talk_page(
            recordings.sayings(errand.services, stored, run.case), run.outcome.duration_ns, language
        ),
        "bags": _WRITES_BAGS,
        "replay_words": replay_words(language),
    }
