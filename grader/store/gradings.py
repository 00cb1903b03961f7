"""Finished gradings: written as rows, read back as reports.

Rows are plain values by column, inserted by statements of tables: making an object of each and keeping account of
it would cost more than the database takes to store it.
"""

import gzip
import hashlib
import json
from collections.abc import Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import Connection, Insert, Select, insert, select
from sqlmodel import Session, col

from grader.contracts.assignment import Assignment, Distro
from grader.contracts.grading import GradingResult
from grader.contracts.record import canonical, from_json, to_plain
from grader.contracts.report import Measurements
from grader.contracts.submission import Claim, StoredReport
from grader.store.database import StorePart
from grader.store.judgements import judgements_of
from grader.store.tables import (
    GZIP_LEVEL,
    GradedItemRow,
    GradedMistakeRow,
    GradingRow,
    SubmissionRow,
    TrajectoryRow,
    as_contract,
    table_of,
)

Values = dict[str, Any]
"""One row, by column."""

_GRADINGS, _ITEMS, _MISTAKES, _TRAJECTORIES = (
    insert(table_of(row)) for row in (GradingRow, GradedItemRow, GradedMistakeRow, TrajectoryRow)
)
Details = Sequence[tuple[Insert, list[Values]]]
"""Rows that belong to a grading, with the statement that inserts them."""


def grading_values(
    claim: Claim, result: GradingResult, finished_at: datetime, assignment_sha256: str | None = None
) -> Values:
    """Return the row of the grading itself."""
    report = result.report
    content = result.report_bytes()
    return {
        "submission_id": claim.submission_id,
        "attempt": claim.attempt,
        "worker": claim.worker,
        "finished_at": finished_at,
        "grader_version": report.grader_version,
        "assignment_version": report.assignment_version,
        "verdict": report.status.value,
        "score": report.score,
        "max_score": report.max_score,
        "report_sha256": hashlib.sha256(content).hexdigest(),
        "report": content,
        "assignment_sha256": assignment_sha256,
        "measurements": json.dumps(result.measurements, default=to_plain, sort_keys=True, allow_nan=False),
    }


def assignment_values(assignment: Assignment) -> Values:
    """Return the row of an assignment as it is graded."""
    content = canonical(assignment)
    return {"sha256": hashlib.sha256(content).hexdigest(), "content": content}


class AssignmentRows:
    """Makes rows of assignments. Remembers the latest of each: encoding one takes long."""

    def __init__(self) -> None:
        self._latest: dict[tuple[str, Distro], tuple[Assignment, Values]] = {}

    def of(self, assignment: Assignment) -> Values:
        """Return the row of an assignment as it is graded."""
        key = assignment.id, assignment.release
        known = self._latest.get(key)
        if known is None or known[0] != assignment:
            known = self._latest[key] = (assignment, assignment_values(assignment))
        return known[1]


def detail_values(grading: Values, result: GradingResult) -> Details:
    """Return what belongs to the row `grading`: rubric items, mistakes and trajectories."""
    key = {"submission_id": grading["submission_id"], "attempt": grading["attempt"]}
    return [
        (statement, [key | row for row in rows])
        for statement, rows in (
            (_ITEMS, _items(result)),
            (_MISTAKES, _mistakes(result)),
            (_TRAJECTORIES, _trajectories(result)),
        )
        if rows
    ]


def insert_grading(connection: Connection, grading: Values, details: Details) -> None:
    """Insert the row of a grading and what belongs to it."""
    connection.execute(_GRADINGS, grading)
    for statement, rows in details:
        connection.execute(statement, rows)


def _items(result: GradingResult) -> list[Values]:
    return [
        {"item": item.id, "status": item.status.value, "points": item.points, "earned": item.earned}
        for item in result.report.items
    ]


def _mistakes(result: GradingResult) -> list[Values]:
    codes = dict.fromkeys(result.report.mistakes)
    return [{"code": code, "rank": rank} for rank, code in enumerate(codes)]


def _trajectories(result: GradingResult) -> list[Values]:
    return [
        {
            "case_id": case_id,
            "position": position,
            "sha256": hashlib.sha256(content).hexdigest(),
            "content": gzip.compress(content, GZIP_LEVEL, mtime=0),
        }
        for position, (case_id, content) in enumerate(result.trajectories.items())
    ]


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
    return as_contract(
        row,
        StoredReport,
        content=row.report,
        sha256=row.report_sha256,
        cases=_cases(session, row),
        judgements=judgements_of(session, [judged]),
    )


def report_of(session: Session, grading: Select[GradingRow], judged: str) -> StoredReport | None:
    """Return as `stored_report` does the one grading that a query selects; None if it selects none."""
    row = session.execute(grading).scalar_one_or_none()
    return None if row is None else stored_report(session, row, judged)


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


class PastGradings(StorePart):
    """Reads gradings one by one; safe to share between threads."""

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
            of_submission = select(GradingRow).where(col(GradingRow.submission_id) == submission_id)
            of_regrade = of_submission.where(col(GradingRow.regrade) == regrade_id)
            applied = session.execute(of_regrade).scalar_one_or_none()
            if applied is not None:
                replaced = of_submission.where(
                    col(GradingRow.attempt) == applied.replaced
                )  # None: there is none
                before = report_of(session, replaced, submission_id)
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
            before = report_of(session, standing_grading(submission_id), submission_id)
            return before, report_of(session, trial, submission_id)

    def measurements(self, stored: StoredReport) -> Measurements | None:
        """Return the measurements of a grading, which its report does not contain; None if it is not stored."""
        row = self._get(GradingRow, (stored.submission_id, stored.attempt))
        return None if row is None else from_json(Measurements, row.measurements)
