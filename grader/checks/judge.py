"""Turn findings into judged rubric items: credit, dependencies, sentences."""

import math
from collections.abc import Sequence
from dataclasses import replace

from grader.checks import credit
from grader.checks.measure import UNMEASURED, Findings, Kind, Measure, MeasureKind, Mistake
from grader.checks.rubric_text import wanted
from grader.contracts.assignment import BY_PERSON, ItemSpec
from grader.contracts.record import positional_record
from grader.contracts.rubric import ItemStatus, RubricItem
from grader.contracts.text import EMPTY, Text
from grader.messages import enumerated, say
from grader.messages.quantity import number, number_beside

_BLOCKING = (ItemStatus.FAILED, ItemStatus.NOT_CHECKED)


@positional_record
class Portion:
    """One of the runs among which each item's points are divided.

    Attributes:
        prefix: put before each item's id (``case/``), or empty.
        part, parts: which of how many runs.
    """

    prefix: str = ""
    part: int = 0
    parts: int = 1

    def of(self, points: float) -> float:
        """Return this run's share of an item's points in whole hundredths; the shares sum up exactly."""
        each, rest = divmod(round(points * 100), self.parts)
        return (each + (self.part < rest)) / 100


WHOLE = Portion()


def judge(
    check: Kind, specs: Sequence[ItemSpec], findings: Findings, portion: Portion = WHOLE
) -> list[RubricItem]:
    """Judge every item on one run.

    Args:
        check: the kind of check that made the findings.
        specs: the rubric.
        findings: what was seen in the run.
        portion: which of several runs it was.
    """
    judged: dict[str, RubricItem] = {}
    shares: dict[str, float] = {}
    for spec in specs:
        blank = _blank(check, spec, portion.of(spec.points), portion.prefix)
        blockers = [judged[need].title for need in spec.needs if judged[need].status in _BLOCKING]
        if blockers:
            message = say("item.not_checked", items=enumerated(blockers))
            judged[spec.id] = replace(blank, message=message)
        elif spec.measure == BY_PERSON:
            judged[spec.id] = replace(blank, status=ItemStatus.NEEDS_MANUAL, message=say("item.by_person"))
        else:
            weak = {need: shares[need] for need in spec.needs if shares.get(need, 1.0) < credit.ENOUGH}
            counted = credit.counted(weak.values())
            judged[spec.id], shares[spec.id] = _judged(check, spec, blank, findings, counted)
            if weak:
                judged[spec.id] = _held_back(judged[spec.id], counted, [judged[need].title for need in weak])
    return list(judged.values())


def _blank(check: Kind, spec: ItemSpec, points: float, prefix: str) -> RubricItem:
    target, tolerance = _target(spec)
    kind = check.measures.get(spec.measure, MeasureKind())  # what a person judges is no measure
    return RubricItem(
        id=prefix + spec.id,
        title=spec.title,
        points=points,
        earned=0.0,
        status=ItemStatus.NOT_CHECKED,
        target=target,
        tolerance=tolerance,
        unit=kind.unit,
        wanted=wanted(kind, spec),
    )


def _judged(
    check: Kind, spec: ItemSpec, blank: RubricItem, findings: Findings, counted: float
) -> tuple[RubricItem, float]:
    """Return the item and its share of the points, when only the share `counted` of it counts."""
    measure = findings.measures.get(spec.measure, UNMEASURED)
    own = credit.share(spec, measure.value)
    part = own * counted
    earned = credit.earned(blank.points, part)
    item = replace(
        blank,
        earned=earned,
        status=credit.status(earned, part),
        measured=round(measure.value, 4) + 0.0
        if math.isfinite(measure.value)
        else None,  # + 0.0: no minus zero
        message=_seen(check, spec, measure),
        hint=EMPTY if own >= 1.0 else _hint(check, spec, findings.mistakes),
    )
    return item, part


def _held_back(item: RubricItem, counted: float, weak: Sequence[Text]) -> RubricItem:
    """Say beside what was seen why the item earns less than that."""
    share = number(100.0 * counted, "%")
    message = say("item.in_part", seen=item.message, share=share, items=enumerated(list(weak)))
    return replace(item, message=message)


def _target(spec: ItemSpec) -> tuple[float | None, float | None]:
    """Return target and tolerance of a band; a band open on one side has only the end that counts."""
    if spec.measure == BY_PERSON:
        return None, None
    if spec.low is not None and spec.high is not None:
        return (spec.low + spec.high) / 2.0, (spec.high - spec.low) / 2.0
    return (spec.low, None) if spec.low is not None else (0.0, spec.high)


def _seen(check: Kind, spec: ItemSpec, measure: Measure) -> Text:
    kind = check.measures[spec.measure]
    if not math.isfinite(measure.value):
        return say("item.unmeasured")
    if kind.form == "flag":
        answer = "yes" if measure.value >= 1.0 else "no"
        return say(f"{check.kind}.{spec.measure}.{answer}", **measure.details)
    value = number_beside(measure.value, kind.unit, (spec.low, spec.high))
    return say(f"{check.kind}.{spec.measure}.seen", value=value, **measure.details)


def _hint(check: Kind, spec: ItemSpec, mistakes: Sequence[Mistake]) -> Text:
    for mistake in mistakes:
        if mistake.explains(spec.measure):
            return mistake.text
    return say(f"{check.kind}.{spec.measure}.hint")
