"""Judgements as rows, and what follows from them for the row of a submission."""

from collections.abc import Sequence

from sqlalchemy import select
from sqlmodel import Session, col

from grader.contracts.judgement import Judgement, composed, to_judge
from grader.contracts.report import GradeReport, report_from
from grader.store.tables import GradingRow, JudgementRow, SubmissionRow


def judgements_of(session: Session, submissions: Sequence[str]) -> tuple[Judgement, ...]:
    """Return everything that people decided about submissions, in order of submission, item and revision."""
    row = JudgementRow
    statement = (
        select(row)
        .where(col(row.submission_id).in_(submissions))
        .order_by(col(row.submission_id), col(row.item), col(row.revision))
    )
    return tuple(judgement(one) for one in session.execute(statement).scalars())


def report_of(session: Session, submission: SubmissionRow) -> GradeReport | None:
    """Return the report of a submission's latest grading as the machine made it, or None."""
    if submission.graded_attempt is None:
        return None
    grading = session.get(GradingRow, (submission.id, submission.graded_attempt))
    return None if grading is None else report_from(grading.report)


def settle(session: Session, submission: SubmissionRow) -> GradeReport | None:
    """Put what people judged into the row's score and verdict; return the report with it.

    Called whenever a judgement changes, or the latest grading of a submission that has some.
    """
    report = report_of(session, submission)
    if report is None:
        return None
    whole = composed(report, judgements_of(session, [submission.id]))
    submission.score, submission.verdict = whole.score, whole.status.value
    if submission.to_judge is not None:  # something was left to people, not only corrected by them
        submission.to_judge = to_judge(whole.items)
    session.flush()
    return whole


def judgement(row: JudgementRow) -> Judgement:
    """Return what a row says."""
    return Judgement(
        submission=row.submission_id,
        item=row.item,
        revision=row.revision,
        points=row.points,
        out_of=row.out_of,
        comment=row.comment,
        by=row.judged_by,
        at=row.judged_at,
        attempt=row.attempt,
        source_sha256=row.source_sha256,
    )
