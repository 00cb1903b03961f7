"""Short ways to grade a script through the real sandbox, car and checks."""

from dataclasses import replace
from functools import cache
from pathlib import Path

from grader.catalog import Catalog
from grader.contracts.assignment import Limits
from grader.contracts.grading import Grader, GradingJob
from grader.contracts.report import GradeReport

LESSON = Path(__file__).resolve().parents[2] / "lesson"


@cache
def catalog() -> Catalog:
    return Catalog()


def grade(
    grader: Grader,
    assignment: str,
    source: str | bytes,
    file_name: str = "script.py",
    limits: Limits | None = None,
) -> GradeReport:
    raw = source.encode() if isinstance(source, str) else source
    task = catalog().get(assignment)
    job = GradingJob(file_name=file_name, source=raw, assignment=replace(task, limits=limits or task.limits))
    return grader.grade(job).report
