"""What students are told of lost points: what was measured, in which line, and a change that was tried."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from grader.contracts.assignment import Assignment, Hints
from grader.contracts.explanation import ChangedText, Explanation, ProvenChange
from grader.contracts.report import GradeReport
from grader.contracts.rubric import ItemStatus, RubricItem, first_lost
from grader.contracts.text import EMPTY, Text
from grader.messages import say
from grader.messages.quantity import measured

_NOTHING_LOST = (ItemStatus.PASSED, ItemStatus.NEEDS_MANUAL)


@dataclass(frozen=True, slots=True, kw_only=True)
class HintStep:
    """One thing to do; what is not to be told is empty.

    Attributes:
        fact: what was measured. line: where it comes from.
        change: what to write instead, and that it was tried; `lines`: the same as text.
    """

    fact: Text
    line: Text = EMPTY
    change: Text = EMPTY
    lines: tuple[ChangedText, ...] = ()


def steps(report: GradeReport, explanation: Explanation, level: Hints) -> tuple[HintStep, ...]:
    """Return what is told of the changes that were tried, in the order in which they are to be made.

    Where none gains: what the run shows, which names a line.
    """
    items, cause = {item.id: item for item in report.items}, explanation.cause
    if not explanation.changes and cause is not None and level is not Hints.FACT:
        return (HintStep(fact=cause.text),)
    return tuple(_step(change, items, level) for change in explanation.changes)


def _step(change: ProvenChange, items: Mapping[str, RubricItem], level: Hints) -> HintStep:
    gaining = [items[id_] for id_ in change.gains if id_ in items]
    # a teacher may have given the points of others
    lost = [item for item in gaining if item.status not in _NOTHING_LOST]
    step = HintStep(fact=_first_fact(lost or gaining))
    if level is Hints.FACT:
        return step
    step = replace(step, line=_line(change))
    return step if level is Hints.LINE else replace(step, change=change.text, lines=change.lines)


def first_fact(report: GradeReport) -> Text:
    """Return what was measured of the lost points, as the first step says it once changes were tried."""
    return _first_fact([item for item in report.items if item.status not in _NOTHING_LOST])


def _first_fact(items: Sequence[RubricItem]) -> Text:
    """Return the fact of the first one that failed by itself: what comes later may follow from it."""
    first = first_lost(items)
    return EMPTY if first is None else _fact(first)


def _fact(item: RubricItem) -> Text:
    message = item.message
    if message == EMPTY:
        message = Text(zh=measured(item, "zh"), en=measured(item, "en"))
    return say("step.fact", title=item.title, seen=message)


def _line(change: ProvenChange) -> Text:
    first = change.lines[0]
    if first.before is None:
        return say("step.behind_line", line=first.number) if first.number else say("step.at_top")
    return say("step.line", line=first.number, text=first.before.strip())


def own_hints(assignment: Assignment, report: GradeReport) -> dict[str, Text]:
    """Return what the teacher says of the items that were measured and lost points, by their ids in the report."""
    own = {item.id: item.hint for item in assignment.items if item.hint != EMPTY}
    return {
        item.id: hint
        for item in report.items
        if item.status not in (*_NOTHING_LOST, ItemStatus.NOT_CHECKED)
        and (hint := own.get(item.id.rpartition("/")[2])) is not None
    }


def told(report: GradeReport, explanation: Explanation, level: Hints, own: Mapping[str, Text]) -> GradeReport:
    """Return a report whose next steps are the teacher's own, and what was tried or what the run shows.

    Below `Hints.CHANGE` everything else that says what to do is left out.
    """
    explained = steps(report, explanation, level)
    if level is Hints.CHANGE and not explained:
        return report
    gains = {id_ for change in explanation.changes for id_ in change.gains}
    items = tuple(
        replace(item, hint=own.get(item.id, EMPTY)) if level is not Hints.CHANGE or item.id in gains else item
        for item in report.items
    )
    said = dict.fromkeys((*own.values(), *(_next(step) for step in explained)))
    hint = Text(
        zh="\n".join(sentence.zh for sentence in said), en="\n".join(sentence.en for sentence in said)
    )
    if level is not Hints.CHANGE:
        return replace(report, items=items, hint=hint, mistakes=())
    return replace(report, items=items, hint=hint, mistakes=explanation.codes)


def _next(step: HintStep) -> Text:
    """Return a step in one text: a change names its line and what it is about."""
    if step.change != EMPTY:
        return step.change
    if EMPTY in (step.fact, step.line):
        return step.line if step.fact == EMPTY else step.fact
    return Text(zh=f"{step.fact.zh} {step.line.zh}", en=f"{step.fact.en} {step.line.en}")
