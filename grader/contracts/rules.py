"""The rules of an assignment in a course: what is accepted, what lateness costs, which attempt counts.

Every instant has a time zone. What the rules say about a submission depends only on the instant it was received:
waiting in the queue, grading and grading again change nothing. There is no clock and no store here, so the same
question always has the same answer.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, time, timedelta
from typing import Annotated, Final, Literal
from zoneinfo import ZoneInfo

from grader.contracts.errors import RefusedError
from grader.contracts.fields import (
    Choice,
    Count,
    FieldKind,
    Instant,
    Name,
    Names,
    Nested,
    Seconds,
    Share,
    Table,
    kinds_of,
)
from grader.contracts.python import StrEnum
from grader.contracts.team import LARGEST_TEAM
from grader.contracts.text import Text

LateKind = Literal["none", "linear", "steps"]
LATE_PARAMETERS: Final[dict[LateKind, tuple[str, ...]]] = {
    "none": (),
    "linear": ("per_day",),
    "steps": ("steps",),
}
"""The fields that each kind of late rule uses. The form shows only these; the others keep their defaults."""

YEARS = range(2000, 2201)  # near the ends of the calendar, adding a duration to an instant overflows
_MOST_S = 10 * 366 * 86_400
_MOST_ATTEMPTS = 10_000
_MOST_WEIGHT = 10_000
MOST_STEPS = 50
MOST_HIDDEN_ITEMS = 100
MOST_SECTIONS = 100
_DAY_S = 86_400
_SCORE_DIGITS = 2  # as rubric items are rounded
RefusalCode = Literal["not_open_yet", "closed", "no_attempts_left", "no_attempts_today", "course_archived"]


class RuleError(ValueError):
    """Rules that contradict themselves; the message is English.

    Attributes:
        field: the rule that is wrong, as in ``late.per_day``.
        code: what is wrong with it; the form says ``page.rules.error.<code>`` at the field.
        text: what is wrong with it, in both languages, for JSON and the command line.
    """

    def __init__(self, field: str, code: str, *, zh: str, en: str) -> None:
        super().__init__(en)
        self.field = field
        self.code = code
        self.text = Text(zh=zh, en=en)


class Counts(StrEnum):
    """Which of a student's attempts counts."""

    BEST = "best"
    LAST = "last"
    BEST_BEFORE_DUE = "best_before_due"


class Shown(StrEnum):
    """When students see an assignment. The staff always does."""

    ALWAYS = "always"
    WHEN_OPEN = "when_open"
    DRAFT = "draft"


class HintRule(StrEnum):
    """How much students are told of lost points: what the assignment says, or what `Hints` means."""

    ASSIGNMENT = "assignment"
    FACT = "fact"
    LINE = "line"
    CHANGE = "change"


class Corrector(StrEnum):
    """Who corrects the points that the machine gave."""

    INSTRUCTORS = "instructors"
    STAFF = "staff"


@dataclass(frozen=True, slots=True, kw_only=True)
class LateStep:
    """What is kept of the points of a submission that is late by more than `after_s`."""

    after_s: Annotated[int, Seconds("Late by more than this.", high=_MOST_S, example=86_400)]
    keep: Annotated[float, Share("Share of the points that is kept.", example=0.8)]


@dataclass(frozen=True, slots=True, kw_only=True)
class LateRule:
    """What lateness costs.

    Attributes:
        kind: ``none``: nothing; ``linear``: `per_day` of the points for each begun day; ``steps``.
        per_day: share of the points, in (0, 1].
        steps: by rising `after_s`; `keep` never rises.
    """

    kind: Annotated[LateKind, Choice(options=tuple(LATE_PARAMETERS), example="linear")] = "none"
    per_day: Annotated[
        float, Share("`linear`: share lost for each begun day.", example=0.1, positive=True)
    ] = 0.0
    steps: Annotated[tuple[LateStep, ...], Table("`steps`.", of=LateStep, most=MOST_STEPS, example=())] = ()

    def __post_init__(self) -> None:
        if self.kind == "linear" or self.per_day:
            self._check_linear()
        if self.kind == "steps" or self.steps:
            self._check_steps()

    def _check_linear(self) -> None:
        if not 0.0 < self.per_day <= 1.0:
            raise RuleError(
                "late.per_day",
                "percent",
                zh="late.per_day 要大于 0、不超过 1。",
                en="late.per_day must be more than 0 and at most 1",
            )

    def _check_steps(self) -> None:
        if not self.steps:
            raise RuleError(
                "late.steps",
                "no_steps",
                zh="late.steps 至少要有一档。",
                en="late.steps must name at least one step",
            )
        if any(not (step.after_s >= 0 and 0.0 <= step.keep <= 1.0) for step in self.steps):
            raise RuleError(
                "late.steps",
                "step",
                zh="late.steps：after_s 不能小于 0，keep 在 0 到 1 之间。",
                en="late.steps: after_s must be at least 0, keep from 0 to 1",
            )
        pairs = list(zip(self.steps, self.steps[1:], strict=False))
        if any(second.after_s <= first.after_s or second.keep > first.keep for first, second in pairs):
            raise RuleError(
                "late.steps",
                "steps_order",
                zh="late.steps：after_s 要一档比一档大，keep 不能变大。",
                en="late.steps must rise in after_s and not rise in keep",
            )

    def kept_share(self, late_s: float) -> float:
        """Return the share of the points that is kept `late_s` seconds after the due date; it never rises."""
        if late_s <= 0.0 or self.kind == "none":
            return 1.0
        if self.kind == "linear":
            begun_days = -(-late_s // _DAY_S)
            return max(1.0 - begun_days * self.per_day, 0.0)
        passed = [step.keep for step in self.steps if late_s > step.after_s]
        return passed[-1] if passed else 1.0


def _check_fields(contract: object, kinds: Mapping[str, FieldKind]) -> None:
    """Refuse an instant without a time zone, and a count or duration below the least that its kind allows.

    Raises RuleError: names the first such field.
    """
    for name, kind in kinds.items():
        value = getattr(contract, name)
        if value is None:
            continue
        if isinstance(kind, Instant) and value.tzinfo is None:
            raise RuleError(name, "instant", zh=f"{name} 要有时区。", en=f"{name} needs a time zone")
        if isinstance(kind, Count | Seconds) and value < kind.low:
            code = "hours" if isinstance(kind, Seconds) else f"count_from_{kind.low}"
            zh, en = f"{name} 不能小于 {kind.low}。", f"{name} must be at least {kind.low}"
            raise RuleError(name, code, zh=zh, en=en)


@dataclass(frozen=True, slots=True, kw_only=True)
class SectionRule:
    """What holds for the students of one section in place of the same fields of `Rules`."""

    section: Annotated[str, Name("A section of the course.", longest=64, example="A")]
    due: Annotated[datetime, Instant("Later is late.", example="2026-03-22T23:59:59")]
    late: Annotated[LateRule, Nested(of=LateRule)] = LateRule()
    accept_late_s: Annotated[
        int | None, Seconds("How long after `due`; null: for ever.", high=_MOST_S, example=172_800)
    ] = None

    def __post_init__(self) -> None:
        _check_fields(self, kinds_of(SectionRule))


@dataclass(frozen=True, slots=True, kw_only=True)
class Extension:
    """What one student gets beyond the rules: a later due date, more attempts. It never takes anything away."""

    due: Annotated[datetime | None, Instant("Later than everybody's, else without effect.")] = None
    extra_attempts: Annotated[int, Count(high=_MOST_ATTEMPTS)] = 0

    def __post_init__(self) -> None:
        _check_fields(self, kinds_of(Extension))


NO_EXTENSION = Extension()


@dataclass(frozen=True, slots=True, kw_only=True)
class Attempt:
    """One submission as the rules see it.

    Attributes:
        score: None while it is not graded.
        costs: whether it uses up an attempt. If not (the service failed to grade it), it never counts either.
    """

    id: str
    received_at: datetime
    score: float | None = None
    costs: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Counted:
    """The attempt that counts, and what of its score is kept after lateness (`score`)."""

    attempt: Attempt
    score: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Refusal:
    """Why an upload is not accepted. `until`: when it would be; None: never, unless the rules change."""

    code: RefusalCode
    until: datetime | None = None

    def error(self) -> RefusedError:
        """Return the error that says so to the student."""
        if self.until is None:
            return RefusedError(self.code)
        until = self.until.isoformat(timespec="seconds")
        detail = Text(zh=f"{until} 之后可以提交。", en=f"Uploads are accepted from {until} on.")
        return RefusedError(self.code, detail)


@dataclass(frozen=True, slots=True, kw_only=True)
class Rules:
    """The rules of one assignment; the default allows everything at any time.

    Attributes:
        shown: when students see the assignment: always, from `opens` on, or, of a draft, never.
        opens: nothing is accepted before. due: what comes later is late. Either may be None. Days of lateness are
            those on the clock of the zone of `due`.
        accept_late_s: how long after `due` submissions are accepted; None: for ever, 0: not at all.
        attempts, attempts_per_day: how many in all, and in one calendar day of the course; None: any number.
        weight: what the assignment counts in the total in per cent; None: its points.
        hidden_items: rubric items that students do not see before `hidden_until`; None: they never see them.
        hints: how much students are told of lost points.
        appeals_until: how long students may ask for another look at an item; None: they may not.
        corrected_by: who may correct what the machine judged.
        team_size: how many students at most hand in together; 1: everybody alone.
        by_section: what holds for single sections instead of `due`, `late` and `accept_late_s`.
    """

    shown: Annotated[
        Shown, Choice("`when_open`: students see it from `opens` on; `draft`: never.", options=tuple(Shown))
    ] = Shown.ALWAYS
    opens: Annotated[datetime | None, Instant("Nothing is accepted before.")] = None
    due: Annotated[datetime | None, Instant("Later is late.", example="2026-03-20T23:59:59")] = None
    late: Annotated[LateRule, Nested(of=LateRule)] = LateRule()
    accept_late_s: Annotated[
        int | None,
        Seconds("How long after `due`; null: for ever.", high=_MOST_S, example=172_800),
    ] = None
    attempts: Annotated[int | None, Count("In all; null: any number.", low=1, high=_MOST_ATTEMPTS)] = None
    attempts_per_day: Annotated[
        int | None, Count("In a calendar day of the course.", low=1, high=_MOST_ATTEMPTS)
    ] = None
    counts: Annotated[Counts, Choice("Which attempt counts.", options=tuple(Counts))] = Counts.BEST
    weight: Annotated[
        int | None, Count("In the total in per cent; null: its points, 0: not at all.", high=_MOST_WEIGHT)
    ] = None
    hidden_items: Annotated[
        tuple[str, ...], Names("Rubric items that students do not see.", most=MOST_HIDDEN_ITEMS)
    ] = ()
    hidden_until: Annotated[datetime | None, Instant("Null: students never see them.")] = None
    hints: Annotated[
        HintRule, Choice("How much students are told of lost points.", options=tuple(HintRule))
    ] = HintRule.ASSIGNMENT
    appeals_until: Annotated[
        datetime | None,
        Instant("Until then students may ask for another look at an item; null: they may not."),
    ] = None
    corrected_by: Annotated[
        Corrector, Choice("Who corrects what the machine judged.", options=tuple(Corrector))
    ] = Corrector.INSTRUCTORS
    team_size: Annotated[
        int, Count("Most students who hand in together; 1: each alone.", low=1, high=LARGEST_TEAM)
    ] = 1
    by_section: Annotated[
        tuple[SectionRule, ...],
        Table("Due date and lateness of single sections.", of=SectionRule, most=MOST_SECTIONS, example=()),
    ] = ()

    def __post_init__(self) -> None:
        _check_fields(self, kinds_of(Rules))
        if self.opens is not None and self.due is not None and self.opens >= self.due:
            raise RuleError(
                "due", "order", zh="due（截止）要晚于 opens（开放）。", en="due must be later than opens"
            )
        self._check_sections()
        if self.opens is None and self.shown is Shown.WHEN_OPEN:
            raise RuleError(
                "shown",
                "needs_opens",
                zh="shown 用 when_open 时要有 opens（开放时间）。",
                en="shown when_open needs the date from which it opens",
            )
        if self.due is None and self.counts is Counts.BEST_BEFORE_DUE:
            raise RuleError(
                "counts",
                "needs_due",
                zh="counts 用 best_before_due 时要有 due（截止时间）。",
                en="counts best_before_due needs a due date",
            )

    def _check_sections(self) -> None:
        names = [rule.section for rule in self.by_section]
        if len(set(names)) < len(names):
            raise RuleError(
                "by_section",
                "section_twice",
                zh="by_section 里一个班级只能写一次。",
                en="by_section must name a section once",
            )
        if self.opens is not None and any(rule.due <= self.opens for rule in self.by_section):
            raise RuleError(
                "by_section",
                "order",
                zh="due（截止）要晚于 opens（开放）。",
                en="due must be later than opens",
            )

    def for_sections(self, sections: Collection[str]) -> "Rules":
        """Return the rules as they hold for a student of `sections`; of several the latest due date counts."""
        if not self.by_section:
            return self
        own = [rule for rule in self.by_section if rule.section in sections]
        if not own:
            return replace(self, by_section=())
        latest = max(own, key=lambda rule: rule.due)
        return replace(
            self, due=latest.due, late=latest.late, accept_late_s=latest.accept_late_s, by_section=()
        )

    def with_section(self, section: str, rule: SectionRule | None) -> "Rules":
        """Return the rules with `rule` as that of a section; None: without a rule for it."""
        others = [one for one in self.by_section if one.section != section]
        own = [] if rule is None else [rule]
        return replace(self, by_section=tuple(sorted([*others, *own], key=lambda one: one.section)))

    def shown_at(self, now: datetime) -> bool:
        """Return whether students see the assignment at `now`."""
        if self.shown is Shown.WHEN_OPEN:
            return self.opens is not None and now >= self.opens
        return self.shown is Shown.ALWAYS

    def due_for(self, extension: Extension) -> datetime | None:
        """Return the due date of one student, never earlier than everybody's. None: there is none."""
        if self.due is None or extension.due is None:
            return self.due
        return max(self.due, extension.due.astimezone(self.due.tzinfo))

    def late_s(self, extension: Extension, received_at: datetime) -> float:
        """Return how many seconds after the student's due date `received_at` is; 0.0 when it is not."""
        due = self.due_for(extension)
        return 0.0 if due is None else max((received_at - due).total_seconds(), 0.0)

    def kept_share(self, extension: Extension, received_at: datetime) -> float:
        """Return the share of its points that a submission keeps, in [0, 1]."""
        due = self.due_for(extension)
        if due is None or received_at <= due:
            return 1.0
        return self.late.kept_share(_late_on_the_clock_s(due, received_at))

    def kept_score(self, extension: Extension, score: float, received_at: datetime) -> float:
        """Return what of `score` is kept after lateness, rounded as scores are."""
        return round(score * self.kept_share(extension, received_at), _SCORE_DIGITS)

    def refusal(
        self, extension: Extension, earlier: Sequence[Attempt], received_at: datetime, zone: ZoneInfo
    ) -> Refusal | None:
        """Return why an upload received at `received_at` is refused, or None.

        Args:
            extension: what this student gets beyond the rules.
            earlier: the student's attempts so far; those that cost nothing are not counted.
            received_at: instant of the upload.
            zone: the course's time zone; the limit per day is per calendar day there.
        """
        if self.shown is Shown.DRAFT:
            return Refusal(code="not_open_yet")
        if self.opens is not None and received_at < self.opens:
            return Refusal(code="not_open_yet", until=self.opens)
        due = self.due_for(extension)
        if (
            due is not None
            and self.accept_late_s is not None
            and received_at > due + timedelta(seconds=self.accept_late_s)
        ):
            return Refusal(code="closed")
        costly = [attempt for attempt in earlier if attempt.costs]
        left = self.attempts_left(extension, costly)
        if left is not None and left <= 0:
            return Refusal(code="no_attempts_left")
        return self._too_many_today(costly, received_at, zone)

    def attempts_left(self, extension: Extension, earlier: Sequence[Attempt]) -> int | None:
        """Return how many attempts a student has left in all; None: any number."""
        if self.attempts is None:
            return None
        used = sum(attempt.costs for attempt in earlier)
        return max(self.attempts + extension.extra_attempts - used, 0)

    def counting(self, extension: Extension, attempts: Sequence[Attempt]) -> Counted | None:
        """Return the attempt that counts; None while no attempt has a score.

        Of attempts that keep the same score the first one counts; with ``last``, the last graded one.
        """
        graded = sorted(
            (attempt for attempt in attempts if attempt.costs and attempt.score is not None),
            key=lambda one: (one.received_at, one.id),
        )
        if self.counts is Counts.BEST_BEFORE_DUE:
            graded = [attempt for attempt in graded if self.late_s(extension, attempt.received_at) <= 0.0]
        if not graded:
            return None
        kept = [
            Counted(
                attempt=attempt, score=self.kept_score(extension, attempt.score or 0.0, attempt.received_at)
            )
            for attempt in graded
        ]
        return kept[-1] if self.counts is Counts.LAST else max(kept, key=lambda one: one.score)

    def moved(self, days: int, zone: ZoneInfo) -> "Rules":
        """Return the rules with every date `days` days later, at the same time of the day in `zone`."""
        later = timedelta(days=days)
        instants = [name for name, kind in kinds_of(Rules).items() if isinstance(kind, Instant)]
        dates = {name: date for name in instants if (date := getattr(self, name)) is not None}
        moved = {name: date.astimezone(zone) + later for name, date in dates.items()}
        sections = [replace(rule, due=rule.due.astimezone(zone) + later) for rule in self.by_section]
        return replace(self, **moved, by_section=tuple(sections))

    def may_appeal_at(self, now: datetime) -> bool:
        """Return whether students may ask for another look at `now`."""
        return self.appeals_until is not None and now < self.appeals_until

    def hidden_at(self, now: datetime) -> frozenset[str]:
        """Return the ids of the rubric items that students do not see at `now`."""
        if self.hidden_until is not None and now >= self.hidden_until:
            return frozenset()
        return frozenset(self.hidden_items)

    def _too_many_today(
        self, costly: Sequence[Attempt], received_at: datetime, zone: ZoneInfo
    ) -> Refusal | None:
        if self.attempts_per_day is None:
            return None
        today = received_at.astimezone(zone).date()
        used = sum(attempt.received_at.astimezone(zone).date() == today for attempt in costly)
        if used < self.attempts_per_day:
            return None
        tomorrow = datetime.combine(today + timedelta(days=1), time(), zone)
        return Refusal(code="no_attempts_today", until=tomorrow)


def _late_on_the_clock_s(due: datetime, received_at: datetime) -> float:
    """Return how late an instant is if each day of the zone of `due` had 24 hours: clocks may change meanwhile."""
    late_at_s = received_at.timestamp()
    days = int((late_at_s - due.timestamp()) // _DAY_S) + 1
    while (
        due + timedelta(days=days)
    ).timestamp() > late_at_s:  # at the same time of the day, so many days later
        days -= 1
    rest_s = late_at_s - (due + timedelta(days=days)).timestamp()
    return days * _DAY_S + min(rest_s, _DAY_S)


NO_RULES = Rules()


def is_hidden(item_id: str, hidden: frozenset[str]) -> bool:
    """Return whether an item of a report (``id``, or ``case/id``) is one of the `hidden` ones."""
    return item_id in hidden or item_id.rpartition("/")[2] in hidden
