"""Points that people give for what no machine judges or correct: what waits for them, and what they gave."""

import math
from typing import Annotated

from fastapi import APIRouter, Header, Path, Query, Response

from grader.contracts.errors import JudgementError, RefusedError
from grader.contracts.identity import Caller
from grader.contracts.notation import written
from grader.contracts.report import report_from
from grader.contracts.rubric import ItemStatus
from grader.contracts.text import Language, Text
from grader.routes.dependencies import (
    ENTRY_PROBLEMS,
    SIGHT,
    LanguageDep,
    QueryWhole,
    ServicesDep,
    StaffDep,
    SubmissionId,
    seen,
)
from grader.routes.judgement_views import (
    JudgementBody,
    ManualItemsView,
    ManualItemView,
    WaitingList,
    manual_items,
    waiting_list,
)
from grader.routes.problems import responses
from grader.store.audit import Signature
from grader.store.judgements import Given, WaitingFor
from grader.use_cases.services import Services
from grader.use_cases.visibility import graded

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
_KNOWN = (*ENTRY_PROBLEMS, "forbidden", "submission_not_found", "not_graded_yet", "invalid_request")
_MOST_PER_PAGE = 500
_MOST = 1_000_000
_REFUSALS = {"stale": "judged_meanwhile", "role": "forbidden", "same": "points_unchanged"}
_REASON = Text(
    zh="改机器评的分要写原因，学生会看到。",
    en="Say why the machine's points are changed; the student sees it.",
)
_ETAG = {"ETag": {"description": "Of the item's state.", "schema": {"type": "string"}}}


@router.get(
    "/waiting",
    summary="What waits for a person",
    responses=responses(*ENTRY_PROBLEMS, "forbidden", "invalid_request"),
)
def read_waiting(  # noqa: PLR0913
    services: ServicesDep,
    caller: StaffDep,
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
    return waiting(services, caller, language, which, offset=offset, limit=limit, anonymous=anonymous)


def waiting(  # noqa: PLR0913
    services: Services,
    caller: Caller,
    language: Language,
    which: WaitingFor,
    *,
    offset: int,
    limit: int,
    anonymous: bool,
) -> WaitingList:
    """Return at most `limit` of what waits in the caller's course, and how much of each question waits."""
    return waiting_list(
        services.judgements.waiting(caller.course, which, offset, limit),
        services.judgements.questions(caller.course, which),
        {one.id: one for one in services.assignments.all()},
        language,
        anonymous=anonymous,
    )


@of_submission.get(
    "/{submission_id}/judgements",
    summary="What people gave for a submission's items",
    responses=responses(*_KNOWN),
)
def read_judgements(
    services: ServicesDep, caller: StaffDep, language: LanguageDep, submission_id: SubmissionId
) -> ManualItemsView:
    """Return every rubric item, whether it is left to people, and what was given by whom and when."""
    return items_of(services, caller, language, submission_id)


def items_of(services: Services, caller: Caller, language: Language, submission_id: str) -> ManualItemsView:
    """Return the rubric items of a submission with what people gave for them.

    Raises:
        RefusedError: there is no such submission, or no grading yet.
    """
    submission, stored = graded(services, caller, submission_id)
    return manual_items(submission, stored, report_from(stored.content), language)


@of_submission.get(
    "/{submission_id}/judgements/{item:path}",
    summary="What people gave for one rubric item",
    responses={200: {"headers": _ETAG}, **responses(*_KNOWN, "item_not_found")},
)
def read_judgement(  # noqa: PLR0913
    services: ServicesDep,
    caller: StaffDep,
    language: LanguageDep,
    response: Response,
    *,
    submission_id: SubmissionId,
    item: ItemId,
) -> ManualItemView:
    """Return one item, with its ETag."""
    return _tagged(services, caller, language, response, submission_id, item)


def _tagged(  # noqa: PLR0913, PLR0917
    services: Services, caller: Caller, language: Language, response: Response, submission_id: str, item: str
) -> ManualItemView:
    items = items_of(services, caller, language, submission_id).items
    for one in items:
        if one.item == item:
            response.headers.update({"ETag": one.etag, "Cache-Control": "no-store"})
            return one
    raise RefusedError("item_not_found", field="item", allowed=[one.item for one in items])


@of_submission.put(
    "/{submission_id}/judgements/{item:path}",
    summary="Give points for a rubric item",
    responses={
        200: {"headers": _ETAG},
        **responses(
            *_KNOWN,
            "malformed_body",
            "too_large",
            "item_not_found",
            "judged_meanwhile",
            "invalid_points",
            "points_unchanged",
        ),
    },
)
def judge(  # noqa: PLR0913
    services: ServicesDep,
    caller: StaffDep,
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
    give(services, caller, submission_id, item, body, if_match)
    return _tagged(services, caller, language, response, submission_id, item)


def give(  # noqa: PLR0913, PLR0917
    services: Services,
    caller: Caller,
    submission_id: str,
    item: str,
    body: JudgementBody,
    if_match: str | None,
) -> None:
    """Keep what a person gives for an item in the state that `if_match` names.

    Raises:
        RefusedError: the points do not fit, there is no such item, only an instructor may correct it, the reason
            is missing, or somebody judged it meanwhile.
    """
    if not math.isclose(body.points, round(body.points, 2), abs_tol=1e-9):
        raise RefusedError("invalid_points", field="points")
    given = Given(
        item=item,
        points=round(body.points, 2),
        comment=body.comment.replace("\r\n", "\n"),
        corrects=caller.is_instructor,
    )
    signed = Signature(services.clock(), caller.course, caller.signature)
    try:
        services.judgements.judge(submission_id, given, seen(if_match), signed)
    except JudgementError as error:
        raise _problem(services, caller, submission_id, given, error) from None


def _problem(
    services: Services, caller: Caller, submission_id: str, given: Given, error: JudgementError
) -> RefusedError:
    if error.code in _REFUSALS:
        return RefusedError(_REFUSALS[error.code])
    if error.code == "reason":
        return RefusedError("invalid_request", _REASON, field="comment")
    items = report_from(graded(services, caller, submission_id)[1].content).items
    if error.code == "range":
        most = next((written(one.points) for one in items if one.id == given.item), "?")
        detail = Text(zh=f"这一项可以给 0 到 {most} 分。", en=f"This item takes points from 0 to {most}.")
        return RefusedError("invalid_points", detail, field="points")
    allowed = [one.id for one in items if given.corrects or one.status is ItemStatus.NEEDS_MANUAL]
    return RefusedError("item_not_found", field="item", allowed=allowed)
