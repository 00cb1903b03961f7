"""Comments of a course's staff and of a student on a submission."""

from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, status
from pydantic import Field

from grader.contracts.comment import COMMENT_PATTERN, LONGEST_COMMENT
from grader.service.requests.dependencies import ErrandDep, SubmissionId
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases import commenting
from grader.use_cases.bodies import Body

router = APIRouter(prefix="/api/v1/submissions", tags=["submissions"])


class CommentBody(Body):
    """What somebody writes about a submission."""

    text: Annotated[
        str,
        Field(
            min_length=1,
            max_length=LONGEST_COMMENT,
            pattern=COMMENT_PATTERN,
            examples=["Why a second publisher here?"],
        ),
    ]
    line: Annotated[
        int | None,
        Field(ge=1, le=1_000_000, description="Of the file; null: about the whole.", examples=[12]),
    ] = None


class CommentView(View):
    """One comment."""

    number: int = Field(description="1 for the first one on the submission.", examples=[1])
    by: str = Field(examples=["wang"])
    by_student: bool = Field(description="The submission's student wrote it, and not the staff.")
    line: int | None = Field(description="Of the file; null: about the whole.", examples=[12])
    text: str
    at: datetime
    seen: bool = Field(description="Somebody of the other side has opened the submission's page since.")


class CommentList(View):
    """All comments on a submission, oldest first."""

    comments: list[CommentView]


@router.get(
    "/{submission_id}/comments",
    summary="What people wrote about it",
    responses=responses("submission_not_found", "invalid_request"),
)
def read_comments(errand: ErrandDep, submission_id: SubmissionId) -> CommentList:
    """Return the comments of staff and student. Reading them here does not mark them as seen."""
    comments = commenting.comments(errand.services, errand.caller, submission_id)
    return CommentList(comments=[CommentView.of(comment) for comment in comments])


@router.post(
    "/{submission_id}/comments",
    status_code=status.HTTP_201_CREATED,
    summary="Write about it",
    responses=responses("submission_not_found", "no_course", "course_archived", "invalid_request"),
)
def add_comment(errand: ErrandDep, submission_id: SubmissionId, body: CommentBody) -> CommentView:
    """Add a comment: the student's for the staff, the staff's for the student. It cannot be taken back."""
    return CommentView.of(
        commenting.add_comment(errand.services, errand.caller, submission_id, body.text, body.line)
    )
