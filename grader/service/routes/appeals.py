"""Appeals: a student asks for another look at a rubric item, staff answer."""

from datetime import datetime
from typing import Annotated, Literal

from fastapi import APIRouter, Query, status
from pydantic import Field

from grader.contracts.appeal import LONGEST_TEXT, Appeal, AppealState
from grader.contracts.comment import COMMENT_PATTERN
from grader.contracts.text import Language
from grader.service.requests.dependencies import (
    SIGHT,
    SUBMISSIONS,
    Errand,
    ErrandDep,
    LanguageDep,
    QueryWhole,
    SectionDep,
    StaffDep,
    SubmissionId,
    seen,
)
from grader.service.routes.judgements import IfMatch, ItemId
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.store.appeals import AppealsWanted
from grader.use_cases import appealing
from grader.use_cases.appealing import AppealAnswer
from grader.use_cases.assignments import item_title, published
from grader.use_cases.bodies import Body, Number

router = APIRouter(prefix="/api/v1/appeals", tags=["appeals"])
of_submission = APIRouter(prefix="/api/v1/submissions", tags=["appeals"], dependencies=[SIGHT])
_ON_READ = ("submission_not_found", "invalid_request")
_BODY = ("malformed_body", "too_large", "forbidden", "course_archived")
_MOST_PER_PAGE = 500
_MOST = 1_000_000
_Words = Annotated[str, Field(min_length=1, max_length=LONGEST_TEXT, pattern=COMMENT_PATTERN)]


class AppealBody(Body):
    """What a student asks to be looked at again."""

    item: Annotated[str, Field(max_length=128, description="Of the rubric.", examples=["closed"])]
    reason: _Words = Field(examples=["The replay shows that the car came back to its start."])


class AnswerBody(Body):
    """What staff make of an open appeal."""

    state: Literal["answered", "corrected", "refused"]
    text: _Words = Field(
        description="For the student.", examples=["It came back, but 0.4 m beside the start."]
    )
    points: Annotated[Number, Field(ge=0.0, allow_inf_nan=False)] | None = Field(
        default=None, description="With `corrected`: what the item gets, as for a judgement.", examples=[None]
    )


class AppealView(View):
    """One appeal."""

    submission: str = Field(description="Its address.")
    student: str = Field(examples=["20260123"])
    assignment: str = Field(examples=["square"])
    item: str = Field(examples=["closed"])
    title: str = Field(examples=["Back at the start"])
    reason: str
    made_at: datetime
    attempt: int = Field(description="Number of the grading that the student looked at.", examples=[1])
    earned: float = Field(description="What the item had then.", examples=[0.0])
    points: float = Field(description="Most it could earn then.", examples=[5.0])
    state: AppealState
    answer: str = Field(description="In words; empty while it is open.")
    answered_by: str | None = Field(description="Null for students, and while it is open.", examples=["wang"])
    answered_at: datetime | None
    passed_on_by: str | None = Field(
        description="Which assistant left it to the instructors; null for students.", examples=["zhang"]
    )
    seen: bool = Field(description="The student has opened the submission's page since it was answered.")


class AppealList(View):
    """The appeals about a submission, in order of their items."""

    appeals: list[AppealView]


class AppealQueue(View):
    """A page of a class's appeals: open ones oldest first, answered ones latest first."""

    total: int = Field(description="Of all pages.", examples=[4])
    waiting: int = Field(description="Open ones of the whole class.", examples=[4])
    appeals: list[AppealView]


@router.get(
    "",
    summary="What students ask to be looked at again",
    responses=responses("forbidden", "invalid_request", "unknown_assignment"),
)
def read_appeals(  # noqa: PLR0913
    errand: StaffDep,
    language: LanguageDep,
    *,
    state: Annotated[Literal["open", "answered"], Query(description="Waiting, or answered.")] = "open",
    assignment: Annotated[str | None, Query(max_length=64)] = None,
    section: SectionDep,
    offset: Annotated[QueryWhole, Query(ge=0, le=_MOST)] = 0,
    limit: Annotated[QueryWhole, Query(ge=1, le=_MOST_PER_PAGE)] = 50,
) -> AppealQueue:
    """Return the appeals of the class."""
    wanted = AppealsWanted(open=state == "open", assignment=assignment, section=section or None)
    page = appealing.queue(errand.services, errand.caller, wanted, offset=offset, limit=limit)
    views = [_view(errand, appeal, language) for appeal in page.appeals]
    return AppealQueue(total=page.total, waiting=page.waiting, appeals=views)


@of_submission.get(
    "/{submission_id}/appeals", summary="The appeals about a submission", responses=responses(*_ON_READ)
)
def read_own(errand: ErrandDep, language: LanguageDep, submission_id: SubmissionId) -> AppealList:
    """Return what its student asked and what staff answered. Reading it here does not mark answers as seen."""
    appeals = appealing.appeals_of(errand.services, errand.caller, submission_id)
    return AppealList(appeals=[_view(errand, appeal, language) for appeal in appeals])


@of_submission.post(
    "/{submission_id}/appeals",
    status_code=status.HTTP_201_CREATED,
    summary="Ask for another look at an item",
    responses=responses(
        *_ON_READ, *_BODY, "not_graded_yet", "no_course", "appeals_closed", "item_not_found", "appeal_exists"
    ),
)
def ask(
    errand: ErrandDep, language: LanguageDep, submission_id: SubmissionId, body: AppealBody
) -> AppealView:
    """Ask, once for each item of a submission, while the rules take appeals (`appeals_until`).

    Only the submission's student may. Items that are hidden, wait for a person, or have all points take none.
    """
    appeal = appealing.ask(errand.services, errand.caller, submission_id, body.item, body.reason)
    return _view(errand, appeal, language)


@of_submission.delete(
    "/{submission_id}/appeals/{item:path}",
    status_code=status.HTTP_204_NO_CONTENT,
    summary="Take an open appeal back",
    responses=responses(*_ON_READ, "forbidden", "appeal_not_found", "appeal_decided", "course_archived"),
)
def take_back(errand: ErrandDep, submission_id: SubmissionId, item: ItemId) -> None:
    """Withdraw one's own appeal while it is open; one may ask again."""
    appealing.take_back(errand.services, errand.caller, submission_id, item)


@of_submission.put(
    "/{submission_id}/appeals/{item:path}",
    summary="Answer an appeal",
    responses=responses(
        *_ON_READ,
        *_BODY,
        "appeal_not_found",
        "appeal_decided",
        "item_not_found",
        "not_graded_yet",
        "judged_meanwhile",
        "invalid_points",
        "points_unchanged",
    ),
)
def answer(  # noqa: PLR0913
    errand: StaffDep,
    language: LanguageDep,
    *,
    submission_id: SubmissionId,
    item: ItemId,
    body: AnswerBody,
    if_match: IfMatch = None,
) -> AppealView:
    """Answer in words, correct the points, or refuse, each with words for the student.

    Points are given as by `PUT …/judgements/{item}`, with the same If-Match; who may not correct the item is
    refused. Whoever gives points there answers the item's open appeal, too.
    """
    reply = AppealAnswer(state=AppealState(body.state), text=body.text, points=body.points)
    appealing.answer(errand.services, errand.caller, submission_id, item, reply, seen=seen(if_match))
    appeals = appealing.appeals_of(errand.services, errand.caller, submission_id)
    return _view(errand, next(appeal for appeal in appeals if appeal.item == item), language)


def _view(errand: Errand, appeal: Appeal, language: Language) -> AppealView:
    return AppealView.of(
        appeal,
        submission=SUBMISSIONS + appeal.submission,
        answered_by=appeal.answered_by or None if errand.caller.is_staff else None,
        passed_on_by=appeal.passed_on_by or None if errand.caller.is_staff else None,
        title=item_title(published(errand.services, errand.caller, appeal.assignment), appeal.item, language),
    )
