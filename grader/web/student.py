"""The student's pages: assignments, handing in, earlier attempts."""

from datetime import datetime
from typing import Annotated, Any
from zoneinfo import ZoneInfo

from fastapi import APIRouter, Depends, File, Form, Request, Response, UploadFile
from fastapi.responses import RedirectResponse

from grader.checks import published_rubric
from grader.contracts.assignment import SUFFIXES, Assignment
from grader.contracts.errors import RefusedError
from grader.contracts.submission import Submission
from grader.contracts.text import Language
from grader.messages import quantity
from grader.routes import rules
from grader.routes.dependencies import ServicesDep
from grader.routes.middleware import UploadRoute, arrival_of
from grader.routes.problem_types import PROBLEM_TYPES, ProblemType
from grader.routes.rule_views import StandingView
from grader.telemetry.context import note
from grader.use_cases import handing_in
from grader.use_cases.assignments import require_published
from grader.use_cases.handing_in import Upload
from grader.use_cases.services import Services
from grader.use_cases.visibility import shown_assignment, shown_list
from grader.web import access
from grader.web.access import Visitor, VisitorDep
from grader.web.audit_lines import Teller
from grader.web.forms import require_own_form
from grader.web.pages import language_of, page
from grader.web.words import say

router = APIRouter(include_in_schema=False)
uploads = APIRouter(include_in_schema=False, route_class=UploadRoute)
_MOST_ATTEMPTS = 50


@router.get("/")
def read_assignments(request: Request, services: ServicesDep, visitor: VisitorDep) -> Response:
    """Show the checklist, with what the student reached so far."""
    attempts = _attempts(services, visitor)
    best: dict[str, Submission] = {}
    for one in attempts:
        if one.score is not None and (
            one.assignment not in best or one.score > (best[one.assignment].score or 0)
        ):
            best[one.assignment] = one
    shown = [shown_assignment(services, visitor.caller, one) for one in services.assignments.all()]
    return page(
        request,
        "assignments.html",
        assignments=shown,
        best=best,
        due=_due(services, visitor),
        now=services.clock(),
    )


@router.get("/assignments/{assignment_id}")
def read_assignment(
    request: Request, services: ServicesDep, _visitor: VisitorDep, assignment_id: str
) -> Response:
    """Show what is asked and how it earns points, and take a file."""
    return _assignment_page(request, require_published(services, assignment_id))


@uploads.post("/assignments/{assignment_id}", dependencies=[Depends(require_own_form)])
def hand_in(  # noqa: PLR0913, PLR0917
    request: Request,
    services: ServicesDep,
    visitor: VisitorDep,
    assignment_id: str,
    file: Annotated[UploadFile, File()],
    student: Annotated[str, Form(max_length=200)] = "",
) -> Response:
    """Take a file and lead to its result; on a refusal show the same page with the reason."""
    assignment = require_published(services, assignment_id)
    if not visitor.open:
        access.require_known(visitor)
    given = visitor.student or student.strip()
    upload = Upload(
        assignment=assignment.id,
        student=given,
        file_name=file.filename or "",
        content=file.file.read(services.settings.max_upload_bytes + 1),
        arrived_at=arrival_of(request),
    )
    try:
        submission, _ = handing_in.hand_in(services, visitor.caller, upload)
    except RefusedError as problem:
        note(code=problem.code)
        return _assignment_page(request, assignment, problem, student)
    response = RedirectResponse(f"/submissions/{submission.id}", status_code=303)
    if visitor.open:
        access.enter_student(request, response, given)
    return response


@router.get("/submissions")
def read_attempts(request: Request, services: ServicesDep, visitor: VisitorDep) -> Response:
    """Show the student's earlier attempts, newest first."""
    access.require_known(visitor)
    titles = {one.id: one.title for one in services.assignments.all()}
    return page(request, "attempts.html", attempts=_attempts(services, visitor), titles=titles)


def _attempts(services: Services, visitor: Visitor, assignment: str | None = None) -> tuple[Submission, ...]:
    if visitor.student is None:
        return ()
    own = services.submissions.of_student(visitor.student, assignment, course=visitor.caller.course)
    return shown_list(services, visitor.caller, own)


def _assignment_page(
    request: Request, assignment: Assignment, problem: RefusedError | None = None, given: str = ""
) -> Response:
    services: Services = request.app.state.services
    visitor, language = access.visitor_of(request), language_of(request)
    standing = _standing(services, visitor, assignment)
    return page(
        request,
        "assignment.html",
        status=200 if problem is None else PROBLEM_TYPES[problem.code].status,
        assignment=assignment,
        rubric=published_rubric(shown_assignment(services, visitor.caller, assignment)),
        standing=standing,
        late="" if standing is None else _late(standing, language),
        attempts=_attempts(services, visitor, assignment.id)[:_MOST_ATTEMPTS],
        suffixes=SUFFIXES[assignment.input],
        max_bytes=services.settings.max_upload_bytes,
        closed=_closed(services, visitor, assignment),
        refusal=None if problem is None else _refusal(problem, language),
        given=given,
    )


def _standing(services: Services, visitor: Visitor, assignment: Assignment) -> StandingView | None:
    """Return dates and attempts for a member of a course."""
    caller = visitor.caller
    if caller.course is None:
        return None
    return rules.standing(services, caller, services.rules.of(caller.course), assignment.id)


def _closed(services: Services, visitor: Visitor, assignment: Assignment) -> ProblemType | None:
    """Return why the rules accept no file from this student now; None when they do."""
    caller = visitor.caller
    if caller.course is None or caller.person is None or caller.is_staff:
        return None
    known = services.rules.of(caller.course)
    attempts = services.submissions.attempts(caller.person, assignment.id, caller.course)
    extension = known.extension(assignment.id, caller.person)
    why = known.of(assignment.id).refusal(extension, attempts, services.clock(), known.zone)
    return None if why is None else PROBLEM_TYPES[why.code]


def _due(services: Services, visitor: Visitor) -> dict[str, datetime | None]:
    """Return by assignment when it is due for a member of a course."""
    if visitor.caller.course is None:
        return {}
    known, person = services.rules.of(visitor.caller.course), visitor.caller.person or ""
    return {
        assignment: rules.due_for(known.extension(assignment, person))
        for assignment, rules in known.by_assignment.items()
    }


def _late(standing: StandingView, language: Language) -> str:
    """Return what handing in after the due date costs, and until when it is possible."""
    accepted_s = standing.rules.accept_late_s
    if accepted_s == 0:
        return say("standing.closed", language)
    teller = Teller(language, ZoneInfo(standing.time_zone))
    cost = teller.value("late", standing.rules.late.model_dump())
    if accepted_s is None:
        return cost
    hours = quantity.exact(accepted_s / 3_600)
    return cost + say("comma", language) + say("rules.accept_short", language, hours=hours)


def _refusal(problem: RefusedError, language: Language) -> dict[str, Any]:
    """Return what the form says about a file that was not accepted."""
    kind, detail = PROBLEM_TYPES[problem.code], problem.detail
    return {
        "field": problem.members.get("field", "file"),
        "title": kind.title.get(language),
        "detail": None if detail is None else detail.get(language),
        "fix": kind.fix.get(language),
        "line": problem.members.get("line"),
        "text": problem.members.get("text"),
    }
