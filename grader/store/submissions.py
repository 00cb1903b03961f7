"""Submissions and their gradings, as they are read one by one or in lists."""

from sqlalchemy import Select, and_, bindparam, select
from sqlmodel import Session, col

from grader.contracts.assignment import Assignment, stored_assignment
from grader.contracts.record import from_json
from grader.contracts.report import Measurements
from grader.contracts.submission import (
    StoredReport,
    Submission,
    SubmissionFilter,
)
from grader.store.courses import in_class
from grader.store.database import StorePart
from grader.store.judgements import judgements_of
from grader.store.tables import (
    GradedAssignmentRow,
    GradingRow,
    SourceRow,
    SubmissionRow,
    TrajectoryRow,
    as_contract,
    submission_of,
)

_WITH_GRADING = (
    select(SubmissionRow, GradingRow)
    .outerjoin(
        GradingRow,
        and_(
            col(GradingRow.submission_id) == col(SubmissionRow.id),
            col(GradingRow.attempt) == col(SubmissionRow.graded_attempt),
        ),
    )
    .where(col(SubmissionRow.id) == bindparam("id"), col(SubmissionRow.regrade).is_(None))
)


class Submissions(StorePart):
    """Reads what was handed in and how it was graded; safe to share between threads."""

    def get(self, submission_id: str) -> Submission | None:
        """Return one submission, or None. Trials of a re-grade are not found here, only through the re-grade."""
        with self._database.reading() as session:
            row = _handed_in(session, submission_id)
            return None if row is None else submission_of(row)

    def source(self, submission_id: str) -> bytes | None:
        """Return the uploaded bytes, or None when there is no such submission."""
        statement = (
            select(col(SourceRow.content))
            .join(SubmissionRow, col(SubmissionRow.source_sha256) == col(SourceRow.sha256))
            .where(col(SubmissionRow.id) == submission_id)
        )
        with self._database.reading() as session:
            return session.execute(statement).scalar_one_or_none()

    def report(self, submission_id: str) -> StoredReport | None:
        """Return the latest grading of a submission, or None when there is none yet."""
        with self._database.reading() as session:
            return _latest_report(session, submission_id)

    def with_report(self, submission_id: str) -> tuple[Submission, StoredReport | None] | None:
        """Return a submission and its latest grading as they are at one instant, or None, as `get` does."""
        with self._database.reading() as session:
            both = session.execute(_WITH_GRADING, {"id": submission_id}).first()
            if both is None:
                return None
            row, grading = both
            stored = None if grading is None else _stored_report(session, grading, submission_id)
            return submission_of(row), stored

    def trajectory(self, report: StoredReport, case_id: str) -> bytes | None:
        """Return the trajectory of one case as gzip of its JSON, or None."""
        with self._database.reading() as session:
            row = session.get(TrajectoryRow, (report.submission_id, report.attempt, case_id))
            return None if row is None else row.content

    def graded_assignment(self, report: StoredReport) -> Assignment:
        """Return the assignment as it was when `report` was made."""
        with self._database.reading() as session:
            row = session.get_one(GradedAssignmentRow, report.assignment_sha256)
            return stored_assignment(row.content)

    def grading(self, submission_id: str, attempt: int) -> StoredReport | None:
        """Return the grading that `attempt` made of a submission, or None."""
        with self._database.reading() as session:
            row = session.get(GradingRow, (submission_id, attempt))
            return None if row is None else _stored_report(session, row, submission_id)

    def around_regrade(
        self, regrade_id: str, submission_id: str
    ) -> tuple[StoredReport | None, StoredReport | None]:
        """Return a submission's grading before a re-grade and the one the re-grade made.

        While the re-grade is open the latter is its trial's; once applied, the one that was taken over; None
        when there is none (not made yet, failed, or discarded). Judgements by people are the submission's.
        """
        with self._database.reading() as session:
            of_submission = select(GradingRow).where(col(GradingRow.submission_id) == submission_id)
            of_regrade = of_submission.where(col(GradingRow.regrade) == regrade_id)
            applied = session.execute(of_regrade).scalar_one_or_none()
            if applied is not None:
                # where it replaced none, this selects none
                replaced = of_submission.where(col(GradingRow.attempt) == applied.replaced)
                before = _report_of(session, replaced, submission_id)
                return before, _stored_report(session, applied, submission_id)
            trial = (
                select(GradingRow)
                .join(SubmissionRow, col(SubmissionRow.id) == col(GradingRow.submission_id))
                .where(
                    col(SubmissionRow.regrade) == regrade_id,
                    col(SubmissionRow.original) == submission_id,
                    col(SubmissionRow.graded_attempt) == col(GradingRow.attempt),
                )
            )
            before = _latest_report(session, submission_id)
            return before, _report_of(session, trial, submission_id)

    def measurements(self, stored: StoredReport) -> Measurements | None:
        """Return the measurements of a grading, which its report does not contain; None if it is not stored."""
        row = self._get(GradingRow, (stored.submission_id, stored.attempt))
        return None if row is None else from_json(Measurements, row.measurements)

    def of_student(
        self, student: str, assignment: str | None = None, course: str | None = None
    ) -> tuple[Submission, ...]:
        """Return a student's submissions, newest first; only those to `assignment` when it is given."""
        own = (col(SubmissionRow.student) == student, col(SubmissionRow.course) == course)
        statement = select(SubmissionRow).where(*own)
        if assignment is not None:
            statement = statement.where(col(SubmissionRow.assignment) == assignment)
        newest_first = statement.order_by(col(SubmissionRow.received_at).desc(), col(SubmissionRow.id).desc())
        return tuple(submission_of(row) for row in self._scalars(newest_first))

    def students_of_upload(self, team_upload: str) -> tuple[str, ...]:
        """Return who has a submission of one upload of a team, in order."""
        row = SubmissionRow
        students = select(col(row.student)).where(col(row.team_upload) == team_upload)
        return tuple(self._scalars(students.order_by(col(row.student))))

    def of_class(
        self,
        course: str | None,
        wanted: SubmissionFilter,
        limit: int,
        students: frozenset[str] | None = None,
    ) -> tuple[Submission, ...]:
        """Return at most `limit` submissions of a class, or of some of it, in the order of their storing."""
        statement = select(SubmissionRow).where(
            in_class(course, students), col(SubmissionRow.regrade).is_(None)
        )
        equal = (
            (SubmissionRow.student, wanted.student),
            (SubmissionRow.assignment, wanted.assignment),
            (SubmissionRow.state, wanted.state),
        )
        for column, value in equal:
            if value is not None:
                statement = statement.where(col(column) == value)
        if wanted.since is not None:
            statement = statement.where(col(SubmissionRow.received_at) >= wanted.since)
        if wanted.after is not None:
            statement = statement.where(col(SubmissionRow.id) > wanted.after)
        with self._database.reading() as session:
            rows = session.execute(statement.order_by(col(SubmissionRow.id)).limit(limit)).scalars()
            return tuple(submission_of(row) for row in rows)

    def in_order(self, course: str, after: str | None, limit: int) -> tuple[Submission, ...]:
        """Return at most `limit` submissions of a course, of everybody, stored after the one of the id `after`."""
        row = SubmissionRow
        statement = select(row).where(col(row.course) == course, col(row.regrade).is_(None))
        if after is not None:
            statement = statement.where(col(row.id) > after)
        with self._database.reading() as session:
            rows = session.execute(statement.order_by(col(row.id)).limit(limit)).scalars()
            return tuple(submission_of(submission) for submission in rows)

    def neighbour(
        self, submission: Submission, students: frozenset[str] | None = None, *, after: bool
    ) -> Submission | None:
        """Return the newest submission to the same assignment by the class's next student, in order of id.

        `students`: only of these. `after` False: of the student before instead.
        """
        student, received_at = col(SubmissionRow.student), col(SubmissionRow.received_at)
        towards = student > submission.student if after else student < submission.student
        nearest = (
            select(SubmissionRow)
            .where(in_class(submission.course, students), col(SubmissionRow.regrade).is_(None))
            .where(col(SubmissionRow.assignment) == submission.assignment, towards)
            .order_by(student if after else student.desc(), received_at.desc(), col(SubmissionRow.id).desc())
            .limit(1)
        )
        with self._database.reading() as session:
            row = session.execute(nearest).scalar_one_or_none()
            return None if row is None else submission_of(row)


def _handed_in(session: Session, submission_id: str) -> SubmissionRow | None:
    row = session.get(SubmissionRow, submission_id)
    return None if row is None or row.regrade is not None else row


def _latest_report(session: Session, submission_id: str) -> StoredReport | None:
    """Return the grading that counts for a submission; None before it is graded."""
    row = SubmissionRow
    standing = (col(row.id) == col(GradingRow.submission_id)) & (
        col(row.graded_attempt) == col(GradingRow.attempt)
    )
    grading = select(GradingRow).join(row, standing).where(col(row.id) == submission_id)
    return _report_of(session, grading, submission_id)


def _stored_report(session: Session, row: GradingRow, judged: str) -> StoredReport:
    """Return the report of a grading with its cases, and what people judged of the submission `judged`."""
    return as_contract(
        row,
        StoredReport,
        content=row.report,
        sha256=row.report_sha256,
        cases=_cases(session, row),
        judgements=judgements_of(session, [judged]),
    )


def _report_of(session: Session, grading: Select[GradingRow], judged: str) -> StoredReport | None:
    """Return as `_stored_report` does the one grading that a query selects; None if it selects none."""
    row = session.execute(grading).scalar_one_or_none()
    return None if row is None else _stored_report(session, row, judged)


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
