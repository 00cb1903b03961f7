"""Explaining the marks of a submission: changes of the student's own text that were tried.

They are looked for when somebody asks, behind all submissions and beside practice runs. Nothing is stored, because
the same script has the same explanation whenever it is asked for. The marks are final long before.
"""

import asyncio
from collections import OrderedDict
from dataclasses import replace
from threading import Lock
from typing import Final

from grader.contracts.errors import GraderError
from grader.contracts.explanation import Explanation, is_worth_trying
from grader.contracts.grading import GradingJob
from grader.contracts.identity import Caller
from grader.contracts.report import report_from
from grader.contracts.submission import StoredReport, Submission
from grader.use_cases.callers import name_of
from grader.use_cases.practising import for_practice
from grader.use_cases.services import Services
from grader.use_cases.visibility import found, hiding

_MOST_KEPT: Final = 500


class _Kept:
    """The latest explanations, in the memory of this process. Thread-safe."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._known: OrderedDict[str, Explanation] = OrderedDict()

    def get(self, key: str) -> Explanation | None:
        with self._lock:
            return self._known.get(key)

    def put(self, key: str, explanation: Explanation) -> None:
        with self._lock:
            self._known[key] = explanation
            while len(self._known) > _MOST_KEPT:
                self._known.popitem(last=False)


_kept = _Kept()


def is_explained(services: Services, submission: Submission, grading: StoredReport | None) -> bool:
    """Whether changes are tried for a grading: marks lack, nothing of it is hidden, and it is of one script."""
    if grading is None or not services.practice.offered or hiding(services, submission).items:
        return False
    return is_worth_trying(report_from(grading.content))


async def explain(services: Services, caller: Caller, submission_id: str) -> Explanation:
    """Return the changes that gain marks; none where nothing is tried, or nothing was found.

    Also none while others wait or the caller has asked for much: nobody needs an explanation to go on.

    Raises:
        RefusedError: the caller may not see the submission.
    """
    submission, grading = await asyncio.to_thread(found, services, caller, submission_id)
    if grading is None or not await asyncio.to_thread(is_explained, services, submission, grading):
        return Explanation()
    if (known := _kept.get(grading.sha256)) is not None:
        return known
    job = await asyncio.to_thread(_job, services, submission, grading)
    if job is None:
        return Explanation()
    try:
        explanation = await _looked_for(services, name_of(caller) or "", job)
    except GraderError:
        return Explanation()
    _kept.put(grading.sha256, explanation)
    return explanation


async def _looked_for(services: Services, owner: str, job: GradingJob) -> Explanation:
    with services.allowances.practice_at_once.one_more(owner):
        services.allowances.practice.take(owner)
        found_later: Explanation = await asyncio.wrap_future(services.practice.run(job, explains=True).answer)
        return found_later


def _job(services: Services, submission: Submission, grading: StoredReport) -> GradingJob | None:
    """Return what was graded, with all its cases and a practice run's limits; None of what is no script."""
    assignment = services.submissions.graded_assignment(grading)
    if assignment.input != "script":
        return None
    limits = for_practice(assignment).limits
    return GradingJob(
        file_name=submission.file_name,
        source=services.submissions.source(submission.id) or b"",
        assignment=replace(assignment, limits=limits),
    )
