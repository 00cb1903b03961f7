"""What a rubric item expects of the script, which any check of scripts can have beside its own measures.

Each such item has a measure of its own: the share of its expectations that is met, in percent.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Final, cast

from grader.checks.measure import Check, Measure, MeasureKind, Measures, Mistake
from grader.contracts.assignment import Assignment, ItemSpec
from grader.contracts.conversation import Expectation, ExpectationKind
from grader.contracts.outcome import RunStatus
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text
from grader.messages import join, say
from grader.messages.quantity import number

if TYPE_CHECKING:
    from grader.checks.expectations.verdict import Evidence, Verdict

MEASURE: Final = MeasureKind(unit="%", text="expected.share")
_MOST_ROWS: Final = 4
_ROWS: Final = Text(zh="；", en="; ")


@cache
def _judges() -> Mapping[ExpectationKind, "Callable[[Expectation, Evidence], Verdict]"]:
    """Return what judges each kind; most assignments expect nothing, and a cold start pays for every import."""
    from grader.checks.expectations import answers, frames, graph, motions, topics

    return {
        "topic": topics.topic,
        "log": topics.log,
        "answer": answers.answer,
        "goal": answers.goal,
        "set": answers.settings,
        "parameter": answers.parameter,
        "served": answers.served,
        "frame": frames.frame,
        "node": graph.node,
        "listener": graph.endpoint,
        "service": graph.endpoint,
        "client": graph.endpoint,
        "action": graph.endpoint,
        "turtle": graph.turtle,
        "moved": motions.moved,
    }


def with_expectations(check: Check, assignment: Assignment) -> Check:
    """Return the check with a measure for each item that expects something."""
    own = {item.measure: MEASURE for item in assignment.items if item.expect}
    return replace(check, measures={**check.measures, **own}) if own else check


def expected_measures(assignment: Assignment, run: Run) -> Measures:
    """Return how much is met of what each item expects."""
    items = [item for item in assignment.items if item.expect]
    if not items:
        return {}
    from grader.checks.expectations.verdict import Evidence

    evidence = Evidence(assignment, run)
    targets = {step.id: step.target for step in assignment.steps}
    return {
        item.measure: _measure(item, [_judges()[one.kind](one, evidence) for one in item.expect], targets)
        for item in items
    }


def with_expected_mistakes(
    mistakes: Sequence[Mistake], assignment: Assignment, run: Run, measures: Measures
) -> tuple[Mistake, ...]:
    """Return the mistakes of the check, and why items do not have what they expect.

    What spoils everything comes first. A reason that several items have is told once.
    """
    reasons = dict[str, Mistake]()
    for item, verdicts in _judged(assignment, measures):
        for one, verdict in zip(item.expect, verdicts, strict=True):
            found = None if verdict.share >= 1.0 or one.secret else verdict.why()
            if found is not None:
                before = reasons.get(found.code)
                spoilt = (*(before.measures if before else ()), item.measure)
                reasons[found.code] = replace(before or found, measures=spoilt)
    if run.outcome.status not in (RunStatus.INTERRUPTED, RunStatus.FINISHED):
        return (*mistakes, *reasons.values())
    return (*_whole(mistakes), *reasons.values(), *_parts(mistakes))


def _judged(assignment: Assignment, measures: Measures) -> "Iterator[tuple[ItemSpec, Sequence[Verdict]]]":
    for item in assignment.items:
        if item.expect and item.measure in measures:
            yield item, cast("Sequence[Verdict]", measures[item.measure].details["verdicts"])


def _whole(mistakes: Sequence[Mistake]) -> list[Mistake]:
    """Return the mistakes that spoil everything: they come before what follows from them."""
    return [mistake for mistake in mistakes if not mistake.measures]


def _parts(mistakes: Sequence[Mistake]) -> list[Mistake]:
    return [mistake for mistake in mistakes if mistake.measures]


def unmet(assignment: Assignment, measures: Measures) -> Iterator[str]:
    """Yield the places of the expectations that are not met in full, such as ``items.2.expect.0``."""
    for item, verdicts in _judged(assignment, measures):
        for k, verdict in enumerate(verdicts):
            if verdict.share < 1.0:
                yield f"items.{assignment.items.index(item)}.expect.{k}"


def _measure(item: ItemSpec, verdicts: "Sequence[Verdict]", targets: Mapping[str, str]) -> Measure:
    share = sum(verdict.share for verdict in verdicts) / len(verdicts)
    met = sum(verdict.share >= 1.0 for verdict in verdicts)
    short = [(one, each) for one, each in zip(item.expect, verdicts, strict=True) if each.share < 1.0]
    told = [(_heading(one, each, targets), each) for one, each in short]
    rows = [say("expected.row_share", row=row, share=number(100.0 * each.share, "%")) for row, each in told]
    more = [say("expected.more", count=len(rows) - _MOST_ROWS)] if len(rows) > _MOST_ROWS else []
    listed = join([*rows[:_MOST_ROWS], *more], _ROWS) if rows else EMPTY
    first = told[0][0] if told else EMPTY
    percent = min(100.0, round(100.0 * share, 2))
    details = {"met": met, "count": len(verdicts), "rows": listed, "first": first, "verdicts": verdicts}
    return Measure(percent, details)


def _heading(expectation: Expectation, verdict: "Verdict", targets: Mapping[str, str]) -> Text:
    """Say what was sent, what was wanted and what came, of a step by what it speaks to, not by its id."""
    if expectation.secret:
        return say("expected.row_secret")
    name = expectation.target if len(expectation.target) <= 40 else expectation.target[:39] + "…"
    is_text = expectation.kind == "log"  # then `wanted` has it, as it should read
    what = expectation.kind if is_text else targets.get(expectation.target) or f"{expectation.kind} {name}"
    code = "expected.row_sent" if verdict.sent else "expected.row"
    return say(code, what=what, sent=verdict.sent, wanted=verdict.wanted, came=verdict.came)
