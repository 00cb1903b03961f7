"""Points by a person, as pages: what waits, and one answer after the other to one question."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Literal
from urllib.parse import urlencode

from fastapi import APIRouter, Depends, Form, Query, Request, Response
from fastapi.responses import RedirectResponse
from pydantic import BaseModel, Field, ValidationError

from grader.contracts.errors import RefusedError
from grader.contracts.judgement import LONGEST_COMMENT
from grader.contracts.notation import decimal, written
from grader.contracts.submission import Submission
from grader.routes import judgements
from grader.routes.judgement_views import JudgementBody, ManualItemsView, ManualItemView
from grader.store.judgements import WaitingFor
from grader.use_cases.assignments import published
from grader.use_cases.services import Services
from grader.web import access
from grader.web.access import ServicesDep, StaffDep, SubmissionId, Visitor, require_staff
from grader.web.forms import require_own_form
from grader.web.pages import language_of, page
from grader.web.paging import PageQuery, pages_of
from grader.web.roster import named, names

HOME = "/class/judgements"
router = APIRouter(prefix=HOME, include_in_schema=False, dependencies=[Depends(require_staff)])
_PAGE = 50
_CENT = 2  # decimals of points
_MOST_WAITING = 100_000


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Neighbours:
    """Answers to the same question that wait: before and after one in order of arrival, None at the ends."""

    previous: str | None
    next: str | None
    waiting: int


@router.get("")
def read_waiting(
    request: Request, services: ServicesDep, visitor: StaffDep, query: Annotated[WaitingQuery, Query()]
) -> Response:
    """Show what waits for a person: questions, and the answers to them."""
    which = WaitingFor(assignment=query.assignment or None, item=query.item or None)
    listed = judgements.waiting(
        services,
        visitor.caller,
        language_of(request),
        which,
        offset=(query.page - 1) * _PAGE,
        limit=_PAGE,
        anonymous=query.anonymous,
    )
    return page(
        request,
        "judgements.html",
        listed=listed,
        query=query,
        pages=pages_of(listed.total, _PAGE),
        names=names(services, visitor.caller),
        named=named,
    )


@router.get("/{submission_id}")
def read(  # noqa: PLR0913, PLR0917
    request: Request,
    services: ServicesDep,
    visitor: StaffDep,
    submission_id: SubmissionId,
    item: Annotated[str, Query(max_length=128)] = "",
    anonymous: bool = False,
) -> Response:
    """Show one answer and the form for one of its items; without `item` the first that waits."""
    return _desk(request, services, visitor, submission_id, PointsForm(item=item, anonymous=anonymous))


@router.post("/{submission_id}", dependencies=[Depends(require_own_form)])
def judge(
    request: Request,
    services: ServicesDep,
    visitor: StaffDep,
    submission_id: SubmissionId,
    form: Annotated[PointsForm, Form()],
) -> Response:
    """Keep the points and lead to the next answer; on a refusal show the form with the reason at its field."""
    submission, _ = access.seen(services, visitor, submission_id)
    body, errors = _read(form)
    if body is not None:
        try:
            judgements.give(services, visitor.caller, submission.id, form.item, body, form.seen or None)
        except RefusedError as problem:
            if problem.code not in _AT_FIELDS:
                raise
            errors = dict([_AT_FIELDS[problem.code]])
    if errors:
        return _desk(request, services, visitor, submission.id, form, errors)
    around = neighbours(services, submission, form.item)
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


_AT_FIELDS: Mapping[str, tuple[str, str]] = {
    "invalid_points": ("points", "judge.error.points"),
    "points_unchanged": ("points", "judge.error.same"),
    "invalid_request": ("comment", "judge.error.reason"),
    "judged_meanwhile": ("form", "judge.error.meanwhile"),
}
"""Problems that the form shows: the field, and the key of the sentence in ``words.toml``."""


def neighbours(services: Services, submission: Submission, item: str) -> Neighbours:
    """Return what waits before and after `submission`, which may itself be judged already.

    After the last comes the first that still waits, so that nothing that was passed over is forgotten.
    """
    which = WaitingFor(assignment=submission.assignment, item=item)
    waiting = services.judgements.waiting(submission.course, which, 0, _MOST_WAITING)
    here = _place(submission.received_at, submission.id)
    others = [one for one in waiting if one.submission != submission.id]
    before = [one.submission for one in others if _place(one.received_at, one.submission) < here]
    after = [one.submission for one in others if _place(one.received_at, one.submission) > here]
    return Neighbours(
        previous=before[-1] if before else None,
        next=next(iter([*after, *before]), None),
        waiting=len(waiting),
    )


def _place(received_at: datetime, submission_id: str) -> tuple[datetime, str]:
    return received_at, submission_id


def _read(form: PointsForm) -> tuple[JudgementBody | None, dict[str, str]]:
    """Return what was typed, or None and what is wrong with it."""
    try:
        points = _points(form.points.strip())
        comment = form.comment.replace("\r\n", "\n").strip()
        return JudgementBody(points=points, comment=comment), {}
    except ValidationError as error:
        wrong = {str(one["loc"][0]) for one in error.errors()}
    except ValueError:
        wrong = {"points"}
    return None, {name: f"judge.error.{name}" for name in wrong}


def _points(text: str) -> float:
    """Return what was typed as points; a comma before one or two digits is a decimal one.

    Raises:
        ValueError: it is no number, or could be a thousand as well as one.
    """
    units, comma, cents = text.partition(",")
    if comma and len(cents) > _CENT:
        raise ValueError("a comma for thousands")
    return decimal(f"{units}.{cents}" if comma else text)


def _desk(  # noqa: PLR0913, PLR0917
    request: Request,
    services: Services,
    visitor: Visitor,
    submission_id: str,
    form: PointsForm,
    errors: dict[str, str] | None = None,
) -> Response:
    submission, _ = access.seen(services, visitor, submission_id)
    language = language_of(request)
    judged = judgements.items_of(services, visitor.caller, language, submission.id)
    item = _chosen(judged, form.item, corrects=visitor.caller.is_instructor)
    return page(
        request,
        "judge.html",
        status=422 if errors else 200,
        submission=submission,
        judged=judged,
        item=item,
        assignment=published(services, submission.assignment),
        answer=str(services.submissions.source(submission.id) or b"", "utf-8", "replace"),
        form=form if errors else _filled(form, item),
        errors=errors or {},
        around=neighbours(services, submission, item.item),
        name=named(names(services, visitor.caller), submission.student),
        longest=LONGEST_COMMENT,
    )


def _filled(form: PointsForm, item: ManualItemView) -> PointsForm:
    """Return the form with what counts now, if anything does."""
    given = item.judgement
    known: dict[str, str] = {}
    if given is not None:
        known = {"points": written(given.points), "comment": given.comment}
    elif item.machine is not None:
        known = {"points": written(item.machine)}
    return form.model_copy(update=known)


def _chosen(judged: ManualItemsView, item_id: str, *, corrects: bool) -> ManualItemView:
    """Return the item that was asked for, else of those left to people the first that waits, else the first.

    Raises:
        RefusedError: the submission has no such item, or the machine judged it and the visitor `corrects` nothing.
    """
    wanted = [
        one
        for one in judged.items
        if (one.item == item_id if item_id else one.machine is None) and (corrects or one.machine is None)
    ]
    if not wanted:
        raise RefusedError("item_not_found")
    return next((one for one in wanted if one.waits), wanted[0])
