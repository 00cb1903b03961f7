"""The head of a report: one sentence, one next step, and the recognised mistakes."""

from collections.abc import Mapping, Sequence
from typing import Final

from grader.checks.measure import Findings, Mistake
from grader.contracts.outcome import RunOutcome, RunStatus
from grader.contracts.rubric import ItemStatus, RubricItem, first_lost, summed, to_judge
from grader.contracts.scoring import Scoring
from grader.contracts.text import EMPTY, Text
from grader.messages import enumerated, say
from grader.messages.quantity import points

_NOTHING_LOST = (ItemStatus.PASSED, ItemStatus.NEEDS_MANUAL)
_FOLLOWS: Final = frozenset({"off_pct", "mean_off_pct", "covered_pct", "gap_pct"})
"""Measures of a whole figure: what is wrong in a piece of it shows there, too."""


def is_wanting(items: Sequence[RubricItem], outcomes: Sequence[RunOutcome]) -> bool:
    """Whether there is something to explain: points were lost, or the script crashed after all."""
    lost = any(item.status not in _NOTHING_LOST for item in items)
    return lost or any(outcome.status is RunStatus.CRASHED for outcome in outcomes)


def summarise(
    items: Sequence[RubricItem], findings: Sequence[Findings], outcomes: Sequence[RunOutcome]
) -> Scoring:
    """Return the items with summary, hint and recognised mistakes; without mistakes where nothing was lost."""
    if not items:  # no rubric, as for `grader run`: mistakes are still shown
        mistakes = _distinct(findings)
        hint = mistakes[0].text if mistakes else EMPTY
        codes = tuple(mistake.code for mistake in mistakes)
        return Scoring(items=(), summary=EMPTY, hint=hint, mistakes=codes)
    wrong = [item for item in items if item.status not in _NOTHING_LOST]
    if not wrong and to_judge(items):
        return Scoring(items=tuple(items), summary=say("summary.waiting"))
    if not wrong:
        return Scoring(items=tuple(items), summary=_all_passed(outcomes), hint=_later(findings, outcomes))
    mistakes = _distinct(findings)
    hint = mistakes[0].text if mistakes else next((item.hint for item in wrong if item.hint != EMPTY), EMPTY)
    return Scoring(
        items=tuple(items),
        summary=say("summary.waiting") if to_judge(items) else _sentence(items, wrong),
        hint=hint,
        mistakes=tuple(mistake.code for mistake in mistakes),
    )


def first_step(items: Sequence[RubricItem], measures: Mapping[str, str]) -> Text:
    """Return what was measured of one item that lost points, and its hint; empty where no item has one.

    `measures`: of the items whose hint does not say what was measured, by id without the case.
    """
    hinted = [item for item in items if item.status not in _NOTHING_LOST and item.hint != EMPTY]
    names = {item.id: measures.get(item.id.rpartition("/")[2]) for item in hinted}
    first = first_lost(hinted, {id_ for id_, measure in names.items() if measure in _FOLLOWS})
    if first is None:
        return EMPTY
    if names[first.id] is None or first.message == EMPTY:
        return first.hint
    fact = say("step.fact", title=first.title, seen=first.message)
    return Text(zh=f"{fact.zh}{first.hint.zh}", en=f"{fact.en} {first.hint.en}")


def summarise_text(items: Sequence[RubricItem], findings: Findings) -> Scoring:
    """Return the items of a text with summary, hint and recognised mistakes."""
    if not to_judge(items):
        return summarise(items, [findings], [])
    short = next((item for item in items if item.status is ItemStatus.FAILED), None)
    hint = EMPTY if short is None else short.hint
    return Scoring(items=tuple(items), summary=say("summary.waiting"), hint=hint)


def _all_passed(outcomes: Sequence[RunOutcome]) -> Text:
    """Return praise, or the error that ended the script later."""
    error = next(
        (outcome.error for outcome in outcomes if outcome.status is RunStatus.CRASHED and outcome.error), None
    )
    if error is None:
        return say("summary.full")
    return say("summary.full_then_crashed", line=error.line or "?", type=error.type)


def _later(findings: Sequence[Findings], outcomes: Sequence[RunOutcome]) -> Text:
    """Return what an error means that ended the script after it had done all that was asked."""
    for seen, outcome in zip(findings, outcomes, strict=False):
        if outcome.status is RunStatus.CRASHED and outcome.error and seen.mistakes:
            return seen.mistakes[0].text
    return EMPTY


def _sentence(items: Sequence[RubricItem], wrong: Sequence[RubricItem]) -> Text:
    earned, most = summed(item.earned for item in items), summed(item.points for item in items)
    if earned <= 0.0:
        return say("summary.nothing", points=points(most))
    # not items that lost points only because of another one
    own = (item.title for item in wrong if item.hint != EMPTY)
    titles = enumerated(list(dict.fromkeys(own)))  # an item may fail in several cases
    return say(
        "summary.partial",
        earned=points(earned),
        points=points(most),
        passed=len(items) - len(wrong),
        count=len(items),
        items=titles,
    )


def _distinct(findings: Sequence[Findings]) -> list[Mistake]:
    mistakes: dict[str, Mistake] = {}
    for seen in findings:
        for mistake in seen.mistakes:
            mistakes.setdefault(mistake.code, mistake)
    return list(mistakes.values())
