"""Grading again, as pages: choose, watch the trial, look at who gains and loses, then apply or discard."""

import re
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Form, Query, Request, Response
from fastapi.responses import JSONResponse, RedirectResponse
from pydantic import BaseModel, Field

from grader.contracts.errors import RefusedError
from grader.contracts.judgement import judged
from grader.contracts.regrade import Wanted, Which
from grader.messages import on_page
from grader.service.web import access
from grader.service.web.access import InstructorDep, RegradeId, StaffDep, language_of, require_staff
from grader.service.web.comparison import compare
from grader.service.web.errors import form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page
from grader.service.web.regrade_table import PARTS, ChangesQuery, changes
from grader.use_cases import regrading
from grader.use_cases.assignments import published
from grader.use_cases.people import names, person
from grader.use_cases.regrading import Ending, all_regrades, both_gradings, open_regrade, regrade_of

router = APIRouter(prefix="/class/regrades", include_in_schema=False, dependencies=[Depends(require_staff)])
WHICH: tuple[Which, ...] = ("all", "latest", "best", "faults")
_SEPARATORS = re.compile(r"[\s,;，；、]+")
_MOST_STUDENTS = 500
_LONGEST_LIST = 40_000


class Order(BaseModel):
    """What the form says: `students` are ids with anything between them, nobody's for everybody's."""

    assignment: str = Field(default="", max_length=64)
    which: Which = "all"
    students: str = Field(default="", max_length=_LONGEST_LIST)


class DecisionForm(BaseModel):
    """What an instructor decides about a re-grade, and why."""

    decision: Ending
    reason: str = Field(default="", max_length=1_000)


class FormError(BaseModel):
    """Which field was not accepted, and what to do about it."""

    field: Literal["assignment", "which", "students", "reason"]
    text: str


@router.get("")
def read_all(errand: StaffDep, order: Annotated[Order, Query()]) -> Response:
    """Show all re-grades and the form that starts one; `order` fills the form."""
    return _list(errand, order)


@router.post("", dependencies=OWN_FORM)
def start(errand: InstructorDep, order: Annotated[Order, Form()]) -> Response:
    """Start a trial and lead to its page; on a refusal show the form with the reason."""
    students = [id_ for id_ in _SEPARATORS.split(order.students) if id_]
    if len(students) > _MOST_STUDENTS:
        text = on_page(errand.language, "regrade.many_students", most=_MOST_STUDENTS)
        return _list(errand, order, FormError(field="students", text=text))
    try:
        wanted = Wanted(assignment=order.assignment, which=order.which, students=tuple(students))
        started = open_regrade(errand.services, errand.caller, wanted)
    except RefusedError as problem:
        return _list(errand, order, _refusal(errand.request, problem))
    return RedirectResponse(f"/class/regrades/{started.id}", status_code=303)


@router.get("/{regrade_id}")
def read(errand: StaffDep, regrade_id: RegradeId, query: Annotated[ChangesQuery, Query()]) -> Response:
    """Show how far a re-grade is and what it changes."""
    return _one(errand, regrade_id, query)


@router.get("/{regrade_id}/state.json")
def read_state(errand: StaffDep, regrade_id: RegradeId) -> Response:
    """Say how far a trial is: what its page asks for again and again."""
    regrade = regrade_of(errand.services, errand.caller, regrade_id)
    document = {"waiting": regrade.waiting, "total": regrade.total, "open": regrade.state == "open"}
    return JSONResponse(document, headers={"Cache-Control": "no-store"})


@router.post("/{regrade_id}", dependencies=OWN_FORM)
def decide(errand: InstructorDep, regrade_id: RegradeId, form: Annotated[DecisionForm, Form()]) -> Response:
    """Apply or discard; without a reason show the page again."""
    if not form.reason.strip():
        wrong = FormError(field="reason", text=on_page(errand.language, "form.reason_needed"))
        return _one(errand, regrade_id, ChangesQuery(), wrong)
    regrading.decide(errand.services, errand.caller, regrade_id, form.decision, form.reason.strip())
    return RedirectResponse(f"/class/regrades/{regrade_id}", status_code=303)


@router.get("/{regrade_id}/changes/{submission_id}")
def read_change(errand: StaffDep, regrade_id: RegradeId, submission_id: str) -> Response:
    """Show a submission's grading before a re-grade and the one made by it, side by side."""
    regrade, submission, first, second = both_gradings(
        errand.services, errand.caller, regrade_id, submission_id
    )
    both = compare(judged(first), judged(second), "", "", errand.language)
    return page(
        errand.request,
        "compare_gradings.html",
        submission=submission,
        person=person(names(errand.services, errand.caller), submission.student),
        comparison=both,
        gradings=(first, second),
        regrade=regrade,
    )


def _list(errand: access.PageErrand, order: Order, wrong: FormError | None = None) -> Response:
    return page(
        errand.request,
        "regrades.html",
        status=200 if wrong is None else 422,
        regrades=all_regrades(errand.services, errand.caller),
        titles={id_: assignment.title for id_, assignment in errand.assignments.items()},
        assignments=errand.assignments.values(),
        order=order,
        choices=WHICH,
        refusal=wrong,
    )


def _one(
    errand: access.PageErrand, regrade_id: str, query: ChangesQuery, wrong: FormError | None = None
) -> Response:
    regrade = regrade_of(errand.services, errand.caller, regrade_id)
    known, language = names(errand.services, errand.caller), errand.language
    assignment = published(errand.services, errand.caller, regrade.wanted.assignment)
    values: dict[str, Any] = {
        "regrade": regrade,
        "title": regrade.wanted.assignment if assignment is None else assignment.title.get(language),
        "changes": changes(regrade.changes, assignment, known, language, query),
        "parts": PARTS,
        "people": [person(known, student) for student in regrade.wanted.students],
        "refusal": wrong,
    }
    return page(errand.request, "regrade.html", status=200 if wrong is None else 422, **values)


def _refusal(request: Request, problem: RefusedError) -> FormError:
    language = language_of(request)
    if problem.code == "nothing_to_regrade":
        return FormError(field="students", text=on_page(language, "regrade.nothing_fits"))
    if problem.code == "unknown_student" and problem.detail is not None:
        return FormError(field="students", text=problem.detail.get(language))
    if problem.code == "invalid_request" and problem.detail is not None:
        return FormError(field="assignment", text=problem.detail.get(language))
    if problem.code == "regrade_open":
        return FormError(field="assignment", text=on_page(language, "regrade.open_already"))
    return FormError(field="assignment", text=form_problem(problem, language).title)
