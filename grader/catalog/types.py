"""Whether the types that steps and expectations name exist, and have the fields that are written."""

from collections.abc import Iterator, Mapping
from typing import Any, Final, TypeAlias

from grader.catalog.misfits import no_such_field_of, unknown_type
from grader.contracts.assignment import Assignment
from grader.contracts.conversation import Expectation, Step
from grader.contracts.text import Text

Known: TypeAlias = Mapping[str, Mapping[str, str]]
"""The fields of structures, with their types, by the structures' full names."""

_Misfit: TypeAlias = tuple[str, Text]  # the field it is about, and what is wrong
_SENT: Final = {"publish": "", "call": "_Request", "goal": "_Goal", "serve": "_Response"}
_OF_ENDPOINTS: Final = {
    "topic": "",
    "listener": "",
    "service": "_Request",
    "client": "_Request",
    "action": "_Goal",
}
_CAME: Final = {"answer": "_Response", "served": "_Request", "goal": "_Result"}


def misfits_of_types(
    assignment: Assignment, known: Known, *, may_be_unknown: bool = False
) -> Iterator[_Misfit]:
    """Yield what does not fit the types of an assignment's steps and expectations.

    `may_be_unknown`: a handed-in package may define them.
    """
    for place, told in _misfits(assignment, known):
        if not (may_be_unknown and place.endswith(".type")):
            yield place, told


def _misfits(assignment: Assignment, known: Known) -> Iterator[_Misfit]:
    steps = {step.id: step for step in assignment.steps}
    for i, step in enumerate(assignment.steps):
        yield from _of_step(f"steps.{i}", step, known)
    for i, item in enumerate(assignment.items):
        for k, one in enumerate(item.expect):
            yield from _of_expectation(f"items.{i}.expect.{k}", one, steps, known)


def _of_step(place: str, step: Step, known: Known) -> Iterator[_Misfit]:
    if step.kind not in _SENT:
        return
    fields = known.get(step.type + _SENT[step.kind])
    if fields is None:
        yield f"{place}.type", unknown_type(step.type)
        return
    name = "answer" if step.kind == "serve" else "values"
    yield from _unknown(f"{place}.{name}", step.values, fields, known)
    for i, values in enumerate(step.each):
        yield from _unknown(f"{place}.each.{i}", values, fields, known)


def _of_expectation(
    place: str, one: Expectation, steps: Mapping[str, Step], known: Known
) -> Iterator[_Misfit]:
    if one.kind in _OF_ENDPOINTS and one.type is not None:
        fields = known.get(one.type + _OF_ENDPOINTS[one.kind])
        if fields is None:
            yield f"{place}.type", unknown_type(one.type)
        else:
            yield from _unknown(f"{place}.values", one.values or {}, fields, known)
    if one.kind in _CAME:
        kind, name = steps[one.target].type, "result" if one.kind == "goal" else "values"
        came = known.get(kind + _CAME[one.kind])
        if came is not None:
            yield from _unknown(f"{place}.{name}", one.values or {}, came, known)
        if feedback := known.get(f"{kind}_Feedback"):
            yield from _unknown(f"{place}.feedback", one.feedback or {}, feedback, known)


def _unknown(
    place: str, values: Mapping[str, Any], fields: Mapping[str, str], known: Known
) -> Iterator[_Misfit]:
    """Yield the fields that a message of these fields has not, also those of messages in it."""
    for name, value in values.items():
        if name not in fields:
            yield f"{place}.{name}", no_such_field_of(name, fields)
        elif isinstance(value, Mapping) and fields[name] in known:
            yield from _unknown(f"{place}.{name}", value, known[fields[name]], known)
