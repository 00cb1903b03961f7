"""A question that people judge, and its grading as the pipeline makes it for texts."""

import hashlib

from grader.checks import evaluate_text
from grader.contracts.assignment import BY_PERSON, Assignment, ItemSpec
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.report import GradeReport, status_of
from grader.contracts.rubric import score_of, total
from grader.contracts.text import Text
from tests.fakes.grading import MEASUREMENTS

ANSWER = b"A publisher sends messages, a timer calls a function again and again.\n"


def question(version: int = 1, timer_points: float = 45.0) -> Assignment:
    text = Text(zh="问题", en="Question")
    return Assignment(
        id="essay",
        version=version,
        order=9,
        title=text,
        brief=text,
        check="essay",
        input="text",
        items=(
            ItemSpec(id="written", title=text, points=10.0, measure="characters", low=20),
            ItemSpec(id="publisher", title=text, points=45.0, measure=BY_PERSON, needs=("written",)),
            ItemSpec(id="timer", title=text, points=timer_points, measure=BY_PERSON, needs=("written",)),
        ),
    )


def grade_essay(job: GradingJob) -> GradingResult:
    verdict = evaluate_text(job.assignment, job.source.decode())
    report = GradeReport(
        submission_sha256=hashlib.sha256(job.source).hexdigest(),
        assignment=job.assignment.id,
        assignment_version=job.assignment.version,
        grader_version="0.1.0",
        simulator="none",
        seed=0,
        status=status_of(verdict.items, []),
        score=total([score_of(item) for item in verdict.items]),
        max_score=job.assignment.max_score,
        items=verdict.items,
        runs=(),
        summary=verdict.summary,
        hint=verdict.hint,
    )
    return GradingResult(report=report, trajectories={}, measurements=MEASUREMENTS)
