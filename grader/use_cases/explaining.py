"""Explaining the marks of a submission: changes of the student's own text that were tried.

A worker looks for them behind all submissions and keeps them with the grading (`grader.store.explanations`). What
the rules hide from students is left out while it is looked for, so no explanation can give it away.
"""

from dataclasses import dataclass

from grader.contracts.assignment import Assignment
from grader.contracts.explanation import Explanation, is_worth_trying
from grader.contracts.identity import Caller
from grader.contracts.judgement import judged
from grader.contracts.report import GradeReport
from grader.contracts.submission import StoredReport, Submission
from grader.render.steps import HintStep, own_hints, steps, told
from grader.store.rules import CourseRules
from grader.use_cases.services import Services
from grader.use_cases.visibility import hint_level


@dataclass(frozen=True, slots=True, kw_only=True)
class Told:
    """What a caller is told of a grading.

    Attributes:
        report: says what was tried in place of what was guessed, as far as it is there.
        steps: what was tried, step by step. own: what the teacher says, which goes before.
        looking: whether changes are still to be tried.
    """

    report: GradeReport
    steps: tuple[HintStep, ...] = ()
    own: tuple[HintStep, ...] = ()
    looking: bool = False


def _is_explained(services: Services, submission: Submission, grading: StoredReport | None) -> bool:
    """Whether changes are tried for a grading as the caller sees it: marks lack, of the assignment as it is."""
    if grading is None or (assignment := _published(services, submission)) is None:
        return False
    report = judged(grading)
    return report.assignment_version == assignment.version and is_worth_trying(assignment, report)


def found(
    services: Services, submission: Submission, grading: StoredReport, rules: CourseRules
) -> Explanation | None:
    """Return the explanation of a grading; nothing where nothing is tried, None while there is none.

    One that was made when other items were hidden than now is none.
    """
    if not _is_explained(services, submission, grading):
        return Explanation()
    kept = services.explanations.of(submission.id, grading.attempt)
    hidden = rules.of(submission.assignment).hidden_at(services.clock())
    return kept if kept is not None and frozenset(kept.hidden) == hidden else None


def told_steps(
    services: Services, caller: Caller, submission: Submission, grading: StoredReport | None
) -> tuple[HintStep, ...] | None:
    """Return what the caller is told, step by step; None while it is looked for, which this begins if need be.

    The teacher's own words go first. Nothing, where nothing was found.
    """
    if grading is None:
        return ()
    rules = services.rules.about(submission.course, submission.student, submission.assignment)
    seen = told_of(services, caller, submission, grading, rules)
    if seen.looking:
        services.explanations.ask(submission.id, grading.attempt)
        services.doorbell.ring()
        return None
    return (*seen.own, *seen.steps) if seen.steps else ()


def told_of(
    services: Services, caller: Caller, submission: Submission, grading: StoredReport, rules: CourseRules
) -> Told:
    """Return what the caller is told of a grading so far; nobody is asked to look."""
    report, assignment = judged(grading), _published(services, submission)
    if assignment is None:
        return Told(report=report)
    level = hint_level(services, caller, assignment.id, rules)
    tried = found(services, submission, grading, rules)
    explanation = tried or Explanation()
    own = own_hints(assignment, report)
    return Told(
        report=told(report, explanation, level, own),
        steps=steps(report, explanation, level),
        own=tuple(HintStep(fact=hint) for hint in dict.fromkeys(own.values())),
        looking=tried is None,
    )


def _published(services: Services, submission: Submission) -> Assignment | None:
    assignments = services.assignments.of(submission.course).all()
    return next((other for other in assignments if other.id == submission.assignment), None)
