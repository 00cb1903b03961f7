"""The student's pages: assignments, handing in, earlier attempts."""

from dataclasses import asdict, replace
from typing import Annotated

from fastapi import APIRouter, File, Form, Response, UploadFile
from fastapi.responses import RedirectResponse

from grader.checks import published_rubric
from grader.contracts.assignment import SUFFIXES, Assignment
from grader.contracts.errors import RefusedError
from grader.contracts.text import Language
from grader.contracts.upload import MAX_SOURCE_BYTES
from grader.messages import on_page, quantity
from grader.operation.logs import note
from grader.render.audit_lines import Teller
from grader.service.requests.middleware import UploadRoute, arrival_of
from grader.service.web import access
from grader.service.web.access import COSTLY, KnownDep, MemberDep, PageErrand
from grader.service.web.errors import form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page
from grader.use_cases.appealing import pending
from grader.use_cases.assignments import Terms, all_terms, checklist, terms_of, visible_assignment
from grader.use_cases.commenting import unread
from grader.use_cases.handing_in import Upload, hand_in, most_upload_bytes, upload_limit
from grader.use_cases.practising import may_practise
from grader.use_cases.regrading import unseen_changes
from grader.use_cases.submissions import PastAttempt, best_of, course_progress, history
from grader.use_cases.teams import own_team, people_of

router = APIRouter(include_in_schema=False)
uploads = APIRouter(include_in_schema=False, route_class=UploadRoute)
_ANSWER = "answer.txt"  # how a text is called that was written on the page
_MOST_ATTEMPTS = 50


@router.get("/", dependencies=[COSTLY])
def read_assignments(errand: MemberDep) -> Response:
    """Show the checklist, with what the student reached so far."""
    own = [one.submission for one in _attempts(errand)]
    return page(
        errand.request,
        "assignments.html",
        assignments=checklist(errand.services, errand.caller),
        best=best_of(own),
        latest={one.assignment: one for one in reversed(own)},
        terms=all_terms(errand.services, errand.caller),
        course_progress=None
        if errand.visitor.student is None
        else course_progress(errand.services, errand.caller, errand.visitor.student),
        now=errand.services.clock(),
        unread=unread(errand.services, errand.caller),
        appeals=pending(errand.services, errand.caller),
        changed=unseen_changes(errand.services, errand.caller),
    )


@router.get("/assignments/{assignment_id}", dependencies=[COSTLY])
def read_assignment(errand: MemberDep, assignment_id: str) -> Response:
    """Show what is asked and how it earns points, and take a file."""
    return _assignment_page(errand, visible_assignment(errand.services, errand.caller, assignment_id))


@uploads.post("/assignments/{assignment_id}", dependencies=OWN_FORM)
def take_file(
    errand: MemberDep,
    assignment_id: str,
    file: Annotated[UploadFile | None, File()] = None,
    student: Annotated[str, Form(max_length=200)] = "",
    text: Annotated[str, Form(max_length=MAX_SOURCE_BYTES)] = "",
) -> Response:
    """Take a file, or a text that was written, and lead to its result; on a refusal show the page with the reason.

    None was chosen where a browser does not insist on it: it is refused as any file without a name.
    """
    assignment = visible_assignment(errand.services, errand.caller, assignment_id)
    given = errand.visitor.student or student.strip()
    name = "" if file is None else file.filename or ""
    content = b"" if file is None else file.file.read(most_upload_bytes(errand.services) + 1)
    if assignment.input == "text" and not name:  # nothing written is refused as empty
        name, content = _ANSWER, text.replace("\r\n", "\n").encode()
    upload = Upload(
        assignment=assignment.id,
        student=given,
        file_name=name,
        content=content,
        arrived_at=arrival_of(errand.request),
    )
    try:
        submission, repeated = hand_in(errand.services, errand.caller, upload)
    except RefusedError as problem:
        note(code=problem.code)
        return _assignment_page(errand, assignment, problem, student, text)
    same = "?same=true" if repeated else ""
    response = RedirectResponse(f"/submissions/{submission.id}{same}", status_code=303)
    if errand.visitor.open:
        access.enter_student(errand.request, response, given)
    return response


@router.get("/submissions", dependencies=[COSTLY])
def read_attempts(errand: KnownDep) -> Response:
    """Show the student's earlier attempts, newest first."""
    titles = {one.id: one.title for one in errand.services.assignments.of(errand.caller.course).all()}
    own = _attempts(errand)
    return page(
        errand.request,
        "attempts.html",
        attempts=own,
        titles=titles,
        terms=all_terms(errand.services, errand.caller),
        newest={one.submission.assignment: one.submission.id for one in reversed(own)},
    )


def _attempts(errand: PageErrand, assignment: str | None = None) -> tuple[PastAttempt, ...]:
    student = errand.visitor.student
    return () if student is None else history(errand.services, errand.caller, student, assignment)


def _assignment_page(
    errand: PageErrand,
    assignment: Assignment,
    problem: RefusedError | None = None,
    given: str = "",
    text: str = "",
) -> Response:
    services, caller, language = errand.services, errand.caller, errand.language
    terms = None if caller.course is None else terms_of(services, caller, assignment.id)
    closed = None if terms is None or terms.refusal is None else RefusedError(terms.refusal.code)
    refused = None if problem is None else form_problem(problem, language, field="file")
    if refused is not None and refused.code == "empty" and assignment.input == "text":
        title, fix = on_page(language, "upload.no_answer"), on_page(language, "upload.no_answer.fix")
        refused = replace(refused, title=title, fix=fix, detail=None)
    team, _ = own_team(services, caller, assignment.id)
    return page(
        errand.request,
        "assignment.html",
        status=200 if refused is None else refused.status,
        assignment=assignment,
        rubric=published_rubric(assignment),
        terms=terms,
        late="" if terms is None else _late(terms, language),
        attempts=_attempts(errand, assignment.id)[:_MOST_ATTEMPTS],
        suffixes=SUFFIXES[assignment.input],
        max_bytes=upload_limit(services, assignment.input),
        closed=None if closed is None else form_problem(closed, language),
        refusal=refused,
        given=given,
        text=text,
        team=team,
        team_people=[] if team is None else people_of(services, caller, team.members),
        practice=services.practice.offered and may_practise(services, caller, assignment),
    )


def _late(terms: Terms, language: Language) -> str:
    """Return what handing in after the due date costs, and until when it is possible."""
    accepted_s = terms.rules.accept_late_s
    if accepted_s == 0:
        return on_page(language, "standing.closed")
    cost = Teller(language, terms.zone).value("late", asdict(terms.rules.late))
    if accepted_s is None:
        return cost
    hours = quantity.exact(accepted_s / 3_600)
    return cost + on_page(language, "comma") + on_page(language, "rules.accept_short", hours=hours)
