"""The rubric as a student reads it before submitting, from the same data that is scored by."""

from collections.abc import Mapping

from grader.checks.measure import Kind, MeasureKind, text_id
from grader.contracts.assignment import BY_PERSON, Assignment, ItemSpec
from grader.contracts.rubric import PublishedItem, PublishedRubric, Unit
from grader.contracts.text import EMPTY, Text
from grader.messages import enumerated, join, say
from grader.messages.quantity import number

_SPACE = Text(zh="", en=" ")

_MOST_DECIMALS = 4


def wanted(kind: MeasureKind, spec: ItemSpec) -> Text:
    """Say what earns full credit: ``90° ± 3°``, ``at least 0.5 m``, ``yes``."""
    if spec.measure == BY_PERSON:
        return say("wanted.by_person")
    if kind.form == "flag":
        return say("wanted.yes")
    low, high = _number(spec.low, kind.unit), _number(spec.high, kind.unit)
    if kind.form == "count" and spec.high == 0.0:
        return say("wanted.exactly", value=high)
    if spec.low is None or spec.high is None:
        return say("wanted.at_least", low=low) if spec.low is not None else say("wanted.at_most", high=high)
    if spec.low == spec.high:
        return say("wanted.exactly", value=low)
    middle, half = (spec.low + spec.high) / 2.0, (spec.high - spec.low) / 2.0
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
