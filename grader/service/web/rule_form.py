"""The rules of an assignment as a form: rules to typed texts and back, with what is wrong at each field.

Which fields there are, and between which bounds, stands at the contracts. Instants are typed on the clock of the
course, durations in hours or minutes, shares in per cent. A field that was not touched gives back exactly the
value that it was made from, whatever its text leaves out.
"""

import dataclasses
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from itertools import chain
from typing import Any, TypeVar
from zoneinfo import ZoneInfo

from pydantic import BaseModel, ConfigDict, Field, create_model

from grader.contracts import fields
from grader.contracts.fields import FieldKind, kinds_of
from grader.contracts.notation import decimal, instant, whole
from grader.contracts.rules import (
    LATE_PARAMETERS,
    MOST_HIDDEN_ITEMS,
    MOST_STEPS,
    YEARS,
    Corrector,
    Counts,
    Extension,
    HintRule,
    LateKind,
    LateRule,
    LateStep,
    RuleError,
    Rules,
    Shown,
)
from grader.messages import is_on_page
from grader.messages.quantity import exact

CHANGED_MEANWHILE = "rules.error.meanwhile"
EXTENDED_MEANWHILE = "rules.error.extended_meanwhile"
_HOUR_S = 3600
_UNITS_S = {"": _HOUR_S, "h": _HOUR_S, "小时": _HOUR_S, "min": 60, "分钟": 60}
"""What a duration may be typed in."""
_WITH_UNIT = re.compile(rf"(.*?)\s*({'|'.join(_UNITS_S)})", re.DOTALL)
_SPARE_STEPS = 2
_SHORT = Field(default="", max_length=40)
_Form = TypeVar("_Form", bound=BaseModel)
_Contract = TypeVar("_Contract")


def typed_name(name: str) -> str:
    """Return what forms call the field `name` of a contract; people do not type durations in seconds."""
    return name.removesuffix("_s")


def _short(contract: type) -> dict[str, FieldKind]:
    """Return the fields of a contract that are typed as one short text."""
    kinds = kinds_of(contract).items()
    return {name: kind for name, kind in kinds if isinstance(kind, fields.Instant | fields.Number)}


def _typed(*contracts: type) -> Callable[[type[_Form]], type[_Form]]:
    """Return a decorator that gives a form the short fields of contracts."""
    made: Any = {typed_name(name): (str, _SHORT) for contract in contracts for name in _short(contract)}
    return lambda form: create_model(form.__name__, __base__=form, __doc__=form.__doc__, **made)


@_typed(Rules, LateRule)
class RuleForm(BaseModel):
    """The fields as they are typed. `step_after` and `step_keep` belong together line by line.

    `seen` is the tag of the rules that the form was made from; empty: whatever they are now.
    """

    model_config = ConfigDict(use_enum_values=True)

    late: LateKind = "none"
    step_after: list[str] = Field(default_factory=list, max_length=MOST_STEPS)
    step_keep: list[str] = Field(default_factory=list, max_length=MOST_STEPS)
    shown: Shown = Shown.ALWAYS
    counts: Counts = Counts.BEST
    hints: HintRule = HintRule.ASSIGNMENT
    corrected_by: Corrector = Corrector.INSTRUCTORS
    hidden_items: list[str] = Field(default_factory=list, max_length=MOST_HIDDEN_ITEMS)
    reason: str = Field(default="", max_length=1_000)
    seen: str = _SHORT

    def steps(self) -> list[tuple[str, str]]:
        """Return the lines of the late rule with some empty ones behind them."""
        lines = zip(self.step_after, self.step_keep, strict=False)
        typed = [line for line in lines if any(text.strip() for text in line)]
        return [*typed, *[("", "")] * _SPARE_STEPS]

    def late_texts(self) -> list[object]:
        """Return everything that is typed about lateness."""
        return [self.late, self.steps(), *(getattr(self, typed_name(name)) for name in _short(LateRule))]


@_typed(Extension)
class ExtensionForm(BaseModel):
    """What one student gets beyond the rules, as typed.

    `seen` is the tag of what the student `seen_for` had when the form was made; empty: whatever it is now.
    """

    student: str = Field(default="", max_length=200)
    reason: str = Field(default="", max_length=1_000)
    seen: str = _SHORT
    seen_for: str = Field(default="", max_length=200)


@dataclass(frozen=True, slots=True)
class Widget:
    """How a short field is asked for: what the form calls it, attributes of its input, whether a hint helps."""

    name: str
    type: str
    mode: str
    hint: bool


def widgets() -> dict[str, Widget]:
    """Return how each short field of the rules is asked for."""
    return {
        name: Widget(
            name=typed_name(name),
            type="datetime-local" if isinstance(kind, fields.Instant) else "text",
            mode={fields.Instant: "", fields.Count: "numeric"}.get(type(kind), "decimal"),
            hint=is_on_page(f"rules.hint.{name}"),
        )
        for name, kind in {**_short(Rules), **_short(LateRule)}.items()
    }


def late_parameters() -> dict[str, list[str]]:
    """Return the parameters of late rules, each with the kinds of late rule that have it."""
    return {
        name: [kind for kind, own in LATE_PARAMETERS.items() if name in own]
        for name in dict.fromkeys(chain(*LATE_PARAMETERS.values()))
    }


def form_of(rules: Rules, zone: ZoneInfo, seen: str = "") -> RuleForm:
    """Return the form that shows `rules`."""
    late, step = rules.late, kinds_of(LateStep)
    return RuleForm.model_validate(
        {
            **_texts(rules, zone),
            **_texts(late, zone),
            "late": late.kind,
            "step_after": [_text(step["after_s"], late_step.after_s, zone) for late_step in late.steps],
            "step_keep": [_text(step["keep"], late_step.keep, zone) for late_step in late.steps],
            "shown": rules.shown,
            "counts": rules.counts,
            "hints": rules.hints,
            "corrected_by": rules.corrected_by,
            "hidden_items": list(rules.hidden_items),
            "seen": seen,
        }
    )


def extension_form_of(student: str, extension: Extension, zone: ZoneInfo, seen: str) -> ExtensionForm:
    """Return the form that shows what a student has."""
    others = {"student": student, "seen": seen, "seen_for": student}
    return ExtensionForm.model_validate({**_texts(extension, zone), **others})


def _texts(contract: object, zone: ZoneInfo) -> dict[str, str]:
    """Return the short fields of a contract as they are typed; empty where they say nothing."""
    values = {name: (kind, getattr(contract, name)) for name, kind in _short(type(contract)).items()}
    defaults = _defaults(type(contract))
    return {
        typed_name(name): "" if value == defaults[name] else _text(kind, value, zone)
        for name, (kind, value) in values.items()
    }


def _text(kind: FieldKind, value: Any, zone: ZoneInfo) -> str:
    match kind:
        case fields.Instant():
            local: datetime = value.astimezone(zone)  # as a browser's field for date and time wants it
            return local.strftime("%Y-%m-%dT%H:%M:%S" if local.second else "%Y-%m-%dT%H:%M")
        case fields.Seconds():
            return exact(value / _HOUR_S)
        case fields.Share():
            return exact(value * 100)
        case _:
            return str(value)


def _defaults(contract: Any) -> Mapping[str, Any]:
    return {parameter.name: parameter.default for parameter in dataclasses.fields(contract)}


class TypedFieldError(ValueError):
    """What is wrong with a field: the id of the sentence about it."""


@dataclass
class Reader:
    """Reads typed fields. `errors`: by what the form calls a field, the key of the sentence about it."""

    zone: ZoneInfo
    errors: dict[str, str] = field(default_factory=dict)

    def rules(self, form: RuleForm, before: Rules, items: frozenset[str]) -> Rules:
        """Return the rules that `form` states; `before`, which the form was made from, while there are errors.

        `items` are the ids of the rubric.
        """
        if not set(form.hidden_items) <= items:
            self.errors["hidden_items"] = "rules.error.items"
        untouched = form.late_texts() == form_of(before, self.zone).late_texts()
        values = {
            "late": before.late if untouched else self._late(form),
            "shown": Shown(form.shown),
            "counts": Counts(form.counts),
            "hints": HintRule(form.hints),
            "corrected_by": Corrector(form.corrected_by),
            "hidden_items": tuple(form.hidden_items),
            **{name: self._value(name, form, before) for name in _short(Rules)},
            "by_section": before.by_section,
        }
        rules = self._made(Rules, values, before)
        return before if self.errors else rules

    def extension(self, form: ExtensionForm, before: Extension) -> Extension:
        """Return the extension that `form` states; `before` while there are errors."""
        values = {name: self._value(name, form, before) for name in _short(Extension)}
        return before if self.errors else self._made(Extension, values, before)

    def typed(self, contract: type, name: str, text: str) -> Any:
        """Return what `text` states for a short field of `contract`; None where it is empty or wrong."""
        try:
            return _read(kinds_of(contract)[name], text.strip(), self.zone) if text.strip() else None
        except TypedFieldError as error:
            self.errors.setdefault(typed_name(name), str(error))
            return None

    def _late(self, form: RuleForm) -> LateRule:
        nothing = LateRule()
        values: dict[str, Any] = {"kind": form.late}
        for name in LATE_PARAMETERS[form.late]:
            values[name] = self._steps(form) if name == "steps" else self._value(name, form, nothing)
        return self._made(LateRule, values, nothing)

    def _steps(self, form: RuleForm) -> tuple[LateStep, ...]:
        try:
            return tuple(_step(*line, self.zone) for line in form.steps()[:-_SPARE_STEPS])
        except TypedFieldError as error:
            self.errors.setdefault("steps", str(error))
            return ()

    def _value(self, name: str, form: BaseModel, before: object) -> Any:
        """Return what is typed for a short field of the contract that the form was made from.

        That is its default where nothing is typed, or something wrong.
        """
        contract: type = type(before)
        text = getattr(form, typed_name(name))
        if text == _texts(before, self.zone)[typed_name(name)]:
            return getattr(before, name)
        try:
            if text.strip():
                return _read(kinds_of(contract)[name], text.strip(), self.zone)
        except TypedFieldError as error:
            self.errors.setdefault(typed_name(name), str(error))
        return _defaults(contract)[name]

    def _made(self, contract: type[_Contract], values: Mapping[str, Any], otherwise: _Contract) -> _Contract:
        """Return the contract with these values; `otherwise` if they contradict each other."""
        try:
            return contract(**values)
        except RuleError as error:
            self.errors.setdefault(typed_name(error.field.rpartition(".")[2]), f"rules.error.{error.code}")
            return otherwise


def _step(hours: str, percent: str, zone: ZoneInfo) -> LateStep:
    kinds, wrong = kinds_of(LateStep), "rules.error.step"
    if not hours.strip():
        raise TypedFieldError(wrong)
    after_s = _read(kinds["after_s"], hours.strip(), zone)
    return LateStep(after_s=after_s, keep=_read(kinds["keep"], percent.strip(), zone, wrong))


def _read(kind: FieldKind, text: str, zone: ZoneInfo, wrong_share: str | None = None) -> Any:
    match kind:
        case fields.Instant():
            return _instant(text, zone)
        case fields.Seconds():
            return _seconds(text, kind)
        case fields.Share():
            wrong = "rules.error.percent" if kind.positive else "rules.error.percent_from_0"
            return _between(text.removesuffix("%").strip(), 100.0, wrong_share or wrong) / 100
        case _:
            assert isinstance(kind, fields.Count)
            return _count(text, kind)


def _instant(text: str, zone: ZoneInfo) -> datetime:
    try:
        typed = instant(text)
    except ValueError:
        raise TypedFieldError("rules.error.instant") from None
    if typed.year not in YEARS:
        raise TypedFieldError("rules.error.years")
    return typed.replace(tzinfo=zone) if typed.tzinfo is None else typed


def _count(text: str, kind: fields.Count) -> int:
    try:
        number = whole(text)
    except ValueError:
        raise TypedFieldError("rules.error.count") from None
    if not kind.low <= number <= kind.high:
        raise TypedFieldError(f"rules.error.count_from_{kind.low}")
    return number


def _seconds(text: str, kind: fields.Seconds) -> int:
    found = _WITH_UNIT.fullmatch(text)
    assert found is not None  # the unit may be missing
    unit_s = _UNITS_S[found[2]]
    return round(_between(found[1], kind.high / unit_s, "rules.error.hours") * unit_s)


def _between(text: str, high: float, wrong: str) -> float:
    """Return the number that was typed.

    Raises TypedFieldError: `wrong`: it is none from 0 to `high`.
    """
    try:
        number = decimal(text)
    except ValueError:
        raise TypedFieldError(wrong) from None
    if not 0.0 <= number <= high:
        raise TypedFieldError(wrong)
    return number
