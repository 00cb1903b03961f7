"""Explaining the marks of a submission: changes of the student's own text that were tried.

A worker looks for them behind all submissions and keeps them with the grading (`grader.store.explanations`). What
the rules hide from students is left out while it is looked for, so no explanation can give it away.
"""

from grader.contracts.explanation import Explanation, is_worth_trying
from grader.contracts.judgement import judged
from grader.contracts.submission import StoredReport, Submission
from grader.use_cases.services import Services
from grader.use_cases.visibility import hiding


def is_explained(services: Services, submission: Submission, grading: StoredReport | None) -> bool:
    """Whether changes are tried for a grading as the caller sees it: marks lack, of the assignment as it is."""
    if grading is None:
        return False
    graded, report = services.submissions.graded_assignment(grading), judged(grading)
    used = {one.id: one.version for one in services.assignments.of(submission.course).all()}
    return used.get(graded.id) == report.assignment_version and is_worth_trying(graded, report)


def explanation(
    services: Services, submission: Submission, grading: StoredReport | None
) -> Explanation | None:
    """Return what was found; nothing where nothing is tried, None while it is looked for.

    One that was made when other items were hidden is thrown away.
    """
    if grading is None or not is_explained(services, submission, grading):
        return Explanation()
    found = services.explanations.of(submission.id, grading.attempt)
    if found is not None and frozenset(found.hidden) == hiding(services, submission).items:
        return found
    services.explanations.ask(submission.id, grading.attempt)
    services.doorbell.ring()
    return None
