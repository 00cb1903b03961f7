"""Checks: pure functions from what happened to judged rubric items.

`evaluate` is the only entry point of grading; `published_rubric` says beforehand what it will look for,
`sketch` what a plot should show, and `problems` what is wrong with an assignment's use of its check.
"""

from collections.abc import Mapping, Sequence

from grader.checks import motion, node, polygon, rotation
from grader.checks.judge import judge
from grader.checks.measure import Check, Findings
from grader.checks.rubric_text import published
from grader.checks.summary import summarise
from grader.contracts.assignment import Assignment
from grader.contracts.errors import AssignmentError
from grader.contracts.figure import FigureSketch
from grader.contracts.rubric import PublishedRubric
from grader.contracts.verdict import Run, Verdict

CHECKS: Mapping[str, Check] = {
    "node": node.CHECK,
    "motion": motion.CHECK,
    "rotation": rotation.CHECK,
    "polygon": polygon.CHECK,
}


def evaluate(assignment: Assignment, runs: Sequence[Run]) -> Verdict:
    """Judge a submission by its runs, one per case of the assignment.

    Each item's points are divided evenly among the runs; with several runs the items are named
    ``case/item``. Deterministic and total: nothing a script did makes it raise.

    Raises:
        AssignmentError: the assignment does not fit its check (see `problems`).
    """
    check = _fitting(assignment)
    seen: list[Findings] = []
    items = []
    for run in runs:
        findings = check.examine(assignment, run)
        prefix = f"{run.case}/" if len(runs) > 1 else ""
        items += judge(check, assignment.items, findings, parts=len(runs), prefix=prefix)
        seen.append(findings)
    return summarise(items, seen, [run.outcome for run in runs])


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return what a plot of `run` shows beside the bare path.

    Raises:
        AssignmentError: the assignment does not fit its check.
    """
    return _fitting(assignment).sketch(assignment, run)


def published_rubric(assignment: Assignment) -> PublishedRubric:
    """Return the rubric that a student reads before submitting.

    Raises:
        AssignmentError: the assignment does not fit its check.
    """
    return published(_fitting(assignment), assignment)


def problems(assignment: Assignment) -> tuple[tuple[str, str], ...]:
    """Return (field, problem) for all that does not fit the assignment's check; empty when it fits."""
    check = CHECKS.get(assignment.check)
    if check is None:
        return (("check", f"unknown check {assignment.check!r}; use one of {', '.join(CHECKS)}"),)
    found = [
        (f"options.{name}", "not an option of this check; remove it")
        for name in assignment.options
        if name not in check.options
    ]
    for name, problem_with in check.options.items():
        if name not in assignment.options:
            found.append((f"options.{name}", f"missing; the check {check.kind!r} needs it"))
        elif (problem := problem_with(assignment.options[name])) is not None:
            found.append((f"options.{name}", problem))
    for i, item in enumerate(assignment.items):
        if item.measure not in check.measures:
            known = ", ".join(check.measures)
            found.append(
                (
                    f"items.{i}.measure",
                    f"{item.measure!r} is no measure of {check.kind!r}; use one of {known}",
                )
            )
    return tuple(found)


def _fitting(assignment: Assignment) -> Check:
    for field, problem in problems(assignment):
        raise AssignmentError(f"{assignment.id}: {field}: {problem}")
    return CHECKS[assignment.check]
