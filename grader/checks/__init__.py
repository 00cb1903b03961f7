"""Checks: pure functions from what happened to judged rubric items.

`evaluate` and `evaluate_text` are the only entry points of grading; `published_rubric` says beforehand what
will be looked for, `sketch` what a plot should show, and `problems` what is wrong with an assignment's use of
its check.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from grader.checks import essay, motion, node, number, polygon, rotation, service
from grader.checks.judge import WHOLE, Portion, judge
from grader.checks.measure import Check, Findings, Kind, Options, TextCheck
from grader.checks.rubric_text import published
from grader.checks.summary import summarise, summarise_text
from grader.contracts.assignment import BY_PERSON, Assignment
from grader.contracts.errors import AssignmentError
from grader.contracts.figure import FigureSketch
from grader.contracts.rubric import PublishedRubric
from grader.contracts.verdict import Run, Verdict

CHECKS: Mapping[str, Check] = {
    check.kind: check for check in (node.CHECK, motion.CHECK, rotation.CHECK, polygon.CHECK, service.CHECK)
}
TEXT_CHECKS: Mapping[str, TextCheck] = {check.kind: check for check in (number.CHECK, essay.CHECK)}
KINDS: Mapping[str, Kind] = {**CHECKS, **TEXT_CHECKS}


def evaluate(assignment: Assignment, runs: Sequence[Run]) -> Verdict:
    """Judge a submitted script by its runs, one per case of the assignment.

    Each item's points are divided evenly among the runs; with several runs the items are named
    ``case/item``. Deterministic and total: nothing a script did makes it raise.

    Raises:
        AssignmentError: the assignment does not fit its check (see `problems`).
    """
    check = _script_check(assignment)
    seen: list[Findings] = []
    items = []
    for part, run in enumerate(runs):
        findings = check.examine(_in_case(assignment, run.case), run)
        portion = Portion(f"{run.case}/", part, len(runs)) if len(runs) > 1 else WHOLE
        items += judge(check, assignment.items, findings, portion)
        seen.append(findings)
    return summarise(items, seen, [run.outcome for run in runs])


def evaluate_text(assignment: Assignment, text: str) -> Verdict:
    """Judge a submitted text. Deterministic and total: no text makes it raise.

    Raises:
        AssignmentError: the assignment does not fit its check, or asks for a script.
    """
    _raise_problem(assignment)
    check = TEXT_CHECKS.get(assignment.check)
    if check is None:
        raise AssignmentError(f"{assignment.id}: check: {assignment.check!r} judges scripts, not texts")
    findings = check.examine(assignment, text)
    items = judge(check, assignment.items, findings)
    return summarise_text(items, findings)


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return what a plot of `run` shows beside the bare path.

    Raises:
        AssignmentError: the assignment does not fit its check.
    """
    return _script_check(assignment).sketch(_in_case(assignment, run.case), run)


def published_rubric(assignment: Assignment) -> PublishedRubric:
    """Return the rubric that a student reads before submitting.

    Raises:
        AssignmentError: the assignment does not fit its check.
    """
    _raise_problem(assignment)
    return published(KINDS[assignment.check], assignment)


def problems(assignment: Assignment) -> tuple[tuple[str, str], ...]:
    """Return (field, problem) for all that does not fit the assignment's check; empty when it fits."""
    check = KINDS.get(assignment.check)
    if check is None:
        return (("check", f"unknown check {assignment.check!r}; use one of {', '.join(KINDS)}"),)
    return tuple(_problems(assignment, check))


def _problems(assignment: Assignment, check: Kind) -> Iterator[tuple[str, str]]:
    wanted = "script" if assignment.check in CHECKS else "text"
    if assignment.input != wanted:
        yield "input", f"the check {check.kind!r} judges a {wanted}; write `input: {wanted}`"
    for i, case in enumerate(assignment.cases):
        options = {**assignment.options, **case.options}
        where = "options" if not case.options else f"cases.{i}.options"
        yield from _option_problems(check, options, where)
    for i, item in enumerate(assignment.items):
        if item.measure not in check.measures and item.measure != BY_PERSON:
            known = ", ".join((*check.measures, BY_PERSON))
            yield (
                f"items.{i}.measure",
                f"{item.measure!r} is no measure of {check.kind!r}; use one of {known}",
            )
    if assignment.calls and "offered" not in check.measures:
        yield "calls", f"the check {check.kind!r} calls no services; remove them or use 'service'"
    if assignment.answers and "correct" not in check.measures:
        yield "answers", f"the check {check.kind!r} compares no numbers; remove them or use 'number'"
    yield from check.consult(assignment)


def _option_problems(
    check: Kind, options: Mapping[str, float | int | str | bool], where: str
) -> Iterator[tuple[str, str]]:
    known: Options = {**check.options, **check.optional}
    for name in options:
        if name not in known:
            yield f"{where}.{name}", "not an option of this check; remove it"
    for name, problem_with in known.items():
        if name in options:
            if (problem := problem_with(options[name])) is not None:
                yield f"{where}.{name}", problem
        elif name in check.options:
            yield f"{where}.{name}", f"missing; the check {check.kind!r} needs it"


def _in_case(assignment: Assignment, case_id: str) -> Assignment:
    """Return the assignment with the case's options in the place of its own."""
    options = next((case.options for case in assignment.cases if case.id == case_id), {})
    return replace(assignment, options={**assignment.options, **options}) if options else assignment


def _script_check(assignment: Assignment) -> Check:
    _raise_problem(assignment)
    if assignment.check not in CHECKS:
        raise AssignmentError(f"{assignment.id}: check: {assignment.check!r} judges texts, not scripts")
    return CHECKS[assignment.check]


def _raise_problem(assignment: Assignment) -> None:
    for field, problem in problems(assignment):
        raise AssignmentError(f"{assignment.id}: {field}: {problem}")
