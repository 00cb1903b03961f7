"""What people write as JSON, over HTTP and on the command line: numbers, instants, and the rules of assignments.

The fields of a body are those of its contract, with the kinds that stand there.
"""

import dataclasses
from collections.abc import Callable
from datetime import datetime
from types import GenericAlias
from typing import Annotated, Any, ClassVar, TypeVar, get_type_hints
from zoneinfo import ZoneInfo

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, create_model
from pydantic_core import PydanticCustomError

from grader.contracts import fields
from grader.contracts.errors import RefusedError
from grader.contracts.fields import FieldKind, kinds_of
from grader.contracts.notation import instant
from grader.contracts.python import Self
from grader.contracts.rules import YEARS, Extension, LateRule, LateStep, RuleError, Rules, SectionRule
from grader.contracts.validation_words import OUT_OF_YEARS

# Pydantic by itself takes texts and true for numbers, too.


def _number(value: object) -> object:
    if isinstance(value, bool | str):
        raise PydanticCustomError("float_type", "Input should be a number")
    return value


def _whole_number(value: object) -> object:
    if isinstance(value, bool | str):
        raise PydanticCustomError("int_type", "Input should be a whole number")
    return value


Whole = Annotated[int, BeforeValidator(_whole_number)]
"""A whole number in a JSON body; 10.0 is one, as in JSON Schema."""

Number = Annotated[float, BeforeValidator(_number)]
"""A number in a JSON body. Bounds refuse what is not finite."""


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


class Body(BaseModel):
    """What somebody writes as JSON: fields that it does not have are refused."""

    model_config = ConfigDict(extra="forbid")


class Described(Body):
    """The JSON of a contract whose fields have kinds."""

    contract: ClassVar[type]

    @classmethod
    def of(cls, value: Any, **more: object) -> Self:
        """Return a contract as JSON shows it, and `more` fields that only this body has."""
        return cls.model_validate({**dataclasses.asdict(value), **more})

    def meant(self, zone: ZoneInfo) -> Any:
        """Return the contract that is written here; instants without an offset are on the clock of `zone`.

        Raises RuleError: its fields contradict each other.
        """
        return self.contract(**{name: _meant(getattr(self, name), zone) for name in kinds_of(self.contract)})


def _meant(value: object, zone: ZoneInfo) -> object:
    if isinstance(value, datetime) and value.tzinfo is None:
        return value.replace(tzinfo=zone)
    if isinstance(value, list):
        return tuple(_meant(element, zone) for element in value)
    return value.meant(zone) if isinstance(value, Described) else value


_Body = TypeVar("_Body", bound=Described)
_bodies: dict[type, type[Described]] = {}


def _of(contract: type) -> Callable[[type[_Body]], type[_Body]]:
    """Return a decorator that gives a body the fields of `contract`."""

    def decorate(empty: type[_Body]) -> type[_Body]:
        kinds, hints = kinds_of(contract), get_type_hints(contract)
        defined: Any = {
            field.name: _field(kinds[field.name], hints[field.name], field.default)
            for field in dataclasses.fields(contract)
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
        case fields.Name():
            return Annotated[str, Field(min_length=1, max_length=kind.longest)]
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


@_of(SectionRule)
class SectionRuleBody(Described):
    """What holds for the students of one section; what it leaves out is as in the rules around it."""


@_of(Rules)
class RulesBody(Described):
    """The rules of one assignment. Instants without an offset are meant in the course's time zone."""


@_of(Extension)
class ExtensionBody(Described):
    """What one student gets beyond the rules; an empty one takes an extension back."""


def rules_from(body: RulesBody, zone: ZoneInfo) -> Rules:
    """Return the rules that `body` states. Raises RefusedError: they contradict each other."""
    for section in vars(body)["by_section"]:  # else who only moves a date would make lateness free
        for name in {"late", "accept_late_s"} - section.model_fields_set:
            setattr(section, name, getattr(body, name))
    try:
        rules: Rules = body.meant(zone)
    except RuleError as error:
        raise RefusedError("invalid_rules", error.text, field=error.field) from None
    return rules
