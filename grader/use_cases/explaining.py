"""Explaining the marks of a submission: changes of the student's own text that were tried.

A worker looks for them behind all submissions and keeps them with the grading (`grader.store.explanations`). What
the rules hide from students is left out while it is looked for, so no explanation can give it away.
"""

from grader.contracts.assignment import Hints
from grader.contracts.explanation import Explanation, is_worth_trying
from grader.contracts.identity import Caller
from grader.contracts.judgement import judged
from grader.contracts.report import GradeReport
from grader.contracts.submission import StoredReport, Submission
from grader.render.steps import Step, own_hints, steps, told
from grader.use_cases.services import Services
from grader.use_cases.visibility import hiding, hint_level


def is_explained(services: Services, submission: Submission, grading: StoredReport | None) -> bool:
    """Whether changes are tried for a grading as the caller sees it: marks lack, of the assignment as it is."""
    if grading is None:
        return False
    graded, report = services.submissions.graded_assignment(grading), judged(grading)
    used = {one.id: one.version for one in services.assignments.of(submission.course).all()}
    return used.get(graded.id) == report.assignment_version and is_worth_trying(graded, report)


def found(services: Services, submission: Submission, grading: StoredReport | None) -> Explanation | None:
    """Return the explanation of a grading; nothing where nothing is tried, None while there is none.

    One that was made when other items were hidden than now is none.
    """
    if grading is None or not is_explained(services, submission, grading):
        return Explanation()
    kept = services.explanations.of(submission.id, grading.attempt)
    if kept is not None and frozenset(kept.hidden) == hiding(services, submission).items:
        return kept
    return None


def told_steps(
    services: Services, caller: Caller, submission: Submission, grading: StoredReport | None
) -> tuple[Step, ...] | None:
    """Return what the caller is told, step by step; None while it is looked for, which this begins if need be.

    The teacher's own words go first. Nothing, where nothing was found.
    """
    explanation = found(services, submission, grading)
    if explanation is None and grading is not None:
        services.explanations.ask(submission.id, grading.attempt)
        services.doorbell.ring()
    if explanation is None or grading is None:
        return None
    report, level = judged(grading), level_for(services, caller, submission)
    shown = steps(report, explanation, level)
    own = dict.fromkeys(own_hints(services.submissions.graded_assignment(grading), report).values())
    return (*(Step(fact=hint) for hint in own), *shown) if shown else ()


def told_report(
    services: Services, submission: Submission, grading: StoredReport, level: Hints
) -> GradeReport:
    """Return a report that says what was tried in place of what was guessed, as far as it is there."""
    report = judged(grading)
    own = own_hints(services.submissions.graded_assignment(grading), report)
    return told(report, found(services, submission, grading) or Explanation(), level, own)


def level_for(services: Services, caller: Caller, submission: Submission) -> Hints:
    """Return how much the caller is told of a submission."""
    rules = services.rules.about(submission.course, submission.student, submission.assignment)
    return hint_level(services, caller, submission.assignment, rules)
