"""Laws of the rules of an assignment, for any rules and any instants."""

from datetime import UTC, datetime, timedelta
from zoneinfo import ZoneInfo

from hypothesis import given
from hypothesis import strategies as st

from grader.contracts.rules import (
    NO_EXTENSION,
    Attempt,
    Counts,
    Extension,
    Rules,
)
from tests.fakes.late_rules import late_rules

START = datetime(2026, 3, 1, tzinfo=UTC)
ZONE = ZoneInfo("Asia/Shanghai")
instants = st.integers(0, 60 * 86_400_000).map(lambda ms: START + timedelta(milliseconds=ms))


@st.composite
def rule_sets(draw: st.DrawFn) -> Rules:
    due = draw(st.none() | instants)
    counts = draw(st.sampled_from([Counts.BEST, Counts.LAST] + ([Counts.BEST_BEFORE_DUE] if due else [])))
    return Rules(
        opens=None if due is None else draw(st.none() | st.just(due - timedelta(days=7))),
        due=due,
        late=draw(late_rules()),
        accept_late_s=draw(st.none() | st.integers(0, 900_000)),
        attempts=draw(st.none() | st.integers(1, 5)),
        attempts_per_day=draw(st.none() | st.integers(1, 3)),
        counts=counts,
    )


extensions = st.builds(Extension, due=st.none() | instants, extra_attempts=st.integers(0, 3))
attempts = st.lists(
    st.builds(
        Attempt,
        id=st.uuids().map(str),
        received_at=instants,
        score=st.none() | st.floats(0.0, 10.0).map(lambda score: round(score, 2)),
        costs=st.booleans(),
    ),
    max_size=6,
)


@given(rule_sets(), extensions, instants, instants)
def test_waiting_never_pays(rules: Rules, extension: Extension, one: datetime, other: datetime) -> None:
    early, late = sorted((one, other))
    first, second = (rules.kept_share(extension, at) for at in (early, late))
    assert 0.0 <= second <= first <= 1.0


@given(rule_sets(), extensions, instants)
def test_an_extension_takes_nothing_away(rules: Rules, extension: Extension, at: datetime) -> None:
    assert rules.kept_share(extension, at) >= rules.kept_share(NO_EXTENSION, at)
    if rules.refusal(NO_EXTENSION, [], at, ZONE) is None:
        assert rules.refusal(extension, [], at, ZONE) is None


@given(rule_sets(), extensions, instants)
def test_on_time_is_whole(rules: Rules, extension: Extension, at: datetime) -> None:
    due = rules.due_for(extension)
    if due is None or at <= due:
        assert rules.kept_share(extension, at) == 1.0


@given(rule_sets(), extensions, attempts, instants)
def test_what_costs_nothing_changes_nothing(
    rules: Rules, extension: Extension, made: list[Attempt], at: datetime
) -> None:
    costly = [one for one in made if one.costs]
    assert rules.refusal(extension, made, at, ZONE) == rules.refusal(extension, costly, at, ZONE)
    assert rules.counting(extension, made) == rules.counting(extension, costly)


@given(rule_sets(), extensions, attempts)
def test_the_order_of_looking_does_not_matter(
    rules: Rules, extension: Extension, made: list[Attempt]
) -> None:
    assert rules.counting(extension, made) == rules.counting(extension, made[::-1])


@given(rule_sets(), extensions, attempts)
def test_the_best_keeps_most(rules: Rules, extension: Extension, made: list[Attempt]) -> None:
    counted = rules.counting(extension, made)
    if counted is None or rules.counts is not Counts.BEST:
        return
    kept = [
        rules.kept_score(extension, one.score, one.received_at)
        for one in made
        if one.costs and one.score is not None
    ]
    assert counted.score == max(kept)
    assert counted.score <= counted.attempt.score


@given(rule_sets(), extensions, attempts, st.floats(0.0, 10.0), instants)
def test_another_attempt_never_lowers_the_best(
    rules: Rules, extension: Extension, made: list[Attempt], score: float, at: datetime
) -> None:
    if rules.counts is Counts.LAST:
        return
    before = rules.counting(extension, made)
    after = rules.counting(extension, [*made, Attempt(id="new", received_at=at, score=score)])
    assert before is None or (after is not None and after.score >= before.score)


@given(rule_sets(), extensions, attempts, instants)
def test_a_refusal_that_names_an_instant_ends_then(
    rules: Rules, extension: Extension, made: list[Attempt], at: datetime
) -> None:
    made = [one for one in made if one.received_at <= at]
    refused = rules.refusal(extension, made, at, ZONE)
    if refused is not None and refused.until is not None:
        assert refused.until > at
        later = rules.refusal(extension, made, refused.until, ZONE)
        assert later is None or later.code != refused.code
