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
    quantities,
)

MEASURES = {"correct": MeasureKind(form="flag"), "with_unit": MeasureKind(form="flag")}
_DECIMALS = 3
_CHOICE = re.compile(
    r"\b(?:or|maybe|perhaps|also|otherwise|alternatively)\b|或|还是|也可能|也许|可能|要么|不然", re.I
)
_LISTED = re.compile(r"[\s,、;/.。]*")
_EACH = re.compile(r"每|各|\b(?:per|each|every)\b", re.I)
_EXPLAINED = re.compile(
    r"\s*(?!\W*(?:or|and|to|或|还是|和|及|到|至)\b|\W*(?:或|还是|和|及|到|至))(?:[=(]|\W*[^\W\d])"
)


def examine(assignment: Assignment, text: str) -> Findings:
    """Compare the given number with the known answers."""
    unit = _unit(assignment)
    given = _answering(assignment, text, unit)
    if given is None:
        return Findings({"correct": UNMEASURED, "with_unit": UNMEASURED}, number_mistakes(None, None, unit))
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
    mistakes = number_mistakes(given, answer, unit)
    named = None if right or given.unit == unit else _known(assignment, given.value)
    if not mistakes and given.unit and named is not None and named.right:
        mistakes = (mistake("right_in_other_unit", given=values["given"], unit=unit),)
    return Findings(measures, mistakes)


def given_answers(text: str, unit: Unit) -> list[SpokenQuantity]:
    """Return the quantities that may answer: the last in a fitting unit and the first, else the last number.

    Some compute and end with the answer, others give it and then say why. The first does not answer where it is
    computed with (``12 s + 6 s``).
    """
    found = list(quantities(text))
    fitting = [answer for answer in found if answer.unit and answer.in_unit(unit) is not None]
    if not fitting:
        return found[-1:]
    return [fitting[-1], *(answer for answer in fitting[:1] if _EXPLAINED.match(answer.behind))]


def guesses(text: str, unit: Unit) -> list[SpokenQuantity]:
    """Return the quantities in a fitting unit between which a text leaves the choice; none, or two and more.

    ``12 s or 9 s``, ``12 s ... it may also be 9 s``, or a bare list: ``9 s, 12 s``. In ``每边 3 秒，12 秒`` the
    first is a part.
    """
    found = list(quantities(text))
    fits = [bool(answer.unit) and answer.in_unit(unit) is not None for answer in found]
    lists = _EACH.search(text) is None
    chosen = [
        {i, i + 1}
        for i, each in enumerate(found[:-1])
        if fits[i]
        and fits[i + 1]
        and (_CHOICE.search(each.behind) or (lists and _LISTED.fullmatch(each.behind)))
    ]
    return [found[i] for i in sorted(set().union(*chosen))]


def _answering(assignment: Assignment, text: str, unit: Unit) -> SpokenQuantity | None:
    """Return what answers: of several guesses a wrong one, else one that is right; None without any number."""
    if (several := guesses(text, unit)) and not all(
        _is_right(assignment, answer, unit) for answer in several
    ):
        return next(answer for answer in several if not _is_right(assignment, answer, unit))
    given = given_answers(text, unit)
    return next(
        (answer for answer in given if _is_right(assignment, answer, unit)), given[0] if given else None
    )


def _is_right(assignment: Assignment, given: SpokenQuantity, unit: Unit) -> bool:
    value = given.in_unit(unit)
    known = None if value is None else _known(assignment, value)
    return known is not None and known.right


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


def number_mistakes(given: SpokenQuantity | None, answer: Answer | None, unit: Unit) -> tuple[Mistake, ...]:
    """Return what is known about a wrong answer.

    Args:
        given: the quantity that was taken for the answer, if there was any number.
        answer: the known answer it is nearest to, if any.
        unit: the one asked for.
    """
    if given is None:
        return (mistake("no_number", unit=unit),)
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
