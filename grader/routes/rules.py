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
from grader.contracts.errors import RefusedError
from grader.contracts.fields import FieldKind, kinds_of
from grader.contracts.identity import Role
from grader.contracts.notation import instant
from grader.contracts.rules import YEARS, Extension, LateRule, LateStep, RuleError, Rules
from grader.contracts.validation_words import OUT_OF_YEARS
from grader.routes.dependencies import (
    ENTRY_PROBLEMS,
    SUBMISSIONS,
    AssignmentId,
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
from grader.store.rules import tag
from grader.use_cases import rules as use_case
from grader.use_cases.assignments import Terms, require_published, terms_of
from grader.use_cases.rules import course_rules

router = APIRouter(prefix="/api/v1/assignments/{assignment_id}", tags=["rules"])
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


def _field(kind: FieldKind, hint: Any, default: Any) -> tuple[Any, Any]:
    """Return the type and the properties of a field as pydantic takes them."""
    type_ = _type(kind, hint)
    properties: dict[str, Any] = {"description": kind.meaning or None}
    if kind.example is not None:
        properties["examples"] = [kind.example]
    if isinstance(kind, fields.Number):
        properties |= {"ge": kind.low, "le": kind.high}
    if isinstance(kind, fields.Names | fields.Table):
        properties |= {"max_length": kind.most}
    if isinstance(kind, fields.Names | fields.Table | fields.Nested):
        return type_, Field(default_factory=list if isinstance(default, tuple) else type_, **properties)
    if default is dataclasses.MISSING:
        return type_, Field(**properties)
    return type_ | None if default is None else type_, Field(default=default, **properties)


def _type(kind: FieldKind, hint: Any) -> Any:
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
        case fields.Nested():
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
    terms = terms_of(services, caller, assignment_id)
    if caller.is_staff:  # a student could find out from a digest which items are hidden
        response.headers["ETag"] = etag(tag(terms.rules))
    return _standing(terms, shows_hidden=caller.role is not Role.STUDENT)


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
    rules = rules_from(change, course_rules(services, caller, assignment_id).zone)
    use_case.change_rules(services, caller, assignment_id, rules, change.reason, seen=seen(if_match))
    response.headers["ETag"] = etag(tag(rules))
    return RulesBody.of(rules)


@router.get("/extensions", summary="Who got more", responses=responses(*_KNOWN, "forbidden"))
def read_extensions(services: ServicesDep, caller: StaffDep, assignment_id: AssignmentId) -> ExtensionList:
    """Return all extensions of an assignment."""
    found = use_case.extensions(services, caller, assignment_id)
    return ExtensionList(extensions=[_extension(student, one) for student, one in found])


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
    extension: Extension = change.meant(course_rules(services, caller, assignment_id).zone)
    use_case.extend(services, caller, assignment_id, student, extension, change.reason, seen=seen(if_match))
    return _extension(student, extension)


def _standing(terms: Terms, *, shows_hidden: bool) -> StandingView:
    rules, counted = terms.rules, terms.counted
    return StandingView(
        rules=RulesBody.of(rules if shows_hidden else dataclasses.replace(rules, hidden_items=())),
        time_zone=str(terms.zone),
        your_due=terms.due,
        attempts_used=terms.attempts_used,
        attempts_left=terms.attempts_left,
        counted_submission=None if counted is None else SUBMISSIONS + counted.attempt.id,
        counted_score=None if counted is None else counted.score,
    )


def _extension(student: str, one: Extension) -> ExtensionView:
    return ExtensionView.of(one, student=student, etag=etag(tag(one)))
