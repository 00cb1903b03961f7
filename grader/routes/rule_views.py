"""Rules of an assignment as the interface reads and shows them."""

from datetime import datetime
from typing import Annotated
from zoneinfo import ZoneInfo

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field
from pydantic_core import PydanticCustomError

from grader.contracts.errors import RefusedError
from grader.contracts.notation import instant
from grader.contracts.rules import (
    Counts,
    Extension,
    LateKind,
    LateRule,
    LateStep,
    RuleError,
    Rules,
)
from grader.contracts.validation_words import OUT_OF_YEARS
from grader.routes.dependencies import Number, Whole

MOST_S = 10 * 366 * 86_400
MOST_ATTEMPTS = 10_000
YEARS = range(2000, 2201)  # near the ends of the calendar arithmetic overflows


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


class LateStepBody(BaseModel):
    """A step of a late rule."""

    model_config = ConfigDict(extra="forbid")

    after_s: Whole = Field(ge=0, le=MOST_S, description="Late by more than this.", examples=[86_400])
    keep: Number = Field(ge=0.0, le=1.0, description="Share of the points that is kept.", examples=[0.8])


class LateRuleBody(BaseModel):
    """What lateness costs."""

    model_config = ConfigDict(extra="forbid")

    kind: LateKind = Field(default="none", examples=["linear"])
    per_day: Number = Field(
        default=0.0, ge=0.0, le=1.0, description="`linear`: share lost for each begun day.", examples=[0.1]
    )
    steps: list[LateStepBody] = Field(
        default_factory=list, max_length=50, description="`steps`.", examples=[[]]
    )


class RulesBody(BaseModel):
    """The rules of one assignment. Instants without an offset are meant in the course's time zone."""

    model_config = ConfigDict(extra="forbid")

    opens: Instant | None = Field(default=None, description="Nothing is accepted before.")
    due: Instant | None = Field(default=None, description="Later is late.", examples=["2026-03-20T23:59:59"])
    late: LateRuleBody = Field(default_factory=LateRuleBody)
    accept_late_s: Whole | None = Field(
        default=None,
        ge=0,
        le=MOST_S,
        description="How long after `due`; null: for ever.",
        examples=[172_800],
    )
    attempts: Whole | None = Field(
        default=None, ge=1, le=MOST_ATTEMPTS, description="In all; null: any number."
    )
    attempts_per_day: Whole | None = Field(
        default=None, ge=1, le=MOST_ATTEMPTS, description="In a calendar day of the course."
    )
    counts: Counts = Field(default=Counts.BEST, description="Which attempt counts.")
    hidden_items: list[Annotated[str, Field(max_length=128)]] = Field(
        default_factory=list, max_length=100, description="Rubric items that students do not see."
    )
    hidden_until: Instant | None = Field(default=None, description="Null: students never see them.")


class RulesChange(RulesBody):
    """New rules, in place of all that there were, and why."""

    reason: Reason = ""


class ExtensionBody(BaseModel):
    """What one student gets beyond the rules; an empty one takes an extension back."""

    model_config = ConfigDict(extra="forbid")

    due: Instant | None = Field(default=None, description="Later than everybody's, else without effect.")
    extra_attempts: Whole = Field(default=0, ge=0, le=MOST_ATTEMPTS)


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
        RefusedError: they make no sense together.
    """
    steps = tuple(LateStep(after_s=step.after_s, keep=step.keep) for step in body.late.steps)
    try:
        return Rules(
            opens=_aware(body.opens, zone),
            due=_aware(body.due, zone),
            late=LateRule(kind=body.late.kind, per_day=body.late.per_day, steps=steps),
            accept_late_s=body.accept_late_s,
            attempts=body.attempts,
            attempts_per_day=body.attempts_per_day,
            counts=body.counts,
            hidden_items=tuple(body.hidden_items),
            hidden_until=_aware(body.hidden_until, zone),
        )
    except RuleError as error:
        raise RefusedError("invalid_rules", error.text, field=error.field) from None


def rules_body(rules: Rules, *, with_hidden: bool) -> RulesBody:
    """Return rules as the interface shows them."""
    late = rules.late
    return RulesBody(
        opens=rules.opens,
        due=rules.due,
        late=LateRuleBody(
            kind=late.kind,
            per_day=late.per_day,
            steps=[LateStepBody(after_s=step.after_s, keep=step.keep) for step in late.steps],
        ),
        accept_late_s=rules.accept_late_s,
        attempts=rules.attempts,
        attempts_per_day=rules.attempts_per_day,
        counts=rules.counts,
        hidden_items=list(rules.hidden_items) if with_hidden else [],
        hidden_until=rules.hidden_until,
    )


def extension_from(body: ExtensionBody, zone: ZoneInfo) -> Extension:
    """Return the extension that `body` states."""
    return Extension(due=_aware(body.due, zone), extra_attempts=body.extra_attempts)


def _aware(instant: datetime | None, zone: ZoneInfo) -> datetime | None:
    if instant is None or instant.tzinfo is not None:
        return instant
    return instant.replace(tzinfo=zone)
