"""The rules of assignments over HTTP: everybody reads them, instructors change them."""

import dataclasses
from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Header, Path, Response
from pydantic import Field

from grader.contracts.identity import Role
from grader.contracts.python import UTC
from grader.contracts.rules import Extension
from grader.service.requests.answers import PRIVATE
from grader.service.requests.dependencies import (
    SUBMISSIONS,
    AssignmentId,
    ErrandDep,
    InstructorDep,
    StaffDep,
    etag,
    seen,
)
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.store.rules import tag
from grader.use_cases import rules as use_case
from grader.use_cases.assignments import Terms, terms_of, visible_assignment
from grader.use_cases.bodies import ExtensionBody, RulesBody, rules_from
from grader.use_cases.rules import course_rules

router = APIRouter(prefix="/api/v1/assignments/{assignment_id}", tags=["rules"])
_ON_READ = ("assignment_not_found", "invalid_request")
_ON_CHANGE = ("forbidden", "malformed_body", "too_large", "no_course", "course_archived", "changed_meanwhile")
_ETAG = {
    "ETag": {"description": "Of the rules; for assistants and instructors.", "schema": {"type": "string"}}
}
IfMatch = Annotated[
    str | None,
    Header(max_length=1_000, description="The ETag of what was looked at. Left out: whatever there is."),
]


Reason = Annotated[
    str, Field(max_length=1_000, description="Goes into the audit log.", examples=["exam week"])
]


class RulesChange(RulesBody):
    """New rules, in place of all that there were, and why."""

    reason: Reason = ""


class ExtensionChange(ExtensionBody):
    """A new extension, in place of what the student had, and why."""

    reason: Reason = ""


class ExtensionView(ExtensionBody):
    """An extension and whose it is."""

    student: str = Field(examples=["20260123"])
    etag: str = Field(
        description="To be sent as If-Match with the next change.", examples=['"9f86d081884c7d65"']
    )


class ExtensionList(View):
    """All extensions of one assignment."""

    extensions: list[ExtensionView]


class StandingView(View):
    """Where the caller stands under the rules of one assignment."""

    rules: RulesBody = Field(description="Students do not see which items are hidden.")
    time_zone: str = Field(examples=["Asia/Shanghai"])
    your_due: datetime | None = Field(description="With your extension.")
    attempts_used: int = Field(examples=[2])
    attempts_left: int | None = Field(description="In all; null: any number.", examples=[3])
    counted_submission: str | None = Field(description="Address of the attempt that counts.")
    counted_score: float | None = Field(
        description="What of its score is kept after lateness.", examples=[8.5]
    )


@router.get(
    "/rules",
    summary="The rules, and where one stands",
    responses={200: {"headers": _ETAG}, **responses(*_ON_READ)},
)
def read_rules(errand: ErrandDep, response: Response, assignment_id: AssignmentId) -> StandingView:
    """Return dates, limits and what lateness costs; for a member also attempts and what counts so far."""
    visible_assignment(errand.services, errand.caller, assignment_id)
    response.headers.update(PRIVATE)
    terms = terms_of(errand.services, errand.caller, assignment_id)
    if errand.caller.is_staff:  # a student could find out from a digest which items are hidden
        response.headers["ETag"] = etag(tag(terms.rules))
    return _standing(terms, shows_hidden=errand.caller.role is not Role.STUDENT)


@router.put(
    "/rules",
    summary="Change the rules",
    responses={
        200: {"headers": _ETAG},
        **responses(*_ON_READ, *_ON_CHANGE, "invalid_rules"),
    },
)
def change_rules(
    errand: InstructorDep,
    response: Response,
    assignment_id: AssignmentId,
    change: RulesChange,
    if_match: IfMatch = None,
) -> RulesBody:
    """Put new rules in place of the old ones. They hold for what was handed in before, too."""
    rules = rules_from(change, course_rules(errand.services, errand.caller, assignment_id).zone)
    use_case.change_rules(
        errand.services, errand.caller, assignment_id, rules, change.reason, seen=seen(if_match)
    )
    response.headers["ETag"] = etag(tag(rules))
    return RulesBody.of(rules)


@router.get("/extensions", summary="Who got more", responses=responses(*_ON_READ, "forbidden"))
def read_extensions(errand: StaffDep, assignment_id: AssignmentId) -> ExtensionList:
    """Return all extensions of an assignment."""
    extensions = use_case.extensions(errand.services, errand.caller, assignment_id)
    return ExtensionList(extensions=[_extension(student, one) for student, one in extensions])


@router.put(
    "/extensions/{student}",
    summary="Give one student more",
    responses=responses(*_ON_READ, *_ON_CHANGE, "unknown_student"),
)
def change_extension(
    errand: InstructorDep,
    assignment_id: AssignmentId,
    student: Annotated[str, Path(max_length=64, examples=["20260123"])],
    change: ExtensionChange,
    if_match: IfMatch = None,
) -> ExtensionView:
    """Put an extension in place of what the student had."""
    extension: Extension = change.meant(course_rules(errand.services, errand.caller, assignment_id).zone)
    use_case.extend(
        errand.services, errand.caller, assignment_id, student, extension, change.reason, seen=seen(if_match)
    )
    return _extension(student, extension)


def _standing(terms: Terms, *, shows_hidden: bool) -> StandingView:
    rules, counted = terms.rules, terms.counted
    return StandingView(
        rules=RulesBody.of(rules if shows_hidden else dataclasses.replace(rules, hidden_items=())),
        time_zone=str(terms.zone),
        your_due=None if terms.due is None else terms.due.astimezone(UTC),
        attempts_used=terms.attempts_used,
        attempts_left=terms.attempts_left,
        counted_submission=None if counted is None else SUBMISSIONS + counted.attempt.id,
        counted_score=None if counted is None else counted.score,
    )


def _extension(student: str, one: Extension) -> ExtensionView:
    return ExtensionView.of(one, student=student, etag=etag(tag(one)))
