"""The instructor's pages: the class matrix, one assignment, one student, two attempts, the service itself."""

from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Depends, Form, Query, Response
from fastapi.responses import RedirectResponse

from grader import __version__
from grader.contracts.errors import RefusedError
from grader.contracts.identity import sections_of
from grader.contracts.judgement import judged
from grader.contracts.report import GradeStatus
from grader.contracts.submission import StoredReport, Submission, SubmissionState
from grader.contracts.text import Language
from grader.formats.packages.bundle import text_of
from grader.messages import outline
from grader.render.labels import status_word
from grader.service.web import access
from grader.service.web.access import InstructorDep, PageErrand, StaffDep, require_staff
from grader.service.web.comparison import compare
from grader.service.web.errors import form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.matrix import SHOWS, MatrixQuery, matrix
from grader.service.web.pages import page
from grader.use_cases.appealing import waiting
from grader.use_cases.assignments import item_title, published
from grader.use_cases.commenting import unread
from grader.use_cases.concerned import Concern, concerned
from grader.use_cases.course_life import counted_space
from grader.use_cases.dashboard import Overview, class_state, costs, overview
from grader.use_cases.own_assignments import own_troubles
from grader.use_cases.people import names, person
from grader.use_cases.pinning import LONGEST_PINNED, pin, pinned
from grader.use_cases.risk import STUCK_ATTEMPTS
from grader.use_cases.services import Services
from grader.use_cases.similar import is_compared

router = APIRouter(prefix="/class", include_in_schema=False, dependencies=[Depends(require_staff)])
_Id = Annotated[str, Query(max_length=64)]
_MOST_COSTLY = 20
_STATUSES = {*SubmissionState, *GradeStatus}


@router.get("")
def read_matrix(errand: StaffDep, query: Annotated[MatrixQuery, Query()]) -> Response:
    """Show students by assignments."""
    whole = _overview(errand)
    return page(
        errand.request,
        "class.html",
        overview=whole,
        matrix=matrix(whole, query, whole.roster),
        sections=sections_of(whole.roster),
        titles={assignment.id: assignment.title for assignment in whole.assignments},
        shows=SHOWS,
        stuck_attempts=STUCK_ATTEMPTS,
        unread=unread(errand.services, errand.caller),
        appeals=waiting(errand.services, errand.caller),
    )


@router.get("/assignments/{assignment_id}")
def read_assignment(errand: StaffDep, assignment_id: str) -> Response:
    """Show how the class does at one assignment: scores, failed items, mistakes."""
    whole = _overview(errand)
    statistics = next(
        (assignment for assignment in whole.assignments if assignment.id == assignment_id), None
    )
    if statistics is None:
        raise RefusedError("assignment_not_found")
    language = errand.language
    mistakes = [
        (most_common_mistake.code, _outline(language, most_common_mistake.code), most_common_mistake.students)
        for most_common_mistake in statistics.most_common_mistakes
    ]
    return page(
        errand.request,
        "class_assignment.html",
        overview=whole,
        statistics=statistics,
        mistakes=mistakes,
        compared=is_compared(published(errand.services, errand.caller, assignment_id)),
    )


@router.get("/assignments/{assignment_id}/students")
def read_concerned(
    errand: StaffDep,
    assignment_id: str,
    item: Annotated[str, Query(max_length=128)] = "",
    mistake: _Id = "",
    status: _Id = "",
) -> Response:
    """Show who failed an item, made a mistake, or whose latest submission has a status."""
    concern = Concern(item=item or None, mistake=mistake or None, status=status or None)
    found = concerned(errand.services, errand.caller, assignment_id, concern)
    language, assignment = errand.language, published(errand.services, errand.caller, assignment_id)
    told = [
        *([item_title(assignment, item, language)] if item else []),
        *([_outline(language, mistake)] if mistake else []),
        *([status_word(status, language) if status in _STATUSES else status] if status else []),
    ]
    return page(
        errand.request,
        "concerned.html",
        found=found,
        concern=concern,
        told=told,
        title=assignment_id if assignment is None else assignment.title.get(language),
        id=assignment_id,
        pinned=pinned(errand.services, errand.caller, assignment_id).get(mistake, "")
        if mistake and assignment is not None
        else None,
        longest=LONGEST_PINNED,
        may_change=errand.caller.is_instructor and errand.caller.course is not None,
    )


@router.post("/assignments/{assignment_id}/pinned", dependencies=OWN_FORM)
def change_pinned(
    errand: InstructorDep,
    assignment_id: str,
    mistake: Annotated[str, Form(min_length=1, max_length=64)],
    text: Annotated[str, Form(max_length=20_000)] = "",
) -> Response:
    """Pin a sentence to a mistake, or take it away."""
    pin(errand.services, errand.caller, assignment_id, mistake, text)
    here = f"/class/assignments/{assignment_id}/students?mistake={quote(mistake)}"
    return RedirectResponse(here, status_code=303)


@router.get("/students/{student}")
def read_student(errand: StaffDep, student: str, assignment: _Id = "") -> Response:
    """Show the attempts of one student, at one assignment or all, two of them to be compared."""
    attempts = errand.services.submissions.of_student(
        student, assignment or None, course=errand.caller.course
    )
    known = names(errand.services, errand.caller)
    if not errand.caller.may_see(errand.caller.course, student) or (not attempts and student not in known):
        raise RefusedError("member_not_found")
    by_assignment: dict[str, list[Submission]] = {id_: [] for id_ in errand.assignments}
    for attempt in attempts:
        by_assignment.setdefault(attempt.assignment, []).append(attempt)
    groups = [(id_, own) for id_, own in by_assignment.items() if own]
    titles = {id_: assignment.title for id_, assignment in errand.assignments.items()}
    return page(
        errand.request,
        "class_student.html",
        student=student,
        person=person(known, student),
        only=assignment,
        groups=groups,
        titles=titles,
        refused=[
            (upload, form_problem(RefusedError(upload.code), errand.language).title)
            for upload in errand.services.refused.of(errand.caller.course, student)
            if assignment in ("", upload.assignment)
        ],
    )


@router.get("/compare")
def read_comparison(errand: StaffDep, first: _Id, second: _Id) -> Response:
    """Show two attempts side by side: rubric items, pictures and what changed in the file."""
    chosen = sorted((_graded(errand, id_) for id_ in (first, second)), key=lambda one: one[0].received_at)
    (earlier, earlier_stored), (later, later_stored) = chosen
    comparison = compare(
        judged(earlier_stored),
        judged(later_stored),
        _source(errand.services, earlier),
        _source(errand.services, later),
        errand.language,
    )
    cases = [tuple(stored.cases) for stored in (earlier_stored, later_stored)]
    return page(
        errand.request, "compare.html", first=earlier, second=later, comparison=comparison, cases=cases
    )


@router.get("/service")
def read_service(errand: StaffDep) -> Response:
    """Show queue, workers and sandbox, and who costs the service most."""
    costly = costs(errand.services, errand.caller)[:_MOST_COSTLY]
    return page(
        errand.request,
        "service.html",
        health=errand.services.health(),
        troubles=own_troubles(errand.services, errand.caller),
        costs=costly,
        space=None if errand.caller.course is None else counted_space(errand.services, errand.caller),
        version=__version__,
    )


def _overview(errand: PageErrand) -> Overview:
    state = class_state(errand.services, errand.caller)
    return overview(errand.services, errand.caller, state, errand.language)


def _graded(errand: PageErrand, submission_id: str) -> tuple[Submission, StoredReport]:
    submission, stored = access.seen(errand, submission_id)
    if stored is None:
        raise RefusedError("not_graded_yet")
    return submission, stored


def _source(services: Services, submission: Submission) -> str:
    return text_of(services.submissions.source(submission.id) or b"")


def _outline(language: Language, code: str) -> str:
    """Return the sentence of a mistake, of a change that was tried or a cause, without its values."""
    known = code if code.startswith(("change.", "cause.")) else f"mistake.{code}"
    return outline(language, known) or code
