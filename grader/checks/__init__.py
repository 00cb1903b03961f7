"""Checks: pure functions from what happened to scored rubric items.

Grading calls `evaluate` or `evaluate_text`. `published_rubric` returns what a student reads beforehand, `sketch`
what a plot should show, and `problems` what is wrong with an assignment's use of its check.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from grader.checks.causes import with_causes
from grader.checks.fit import misfits
from grader.checks.kinds import CHECKS, KINDS, TEXT_CHECKS
from grader.checks.measure import Check, Findings, Kind, first_causes
from grader.checks.package import examined, with_package
from grader.checks.scoring import WHOLE, Portion, ignored_input, published, score_items, together_scored
from grader.checks.summary import summarise, summarise_text
from grader.checks.surroundings import solids_of
from grader.contracts.assignment import Assignment
from grader.contracts.errors import AssignmentError
from grader.contracts.figure import FigureSketch
from grader.contracts.rubric import ItemStatus, PublishedRubric, RubricItem
from grader.contracts.scoring import Run, Scoring
from grader.contracts.text import Text


def evaluate(assignment: Assignment, runs: Sequence[Run]) -> Scoring:
    """Score a submitted script by its runs, one for each case of the assignment.

    Each item's points are divided evenly among the runs; with several runs the items are named
    ``case/item``. Those that are scored across the runs come last, under their own names.
    Deterministic; nothing that a script did makes it raise.

    Raises:
        AssignmentError: the assignment does not fit its check (see `problems`).
    """
    check = _script_check(assignment)
    found, scored = [], []
    for part, run in enumerate(runs):
        case = assignment.in_case(run.case)
        found.append(examined(check, with_causes(case, run, check.examine(case, run)), run))
        portion = Portion(f"{run.case}/", part, len(runs)) if len(runs) > 1 else WHOLE
        scored.append(score_items(check, assignment.items, found[-1], portion))
    together = together_scored(check, assignment, runs, found) if len(runs) > 1 else {}
    seen = [
        _without_harmless(findings, assignment, items, together)
        for findings, items in zip(found, scored, strict=True)
    ]
    if (ignored := ignored_input(assignment, runs, seen)) is not None:
        seen[0] = replace(seen[0], mistakes=(ignored, *seen[0].mistakes))
    apart = [
        item
        for items in scored
        for spec, item in zip(assignment.items, items, strict=True)
        if spec.id not in together
    ]
    return summarise([*apart, *together.values()], seen, [run.outcome for run in runs])


def _without_harmless(
    findings: Findings,
    assignment: Assignment,
    scored: Sequence[RubricItem],
    together: Mapping[str, RubricItem],
) -> Findings:
    """Leave out the mistakes that cost nothing, and those that follow from an earlier one."""
    lost = {
        spec.measure
        for spec, item in zip(assignment.items, scored, strict=True)
        if item.status is not ItemStatus.PASSED
        and together.get(spec.id, item).status is not ItemStatus.PASSED
    }
    costly = [each for each in findings.mistakes if not each.measures or lost & set(each.measures)]
    return replace(findings, mistakes=first_causes(costly))


def evaluate_text(assignment: Assignment, text: str) -> Scoring:
    """Score a submitted text. Deterministic; no text makes it raise.

    Raises:
        AssignmentError: the assignment does not fit its check, or asks for a script.
    """
    _raise_problem(assignment)
    check = TEXT_CHECKS.get(assignment.check)
    if check is None:
        raise AssignmentError(f"{assignment.id}: check: {assignment.check!r} scores scripts, not texts")
    findings = check.examine(assignment, text)
    items = score_items(check, assignment.items, findings)
    return summarise_text(items, findings)


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return what a plot of `run` shows beside the bare path.

    Raises:
        AssignmentError: the assignment does not fit its check.
    """
    task = assignment.in_case(run.case)
    drawn = _script_check(assignment).sketch(task, run)
    return drawn if task.world.room is None else replace(drawn, solids=solids_of(task.world.room))


def published_rubric(assignment: Assignment) -> PublishedRubric:
    """Return the rubric that a student reads before submitting.

    Raises:
        AssignmentError: the assignment does not fit its check.
    """
    _raise_problem(assignment)
    return published(_kind(assignment), assignment)


def problems(assignment: Assignment) -> tuple[tuple[str, Text], ...]:
    """Return (field, problem) for all that does not fit the assignment's check; empty when it fits."""
    if assignment.check not in KINDS:
        name, known = repr(assignment.check), ", ".join(KINDS)
        told = Text(zh=f"没有 {name} 这种检查，可用：{known}", en=f"unknown check {name}; use one of {known}")
        return (("check", told),)
    return tuple(dict.fromkeys(misfits(assignment, _kind(assignment))))  # the same may be wrong in each case


def _script_check(assignment: Assignment) -> Check:
    _raise_problem(assignment)
    if assignment.check not in CHECKS:
        raise AssignmentError(f"{assignment.id}: check: {assignment.check!r} scores texts, not scripts")
    return with_package(CHECKS[assignment.check], assignment)


def _kind(assignment: Assignment) -> Kind:
    check = KINDS[assignment.check]
    return with_package(check, assignment) if isinstance(check, Check) else check


def _raise_problem(assignment: Assignment) -> None:
    for field, problem in problems(assignment):
        raise AssignmentError.about(f"{assignment.id}: {field}", problem)
