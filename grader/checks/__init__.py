"""Checks: pure functions from what happened to scored rubric items.

Grading calls `mark` and, when the points are final, `explained`; of a text `evaluate_text`. `published_rubric`
returns what a student reads beforehand, `sketch` what a plot should show, and `problems` what is wrong with an
assignment's use of its check.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import groupby

from grader.checks.expectations import expected_measures, with_expectations, with_expected_mistakes
from grader.checks.expectations import unmet as unmet_in
from grader.checks.fit import misfits
from grader.checks.kinds import CHECKS, KINDS, OLDER_NAMES, TEXT_CHECKS
from grader.checks.measure import Check, Findings, Kind, Measures, first_causes
from grader.checks.package import package_measures, with_package, with_package_mistakes
from grader.checks.scoring import (
    WHOLE,
    Portion,
    ignored_input,
    published,
    score_items,
    together_hinted,
    together_scored,
    with_hints,
)
from grader.checks.summary import first_step, is_wanting, summarise, summarise_text
from grader.checks.surroundings import solids_of
from grader.contracts.assignment import Assignment
from grader.contracts.errors import AssignmentError
from grader.contracts.figure import FigureSketch
from grader.contracts.notation import significant
from grader.contracts.record import Record
from grader.contracts.rubric import ItemStatus, PublishedRubric, RubricItem, summed
from grader.contracts.scoring import Run, Scoring
from grader.contracts.text import EMPTY, Text


class Marks(Record):
    """The points of one submission, final before anything is explained.

    Attributes:
        runs: what was scored. as_commanded: their motions are those of the commands, each obeyed at once.
        measures: of each run. scored: the items of each run. together: those that are scored across the runs.
    """

    runs: tuple[Run, ...]
    measures: tuple[Measures, ...]
    scored: tuple[tuple[RubricItem, ...], ...]
    together: Mapping[str, RubricItem]
    as_commanded: bool = False

    def items(self, assignment: Assignment) -> tuple[RubricItem, ...]:
        """Return all items in the order of the report."""
        return _in_order(assignment, self.scored, self.together.values())


def mark(assignment: Assignment, runs: Sequence[Run]) -> Marks:
    """Score a submitted script by its runs, one for each case of the assignment.

    Each item's points are divided evenly among the runs; with several runs the items are named
    ``case/item``. Those that are scored across the runs come last, under their own names.

    Where commands came faster than turtlesim takes them, the motions as commanded are scored as well, unless the
    assignment counts what was driven. They count, unless what was driven loses at most a tenth of their points:
    what is wrong both ways gains nothing by being less wrong by chance. It is decided once for all runs, because
    a script drives all of them in one way.

    Deterministic; nothing that a script did makes it raise.

    Raises AssignmentError: the assignment does not fit its check (see `problems`).
    """
    driven = _marks(assignment, runs)
    if assignment.counts == "driven" or all(run.trajectory.commanded is None for run in runs):
        return driven
    obeyed = [replace(run, trajectory=run.trajectory.at_once()) for run in runs]
    commanded = replace(_marks(assignment, obeyed), as_commanded=True)
    return driven if 10.0 * _lost(assignment, driven) <= _lost(assignment, commanded) > 0.0 else commanded


def _lost(assignment: Assignment, marks: Marks) -> float:
    return summed(item.points - item.earned for item in marks.items(assignment))


def _marks(assignment: Assignment, runs: Sequence[Run]) -> Marks:
    check = _script_check(assignment)
    measures = [_measured(check, assignment.in_case(run.case), run) for run in runs]
    portions = [
        Portion(f"{run.case}/", part, len(runs)) if len(runs) > 1 else WHOLE for part, run in enumerate(runs)
    ]
    scored = [
        tuple(score_items(check, assignment.items, measured, portion))
        for measured, portion in zip(measures, portions, strict=True)
    ]
    together = together_scored(check, assignment, runs, measures) if len(runs) > 1 else {}
    return Marks(runs=tuple(runs), measures=tuple(measures), scored=tuple(scored), together=together)


def _measured(check: Check, case: Assignment, run: Run) -> Measures:
    """Return measures as they are scored and shown: without the last digits of a computation."""
    measures = {**check.measure(case, run), **expected_measures(case, run), **package_measures(run)}
    return {
        name: replace(one, value=significant(one.value), share=significant(one.share))
        for name, one in measures.items()
    }


def unmet(assignment: Assignment, marks: Marks) -> tuple[str, ...]:
    """Return the places of the expectations that a script does not meet, such as ``items.2.expect.0``."""
    found = (place for measures in marks.measures for place in unmet_in(assignment, measures))
    return tuple(dict.fromkeys(found))


def unexplained(assignment: Assignment, marks: Marks) -> Scoring:
    """Return marks with nothing said of their causes."""
    return summarise(marks.items(assignment), [], [run.outcome for run in marks.runs])


def explained(assignment: Assignment, marks: Marks) -> Scoring:
    """Return the same marks with what probably caused them, and what to do."""
    bare, runs = unexplained(assignment, marks), marks.runs
    if bare.items and not is_wanting(bare.items, [run.outcome for run in runs]):
        return bare
    check = _script_check(assignment)
    found = [
        _findings(check, assignment, run, measures)
        for run, measures in zip(runs, marks.measures, strict=True)
    ]
    scored = [
        with_hints(check, assignment.items, items, findings.measures, findings.mistakes)
        for items, findings in zip(marks.scored, found, strict=True)
    ]
    everything = [mistake for findings in found for mistake in findings.mistakes]
    together = together_hinted(check, assignment, marks.together, marks.measures, everything)
    seen = [
        _without_harmless(findings, assignment, items, marks.together)
        for findings, items in zip(found, marks.scored, strict=True)
    ]
    if (ignored := ignored_input(assignment, runs, seen)) is not None:
        seen[0] = replace(seen[0], mistakes=(ignored, *seen[0].mistakes))
    whole = summarise(_in_order(assignment, scored, together), seen, [run.outcome for run in runs])
    own = {item.hint for item in assignment.items if item.hint != EMPTY}
    first = next(
        (item.hint for item in whole.items if item.hint in own and item.status is not ItemStatus.NOT_CHECKED),
        None,
    )
    if first is not None:
        return replace(whole, hint=first)  # the teacher's own words go first
    if whole.mistakes:
        return whole
    kind = CHECKS[_kind_name(assignment)]
    measures = {item.id: item.measure for item in assignment.items if item.measure in kind.measures}
    step = first_step(whole.items, measures)
    return whole if step == EMPTY else replace(whole, hint=step)


def evaluate(assignment: Assignment, runs: Sequence[Run]) -> Scoring:
    """Score a submitted script by its runs, and explain the score.

    Raises AssignmentError: as `mark`.
    """
    return explained(assignment, mark(assignment, runs))


def _findings(check: Check, assignment: Assignment, run: Run, measures: Measures) -> Findings:
    case = assignment.in_case(run.case)
    own = check.explain(case, run, measures)
    findings = Findings(measures, with_expected_mistakes(own, case, run, measures))
    return replace(findings, mistakes=with_package_mistakes(check, findings.mistakes, run))


def _in_order(
    assignment: Assignment, scored: Iterable[Sequence[RubricItem]], together: Iterable[RubricItem]
) -> tuple[RubricItem, ...]:
    """Return the items of each run, then those that are scored across the runs."""
    last = list(together)
    across = {item.id for item in last}
    apart = (
        item
        for items in scored
        for spec, item in zip(assignment.items, items, strict=True)
        if spec.id not in across
    )
    return (*apart, *last)


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
    costly = [
        mistake for mistake in findings.mistakes if not mistake.measures or lost & set(mistake.measures)
    ]
    return replace(findings, mistakes=first_causes(costly))


def evaluate_text(assignment: Assignment, text: str) -> Scoring:
    """Score a submitted text. Deterministic; no text makes it raise.

    Raises AssignmentError: the assignment does not fit its check, or asks for a script.
    """
    _raise_problem(assignment)
    check = TEXT_CHECKS.get(assignment.check)
    if check is None:
        raise AssignmentError(f"{assignment.id}: check: {assignment.check!r} scores scripts, not texts")
    findings = check.examine(assignment, text)
    items = score_items(check, assignment.items, findings.measures)
    hinted = with_hints(check, assignment.items, items, findings.measures, findings.mistakes)
    return summarise_text(hinted, findings)


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return what a plot of `run` shows beside the bare path.

    Raises AssignmentError: the assignment does not fit its check.
    """
    task = assignment.in_case(run.case)
    drawn = _script_check(assignment).sketch(task, run)
    if (commanded := run.trajectory.commanded) is not None:
        points = zip(commanded.x_m.round(3).tolist(), commanded.y_m.round(3).tolist(), strict=True)
        drawn = replace(drawn, commanded_m=tuple(point for point, _ in groupby(points)))
    return drawn if task.world.room is None else replace(drawn, solids=solids_of(task.world.room))


def published_rubric(assignment: Assignment) -> PublishedRubric:
    """Return the rubric that a student reads before submitting.

    Raises AssignmentError: the assignment does not fit its check.
    """
    _raise_problem(assignment)
    return published(_kind(assignment), assignment)


def problems(assignment: Assignment) -> tuple[tuple[str, Text], ...]:
    """Return (field, problem) for all that does not fit the assignment's check; empty when it fits."""
    if _kind_name(assignment) not in KINDS:
        name, known = repr(assignment.check), ", ".join(KINDS)
        told = Text(zh=f"没有 {name} 这种检查，可用：{known}", en=f"unknown check {name}; use one of {known}")
        return (("check", told),)
    return tuple(dict.fromkeys(misfits(assignment, _kind(assignment))))  # the same may be wrong in each case


def _script_check(assignment: Assignment) -> Check:
    _raise_problem(assignment)
    if _kind_name(assignment) not in CHECKS:
        raise AssignmentError(f"{assignment.id}: check: {assignment.check!r} scores texts, not scripts")
    return with_expectations(with_package(CHECKS[_kind_name(assignment)], assignment), assignment)


def _kind(assignment: Assignment) -> Kind:
    check = KINDS[_kind_name(assignment)]
    if not isinstance(check, Check):
        return check
    return with_expectations(with_package(check, assignment), assignment)


def _kind_name(assignment: Assignment) -> str:
    return OLDER_NAMES.get(assignment.check, assignment.check)


def _raise_problem(assignment: Assignment) -> None:
    for field, problem in problems(assignment):
        raise AssignmentError.about(f"{assignment.id}: {field}", problem)
