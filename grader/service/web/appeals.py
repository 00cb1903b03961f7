"""Appeals as pages: the student's form on the submission's page, the staff's queue and answers."""

from functools import partial
from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Form, Query, Response
from fastapi.responses import RedirectResponse
from pydantic import BaseModel, Field

from grader.contracts.appeal import ANSWERS, LONGEST_TEXT, AppealState
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Role, Seen, sections_of
from grader.contracts.judgement import JudgedItem
from grader.service.web import access
from grader.service.web.access import KnownDep, PageErrand, StaffDep, SubmissionId, require_staff
from grader.service.web.forms import OWN_FORM
from grader.service.web.judging import AT_FIELDS, typed_points
from grader.service.web.pages import page
from grader.service.web.paging import PageQuery, pages_of
from grader.store.appeals import AppealsWanted
from grader.use_cases import appealing, judging
from grader.use_cases.appealing import AppealAnswer
from grader.use_cases.assignments import item_title, published
from grader.use_cases.people import members, named, names

HOME = "/class/appeals"
router = APIRouter(prefix=HOME, include_in_schema=False, dependencies=[Depends(require_staff)])
of_submission = APIRouter(prefix="/submissions/{submission_id}/appeals", include_in_schema=False)
_PAGE = 50


class AppealsQuery(PageQuery):
    """Which appeals are listed."""

    state: Literal["open", "answered"] = "open"
    assignment: str = Field(default="", max_length=64)
    section: str = Field(default="", max_length=64)


class AnswerForm(BaseModel):
    """What staff answer, as typed. `seen` names the state of the item that was looked at."""

    item: str = Field(default="", max_length=128)
    decision: Literal["", "answered", "corrected", "refused", "passed_on"] = ""
    text: str = Field(default="", max_length=20_000)
    points: str = Field(default="", max_length=40)
    seen: str = Field(default="", max_length=200)


@of_submission.post("", dependencies=OWN_FORM)
def ask(
    errand: KnownDep,
    submission_id: SubmissionId,
    item: Annotated[str, Form(max_length=128)] = "",
    reason: Annotated[str, Form(max_length=20_000)] = "",
) -> Response:
    """Keep what a student asks about an item, and lead back to it."""
    appealing.ask(errand.services, errand.caller, submission_id, item, reason)
    return _back(submission_id, item)


@of_submission.post("/withdraw", dependencies=OWN_FORM)
def take_back(
    errand: KnownDep, submission_id: SubmissionId, item: Annotated[str, Form(max_length=128)] = ""
) -> Response:
    """Take an open appeal back."""
    appealing.take_back(errand.services, errand.caller, submission_id, item)
    return _back(submission_id, item)


@router.get("")
def read_queue(errand: StaffDep, query: Annotated[AppealsQuery, Query()]) -> Response:
    """Show what students ask: what waits, or what was answered."""
    wanted = AppealsWanted(
        open=query.state == "open", assignment=query.assignment or None, section=query.section or None
    )
    start = (query.page - 1) * _PAGE
    listed = appealing.queue(errand.services, errand.caller, wanted, offset=start, limit=_PAGE)
    students = members(errand.services, errand.caller, Role.STUDENT)
    return page(
        errand.request,
        "appeals.html",
        listed=listed,
        query=query,
        pages=pages_of(listed.total, _PAGE),
        assignments=errand.assignments,
        item_title=partial(item_title, language=errand.language),
        sections=sections_of(students),
        names={student.id: student.name for student in students},
        named=named,
    )


@router.get("/{submission_id}")
def read(
    errand: StaffDep, submission_id: SubmissionId, item: Annotated[str, Query(max_length=128)] = ""
) -> Response:
    """Show one appeal and the form that answers it."""
    return _one(errand, submission_id, AnswerForm(item=item))


@router.post("/{submission_id}", dependencies=OWN_FORM)
def answer(errand: StaffDep, submission_id: SubmissionId, form: Annotated[AnswerForm, Form()]) -> Response:
    """Answer an appeal and lead back to its item; on a refusal show the form with the reason at its field."""
    access.require_sight(errand, submission_id)
    errors = _errors(form)
    if form.decision == "passed_on" and not errors:
        appealing.pass_on(errand.services, errand.caller, submission_id, form.item, form.text)
        return RedirectResponse(HOME, status_code=303)
    if not errors:
        corrects = form.decision == "corrected"
        points = typed_points(form.points.strip()) if corrects else None
        given = AppealAnswer(state=AppealState(form.decision), text=form.text, points=points)
        seen = Seen.one(form.seen) if form.seen else None
        try:
            appealing.answer(errand.services, errand.caller, submission_id, form.item, given, seen=seen)
        except RefusedError as problem:
            if problem.code not in AT_FIELDS:
                raise
            field, key = AT_FIELDS[problem.code]
            errors = {"text" if field == "comment" else field: key}
    if errors:
        return _one(errand, submission_id, form, errors)
    return _back(submission_id, form.item)


def _errors(form: AnswerForm) -> dict[str, str]:
    """Return what is missing: by field, the key of the sentence about it."""
    errors: dict[str, str] = {}
    if not form.decision:
        errors["decision"] = "appeal.error.decision"
    if not form.text.strip():
        errors["text"] = "appeal.error.text"
    if form.decision == "corrected":
        try:
            typed_points(form.points.strip())
        except ValueError:
            errors["points"] = "judge.error.points"
    return errors


def _one(
    errand: PageErrand, submission_id: str, form: AnswerForm, errors: dict[str, str] | None = None
) -> Response:
    submission = access.require_sight(errand, submission_id)
    found = {
        appeal.item: appeal for appeal in appealing.appeals_of(errand.services, errand.caller, submission.id)
    }
    if form.item not in found:
        raise RefusedError("appeal_not_found")
    assignment = published(errand.services, errand.caller, submission.assignment)
    return page(
        errand.request,
        "appeal.html",
        status=422 if errors else 200,
        submission=submission,
        assignment=assignment,
        title=item_title(assignment, form.item, errand.language),
        appeal=found[form.item],
        name=named(names(errand.services, errand.caller), submission.student),
        item=_judged(errand, submission.id, form.item),
        corrects=judging.may_correct(errand.services, errand.caller, submission.assignment),
        form=form,
        errors=errors or {},
        longest_text=LONGEST_TEXT,
        decisions=(*ANSWERS, *(() if errand.caller.is_instructor else ("passed_on",))),
    )


def _judged(errand: PageErrand, submission_id: str, item: str) -> JudgedItem | None:
    """Return the item as it is now; None when a later grading does not have it."""
    items = judging.items_of(errand.services, errand.caller, submission_id)[1]
    return next((result for result in items if result.id == item), None)


def _back(submission_id: str, item: str) -> RedirectResponse:
    return RedirectResponse(f"/submissions/{submission_id}#appeal-{item}", status_code=303)
