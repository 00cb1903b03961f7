"""The rubric: what each item wants, and what it earns by what a check measured, in one run or across several."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache

from grader.checks.measure import (
    UNMEASURED,
    Check,
    Findings,
    Kind,
    Measure,
    MeasureKind,
    Measures,
    Mistake,
    mistake,
    text_id,
)
from grader.contracts.assignment import BY_PERSON, Across, Assignment, ItemSpec
from grader.contracts.notation import significant
from grader.contracts.record import Record
from grader.contracts.rubric import ItemStatus, PublishedItem, PublishedRubric, RubricItem, Unit
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text
from grader.messages import enumerated, join, say
from grader.messages.quantity import number, number_beside

_SPACE = Text(zh="", en=" ")

_MOST_DECIMALS = 4
_UNMEASURED_STATES = (ItemStatus.NOT_CHECKED, ItemStatus.NEEDS_MANUAL)

# From half of its points on, an item counts as there for those that need it. A threshold at zero would make the
# last hundredth of a point decide about all the points of the items above.
ENOUGH = 0.5

_TINY_M = 0.5  # of the whole way: sides of a few centimetres are commanded as equally many publishes


def wanted(kind: MeasureKind, spec: ItemSpec) -> Text:
    """Say what earns full credit: ``90° ± 3°``, ``at least 0.5 m``, ``yes``."""
    if spec.measure == BY_PERSON:
        return say("wanted.by_person")
    if spec.expect:
        return say("wanted.expected", count=len(spec.expect))
    return say("word.yes") if kind.form == "flag" else _band(kind, spec.low, spec.high)


@lru_cache(maxsize=256)  # one run after the other wants the same
def _band(kind: MeasureKind, low: float | None, high: float | None) -> Text:
    least, most = _number(low, kind.unit), _number(high, kind.unit)
    if kind.form == "count" and high == 0.0:
        return say("wanted.exactly", value=most)
    if low is None or high is None:
        return say("wanted.at_least", low=least) if low is not None else say("wanted.at_most", high=most)
    if low == high:
        return say("wanted.exactly", value=least)
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    return say("wanted.band", middle=_number(middle, kind.unit), half=_number(half, kind.unit))


def published(check: Kind, assignment: Assignment) -> PublishedRubric:
    """Return the assignment's rubric in both languages."""
    specs = {item.id: item for item in assignment.items}
    return PublishedRubric(
        assignment=assignment.id,
        title=assignment.title,
        brief=assignment.brief,
        horizon_s=assignment.horizon_s,
        max_score=assignment.max_score,
        items=tuple(_item(check, spec, specs) for spec in assignment.items),
        remarks=say(f"{check.kind}.remarks"),
    )


def _item(check: Kind, spec: ItemSpec, specs: Mapping[str, ItemSpec]) -> PublishedItem:
    kind = check.measures.get(spec.measure, MeasureKind())
    by_person = spec.measure == BY_PERSON
    return PublishedItem(
        id=spec.id,
        title=spec.title,
        points=spec.points,
        measure=say("rubric.by_person") if by_person else _measure(check, spec),
        wanted=wanted(kind, spec),
        partial=say("rubric.partial_by_person") if by_person else _partial(kind, spec),
        needs=_needs(spec, specs),
    )


def _measure(check: Kind, spec: ItemSpec) -> Text:
    name = say(f"{text_id(check, spec.measure)}.name")
    return name if spec.across == "each" else say(f"rubric.{spec.across}", measure=name)


def _partial(kind: MeasureKind, spec: ItemSpec) -> Text:
    """Say at which values an item earns nothing, or that it earns all or nothing."""
    if spec.expect:
        return say("rubric.by_share")
    if spec.ramp <= 0.0 or kind.form == "flag":
        return say("rubric.all_or_nothing")
    edges = []
    if spec.low is not None:
        edges.append(say("rubric.zero_below", edge=_number(spec.low - spec.ramp, kind.unit)))
    if spec.high is not None:
        edges.append(say("rubric.zero_above", edge=_number(spec.high + spec.ramp, kind.unit)))
    return say("rubric.partial", edges=join(edges, say("rubric.or")))


def _needs(spec: ItemSpec, specs: Mapping[str, ItemSpec]) -> Text:
    """Say which items an item needs, that it counts in part where they earned little, and which ones lower it.

    An item for a person never counts in part: a person gives its points.
    """
    others = enumerated([specs[other].title for other in spec.scaled_by])
    scaled = say("rubric.scaled", items=others) if spec.scaled_by else EMPTY
    if not spec.needs:
        return scaled
    by_halves = spec.measure != BY_PERSON and any(_earns_parts(specs[need], specs) for need in spec.needs)
    items = enumerated([specs[need].title for need in spec.needs])
    needs = say("rubric.needs_half", items=items) if by_halves else say("rubric.needs", items=items)
    return join([needs, scaled], _SPACE) if spec.scaled_by else needs


def _earns_parts(spec: ItemSpec, specs: Mapping[str, ItemSpec]) -> bool:
    return spec.ramp > 0.0 or any(_earns_parts(specs[need], specs) for need in spec.needs)


def _number(value: float | None, unit: Unit) -> str:
    return "" if value is None else number(value, unit, _MOST_DECIMALS)


class Portion(Record, kw_only=False):
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
    distance = significant(band_error(spec, value))
    if distance <= 0.0:
        return 1.0
    if not distance < spec.ramp:
        return 0.0
    x = distance / spec.ramp
    if spec.expect:
        return 1.0 - x  # a share of what is expected earns that share
    return smoothly(x)


def smoothly(x: float) -> float:
    """Return what is left at a share `x` of the way to nothing: flat at both ends, nobody loses much by a hair."""
    return 1.0 - x * x * (3.0 - 2.0 * x)


def weight(needed: Iterable[float]) -> float:
    """Return how much of an item counts, given the shares of the points that the items it needs earned."""
    return min((1.0, *(share / ENOUGH for share in needed)))


def earned_points(points: float, share: float) -> float:
    """Return the points for a share of them, rounded down to hundredths: only a full share earns all."""
    if share >= 1.0:
        return points
    if not share > 0.0:
        return 0.0
    hundredths = math.floor(significant(points * share * 100.0))
    return max(min(hundredths, math.ceil(points * 100.0) - 1), 0) / 100.0


def score_items(
    check: Kind, specs: Sequence[ItemSpec], measures: Measures, portion: Portion = WHOLE
) -> list[RubricItem]:
    """Score every item on one run; what to do about it is said later (`with_hints`).

    `portion`: which of several runs it was.
    """
    credits = _credits(specs, measures)
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
            weak, held = _weak(spec, shares), _held(spec, shares)
            share = credits[spec.id] * held
            shares[spec.id] = share if earned_points(blank.points, share) > 0.0 else 0.0
            scale = _scale(spec, credits)
            item = _scored(check, spec, blank, measures, min(credits[spec.id], scale) * held)
            if weak:
                item = _lowered(item, "item.in_part", held, [titles[need] for need in weak])
            if scale < credits[spec.id]:
                guilty = [titles[other] for other in spec.scaled_by if credits[other] < credits[spec.id]]
                item = _lowered(item, "item.scaled", scale, guilty)
            scored.append(item)
    return scored


def points_of(specs: Sequence[ItemSpec], measures: Measures) -> float:
    """Return the points that measures of one run earn in all, before each item is rounded."""
    credits = _credits(specs, measures)
    shares: dict[str, float] = {}
    for spec in specs:
        if spec.measure != BY_PERSON:
            shares[spec.id] = credits[spec.id] * _held(spec, shares)
    return math.fsum(
        spec.points * min(shares[spec.id], _scale(spec, credits) * _held(spec, shares))
        for spec in specs
        if spec.id in shares
    )


def earns_all(specs: Sequence[ItemSpec], measures: Measures) -> bool:
    """Whether measures of one run earn all points that a machine gives."""
    credits = _credits(specs, measures)
    return all(credit >= 1.0 for credit in credits.values())


def _held(spec: ItemSpec, shares: Mapping[str, float]) -> float:
    """Return how much of an item counts, given the shares that the items before it earned."""
    return (
        0.0
        if any(shares.get(need, 1.0) <= 0.0 for need in spec.needs)
        else weight(_weak(spec, shares).values())
    )


def _weak(spec: ItemSpec, shares: Mapping[str, float]) -> dict[str, float]:
    """Return the needed items that earned little, with their shares."""
    return {need: shares[need] for need in spec.needs if shares.get(need, 1.0) < ENOUGH}


def _scale(spec: ItemSpec, credits: Mapping[str, float]) -> float:
    """Return the least credit of the items that lower an item."""
    return min((credits[other] for other in spec.scaled_by), default=1.0)


def _credits(specs: Sequence[ItemSpec], measures: Measures) -> dict[str, float]:
    """Return the credit of each item that is measured, as if it stood alone."""
    return {
        spec.id: _measured_credit(spec, measures.get(spec.measure, UNMEASURED))
        for spec in specs
        if spec.measure != BY_PERSON
    }


def _measured_credit(spec: ItemSpec, measure: Measure) -> float:
    return credit(spec, measure.value) * measure.share


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


def _scored(check: Kind, spec: ItemSpec, blank: RubricItem, measures: Measures, share: float) -> RubricItem:
    """Return the item with `share` of its points."""
    measure = measures.get(spec.measure, UNMEASURED)
    earned = earned_points(blank.points, share)
    known = math.isfinite(measure.value)
    return replace(
        blank,
        earned=earned,
        status=item_status(earned, share),
        measured=round(measure.value, 4) + 0.0 if known else None,  # + 0.0: no minus zero
        message=_seen(check, spec, measure),
    )


def with_hints(
    check: Kind,
    specs: Sequence[ItemSpec],
    items: Sequence[RubricItem],
    measures: Measures,
    mistakes: Sequence[Mistake],
) -> list[RubricItem]:
    """Return scored items, one for each of `specs`, with what to do about those that lost points by themselves."""
    hints = [_hint(check, spec, measures.get(spec.measure, UNMEASURED), mistakes) for spec in specs]
    return [
        replace(item, hint=hint) if item.status not in _UNMEASURED_STATES else item
        for item, hint in zip(items, hints, strict=True)
    ]


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
    kind, why = check.measures[spec.measure], measure.details.get("why")
    if not math.isfinite(measure.value):
        return why if isinstance(why, Text) else say("item.unmeasured")
    if measure.share < 1.0:
        seen = _seen(check, spec, replace(measure, share=1.0))
        return say("item.shared", seen=seen, share=number(100.0 * measure.share, "%"), why=why)
    if kind.form == "flag":
        answer = "yes" if measure.value >= 1.0 else "no"
        return say(f"{text_id(check, spec.measure)}.{answer}", **measure.details)
    in_part = kind.form == "count" and not measure.value.is_integer()
    value = number_beside(measure.value, "1" if in_part else kind.unit, (spec.low, spec.high))
    return say(f"{text_id(check, spec.measure)}.seen", value=value, **measure.details)


def _hint(check: Kind, spec: ItemSpec, measure: Measure, mistakes: Sequence[Mistake]) -> Text:
    if spec.measure == BY_PERSON or _measured_credit(spec, measure) >= 1.0:
        return EMPTY
    if spec.hint != EMPTY:
        return spec.hint
    for each in mistakes:
        if each.explains(spec.measure):
            return each.text
    if "why" in measure.details and not math.isfinite(measure.value):  # other items report why
        return EMPTY
    return say(f"{text_id(check, spec.measure)}.hint", **measure.details)


def together_scored(
    check: Check, assignment: Assignment, runs: Sequence[Run], found: Sequence[Measures]
) -> dict[str, RubricItem]:
    """Return the items that are scored across the runs: by the worst run, or by the mean of all runs.

    The items that such an item needs are combined in the same way.
    """
    titles = {case.id: case.title for case in assignment.cases}
    names = [_name(titles.get(run.case, EMPTY), run.case) for run in runs]
    items = {}
    for spec in assignment.items:
        if spec.across == "each":
            continue
        combined = {one.measure: _combined(one, spec.across, found) for one in assignment.items}
        combined[spec.measure] = _combined(spec, spec.across, found)
        scored = score_items(check, assignment.items, combined)
        item = next(each for each in scored if each.id == spec.id)
        items[spec.id] = replace(item, message=_run_message(spec, item, check, names, found))
    return items


def together_hinted(
    check: Check,
    assignment: Assignment,
    items: Mapping[str, RubricItem],
    found: Sequence[Measures],
    mistakes: Sequence[Mistake],
) -> list[RubricItem]:
    """Return the items that are scored across the runs with what to do about those that lost points."""
    specs = [spec for spec in assignment.items if spec.id in items]
    combined = {spec.measure: _combined(spec, spec.across, found) for spec in specs}
    return with_hints(check, specs, [items[spec.id] for spec in specs], combined, mistakes)


def _name(title: Text, case_id: str) -> Text:
    return Text(zh=case_id, en=case_id) if title == EMPTY else title


def _combined(spec: ItemSpec, across: Across, found: Sequence[Measures]) -> Measure:
    """Return the measure of an item over all runs; it is unmeasured if one of the runs leaves it unmeasured."""
    measures = [measures.get(spec.measure, UNMEASURED) for measures in found]
    worst = measures[_worst(spec, found)]
    if across == "worst" or not math.isfinite(worst.value):
        return worst
    return Measure(math.fsum(measure.value for measure in measures) / len(measures), worst.details)


def _worst(spec: ItemSpec, found: Sequence[Measures]) -> int:
    """Return the run that is furthest outside of the item's band, of several the first."""
    errors = [band_error(spec, measures.get(spec.measure, UNMEASURED).value) for measures in found]
    return errors.index(max(errors))


def _run_message(
    spec: ItemSpec, item: RubricItem, check: Check, names: Sequence[Text], found: Sequence[Measures]
) -> Text:
    """Say which run was the worst, or what was measured on average."""
    if item.status is ItemStatus.NOT_CHECKED:
        return item.message
    if spec.across == "worst" or item.measured is None:
        return say("item.worst", case=names[_worst(spec, found)], seen=item.message)
    value = number_beside(item.measured, check.measures[spec.measure].unit or "1", (spec.low, spec.high))
    return say("item.mean", value=value, count=len(found))


def _is_tiny(seen: Findings) -> bool:
    """Whether so little was driven that one length cannot be told from another."""
    return seen.measures["distance_m"].value < _TINY_M


def ignored_input(
    assignment: Assignment,
    runs: Sequence[Run],
    seen: Sequence[Findings],
) -> Mistake | None:
    """Recognise a script that drives the same wrong sides in every run, whatever it is given."""
    given = {case.id: (case.stdin, case.args) for case in assignment.cases}
    sides = [each.measures.get("side_error_pct", UNMEASURED) for each in seen]
    if len({given.get(run.case) for run in runs}) < 2 or any(each.mistakes for each in seen):
        return None
    lengths = {str(side.details.get("lengths")) for side in sides}
    wrong = [fits(assignment, "side_error_pct", side.value) is False for side in sides]
    if len(lengths) > 1 or not any(wrong) or any(map(_is_tiny, seen)):
        return None
    code = "argument_ignored" if any(args for _, args in given.values()) else "input_ignored"
    return mistake(code, ("side_error_pct", "gap_pct"), lengths=sides[0].details["lengths"])
