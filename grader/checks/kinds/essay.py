"""Check ``essay``: a free text that a person judges; only its length is looked at here."""

from grader.checks.measure import Findings, Measure, MeasureKind, TextCheck
from grader.contracts.assignment import Assignment

MEASURES = {"characters": MeasureKind(form="count")}


def examine(assignment: Assignment, text: str) -> Findings:
    """Count the characters that are neither space nor punctuation."""
    return Findings({"characters": Measure(float(sum(character.isalnum() for character in text)))})


CHECK = TextCheck(kind="essay", measures=MEASURES, examine=examine)
