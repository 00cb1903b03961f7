"""The rules of assignments: everybody reads them, instructors change them."""

from typing import Annotated

from fastapi import APIRouter, Header, Path, Response

from grader.contracts.errors import ChangedMeanwhileError, CourseError, RefusedError
from grader.contracts.identity import Caller, Role
from grader.contracts.rules import NO_EXTENSION, Extension
from grader.contracts.text import Text
from grader.routes.dependencies import (
    ENTRY_PROBLEMS,
    CallerDep,
    InstructorDep,
    ServicesDep,
    StaffDep,
    etag,
    seen,
)
from grader.routes.problems import responses
from grader.routes.rule_views import (
    ExtensionChange,
    ExtensionList,
    ExtensionView,
    RulesBody,
    RulesChange,
    StandingView,
    extension_from,
    rules_body,
    rules_from,
)
from grader.routes.submission_views import SUBMISSIONS
from grader.store.audit import Signature
from grader.store.rules import ANY_STATE, CourseRules, tag
from grader.use_cases.assignments import require_published
from grader.use_cases.services import Services
from grader.use_cases.visibility import hidden_from

router = APIRouter(prefix="/api/v1/assignments/{assignment_id}", tags=["rules"])
AssignmentId = Annotated[str, Path(max_length=64, examples=["square"])]
_KNOWN = (*ENTRY_PROBLEMS, "assignment_not_found", "invalid_request")
_CHANGING = ("forbidden", "malformed_body", "too_large", "no_course", "changed_meanwhile")
_ETAG = {
    "ETag": {"description": "Of the rules; for assistants and instructors.", "schema": {"type": "string"}}
}
IfMatch = Annotated[
    str | None,
    Header(max_length=1_000, description="The ETag of what was looked at. Left out: whatever there is."),
]


@router.get(
    "/rules",
    summary="The rules, and where one stands",
    responses={200: {"headers": _ETAG}, **responses(*_KNOWN)},
)
def read_rules(
    services: ServicesDep, caller: CallerDep, response: Response, assignment_id: AssignmentId
) -> StandingView:
    """Return dates, limits and what lateness costs; for a member also attempts and what counts so far."""
    require_published(services, assignment_id)
    response.headers.update({"Cache-Control": "no-store", "Vary": "Authorization"})
    known = services.rules.of(caller.course)
    if caller.is_staff:  # a student could find out from a digest which items are hidden
        response.headers["ETag"] = etag(tag(known.of(assignment_id)))
    return standing(services, caller, known, assignment_id)


@router.put(
    "/rules",
    summary="Change the rules",
    responses={
        200: {"headers": _ETAG},
        **responses(*_KNOWN, *_CHANGING, "invalid_rules"),
    },
)
def change_rules(  # noqa: PLR0913, PLR0917
    services: ServicesDep,
    caller: InstructorDep,
    response: Response,
    assignment_id: AssignmentId,
    change: RulesChange,
    if_match: IfMatch = None,
) -> RulesBody:
    """Put new rules in place of the old ones. They hold for what was handed in before, too."""
    items = [item.id for item in require_published(services, assignment_id).items]
    signed = signature(services, caller)
    rules = rules_from(change, services.rules.of(caller.course).zone)
    unknown = set(rules.hidden_items) - set(items)
    if unknown:
        detail = Text(zh=f"没有这个评分项：{min(unknown)}。", en=f"There is no rubric item {min(unknown)}.")
        raise RefusedError("invalid_rules", detail, field="hidden_items", allowed=items)
    try:
        services.rules.set(assignment_id, rules, signed, change.reason, seen=seen(if_match) or ANY_STATE)
    except ChangedMeanwhileError:
        raise RefusedError("changed_meanwhile") from None
    response.headers["ETag"] = etag(tag(rules))
    return rules_body(rules, with_hidden=True)


@router.get("/extensions", summary="Who got more", responses=responses(*_KNOWN, "forbidden"))
def read_extensions(services: ServicesDep, caller: StaffDep, assignment_id: AssignmentId) -> ExtensionList:
    """Return all extensions of an assignment."""
    require_published(services, assignment_id)
    extensions = services.rules.of(caller.course).extensions.items()
    return ExtensionList(
        extensions=[
            _extension(student, one)
            for (assignment, student), one in sorted(extensions, key=lambda item: item[0])
            if assignment == assignment_id and one != NO_EXTENSION
        ]
    )


@router.put(
    "/extensions/{student}",
    summary="Give one student more",
    responses=responses(*_KNOWN, *_CHANGING, "unknown_student"),
)
def change_extension(  # noqa: PLR0913, PLR0917
    services: ServicesDep,
    caller: InstructorDep,
    assignment_id: AssignmentId,
    student: Annotated[str, Path(max_length=64, examples=["20260123"])],
    change: ExtensionChange,
    if_match: IfMatch = None,
) -> ExtensionView:
    """Put an extension in place of what the student had."""
    require_published(services, assignment_id)
    signed = signature(services, caller)
    extension = extension_from(change, services.rules.of(caller.course).zone)
    try:
        services.rules.extend(
            assignment_id, student, extension, signed, change.reason, seen=seen(if_match) or ANY_STATE
        )
    except ChangedMeanwhileError:
        raise RefusedError("changed_meanwhile") from None
    except CourseError:
        raise RefusedError("unknown_student", field="student") from None
    return _extension(student, extension)


def signature(services: Services, caller: Caller) -> Signature:
    """Return who changes something now.

    Raises:
        RefusedError: there is no course whose settings could be changed.
    """
    if caller.course is None:
        raise RefusedError("no_course")
    return Signature(services.clock(), caller.course, caller.signature)


def standing(services: Services, caller: Caller, known: CourseRules, assignment_id: str) -> StandingView:
    """Return where `caller` stands under the rules of an assignment; `known` are those of the course."""
    rules, person = known.of(assignment_id), caller.person
    extension = NO_EXTENSION if person is None else known.extension(assignment_id, person)
    attempts = () if person is None else services.submissions.attempts(person, assignment_id, caller.course)
    counted = rules.counting(extension, attempts)
    hiding = bool(hidden_from(services, caller, assignment_id))
    return StandingView(
        rules=rules_body(rules, with_hidden=caller.role is not Role.STUDENT),
        time_zone=str(known.zone),
        your_due=rules.due_for(extension),
        attempts_used=sum(one.costs for one in attempts),
        attempts_left=rules.attempts_left(extension, attempts),
        counted_submission=None if counted is None or hiding else SUBMISSIONS + counted.attempt.id,
        counted_score=None if counted is None or hiding else counted.score,
    )


def _extension(student: str, one: Extension) -> ExtensionView:
    return ExtensionView(student=student, due=one.due, extra_attempts=one.extra_attempts, etag=etag(tag(one)))
