from datetime import UTC, datetime, timedelta
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest

from grader.contracts.rules import (
    LATE_PARAMETERS,
    NO_EXTENSION,
    NO_RULES,
    Attempt,
    Counts,
    Extension,
    LateRule,
    LateStep,
    Rules,
    is_hidden,
)
from tests.fakes.late_rules import EXAMPLES

DOCS = Path(__file__).resolve().parents[3] / "docs"
SHANGHAI = ZoneInfo("Asia/Shanghai")
DUE = datetime(2026, 3, 20, 23, 59, 59, tzinfo=SHANGHAI)
HOUR = timedelta(hours=1)


def attempt(number: int, at: datetime, score: float | None = None, costs: bool = True) -> Attempt:
    return Attempt(id=str(number), received_at=at, score=score, costs=costs)


def refused(rules: Rules, at: datetime, *made: Attempt, extension: Extension = NO_EXTENSION):
    refusal = rules.refusal(extension, made, at, SHANGHAI)
    return None if refusal is None else refusal.code


def test_without_rules_everything_goes() -> None:
    assert refused(NO_RULES, DUE, *(attempt(n, DUE) for n in range(99))) is None
    assert NO_RULES.kept_share(NO_EXTENSION, DUE) == 1.0


def test_the_due_instant_itself_is_on_time() -> None:
    rules = Rules(due=DUE, accept_late_s=0)
    assert refused(rules, DUE) is None
    assert refused(rules, DUE + timedelta(microseconds=1)) == "closed"
    assert refused(rules, datetime(2026, 3, 20, 15, 59, 59, tzinfo=UTC)) is None
    assert refused(rules, datetime(2026, 3, 20, 16, 0, 0, tzinfo=UTC)) == "closed"


def test_linear_costs_each_begun_day() -> None:
    rules = Rules(due=DUE, late=LateRule(kind="linear", per_day=0.25))
    days = [
        timedelta(0),
        timedelta(seconds=1),
        timedelta(days=1),
        timedelta(days=1, seconds=1),
        timedelta(days=9),
    ]
    assert [rules.kept_share(NO_EXTENSION, DUE + late) for late in days] == [
        1.0,
        0.75,
        0.75,
        0.5,
        0.0,
    ]


def test_steps() -> None:
    steps = (LateStep(after_s=600, keep=0.9), LateStep(after_s=7200, keep=0.5))
    rules = Rules(due=DUE, late=LateRule(kind="steps", steps=steps))
    late = [timedelta(minutes=10), timedelta(minutes=11), 3 * HOUR]
    assert [rules.kept_share(NO_EXTENSION, DUE + one) for one in late] == [1.0, 0.9, 0.5]


@pytest.mark.parametrize("rule", EXAMPLES.values(), ids=list(EXAMPLES))
def test_on_time_is_whole_and_later_is_never_more(rule: LateRule) -> None:
    kept = [rule.kept_share(late_s) for late_s in (0.0, 1.0, 3600.0, 3601.0, 86_400.0, 86_401.0, 1e7)]
    assert kept[0] == 1.0
    assert kept == sorted(kept, reverse=True)
    assert kept[-1] == 1.0 if rule.kind == "none" else kept[-1] < 1.0


def test_an_extension_moves_due_and_cut_off() -> None:
    rules = Rules(due=DUE, accept_late_s=3600, late=LateRule(kind="linear", per_day=0.5))
    extension = Extension(due=DUE + 24 * HOUR)
    assert refused(rules, DUE + 25 * HOUR, extension=extension) is None
    assert refused(rules, DUE + 26 * HOUR, extension=extension) == "closed"
    assert rules.kept_share(extension, DUE + 23 * HOUR) == 1.0
    assert rules.due_for(Extension(due=DUE - HOUR)) == DUE


def test_attempts_run_out() -> None:
    rules = Rules(attempts=2)
    made = (attempt(1, DUE), attempt(2, DUE, costs=False), attempt(3, DUE))
    assert refused(rules, DUE, *made) == "no_attempts_left"
    assert refused(rules, DUE, *made[:2]) is None
    assert refused(rules, DUE, *made, extension=Extension(extra_attempts=1)) is None


def test_a_day_is_a_day_of_the_course() -> None:
    rules = Rules(attempts_per_day=1)
    before_midnight = datetime(2026, 3, 20, 15, 59, tzinfo=UTC)  # 23:59 in Shanghai
    after = before_midnight + timedelta(minutes=2)
    assert refused(rules, after, attempt(1, before_midnight)) is None
    assert refused(rules, after + HOUR, attempt(1, after)) == "no_attempts_today"
    until = rules.refusal(NO_EXTENSION, [attempt(1, after)], after, SHANGHAI).until
    assert until == datetime(2026, 3, 22, tzinfo=SHANGHAI)


def test_a_day_with_a_clock_change_ends_at_midnight() -> None:
    berlin = ZoneInfo("Europe/Berlin")
    at = datetime(2026, 3, 29, 12, tzinfo=berlin)  # a day of 23 hours
    refusal = Rules(attempts_per_day=1).refusal(NO_EXTENSION, [attempt(1, at)], at, berlin)
    assert refusal.until == datetime(2026, 3, 29, 22, tzinfo=UTC)


def test_which_attempt_counts() -> None:
    late = LateRule(kind="linear", per_day=0.5)
    made = [
        attempt(1, DUE - 2 * HOUR, 6.0),
        attempt(2, DUE - HOUR, 4.0),
        attempt(3, DUE + HOUR, 10.0),
        attempt(4, DUE + 2 * HOUR, 7.0),
        attempt(5, DUE + 3 * HOUR, None),
    ]
    expected = {Counts.BEST: ("1", 6.0), Counts.LAST: ("4", 3.5), Counts.BEST_BEFORE_DUE: ("1", 6.0)}
    for counts, (id_, score) in expected.items():
        counted = Rules(due=DUE, late=late, counts=counts).counting(NO_EXTENSION, made)
        assert (counted.attempt.id, counted.score) == (id_, score)
    assert NO_RULES.counting(NO_EXTENSION, made).attempt.id == "3"
    assert NO_RULES.counting(NO_EXTENSION, made[4:]) is None


def test_hidden_items_show_in_time() -> None:
    rules = Rules(hidden_items=("closed",), hidden_until=DUE)
    hidden = rules.hidden_at(DUE - HOUR)
    assert [is_hidden(one, hidden) for one in ("closed", "small/closed", "closed/x", "sides")] == [
        True,
        True,
        False,
        False,
    ]
    assert rules.hidden_at(DUE) == frozenset()
    assert Rules(hidden_items=("a",)).hidden_at(DUE) == {"a"}


@pytest.mark.parametrize(
    ("values", "why"),
    [
        ({"due": datetime(2026, 1, 1)}, "time zone"),
        ({"opens": DUE, "due": DUE}, "later than opens"),
        ({"attempts": 0}, "attempts"),
        ({"accept_late_s": -1}, "accept_late_s"),
        ({"counts": Counts.BEST_BEFORE_DUE}, "due date"),
    ],
)
def test_rules_that_make_no_sense(values: dict[str, object], why: str) -> None:
    with pytest.raises(ValueError, match=why):
        Rules(**values)


@pytest.mark.parametrize(
    "values",
    [
        {"kind": "linear"},
        {"kind": "linear", "per_day": float("nan")},
        {"kind": "none", "per_day": -3.0},
        {"kind": "steps"},
        {"kind": "steps", "steps": (LateStep(after_s=1, keep=float("nan")),)},
        {"kind": "steps", "steps": (LateStep(after_s=1, keep=0.5), LateStep(after_s=2, keep=0.6))},
        {"kind": "steps", "steps": (LateStep(after_s=2, keep=0.5), LateStep(after_s=2, keep=0.4))},
    ],
)
def test_late_rules_that_make_no_sense(values: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="late"):
        LateRule(**values)


@pytest.mark.parametrize("page", ["instructor.md", "instructor.zh.md"])
def test_every_kind_of_late_rule_stands_in_the_instructors_guide(page: str) -> None:
    text = (DOCS / page).read_text(encoding="utf-8")
    assert [kind for kind in LATE_PARAMETERS if f"`{kind}`" not in text] == []


@pytest.mark.parametrize(
    ("due", "received", "kept"),
    [
        # the night of 29 March 2026 has 23 hours in Berlin, that of 25 October 25
        ("2026-03-28T23:59", "2026-03-29T23:59:00", 0.9),
        ("2026-03-28T23:59", "2026-03-29T23:59:01", 0.8),
        ("2026-10-24T23:59", "2026-10-25T23:58:59", 0.9),
        ("2026-10-24T23:59", "2026-10-25T23:59:01", 0.8),
        ("2026-10-24T02:30", "2026-10-25T02:29:00", 0.9),  # the first of two times at which clocks say so
        ("2026-03-01T12:00", "2026-03-01T12:00:00", 1.0),
    ],
)
def test_days_of_lateness_are_those_of_the_calendar(due: str, received: str, kept: float) -> None:
    berlin = ZoneInfo("Europe/Berlin")
    rules = Rules(
        due=datetime.fromisoformat(due).replace(tzinfo=berlin), late=LateRule(kind="linear", per_day=0.1)
    )
    at = datetime.fromisoformat(received).replace(tzinfo=berlin).astimezone(UTC)
    assert rules.kept_share(NO_EXTENSION, at) == pytest.approx(kept)
    extension = Extension(due=rules.due.astimezone(UTC))
    assert rules.kept_share(extension, at) == pytest.approx(kept)
