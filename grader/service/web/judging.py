"""Points by a person, as pages: what waits, and one answer after the other to one question."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Literal
from urllib.parse import urlencode

from fastapi import APIRouter, Depends, Form, Query, Response
from fastapi.responses import RedirectResponse
from pydantic import BaseModel, Field

from grader.contracts.comment import LONGEST_COMMENT, is_comment
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Seen
from grader.contracts.judgement import JudgedItem
from grader.contracts.notation import decimal, written
from grader.contracts.submission import Submission
from grader.contracts.upload import decoded
from grader.service.web import access
from grader.service.web.access import PageErrand, StaffDep, SubmissionId, require_staff
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page
from grader.service.web.paging import PageQuery, pages_of
from grader.service.web.source import source_view
from grader.store.judgements import WaitingFor
from grader.use_cases import judging
from grader.use_cases.assignments import item_title, published
from grader.use_cases.people import named, names

HOME = "/class/judgements"
router = APIRouter(prefix=HOME, include_in_schema=False, dependencies=[Depends(require_staff)])
_PAGE = 50
_MOST_ITEMS = 200
_CENT = 2  # decimals of points

AT_FIELDS: Mapping[str, tuple[str, str]] = {
    "invalid_points": ("points", "judge.error.points"),
    "points_unchanged": ("points", "judge.error.same"),
    "invalid_request": ("comment", "judge.error.reason"),
    "judged_meanwhile": ("form", "judge.error.meanwhile"),
}
"""Problems that the form shows: the field, and the id of the sentence about it."""

_SEVERAL = {"invalid_points": "judge.error.some_points", "points_unchanged": "judge.error.some_same"}
"""What a form about several items says otherwise."""


class WaitingQuery(PageQuery):
    """Which waiting answers are listed."""

    assignment: str = Field(default="", max_length=64)
    item: str = Field(default="", max_length=128)
    anonymous: bool = False


class PointsForm(BaseModel):
    """What is given for one item, as typed. `seen` names the state of the item that was looked at."""

    item: str = Field(default="", max_length=128)
    points: str = Field(default="", max_length=40)
    comment: str = Field(default="", max_length=20_000)
    seen: str = Field(default="", max_length=200)
    anonymous: bool = False
    then: Literal["next", "stay", "result"] = "next"


class SeveralPoints(BaseModel):
    """What is given for several items, as typed: the lists belong together line by line."""

    item: list[str] = Field(default_factory=list, max_length=_MOST_ITEMS)
    points: list[str] = Field(default_factory=list, max_length=_MOST_ITEMS)
    seen: list[str] = Field(default_factory=list, max_length=_MOST_ITEMS)
    comment: str = Field(default="", max_length=20_000)


@dataclass(frozen=True, slots=True)
class TypedItem:
    """What is typed for one item of a whole answer."""

    points: str
    comment: str
    seen: str


class WholeForm(BaseModel):
    """What is given for a whole answer, as typed: the lists belong together line by line."""

    item: list[str] = Field(default_factory=list, max_length=_MOST_ITEMS)
    points: list[str] = Field(default_factory=list, max_length=_MOST_ITEMS)
    comment: list[str] = Field(default_factory=list, max_length=_MOST_ITEMS)
    seen: list[str] = Field(default_factory=list, max_length=_MOST_ITEMS)
    anonymous: bool = False

    def of(self, item: JudgedItem) -> TypedItem:
        """Return what is typed for an item, or what was given."""
        comments = (comment.replace("\r\n", "\n").strip() for comment in self.comment)
        lines = zip(self.item, self.points, comments, self.seen, strict=False)
        typed = {name: TypedItem(*rest) for name, *rest in lines}
        return typed.get(item.id) or self.of_now(item)

    @staticmethod
    def of_now(item: JudgedItem) -> TypedItem:
        """Return what counts of an item now."""
        given = item.judgement
        if given is None:
            return TypedItem("", "", item.tag)
        return TypedItem(written(given.points), given.comment, item.tag)


@router.get("")
def read_waiting(errand: StaffDep, query: Annotated[WaitingQuery, Query()]) -> Response:
    """Show what waits for a person: questions, and the answers to them."""
    which = WaitingFor(assignment=query.assignment or None, item=query.item or None)
    listed = judging.waiting(
        errand.services, errand.caller, which, offset=(query.page - 1) * _PAGE, limit=_PAGE
    )
    return page(
        errand.request,
        "judgements.html",
        listed=listed,
        assignments=errand.assignments,
        item_title=partial(item_title, language=errand.language),
        query=query,
        pages=pages_of(listed.total, _PAGE),
        names=names(errand.services, errand.caller),
        named=named,
    )


@router.get("/phrases")
def read_phrases(errand: StaffDep, saved: bool = False) -> Response:
    """Show the comments that are used again, a line each."""
    lines = [f"{key} {text}" for key, text in judging.phrases(errand.services, errand.caller).items()]
    return page(errand.request, "phrases.html", typed="\n".join(lines), wrong="", saved=saved)


@router.post("/phrases", dependencies=OWN_FORM)
def change_phrases(errand: StaffDep, phrases: Annotated[str, Form(max_length=60_000)] = "") -> Response:
    """Keep them, or show the form again with what is wrong."""
    try:
        judging.set_phrases(errand.services, errand.caller, phrases)
    except RefusedError as problem:
        if problem.code != "invalid_request" or problem.detail is None:
            raise
        wrong = problem.detail.get(errand.language)
        return page(errand.request, "phrases.html", status=422, typed=phrases, wrong=wrong, saved=False)
    return RedirectResponse(f"{HOME}/phrases?saved=true", status_code=303)


@router.get("/{submission_id}/whole")
def read_whole(errand: StaffDep, submission_id: SubmissionId, anonymous: bool = False) -> Response:
    """Show a whole answer with everything that a person judges of it."""
    return _whole(errand, submission_id, WholeForm(anonymous=anonymous))


@router.post("/{submission_id}/whole", dependencies=OWN_FORM)
def judge_whole(
    errand: StaffDep, submission_id: SubmissionId, form: Annotated[WholeForm, Form()]
) -> Response:
    """Keep what was typed, all of it or nothing, and lead to the next answer of the assignment that waits."""
    submission, items = _manual(errand, submission_id)
    wanted, errors = _typed_for(form, items)
    if wanted and not errors:
        try:
            judging.give_each(errand.services, errand.caller, submission_id, wanted)
        except RefusedError as problem:
            if problem.code not in AT_FIELDS:
                raise
            errors["form"] = _SEVERAL.get(problem.code, AT_FIELDS[problem.code][1])
    if errors:
        return _whole(errand, submission_id, form, errors)
    around = judging.neighbours(errand.services, errand.caller, submission, None)
    kept = urlencode({"anonymous": int(form.anonymous)})
    address = HOME if around.next is None else f"{HOME}/{around.next}/whole"
    return RedirectResponse(f"{address}?{kept}", status_code=303)


def _typed_for(
    form: WholeForm, items: Sequence[JudgedItem]
) -> tuple[list[tuple[str, float, Seen | None, str]], dict[str, str]]:
    """Return what is given anew for each item, and by field what is wrong; one without points stays as it is."""
    wanted: list[tuple[str, float, Seen | None, str]] = []
    errors: dict[str, str] = {}
    for item in items:
        typed = form.of(item)
        before = form.of_now(item)
        if item.id not in form.item or typed == before or not typed.points.strip():
            continue
        given, wrong = _read(PointsForm(points=typed.points, comment=typed.comment))
        errors |= {f"{field} {item.id}": said for field, said in wrong.items()}
        if given is not None and given[0] > item.points:
            errors[f"points {item.id}"] = "judge.error.points"
        elif given is not None:
            wanted.append((item.id, given[0], Seen.one(typed.seen), given[1]))
    return wanted, errors


def _manual(errand: PageErrand, submission_id: str) -> tuple[Submission, Sequence[JudgedItem]]:
    """Return a submission and those of its items that a person judges.

    Raises RefusedError: there are none.
    """
    submission, items = judging.items_of(errand.services, errand.caller, submission_id)
    manual = [item for item in items if item.machine is None]
    if not manual:
        raise RefusedError("item_not_found")
    return submission, manual


def _whole(
    errand: PageErrand, submission_id: str, form: WholeForm, errors: dict[str, str] | None = None
) -> Response:
    submission, items = _manual(errand, submission_id)
    return page(
        errand.request,
        "judge_whole.html",
        status=422 if errors else 200,
        submission=submission,
        items=items,
        form=form,
        anonymous=form.anonymous,
        assignment=published(errand.services, errand.caller, submission.assignment),
        answer=decoded(errand.services.submissions.source(submission.id) or b""),
        errors=errors or {},
        around=judging.neighbours(errand.services, errand.caller, submission, None),
        name=named(names(errand.services, errand.caller), submission.student),
        longest=LONGEST_COMMENT,
        phrases=judging.phrases(errand.services, errand.caller),
    )


@router.get("/{submission_id}")
def read(
    errand: StaffDep,
    submission_id: SubmissionId,
    item: Annotated[str, Query(max_length=128)] = "",
    anonymous: bool = False,
) -> Response:
    """Show one answer and the form for one of its items; without `item` the first that waits."""
    return _desk(errand, submission_id, PointsForm(item=item, anonymous=anonymous))


@router.post("/{submission_id}", dependencies=OWN_FORM)
def judge(errand: StaffDep, submission_id: SubmissionId, form: Annotated[PointsForm, Form()]) -> Response:
    """Keep the points and lead to the next answer; on a refusal show the form with the reason at its field."""
    submission, _ = access.seen(errand, submission_id)
    given, errors = _read(form)
    if given is not None:
        points, comment = given
        seen = Seen.one(form.seen) if form.seen else None
        try:
            judging.give(
                errand.services,
                errand.caller,
                submission.id,
                form.item,
                points=points,
                comment=comment,
                seen=seen,
            )
        except RefusedError as problem:
            if problem.code not in AT_FIELDS:
                raise
            errors = dict([AT_FIELDS[problem.code]])
    if errors:
        return _desk(errand, submission.id, form, errors)
    around = judging.neighbours(errand.services, errand.caller, submission, form.item)
    kept: dict[str, object] = {"item": form.item, "anonymous": int(form.anonymous)}
    if form.then == "next" and around.next is not None:
        address = f"{HOME}/{around.next}?{urlencode(kept)}"
    elif form.then == "result":
        address = f"/submissions/{submission.id}"
    elif form.then == "next":
        address = HOME + ("?anonymous=1" if form.anonymous else "")
    else:
        address = f"{HOME}/{submission.id}?{urlencode(kept)}"
    return RedirectResponse(address, status_code=303)


@router.get("/{submission_id}/several")
def read_several(errand: StaffDep, submission_id: SubmissionId) -> Response:
    """Show the form that corrects several items of a submission at once."""
    return _several(errand, submission_id, SeveralPoints())


@router.post("/{submission_id}/several", dependencies=OWN_FORM)
def judge_several(
    errand: StaffDep, submission_id: SubmissionId, form: Annotated[SeveralPoints, Form()]
) -> Response:
    """Keep the points that differ from what counts, with one reason; on a refusal show the form again."""
    access.require_sight(errand, submission_id)
    wanted, errors = _changed(form, judging.items_of(errand.services, errand.caller, submission_id)[1])
    comment = form.comment.replace("\r\n", "\n").strip()
    if not comment or not is_comment(comment, LONGEST_COMMENT):
        errors["comment"] = "judge.error.reason" if not comment else "judge.error.comment"
    if not errors and not wanted:
        errors["form"] = "judge.error.nothing"
    if not errors:
        try:
            judging.give_several(errand.services, errand.caller, submission_id, wanted, comment)
        except RefusedError as problem:
            if problem.code not in AT_FIELDS:
                raise
            errors["form"] = _SEVERAL.get(problem.code, AT_FIELDS[problem.code][1])
    if errors:
        return _several(errand, submission_id, form, errors)
    return RedirectResponse(f"/submissions/{submission_id}#items", status_code=303)


def _changed(
    form: SeveralPoints, items: Sequence[JudgedItem]
) -> tuple[list[tuple[str, float, Seen | None]], dict[str, str]]:
    """Return the points that differ from what counts now, and by item what is wrong with them."""
    known = {result.id: result for result in items}
    wanted: list[tuple[str, float, Seen | None]] = []
    errors: dict[str, str] = {}
    for item, typed, seen in zip(form.item, form.points, form.seen, strict=False):
        try:
            points = typed_points(typed.strip())
        except ValueError:
            errors[item] = "judge.error.points"
            continue
        if item in known and points > known[item].points:
            errors[item] = "judge.error.points"
        elif item not in known or points != _counts(known[item]):
            wanted.append((item, points, Seen.one(seen)))
    return wanted, errors


def _counts(item: JudgedItem) -> float | None:
    return item.machine if item.judgement is None else item.judgement.points


def _several(
    errand: PageErrand, submission_id: str, form: SeveralPoints, errors: dict[str, str] | None = None
) -> Response:
    submission, items = judging.items_of(errand.services, errand.caller, submission_id)
    if not judging.may_correct(errand.services, errand.caller, submission.assignment):
        raise RefusedError("forbidden")
    return page(
        errand.request,
        "correct_several.html",
        status=422 if errors else 200,
        submission=submission,
        assignment=published(errand.services, errand.caller, submission.assignment),
        corrections={item.id: item for item in items},
        typed=dict(zip(form.item, form.points, strict=False)),
        reason=form.comment,
        errors=errors or {},
        longest_comment=LONGEST_COMMENT,
    )


def _read(form: PointsForm) -> tuple[tuple[float, str] | None, dict[str, str]]:
    """Return the points and the comment that were typed, or None and what is wrong with which field."""
    errors: dict[str, str] = {}
    comment = form.comment.replace("\r\n", "\n").strip()
    if not is_comment(comment, LONGEST_COMMENT):
        errors["comment"] = "judge.error.comment"
    try:
        points = typed_points(form.points.strip())
    except ValueError:
        errors["points"] = "judge.error.points"
    return (None if errors else (points, comment)), errors


def typed_points(text: str) -> float:
    """Return what was typed as points; a comma before one or two digits is a decimal one.

    Raises ValueError: it is no number from 0, or could be a thousand as well as one.
    """
    units, comma, cents = text.partition(",")
    if comma and len(cents) > _CENT:
        raise ValueError("a comma for thousands")
    points = decimal(f"{units}.{cents}" if comma else text)
    if points < 0.0:
        raise ValueError("points below zero")
    return points


def _desk(
    errand: PageErrand, submission_id: str, form: PointsForm, errors: dict[str, str] | None = None
) -> Response:
    submission, items = judging.items_of(errand.services, errand.caller, submission_id)
    corrects = judging.may_correct(errand.services, errand.caller, submission.assignment)
    item = _chosen(items, form.item, corrects=corrects)
    content = errand.services.submissions.source(submission.id) or b""
    return page(
        errand.request,
        "judge.html",
        status=422 if errors else 200,
        submission=submission,
        items=items,
        item=item,
        assignment=published(errand.services, errand.caller, submission.assignment),
        answer=decoded(content),
        source=source_view(content, {}) if submission.file_name.endswith((".py", ".zip")) else None,
        form=form if errors else _filled(form, item),
        errors=errors or {},
        around=judging.neighbours(errand.services, errand.caller, submission, item.id),
        name=named(names(errand.services, errand.caller), submission.student),
        longest=LONGEST_COMMENT,
        phrases=judging.phrases(errand.services, errand.caller),
    )


def _filled(form: PointsForm, item: JudgedItem) -> PointsForm:
    """Return the form with what counts now, if anything does."""
    given = item.judgement
    known: dict[str, str] = {}
    if given is not None:
        known = {"points": written(given.points), "comment": given.comment}
    elif item.machine is not None:
        known = {"points": written(item.machine)}
    return form.model_copy(update=known)


def _chosen(items: Sequence[JudgedItem], item_id: str, *, corrects: bool) -> JudgedItem:
    """Return the item that was asked for, else of those left to people the first that waits, else the first.

    Raises:
        RefusedError: the submission has no such item, or the machine judged it and the visitor `corrects` nothing.
    """
    wanted = [
        item
        for item in items
        if (item.id == item_id if item_id else item.machine is None) and (corrects or item.machine is None)
    ]
    if not wanted:
        raise RefusedError("item_not_found")
    return next((row for row in wanted if row.waits), wanted[0])
