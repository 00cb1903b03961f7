"""The rules of one assignment in one course, as data; `grader.policy` applies them.

Every instant is aware. What a rule says about a submission follows from the instant it was received and from
nothing else: neither waiting nor grading nor a re-grade changes it.
"""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Literal

from grader.contracts.text import Text

LateKind = Literal["none", "linear", "steps"]


class RuleError(ValueError):
    """Rules that make no sense; its message is English.

    Attributes:
        field: the rule that is meant. text: what is wrong, in both languages.
    """

    def __init__(self, field: str, *, zh: str, en: str) -> None:
        super().__init__(en)
        self.field = field
        self.text = Text(zh=zh, en=en)


class Counts(StrEnum):
    """Which of a student's attempts counts."""

    BEST = "best"
    LAST = "last"
    BEST_BEFORE_DUE = "best_before_due"


@dataclass(frozen=True, slots=True, kw_only=True)
class LateStep:
    """What is kept of the points of a submission that is late by more than `after_s`."""

    after_s: int
    keep: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LateRule:
    """What lateness costs.

    Attributes:
        kind: ``none``: nothing; ``linear``: `per_day` of the points for each begun day; ``steps``.
        per_day: share of the points, in (0, 1].
        steps: by rising `after_s`; `keep` never rises.
    """

    kind: LateKind = "none"
    per_day: float = 0.0
    steps: tuple[LateStep, ...] = ()

    def __post_init__(self) -> None:
        if self.kind == "linear" and not 0.0 < self.per_day <= 1.0:
            raise RuleError(
                "late.per_day",
                zh="late.per_day 要大于 0、不超过 1。",
                en="late.per_day must be more than 0 and at most 1",
            )
        if self.kind == "steps" and not self.steps:
            raise RuleError(
                "late.steps", zh="late.steps 至少要有一档。", en="late.steps must name at least one step"
            )
        if any(not (step.after_s >= 0 and 0.0 <= step.keep <= 1.0) for step in self.steps):
            raise RuleError(
                "late.steps",
                zh="late.steps：after_s 不能小于 0，keep 在 0 到 1 之间。",
                en="late.steps: after_s must be at least 0, keep from 0 to 1",
            )
        pairs = list(zip(self.steps, self.steps[1:], strict=False))
        if any(second.after_s <= first.after_s or second.keep > first.keep for first, second in pairs):
            raise RuleError(
                "late.steps",
                zh="late.steps：after_s 要一档比一档大，keep 不能变大。",
                en="late.steps must rise in after_s and not rise in keep",
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class AssignmentPolicy:
    """The rules of one assignment; the default allows everything at any time.

    Attributes:
        opens: nothing is accepted before. due: later is late. Either may be None.
        accept_late_s: how long after `due` submissions are accepted; None: for ever, 0: not at all.
        attempts, attempts_per_day: most attempts in all and in one calendar day of the course; None: any number.
        hidden_items: rubric items that students do not see before `hidden_until`, or ever when that is None.
    """

    opens: datetime | None = None
    due: datetime | None = None
    late: LateRule = LateRule()
    accept_late_s: int | None = None
    attempts: int | None = None
    attempts_per_day: int | None = None
    counts: Counts = Counts.BEST
    hidden_items: tuple[str, ...] = ()
    hidden_until: datetime | None = None

    def __post_init__(self) -> None:
        for name in ("opens", "due", "hidden_until"):
            instant: datetime | None = getattr(self, name)
            if instant is not None and instant.tzinfo is None:
                raise RuleError(name, zh=f"{name} 要有时区。", en=f"{name} needs a time zone")
        if self.opens is not None and self.due is not None and self.opens >= self.due:
            raise RuleError("due", zh="due（截止）要晚于 opens（开放）。", en="due must be later than opens")
        for name in ("attempts", "attempts_per_day"):
            number: int | None = getattr(self, name)
            if number is not None and number < 1:
                raise RuleError(name, zh=f"{name} 不能小于 1。", en=f"{name} must be at least 1")
        if self.accept_late_s is not None and self.accept_late_s < 0:
            raise RuleError(
                "accept_late_s", zh="accept_late_s 不能小于 0。", en="accept_late_s must be at least 0"
            )
        if self.due is None and self.counts is Counts.BEST_BEFORE_DUE:
            raise RuleError(
                "counts",
                zh="counts 用 best_before_due 时要有 due（截止时间）。",
                en="counts best_before_due needs a due date",
            )


NO_POLICY = AssignmentPolicy()


@dataclass(frozen=True, slots=True, kw_only=True)
class Extension:
    """What one student gets beyond the rules: a later due date, more attempts. It never takes anything away."""

    due: datetime | None = None
    extra_attempts: int = 0

    def __post_init__(self) -> None:
        if self.due is not None and self.due.tzinfo is None:
            raise RuleError("due", zh="due 要有时区。", en="due needs a time zone")
        if self.extra_attempts < 0:
            raise RuleError(
                "extra_attempts", zh="extra_attempts 不能小于 0。", en="extra_attempts must be at least 0"
            )


NO_EXTENSION = Extension()


@dataclass(frozen=True, slots=True, kw_only=True)
class Attempt:
    """One submission as the rules see it.

    Attributes:
        score: None while it is not graded.
        costs: False when the service failed to grade it: then it costs nothing and counts for nothing.
    """

    id: str
    received_at: datetime
    score: float | None = None
    costs: bool = True


RefusalCode = Literal["not_open_yet", "closed", "no_attempts_left", "no_attempts_today"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Refusal:
    """Why an upload is not accepted. `until`: when one would be; None: never, unless the rules change."""

    code: RefusalCode
    until: datetime | None = None
