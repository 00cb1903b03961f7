"""Reports as they were stored, read back with what belongs to them."""

from sqlalchemy import Select, select
from sqlmodel import Session, col

from grader.contracts.submission import StoredReport
from grader.store.judgement_rows import judgements_of
from grader.store.tables import GradingRow, SubmissionRow, TrajectoryRow


def standing_grading(submission_id: str) -> Select[GradingRow]:
    """Select the grading that counts for a submission: one row, or none before it is graded."""
    return (
        select(GradingRow)
        .join(
            SubmissionRow,
            (col(SubmissionRow.id) == col(GradingRow.submission_id))
            & (col(SubmissionRow.graded_attempt) == col(GradingRow.attempt)),
        )
        .where(col(SubmissionRow.id) == submission_id)
    )


def stored_report(session: Session, row: GradingRow, judged: str) -> StoredReport:
    """Return the report of a grading with its cases, and what people judged of the submission `judged`."""
    return StoredReport(
        submission_id=row.submission_id,
        attempt=row.attempt,
        finished_at=row.finished_at,
        content=row.report,
        sha256=row.report_sha256,
        cases=_cases(session, row),
        assignment_sha256=row.assignment_sha256,
        judgements=judgements_of(session, [judged]),
    )


def _cases(session: Session, grading: GradingRow) -> dict[str, str]:
    statement = (
        select(col(TrajectoryRow.case_id), col(TrajectoryRow.sha256))
        .where(
            col(TrajectoryRow.submission_id) == grading.submission_id,
            col(TrajectoryRow.attempt) == grading.attempt,
        )
        .order_by(col(TrajectoryRow.position))
    )
    return {row[0]: row[1] for row in session.execute(statement)}
