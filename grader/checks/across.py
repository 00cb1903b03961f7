"""What only several runs of one script show: items that are scored by all of them, and mistakes."""

import math
from collections.abc import Sequence
from dataclasses import replace

from grader.checks.measure import UNMEASURED, Check, Findings, Measure, Mistake, mistake
from grader.checks.scoring import band_error, score_items
from grader.contracts.assignment import Across, Assignment, ItemSpec
from grader.contracts.rubric import ItemStatus, RubricItem
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text
from grader.messages import say
from grader.messages.quantity import number_beside


def together_scored(
    check: Check, assignment: Assignment, runs: Sequence[Run], found: Sequence[Findings]
) -> dict[str, RubricItem]:
    """Return the items that are scored across the runs: by the worst run, or by the mean of all runs.

    The items that such an item needs are combined in the same way.
    """
    titles = {case.id: case.title for case in assignment.cases}
    names = [_name(titles.get(run.case, EMPTY), run.case) for run in runs]
    mistakes = tuple(mistake for findings in found for mistake in findings.mistakes)
    items = {}
    for spec in assignment.items:
        if spec.across == "each":
            continue
        combined = {one.measure: _combined(one, spec.across, found) for one in assignment.items}
        combined[spec.measure] = _combined(spec, spec.across, found)
        scored = score_items(check, assignment.items, Findings(combined, mistakes))
        item = next(each for each in scored if each.id == spec.id)
        items[spec.id] = replace(item, message=_run_message(spec, item, check, names, found))
    return items


def _name(title: Text, case_id: str) -> Text:
    return Text(zh=case_id, en=case_id) if title == EMPTY else title


def _combined(spec: ItemSpec, across: Across, found: Sequence[Findings]) -> Measure:
    """Return the measure of an item over all runs; it is unmeasured if one of the runs leaves it unmeasured."""
    measures = [findings.measures.get(spec.measure, UNMEASURED) for findings in found]
    worst = measures[_worst(spec, found)]
    if across == "worst" or not math.isfinite(worst.value):
        return worst
    return Measure(math.fsum(each.value for each in measures) / len(measures), worst.details)


def _worst(spec: ItemSpec, found: Sequence[Findings]) -> int:
    """Return the run that is furthest outside of the item's band, of several the first."""
    errors = [band_error(spec, each.measures.get(spec.measure, UNMEASURED).value) for each in found]
    return errors.index(max(errors))


def _run_message(
    spec: ItemSpec, item: RubricItem, check: Check, names: Sequence[Text], found: Sequence[Findings]
) -> Text:
    """Say which run was the worst, or what was measured on average."""
    if item.status is ItemStatus.NOT_CHECKED:
        return item.message
    if spec.across == "worst" or item.measured is None:
        return say("item.worst", case=names[_worst(spec, found)], seen=item.message)
    value = number_beside(item.measured, check.measures[spec.measure].unit or "1", (spec.low, spec.high))
    return say("item.mean", value=value, count=len(found))


def ignored_input(
    assignment: Assignment,
    runs: Sequence[Run],
    seen: Sequence[Findings],
) -> Mistake | None:
    """Recognise a script that drives the same wrong sides in every run, whatever it is given."""
    given = {case.id: (case.stdin, case.args) for case in assignment.cases}
    if len({given.get(run.case) for run in runs}) < 2 or any(len(each.mistakes) > 1 for each in seen):
        return None
    wrong = [each.mistakes[0] for each in seen if each.mistakes]
    if {each.code for each in wrong} != {"wrong_lengths"}:
        return None
    lengths = {str(each.measures["side_error_pct"].details.get("lengths")) for each in seen}
    if len(lengths) > 1:
        return None
    code = "argument_ignored" if any(args for _, args in given.values()) else "input_ignored"
    shown = seen[0].measures["side_error_pct"].details.get("lengths", "")
    return mistake(code, ("side_error_pct", "gap_pct"), lengths=shown)
