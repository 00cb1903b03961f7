"""Single gradings of a submission, the standing one or an earlier one or a trial's, as they were stored."""

import json

from sqlalchemy import Select, select
from sqlmodel import Session, col

from grader.contracts.codec import from_plain
from grader.contracts.report import Measurements
from grader.contracts.submission import StoredReport
from grader.store.database import Database
from grader.store.stored_reports import standing_grading, stored_report
from grader.store.tables import GradingRow, SubmissionRow


class PastGradings:
    """Reads gradings one by one; safe to share between threads."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def get(self, submission_id: str, attempt: int) -> StoredReport | None:
        """Return the grading that `attempt` made of a submission, or None."""
        with self._database.reading() as session:
            row = session.get(GradingRow, (submission_id, attempt))
            return None if row is None else stored_report(session, row, submission_id)

    def around(self, regrade_id: str, submission_id: str) -> tuple[StoredReport | None, StoredReport | None]:
        """Return a submission's grading before a re-grade and the one the re-grade made.

        While the re-grade is open the latter is its trial's; once applied, the one that was taken over; None
        when there is none (not made yet, failed, or discarded). Judgements by people are the submission's.
        """
        with self._database.reading() as session:
            applied = session.execute(
                _of(submission_id).where(col(GradingRow.regrade) == regrade_id)
            ).scalar_one_or_none()
            if applied is not None:
                earlier = _of(submission_id).where(col(GradingRow.attempt) < applied.attempt)
                before = _newest(session, earlier, submission_id)
                return before, stored_report(session, applied, submission_id)
            trial = (
                select(GradingRow)
                .join(SubmissionRow, col(SubmissionRow.id) == col(GradingRow.submission_id))
                .where(
                    col(SubmissionRow.regrade) == regrade_id,
                    col(SubmissionRow.original) == submission_id,
                    col(SubmissionRow.graded_attempt) == col(GradingRow.attempt),
                )
            )
            before = _newest(session, standing_grading(submission_id), submission_id)
            return before, _newest(session, trial, submission_id)

    def measurements(self, stored: StoredReport) -> Measurements | None:
        """Return what was measured about a grading beside its report, or None."""
        with self._database.reading() as session:
            row = session.get(GradingRow, (stored.submission_id, stored.attempt))
            return None if row is None else from_plain(Measurements, json.loads(row.measurements))


def _of(submission_id: str) -> Select[GradingRow]:
    return select(GradingRow).where(col(GradingRow.submission_id) == submission_id)


def _newest(session: Session, statement: Select[GradingRow], judged: str) -> StoredReport | None:
    newest = statement.order_by(col(GradingRow.attempt).desc()).limit(1)
    row = session.execute(newest).scalar_one_or_none()
    return None if row is None else stored_report(session, row, judged)
