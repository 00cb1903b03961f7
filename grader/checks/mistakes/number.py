"""Mistakes told by the number that should have answered a question."""

from grader.checks.measure import Mistake, mistake
from grader.contracts.assignment import Answer
from grader.contracts.rubric import Unit
from grader.messages.quantity import SpokenQuantity


def number_mistakes(given: SpokenQuantity | None, answer: Answer | None, unit: Unit) -> tuple[Mistake, ...]:
    """Return what is known about a wrong answer.

    Args:
        given: the quantity that was taken for the answer, if there was any number.
        answer: the known answer it is nearest to, if any.
        unit: the one asked for.
    """
    if given is None:
        return (mistake("no_number", unit=unit),)
    if given.unit and given.in_unit(unit) is None:
        return (mistake("other_unit", given=given.unit, unit=unit),)
    if answer is not None and not answer.right:
        return (mistake("known_wrong_answer", ("correct",), remark=answer.remark),)
    return ()
