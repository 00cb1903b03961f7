"""The rules of an assignment as a form: rules to text fields and back, with what is wrong at each field.

Instants are on the clock of the course, durations in hours, shares in per cent. A field that was not touched gives
back exactly what it was made from, whatever its text leaves out.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import datetime
from typing import Literal, TypeVar
from zoneinfo import ZoneInfo

from pydantic import BaseModel, ConfigDict, Field

from grader.contracts.notation import decimal, instant, whole, written
from grader.contracts.rules import Counts, Extension, LateKind, LateRule, LateStep, Rules
from grader.routes.rule_views import MOST_ATTEMPTS, MOST_S, YEARS

_HOUR_S = 3600
_SPARE_STEPS = 2
CHANGED_MEANWHILE = "rules.error.meanwhile"
EXTENDED_MEANWHILE = "rules.error.extended_meanwhile"
_SHORT = Field(default="", max_length=40)
_Read = TypeVar("_Read")


class RuleForm(BaseModel):
    """The fields as they are typed. `step_after` and `step_keep` belong together line by line.

    `seen` is the tag of the rules that the form was made from; empty: whatever they are now.
    """

    model_config = ConfigDict(use_enum_values=True)

    opens: str = _SHORT
    due: str = _SHORT
    late: LateKind = "none"
    per_day: str = _SHORT
    step_after: list[str] = Field(default_factory=list, max_length=50)
    step_keep: list[str] = Field(default_factory=list, max_length=50)
    accept_late: str = _SHORT
    attempts: str = _SHORT
    attempts_per_day: str = _SHORT
    counts: Counts = Counts.BEST
    hidden_items: list[str] = Field(default_factory=list, max_length=100)
    hidden_until: str = _SHORT
    reason: str = Field(default="", max_length=1_000)
    seen: str = _SHORT

    def steps(self) -> list[tuple[str, str]]:
        """Return the lines of the late rule with some empty ones behind them."""
        lines = list(zip(self.step_after, self.step_keep, strict=False))
        typed = [line for line in lines if any(one.strip() for one in line)]
        return [*typed, *[("", "")] * _SPARE_STEPS]


class ExtensionForm(BaseModel):
    """What one student gets beyond the rules, as typed.

    `seen` is the tag of what the student `seen_for` had when the form was made; empty: whatever it is now.
    """

    student: str = Field(default="", max_length=200)
    due: str = _SHORT
    extra_attempts: str = _SHORT
    reason: str = Field(default="", max_length=1_000)
    seen: str = _SHORT
    seen_for: str = Field(default="", max_length=200)


def form_of(rules: Rules, zone: ZoneInfo) -> RuleForm:
    """Return the form that shows `rules`."""
    late = rules.late
    return RuleForm(
        opens=shown_instant(rules.opens, zone),
        due=shown_instant(rules.due, zone),
        late=late.kind,
        per_day=_number(late.per_day * 100) if late.per_day else "",
        step_after=[_number(step.after_s / _HOUR_S) for step in late.steps],
        step_keep=[_number(step.keep * 100) for step in late.steps],
        accept_late="" if rules.accept_late_s is None else _number(rules.accept_late_s / _HOUR_S),
        attempts="" if rules.attempts is None else str(rules.attempts),
        attempts_per_day="" if rules.attempts_per_day is None else str(rules.attempts_per_day),
        counts=rules.counts,
        hidden_items=list(rules.hidden_items),
        hidden_until=shown_instant(rules.hidden_until, zone),
    )


def extension_form_of(student: str, extension: Extension, zone: ZoneInfo) -> ExtensionForm:
    """Return the form that shows what a student has."""
    return ExtensionForm(
        student=student,
        due=shown_instant(extension.due, zone),
        extra_attempts=str(extension.extra_attempts) if extension.extra_attempts else "",
    )


def shown_instant(instant: datetime | None, zone: ZoneInfo) -> str:
    """Return an instant as a browser's field for date and time wants it, empty for None."""
    if instant is None:
        return ""
    local = instant.astimezone(zone)
    return local.strftime("%Y-%m-%dT%H:%M:%S" if local.second else "%Y-%m-%dT%H:%M")


class FieldError(ValueError):
    """What is wrong with a field: the key of the sentence about it in ``words.toml``."""


@dataclass
class Reader:
    """Reads typed fields. `errors`: by field, the key of the sentence about it."""

    zone: ZoneInfo
    errors: dict[str, str] = field(default_factory=dict)

    def rules(self, form: RuleForm, before: Rules, items: frozenset[str]) -> Rules:
        """Return the rules that `form` states; `before`, which the form was made from, while there are errors.

        `items` are the ids of the rubric.
        """
        opens = self._instant("opens", form.opens, before.opens)
        due = self._instant("due", form.due, before.due)
        hidden_until = self._instant("hidden_until", form.hidden_until, before.hidden_until)
        if opens is not None and due is not None and opens >= due:
            self.errors.setdefault("due", "rules.error.order")
        if form.counts == Counts.BEST_BEFORE_DUE and due is None:
            self.errors.setdefault("counts", "rules.error.needs_due")
        if not set(form.hidden_items) <= items:
            self.errors["hidden_items"] = "rules.error.items"
        late = self._read("per_day" if form.late == "linear" else "steps", lambda: self._late(form, before))
        accept_late_s = self._read("accept_late", lambda: _seconds(form.accept_late))
        attempts = self._read("attempts", lambda: _count(form.attempts, 1))
        attempts_per_day = self._read("attempts_per_day", lambda: _count(form.attempts_per_day, 1))
        if self.errors or late is None:
            return before
        return Rules(
            opens=opens,
            due=due,
            late=late,
            accept_late_s=accept_late_s,
            attempts=attempts,
            attempts_per_day=attempts_per_day,
            counts=Counts(form.counts),
            hidden_items=tuple(form.hidden_items),
            hidden_until=hidden_until,
        )

    def extension(self, form: ExtensionForm, before: Extension) -> Extension:
        """Return the extension that `form` states; `before` while there are errors."""
        due = self._instant("due", form.due, before.due)
        extra = self._read("extra_attempts", lambda: _count(form.extra_attempts, 0))
        return before if self.errors else Extension(due=due, extra_attempts=extra or 0)

    def _late(self, form: RuleForm, before: Rules) -> LateRule:
        shown = form_of(before, self.zone)
        untouched = (form.late, form.per_day, form.steps()) == (shown.late, shown.per_day, shown.steps())
        return before.late if untouched else _late(form)

    def _instant(self, name: str, text: str, before: datetime | None) -> datetime | None:
        if text == shown_instant(before, self.zone):
            return before
        return self._read(name, lambda: _instant(text.strip(), self.zone))

    def _read(self, name: str, read: Callable[[], _Read]) -> _Read | None:
        try:
            return read()
        except FieldError as error:
            self.errors.setdefault(name, str(error))
            return None


def _instant(text: str, zone: ZoneInfo) -> datetime | None:
    if not text:
        return None
    try:
        typed = instant(text)
    except ValueError:
        raise FieldError("rules.error.instant") from None
    if typed.year not in YEARS:
        raise FieldError("rules.error.years")
    return typed.replace(tzinfo=zone) if typed.tzinfo is None else typed


def _count(text: str, least: Literal[0, 1]) -> int | None:
    if not text.strip():
        return None
    try:
        number = whole(text.strip())
    except ValueError:
        raise FieldError("rules.error.count") from None
    if not least <= number <= MOST_ATTEMPTS:
        raise FieldError(f"rules.error.count_from_{least}")
    return number


def _late(form: RuleForm) -> LateRule:
    if form.late == "linear":
        percent = _between(form.per_day, 100.0, "rules.error.percent")
        if percent is None or percent <= 0.0:
            raise FieldError("rules.error.percent")
        return LateRule(kind="linear", per_day=percent / 100)
    return LateRule() if form.late == "none" else _steps(form)


def _steps(form: RuleForm) -> LateRule:
    steps = []
    for after, keep in form.steps()[:-_SPARE_STEPS]:
        after_s, percent = _seconds(after), _between(keep, 100.0, "rules.error.step")
        if after_s is None or percent is None:
            raise FieldError("rules.error.step")
        steps.append(LateStep(after_s=after_s, keep=percent / 100))
    try:
        return LateRule(kind="steps", steps=tuple(steps))
    except ValueError:
        raise FieldError("rules.error.steps_order" if steps else "rules.error.no_steps") from None


def _seconds(hours: str) -> int | None:
    number = _between(hours, MOST_S / _HOUR_S, "rules.error.hours")
    return None if number is None else round(number * _HOUR_S)


def _between(text: str, high: float, wrong: str) -> float | None:
    """Return the number that was typed if it lies from 0 to `high`; None when nothing was typed."""
    if not text.strip():
        return None
    try:
        number = decimal(text.strip().removesuffix("%").strip())
    except ValueError:
        raise FieldError(wrong) from None
    if not 0.0 <= number <= high:
        raise FieldError(wrong)
    return number


def _number(value: float) -> str:
    """Return `value` with nine decimals at most, whole numbers without a point."""
    return written(round(value, 9))
