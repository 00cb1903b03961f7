"""Check ``number``: a question whose answer is a number with a unit."""

import re

from grader.checks.measure import (
    UNMEASURED,
    Findings,
    Measure,
    MeasureKind,
    Mistake,
    Option,
    TextCheck,
    mistake,
    one_of,
)
from grader.contracts.assignment import Answer, Assignment
from grader.contracts.rubric import Unit
from grader.contracts.text import EMPTY, Text
from grader.messages.quantity import (
    ANSWER_UNITS,
    SpokenQuantity,
    is_unit,
    number,
    number_in_words,
    quantities,
)

MEASURES = {"correct": MeasureKind(form="flag"), "with_unit": MeasureKind(form="flag")}
_DECIMALS = 3
_EXPLAINED = re.compile(
    r"\s*(?!\W*(?:or|and|to|或|还是|和|及|到|至)\b|\W*(?:或|还是|和|及|到|至))(?:[=(]|\W*[^\W\d])"
)


def examine(assignment: Assignment, text: str) -> Findings:
    """Compare the given number with the known answers."""
    unit = _unit(assignment)
    given = _answering(assignment, text, unit)
    if given is None:
        return Findings(
            {"correct": UNMEASURED, "with_unit": UNMEASURED}, number_mistakes(text, None, None, unit)
        )
    value = given.in_unit(unit)
    answer = None if value is None else _known(assignment, value)
    right = answer is not None and answer.right
    values = {
        "given": f"{number(given.value, '1', _DECIMALS)} {given.unit or given.foreign}".strip(),
        "remark": EMPTY if answer is None else answer.remark,
    }
    measures = {
        "correct": Measure(1.0 if right else 0.0, values),
        "with_unit": Measure(1.0 if given.unit and value is not None else 0.0, {"unit": unit}),
    }
    mistakes = number_mistakes(text, given, answer, unit)
    named = None if right or given.unit == unit else _known(assignment, given.value)
    if not mistakes and given.unit and named is not None and named.right:
        mistakes = (mistake("right_in_other_unit", given=values["given"], unit=unit),)
    return Findings(measures, mistakes)


def given_answers(text: str, unit: Unit) -> list[SpokenQuantity]:
    """Return the quantities that may answer: the last in a fitting unit and the first, else the last number.

    Some compute and end with the answer, others give it and then say why. The first does not answer where it is
    computed with (``12 s + 6 s``) or one of several (``12 s or 13 s``).
    """
    found = list(quantities(text))
    fitting = [each for each in found if each.unit and each.in_unit(unit) is not None]
    if not fitting:
        return found[-1:]
    return [fitting[-1], *(each for each in fitting[:1] if _EXPLAINED.match(each.behind))]


def _answering(assignment: Assignment, text: str, unit: Unit) -> SpokenQuantity | None:
    """Return the first of these that is right, else the first; None without any number."""
    given = given_answers(text, unit)
    for each in given:
        value = each.in_unit(unit)
        known = None if value is None else _known(assignment, value)
        if known is not None and known.right:
            return each
    return given[0] if given else None


def _unit(assignment: Assignment) -> Unit:
    unit = assignment.options["unit"]
    assert is_unit(unit), unit  # `_problem_with_unit` let no other through
    return unit


def _known(assignment: Assignment, value: float) -> Answer | None:
    """Return the known answer that `value` is within tolerance of; a right one before a wrong one."""
    near = [answer for answer in assignment.answers if abs(value - answer.value) <= answer.tolerance]
    return min(near, key=lambda answer: not answer.right, default=None)


def _problem_with_unit(value: Option) -> Text | None:
    return None if value in ANSWER_UNITS else one_of(ANSWER_UNITS)


def _consult(assignment: Assignment) -> tuple[tuple[str, Text], ...]:
    if any(answer.right for answer in assignment.answers):
        return ()
    told = Text(zh="缺少：至少写一个 `right: true`", en="missing; give at least one with `right: true`")
    return (("answers", told),)


def number_mistakes(
    text: str, given: SpokenQuantity | None, answer: Answer | None, unit: Unit
) -> tuple[Mistake, ...]:
    """Return what is known about a wrong answer.

    Args:
        text: the whole answer.
        given: the quantity that was taken for the answer, if there was any number.
        answer: the known answer it is nearest to, if any.
        unit: the one asked for.
    """
    if given is None:
        if (words := number_in_words(text)) is not None:
            return (mistake("number_in_words", words=words, unit=unit),)
        return (mistake("no_number", unit=unit),)
    if (given.foreign or given.in_unit(unit) is None) and (words := number_in_words(text)) is not None:
        return (mistake("number_in_words", words=words, unit=unit),)
    if given.foreign:
        return (mistake("other_unit", given=given.foreign, unit=unit),)
    if given.unit and given.in_unit(unit) is None:
        return (mistake("other_unit", given=given.unit, unit=unit),)
    if answer is not None and not answer.right:
        return (mistake("known_wrong_answer", ("correct",), remark=answer.remark),)
    return ()


CHECK = TextCheck(
    kind="number",
    measures=MEASURES,
    options={"unit": _problem_with_unit},
    consult=_consult,
    examine=examine,
)
