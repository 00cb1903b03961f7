"""Mistakes told by the number that should have answered a question."""

from grader.checks.measure import Mistake
from grader.checks.spoken_quantity import SpokenQuantity
from grader.contracts.assignment import Answer
from grader.messages import say


def number_mistakes(given: SpokenQuantity | None, answer: Answer | None, unit: str) -> tuple[Mistake, ...]:
    """Return what is known about a wrong answer.

    Args:
        given: the quantity that was taken for the answer, if there was any number.
        answer: the known answer it is nearest to, if any.
        unit: the one asked for.
    """
    if given is None:
        return (_mistake("no_number", unit=unit),)
    if given.unit and given.in_unit(unit) is None:
        return (_mistake("other_unit", given=given.unit, unit=unit),)
    if answer is not None and not answer.right:
        text = say("mistake.known_wrong_answer", remark=answer.remark)
        return (Mistake("known_wrong_answer", text, ("correct",)),)
    return ()


def _mistake(code: str, **values: object) -> Mistake:
    return Mistake(code, say(f"mistake.{code}", **values))
