"""From what a check measured to scored rubric items: credit, dependencies, sentences."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from grader.checks.measure import UNMEASURED, Findings, Kind, Measure, MeasureKind, Mistake, text_id
from grader.checks.rubric_text import wanted
from grader.contracts.assignment import BY_PERSON, Assignment, ItemSpec
from grader.contracts.record import PositionalRecord
from grader.contracts.rubric import ItemStatus, RubricItem
from grader.contracts.text import EMPTY, Text
from grader.messages import enumerated, say
from grader.messages.quantity import number, number_beside

# From half of its points on, an item counts as there for those that need it. A threshold at zero would make the
# last hundredth of a point decide about all the points of the items above.
ENOUGH = 0.5


class Portion(PositionalRecord):
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


def band_error(spec: ItemSpec, value: float) -> float:
    """Return the distance of `value` from the band of full credit; infinite for NaN."""
    if math.isnan(value):
        return math.inf
    below = 0.0 if spec.low is None else spec.low - value
    above = 0.0 if spec.high is None else value - spec.high
    return max(below, above, 0.0)


def fits(assignment: Assignment, measure: str, value: float) -> bool | None:
    """Whether `value` earns full credit; None where no rubric item is on `measure` or the value is unknown."""
    spec = assignment.item_on(measure)
    return None if spec is None or not math.isfinite(value) else band_error(spec, value) <= 0.0


def credit(spec: ItemSpec, value: float) -> float:
    """Return the share of the points in [0, 1]: falls monotonically and smoothly with the error."""
    distance = band_error(spec, value)
    if distance <= 0.0:
        return 1.0
    if not distance < spec.ramp:
        return 0.0
    x = distance / spec.ramp
    return 1.0 - x * x * (3.0 - 2.0 * x)  # flat at both ends: nobody loses much by a hair


def weight(needed: Iterable[float]) -> float:
    """Return how much of an item counts, given the shares of the points that the items it needs earned."""
    return min((1.0, *(share / ENOUGH for share in needed)))


def earned_points(points: float, share: float) -> float:
    """Return the points for a share of them, rounded down to hundredths: only a full share earns all."""
    if share >= 1.0:
        return points
    return min(points, math.floor(points * share * 100.0) / 100.0) if share > 0.0 else 0.0


def score_items(
    check: Kind, specs: Sequence[ItemSpec], findings: Findings, portion: Portion = WHOLE
) -> list[RubricItem]:
    """Score every item on one run.

    Args:
        check: the kind of check that made the findings.
        specs: the rubric.
        findings: what was seen in the run.
        portion: which of several runs it was.
    """
    credits = _credits(specs, findings)
    titles = {spec.id: spec.title for spec in specs}
    scored: list[RubricItem] = []
    shares: dict[str, float] = {}  # earned shares before scaling: what `needs` of other items looks at
    for spec in specs:
        blank = _blank(check, spec, portion.of(spec.points), portion.prefix)
        blockers = [titles[need] for need in spec.needs if shares.get(need, 1.0) <= 0.0]
        if blockers:
            shares[spec.id] = 0.0
            scored.append(replace(blank, message=say("item.not_checked", items=enumerated(blockers))))
        elif spec.measure == BY_PERSON:
            scored.append(replace(blank, status=ItemStatus.NEEDS_MANUAL, message=say("item.by_person")))
        else:
            weak = [need for need in spec.needs if shares.get(need, 1.0) < ENOUGH]
            held = weight(shares[need] for need in weak)
            share = credits[spec.id] * held
            shares[spec.id] = share if earned_points(blank.points, share) > 0.0 else 0.0
            scale = min((credits[other] for other in spec.scaled_by), default=1.0)
            item = _scored(check, spec, blank, findings, min(credits[spec.id], scale) * held)
            if weak:
                item = _lowered(item, "item.in_part", held, [titles[need] for need in weak])
            if scale < credits[spec.id]:
                guilty = [titles[other] for other in spec.scaled_by if credits[other] < credits[spec.id]]
                item = _lowered(item, "item.scaled", scale, guilty)
            scored.append(item)
    return scored


def _credits(specs: Sequence[ItemSpec], findings: Findings) -> dict[str, float]:
    """Return the credit of each item that is measured, as if it stood alone."""
    return {
        spec.id: credit(spec, findings.measures.get(spec.measure, UNMEASURED).value)
        for spec in specs
        if spec.measure != BY_PERSON
    }


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


def _scored(check: Kind, spec: ItemSpec, blank: RubricItem, findings: Findings, share: float) -> RubricItem:
    """Return the item with `share` of its points."""
    measure = findings.measures.get(spec.measure, UNMEASURED)
    earned = earned_points(blank.points, share)
    known = math.isfinite(measure.value)
    return replace(
        blank,
        earned=earned,
        status=item_status(earned, share),
        measured=round(measure.value, 4) + 0.0 if known else None,  # + 0.0: no minus zero
        message=_seen(check, spec, measure),
        hint=EMPTY if credit(spec, measure.value) >= 1.0 else _hint(check, spec, measure, findings.mistakes),
    )


def item_status(earned: float, share: float) -> ItemStatus:
    """Return the state that goes with what an item earned and its share of the points."""
    if share >= 1.0:
        return ItemStatus.PASSED
    return ItemStatus.PARTIAL if earned > 0.0 else ItemStatus.FAILED


def _lowered(item: RubricItem, message: str, share: float, items: Sequence[Text]) -> RubricItem:
    """Add to the item's message that it earns only `share` of its points because of `items`."""
    longer = say(message, seen=item.message, share=number(100.0 * share, "%"), items=enumerated(list(items)))
    return replace(item, message=longer)


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
        why = measure.details.get("why")
        return why if isinstance(why, Text) else say("item.unmeasured")
    if kind.form == "flag":
        answer = "yes" if measure.value >= 1.0 else "no"
        return say(f"{text_id(check, spec.measure)}.{answer}", **measure.details)
    value = number_beside(measure.value, kind.unit, (spec.low, spec.high))
    return say(f"{text_id(check, spec.measure)}.seen", value=value, **measure.details)


def _hint(check: Kind, spec: ItemSpec, measure: Measure, mistakes: Sequence[Mistake]) -> Text:
    for mistake in mistakes:
        if mistake.explains(spec.measure):
            return mistake.text
    if "why" in measure.details:  # unmeasured because of what other items report
        return EMPTY
    return say(f"{text_id(check, spec.measure)}.hint")
