"""Points that people give for what no machine judges or correct: what waits for them, and what they gave."""

from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Header, Path, Query, Response
from pydantic import Field

from grader.contracts.comment import COMMENT_PATTERN, LONGEST_COMMENT
from grader.contracts.errors import RefusedError
from grader.contracts.judgement import JudgedItem
from grader.contracts.text import Language
from grader.service.requests.dependencies import (
    SIGHT,
    SUBMISSIONS,
    Errand,
    LanguageDep,
    QueryWhole,
    StaffDep,
    SubmissionId,
    etag,
    seen,
)
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.store.judgements import WaitingFor
from grader.use_cases import judging
from grader.use_cases.assignments import item_title
from grader.use_cases.bodies import Body, Number
from grader.use_cases.judging import WaitingPage

router = APIRouter(prefix="/api/v1/judgements", tags=["judgements"])
of_submission = APIRouter(prefix="/api/v1/submissions", tags=["judgements"], dependencies=[SIGHT])
ItemId = Annotated[
    str,
    Path(
        max_length=128,
        description="Id of the rubric item; `case/id` when there are several cases.",
        examples=["timer"],
    ),
]
IfMatch = Annotated[
    str | None,
    Header(
        max_length=1_000,
        description="The `etag` of the state that was looked at, or several of them; `*`: whatever it is. "
        "Left out: nobody had judged the item then.",
    ),
]
_Id = Annotated[str | None, Query(max_length=128)]
_ON_READ = ("forbidden", "submission_not_found", "not_graded_yet", "invalid_request")
_ON_JUDGING = (
    "malformed_body",
    "too_large",
    "course_archived",
    "item_not_found",
    "judged_meanwhile",
    "invalid_points",
    "points_unchanged",
)
_MOST_PER_PAGE = 500
_MOST = 1_000_000
_ETAG = {"ETag": {"description": "Of the item's state.", "schema": {"type": "string"}}}


class JudgementBody(Body):
    """What a person gives for one rubric item."""

    points: Annotated[
        Number,
        Field(
            ge=0.0,
            allow_inf_nan=False,
            description="From 0 to the most the item can earn, with at most two decimals.",
            examples=[22.5],
        ),
    ]
    comment: Annotated[
        str,
        Field(
            max_length=LONGEST_COMMENT,
            pattern=COMMENT_PATTERN,
            description="For the student, in place of the sentence that says that somebody graded this. Required "
            "where the machine judged.",
            examples=["What a timer does is right; say also who calls the callback."],
        ),
    ] = ""


class ItemPoints(Body):
    """Points for one of several rubric items."""

    item: Annotated[str, Field(max_length=128, examples=["closed"])]
    points: Annotated[Number, Field(ge=0.0, allow_inf_nan=False, examples=[4.0])]
    etag: Annotated[
        str | None,
        Field(
            max_length=1_000,
            description="Of the item's state that was looked at, as in If-Match; null: nobody had judged it then.",
            examples=['"0.9f86d081884c7d65"'],
        ),
    ] = None


class JudgementsBody(Body):
    """What a person gives for several rubric items, with one comment."""

    items: Annotated[list[ItemPoints], Field(min_length=1, max_length=200)]
    comment: Annotated[str, Field(max_length=LONGEST_COMMENT, pattern=COMMENT_PATTERN)] = ""


class JudgementView(View):
    """What somebody gave."""

    revision: int = Field(description="1 for the first judgement of the item.", examples=[1])
    points: float = Field(examples=[22.5])
    out_of: float = Field(
        description="Most the item could earn then; 0: earlier corrections were taken back.", examples=[45.0]
    )
    comment: str
    by: str = Field(examples=["wang"])
    at: datetime
    attempt: int = Field(description="Number of the grading that was looked at.", examples=[1])
    source_sha256: str = Field(description="Digest of the answer that was judged.")


class ManualItemView(View):
    """One rubric item, and what people gave for it."""

    item: str = Field(examples=["timer"])
    title: str = Field(examples=["What create_timer does"])
    points: float = Field(description="Most it can earn.", examples=[45.0])
    machine: float | None = Field(
        description="What the machine gave; null: it leaves the item to people.", examples=[None]
    )
    waits: bool = Field(
        description="It is left to people, and nobody has judged it yet, or not since it has these points."
    )
    judgement: JudgementView | None = Field(
        description="The one that counts; null while it waits, or while the machine's points count."
    )
    history: list[JudgementView] = Field(description="All, oldest first.")
    etag: str = Field(
        description="Of this state: to be sent as If-Match with the next judgement.",
        examples=['"0.9f86d081884c7d65"'],
    )


class ManualItemsView(View):
    """The rubric items of one submission, and what people gave for them."""

    submission: str = Field(description="Its address.")
    source: str = Field(description="Address of the answer as it was handed in.")
    student: str = Field(examples=["20260123"])
    assignment: str = Field(examples=["theory_publisher_timer"])
    score: float | None = Field(description="Null while something waits.", examples=[82.5])
    max_score: float | None = Field(examples=[100.0])
    items: list[ManualItemView]


class QuestionView(View):
    """How many answers to one question wait."""

    assignment: str = Field(examples=["theory_publisher_timer"])
    assignment_title: str = Field(examples=["Question: publisher and timer"])
    item: str = Field(examples=["timer"])
    title: str = Field(examples=["What create_timer does"])
    waiting: int = Field(examples=[17])


class WaitingView(View):
    """One rubric item of one submission that waits for a person."""

    submission: str = Field(description="Its address.")
    source: str = Field(description="Address of the answer as it was handed in.")
    judgement: str = Field(description="Address to put points to.")
    student: str | None = Field(description="Null when names are left out.", examples=["20260123"])
    assignment: str = Field(examples=["theory_publisher_timer"])
    item: str = Field(examples=["timer"])
    title: str = Field(examples=["What create_timer does"])
    points: float = Field(description="Most it can earn.", examples=[45.0])
    received_at: datetime


class WaitingList(View):
    """A page of what waits for a person: question by question, each in order of arrival."""

    total: int = Field(description="Of all pages.", examples=[34])
    questions: list[QuestionView] = Field(description="All that have something waiting.")
    waiting: list[WaitingView]


@router.get(
    "/waiting",
    summary="What waits for a person",
    responses=responses("forbidden", "invalid_request", "unknown_assignment"),
)
def read_waiting(  # noqa: PLR0913
    errand: StaffDep,
    language: LanguageDep,
    *,
    assignment: _Id = None,
    item: _Id = None,
    every: Annotated[
        bool, Query(description="Earlier submissions, too; else of each student the newest only.")
    ] = False,
    anonymous: Annotated[bool, Query(description="Leave out whose they are.")] = False,
    offset: Annotated[QueryWhole, Query(ge=0, le=_MOST)] = 0,
    limit: Annotated[QueryWhole, Query(ge=1, le=_MOST_PER_PAGE)] = 50,
) -> WaitingList:
    """Return answers to be judged, question by question, so that one question is judged with one measure."""
    which = WaitingFor(assignment=assignment, item=item, newest=not every)
    page = judging.waiting(errand.services, errand.caller, which, offset=offset, limit=limit)
    return _waiting(errand, page, language, anonymous=anonymous)


@of_submission.get(
    "/{submission_id}/judgements",
    summary="What people gave for a submission's items",
    responses=responses(*_ON_READ),
)
def read_judgements(errand: StaffDep, language: LanguageDep, submission_id: SubmissionId) -> ManualItemsView:
    """Return every rubric item, whether it is left to people, and what was given by whom and when."""
    return _all_items(errand, language, submission_id)


@of_submission.put(
    "/{submission_id}/judgements",
    summary="Give points for several rubric items",
    responses=responses(*_ON_READ, *_ON_JUDGING),
)
def judge_several(
    errand: StaffDep, language: LanguageDep, submission_id: SubmissionId, body: JudgementsBody
) -> ManualItemsView:
    """Add a judgement for each item that is named, with the same comment, all of them or none."""
    points = [(item.item, item.points, seen(item.etag)) for item in body.items]
    judging.give_several(errand.services, errand.caller, submission_id, points, body.comment)
    return _all_items(errand, language, submission_id)


def _all_items(errand: Errand, language: Language, submission_id: str) -> ManualItemsView:
    submission, items = judging.items_of(errand.services, errand.caller, submission_id)
    own = SUBMISSIONS + submission.id
    shown = [_item(item, language) for item in items]
    return ManualItemsView.of(submission, submission=own, source=f"{own}/source", items=shown)


@of_submission.get(
    "/{submission_id}/judgements/{item:path}",
    summary="What people gave for one rubric item",
    responses={200: {"headers": _ETAG}, **responses(*_ON_READ, "item_not_found")},
)
def read_judgement(
    errand: StaffDep, language: LanguageDep, response: Response, *, submission_id: SubmissionId, item: ItemId
) -> ManualItemView:
    """Return one item, with its ETag."""
    return _tagged(errand, language, response, submission_id, item)


@of_submission.put(
    "/{submission_id}/judgements/{item:path}",
    summary="Give points for a rubric item",
    responses={
        200: {"headers": _ETAG},
        **responses(*_ON_READ, *_ON_JUDGING),
    },
)
def judge(  # noqa: PLR0913
    errand: StaffDep,
    language: LanguageDep,
    response: Response,
    *,
    submission_id: SubmissionId,
    item: ItemId,
    body: JudgementBody,
    if_match: IfMatch = None,
) -> ManualItemView:
    """Add a judgement, which takes the place of an earlier one; both stay in the history and the audit log.

    Assistants and instructors may. Once nothing of a submission waits any more, its score is complete. What the
    machine judged only instructors correct, with a comment; the machine's own points take a correction back.
    """
    judging.give(
        errand.services,
        errand.caller,
        submission_id,
        item,
        points=body.points,
        comment=body.comment,
        seen=seen(if_match),
    )
    return _tagged(errand, language, response, submission_id, item)


def _tagged(
    errand: Errand, language: Language, response: Response, submission_id: str, item: str
) -> ManualItemView:
    _, items = judging.items_of(errand.services, errand.caller, submission_id)
    judged = next((judged_item for judged_item in items if judged_item.id == item), None)
    if judged is None:
        raise RefusedError("item_not_found", field="item", allowed=[judged_item.id for judged_item in items])
    response.headers.update({"ETag": etag(judged.tag), "Cache-Control": "no-store"})
    return _item(judged, language)


def _waiting(errand: Errand, page: WaitingPage, language: Language, *, anonymous: bool) -> WaitingList:
    assignments = errand.assignments
    return WaitingList(
        total=page.total,
        questions=[
            QuestionView(
                assignment=assignment,
                assignment_title=assignments[assignment].title.get(language)
                if assignment in assignments
                else assignment,
                item=item,
                title=item_title(assignments.get(assignment), item, language),
                waiting=count,
            )
            for (assignment, item), count in page.questions.items()
        ],
        waiting=[
            WaitingView.of(
                answer,
                submission=SUBMISSIONS + answer.submission,
                source=f"{SUBMISSIONS}{answer.submission}/source",
                judgement=f"{SUBMISSIONS}{answer.submission}/judgements/{answer.item}",
                student=None if anonymous else answer.student,
                title=item_title(assignments.get(answer.assignment), answer.item, language),
            )
            for answer in page.answers
        ],
    )


def _item(item: JudgedItem, language: Language) -> ManualItemView:
    return ManualItemView.of(item, item=item.id, title=item.title.get(language), etag=etag(item.tag))
