"""The rules of assignments over HTTP: everybody reads them, instructors change them.

The fields of the bodies are those of the contracts, with the kinds that stand there.
"""

import dataclasses
from collections.abc import Callable
from datetime import datetime
from types import GenericAlias
from typing import Annotated, Any, ClassVar, Self, TypeVar, get_type_hints
from zoneinfo import ZoneInfo

from fastapi import APIRouter, Header, Path, Response
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, create_model
from pydantic_core import PydanticCustomError

from grader.contracts import fields
from grader.contracts.errors import ChangedMeanwhileError, CourseError, RefusedError
from grader.contracts.fields import Kind, kinds_of
from grader.contracts.identity import Caller, Role
from grader.contracts.notation import instant
from grader.contracts.rules import NO_EXTENSION, YEARS, Extension, LateRule, LateStep, RuleError, Rules
from grader.contracts.text import Text
from grader.contracts.validation_words import OUT_OF_YEARS
from grader.routes.dependencies import (
    ENTRY_PROBLEMS,
    CallerDep,
    InstructorDep,
    Number,
    ServicesDep,
    StaffDep,
    Whole,
    etag,
    seen,
)
from grader.routes.problems import responses
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


def _in_our_years(instant: datetime) -> datetime:
    if instant.year not in YEARS:
        raise PydanticCustomError(*OUT_OF_YEARS)
    return instant


def _instant(value: object) -> object:
    if isinstance(value, datetime):
        return value
    try:
        return instant(str(value))
    except ValueError as error:
        raise PydanticCustomError("datetime_parsing", str(error)) from None


Instant = Annotated[datetime, BeforeValidator(_instant), AfterValidator(_in_our_years)]
Reason = Annotated[
    str, Field(max_length=1_000, description="Goes into the audit log.", examples=["exam week"])
]


class Described(BaseModel):
    """The JSON of a contract whose fields have kinds."""

    model_config = ConfigDict(extra="forbid")
    contract: ClassVar[type]

    @classmethod
    def of(cls, value: Any, **more: object) -> Self:
        """Return a contract as JSON shows it, and `more` fields that only this body has."""
        return cls.model_validate({**dataclasses.asdict(value), **more})

    def meant(self, zone: ZoneInfo) -> Any:
        """Return the contract that is written here; instants without an offset are on the clock of `zone`.

        Raises:
            RuleError: its fields contradict each other.
        """
        return self.contract(**{name: _meant(getattr(self, name), zone) for name in kinds_of(self.contract)})


def _meant(value: object, zone: ZoneInfo) -> object:
    if isinstance(value, datetime) and value.tzinfo is None:
        return value.replace(tzinfo=zone)
    if isinstance(value, list):
        return tuple(_meant(one, zone) for one in value)
    return value.meant(zone) if isinstance(value, Described) else value


_Body = TypeVar("_Body", bound=Described)
_bodies: dict[type, type[Described]] = {}


def _of(contract: type) -> Callable[[type[_Body]], type[_Body]]:
    """Return a decorator that gives a body the fields of `contract`."""

    def decorate(empty: type[_Body]) -> type[_Body]:
        kinds, hints = kinds_of(contract), get_type_hints(contract)
        defined: Any = {
            one.name: _field(kinds[one.name], hints[one.name], one.default)
            for one in dataclasses.fields(contract)
        }
        body = create_model(
            empty.__name__, __base__=empty, __doc__=empty.__doc__, __module__=empty.__module__, **defined
        )
        body.contract = contract
        _bodies[contract] = body
        return body

    return decorate


def _field(kind: Kind, hint: Any, default: Any) -> tuple[Any, Any]:
    """Return the type and the properties of a field as pydantic takes them."""
    type_ = _type(kind, hint)
    properties: dict[str, Any] = {"description": kind.meaning or None}
    if kind.example is not None:
        properties["examples"] = [kind.example]
    if isinstance(kind, fields.Number):
        properties |= {"ge": kind.low, "le": kind.high}
    if isinstance(kind, fields.Names | fields.Table):
        properties |= {"max_length": kind.most}
    if isinstance(kind, fields.Names | fields.Table | fields.Record):
        return type_, Field(default_factory=list if isinstance(default, tuple) else type_, **properties)
    if default is dataclasses.MISSING:
        return type_, Field(**properties)
    return type_ | None if default is None else type_, Field(default=default, **properties)


def _type(kind: Kind, hint: Any) -> Any:
    match kind:
        case fields.Instant():
            return Instant
        case fields.Share():
            return Number
        case fields.Number():
            return Whole
        case fields.Names():
            return list[Annotated[str, Field(max_length=kind.longest)]]
        case fields.Table():
            return GenericAlias(list, (_bodies[kind.of],))
        case fields.Record():
            return _bodies[kind.of]
        case _:
            return hint


@_of(LateStep)
class LateStepBody(Described):
    """A step of a late rule."""


@_of(LateRule)
class LateRuleBody(Described):
    """What lateness costs."""


@_of(Rules)
class RulesBody(Described):
    """The rules of one assignment. Instants without an offset are meant in the course's time zone."""


class RulesChange(RulesBody):
    """New rules, in place of all that there were, and why."""

    reason: Reason = ""


@_of(Extension)
class ExtensionBody(Described):
    """What one student gets beyond the rules; an empty one takes an extension back."""


class ExtensionChange(ExtensionBody):
    """A new extension, in place of what the student had, and why."""

    reason: Reason = ""


class ExtensionView(ExtensionBody):
    """An extension and whose it is."""

    student: str = Field(examples=["20260123"])
    etag: str = Field(
        description="To be sent as If-Match with the next change.", examples=['"9f86d081884c7d65"']
    )


class ExtensionList(BaseModel):
    """All extensions of one assignment."""

    extensions: list[ExtensionView]


class StandingView(BaseModel):
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


def rules_from(body: RulesBody, zone: ZoneInfo) -> Rules:
    """Return the rules that `body` states.

    Raises:
        RefusedError: they contradict each other.
    """
    try:
        rules: Rules = body.meant(zone)
    except RuleError as error:
        raise RefusedError("invalid_rules", error.text, field=error.field) from None
    return rules


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
    return RulesBody.of(rules)


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
    extension = change.meant(services.rules.of(caller.course).zone)
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
        rules=RulesBody.of(
            dataclasses.replace(rules, hidden_items=()) if caller.role is Role.STUDENT else rules
        ),
        time_zone=str(known.zone),
        your_due=rules.due_for(extension),
        attempts_used=sum(one.costs for one in attempts),
        attempts_left=rules.attempts_left(extension, attempts),
        counted_submission=None if counted is None or hiding else SUBMISSIONS + counted.attempt.id,
        counted_score=None if counted is None or hiding else counted.score,
    )


def _extension(student: str, one: Extension) -> ExtensionView:
    return ExtensionView.of(one, student=student, etag=etag(tag(one)))
