"""Submissions and their gradings: adding uploads, and reading what became of them."""

import hashlib
import uuid
from datetime import datetime

from sqlalchemy import Select, func, select
from sqlmodel import Session, col

from grader import policy as rules
from grader.contracts.errors import UploadRefusedError
from grader.contracts.policy import Attempt, Refusal
from grader.contracts.report import GradeStatus
from grader.contracts.submission import NewSubmission, StoredReport, Submission, SubmissionState
from grader.store.columns import Clock
from grader.store.database import Database
from grader.store.policies import rules_of
from grader.store.tables import GradingRow, SourceRow, SubmissionRow, TrajectoryRow

_FREE_VERDICTS = (GradeStatus.SYNTAX_ERROR.value, GradeStatus.ASSIGNMENT_ERROR.value)
_OPEN_STATES = (SubmissionState.QUEUED.value, SubmissionState.RUNNING.value)
_UUID_VERSION_7 = 0x7 << 76
_UUID_VARIANT = 0b10 << 62


class Submissions:
    """Uploads and what became of them; safe to share between threads."""

    def __init__(self, database: Database, clock: Clock) -> None:
        self._database = database
        self._clock = clock

    def add(self, upload: NewSubmission) -> Submission:
        """Store an accepted upload and queue it, in one transaction: once this returns, it is not lost.

        Raises:
            UploadRefusedError: the rules of the assignment do not accept it. Uploads at the same moment are
                counted one after the other.
        """
        now = upload.received_at or self._clock()
        row = SubmissionRow(
            id=new_id(now),
            course=upload.course,
            student=upload.student,
            assignment=upload.assignment,
            file_name=upload.file_name,
            source_sha256=hashlib.sha256(upload.source).hexdigest(),
            size_bytes=len(upload.source),
            state=SubmissionState.QUEUED.value,
            received_at=now,
            queued_at=now,
            not_before=now,
        )
        with self._database.writing() as session:
            if upload.ruled and (refusal := _refusal(session, upload, now)) is not None:
                raise UploadRefusedError(refusal)
            if session.get(SourceRow, row.source_sha256) is None:
                session.add(SourceRow(sha256=row.source_sha256, content=upload.source))
                session.flush()
            session.add(row)
            session.flush()
            return _submission(row)

    def refusal(self, upload: NewSubmission) -> Refusal | None:
        """Return why `add` would refuse an upload by the rules, before anybody looks at its content."""
        if not upload.ruled:
            return None
        with self._database.reading() as session:
            return _refusal(session, upload, upload.received_at or self._clock())

    def attempts(self, student: str, assignment: str, course: str | None) -> tuple[Attempt, ...]:
        """Return a student's submissions to an assignment as the rules see them, in order of arrival."""
        with self._database.reading() as session:
            return _attempts(session, student, assignment, course)

    def get(self, submission_id: str) -> Submission | None:
        """Return one submission, or None."""
        with self._database.reading() as session:
            row = session.get(SubmissionRow, submission_id)
            return None if row is None else _submission(row)

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
            return _report(session, submission_id)

    def with_report(self, submission_id: str) -> tuple[Submission, StoredReport | None] | None:
        """Return a submission and its latest grading as they are at one instant, or None."""
        with self._database.reading() as session:
            row = session.get(SubmissionRow, submission_id)
            return None if row is None else (_submission(row), _report(session, submission_id))

    def trajectory(self, report: StoredReport, case_id: str) -> bytes | None:
        """Return the trajectory of one case as gzip of its JSON, or None."""
        with self._database.reading() as session:
            row = session.get(TrajectoryRow, (report.submission_id, report.attempt, case_id))
            return None if row is None else row.content

    def of_student(
        self, student: str, assignment: str | None = None, course: str | None = None
    ) -> tuple[Submission, ...]:
        """Return a student's submissions, newest first; only those to `assignment` when it is given."""
        own = (col(SubmissionRow.student) == student, col(SubmissionRow.course) == course)
        statement = select(SubmissionRow).where(*own)
        if assignment is not None:
            statement = statement.where(col(SubmissionRow.assignment) == assignment)
        newest_first = statement.order_by(col(SubmissionRow.received_at).desc(), col(SubmissionRow.id).desc())
        with self._database.reading() as session:
            return tuple(_submission(row) for row in session.execute(newest_first).scalars().all())

    def open_count(self, student: str, course: str | None = None) -> int:
        """Count a student's submissions that are not graded yet."""
        statement = (
            select(func.count())
            .select_from(SubmissionRow)
            .where(
                col(SubmissionRow.state).in_(_OPEN_STATES),
                col(SubmissionRow.student) == student,
                col(SubmissionRow.course) == course,
            )
        )
        with self._database.reading() as session:
            return int(session.execute(statement).scalar_one())


def costs_an_attempt(state: str, verdict: str | None) -> bool:
    """Whether a submission counts against a student's limits: not when nobody could have graded it."""
    return state != SubmissionState.INFRASTRUCTURE_ERROR.value and verdict not in _FREE_VERDICTS


def _attempts(session: Session, student: str, assignment: str, course: str | None) -> tuple[Attempt, ...]:
    row = SubmissionRow
    statement = (
        select(col(row.id), col(row.received_at), col(row.score), col(row.state), col(row.verdict))
        .where(col(row.assignment) == assignment, col(row.student) == student, col(row.course) == course)
        .order_by(col(row.received_at), col(row.id))
    )
    return tuple(
        Attempt(id=one[0], received_at=one[1], score=one[2], costs=costs_an_attempt(one[3], one[4]))
        for one in session.execute(statement)
    )


def _refusal(session: Session, upload: NewSubmission, received_at: datetime) -> Refusal | None:
    known = rules_of(session, upload.course)
    earlier = _attempts(session, upload.student, upload.assignment, upload.course)
    extension = known.extension(upload.assignment, upload.student)
    return rules.refusal(known.policy(upload.assignment), extension, earlier, received_at, known.zone)


def new_id(now: datetime) -> str:
    """Return a UUID version 7 (RFC 9562): sorts by instant, and 74 random bits keep it unguessable."""
    milliseconds = int(now.timestamp() * 1000) & ((1 << 48) - 1)
    random_bits = uuid.uuid4().int
    high, low = (random_bits >> 64) & 0xFFF, random_bits & ((1 << 62) - 1)
    return str(uuid.UUID(int=(milliseconds << 80) | _UUID_VERSION_7 | (high << 64) | _UUID_VARIANT | low))


def _report(session: Session, submission_id: str) -> StoredReport | None:
    row = session.execute(_latest_grading(submission_id)).scalar_one_or_none()
    if row is None:
        return None
    return StoredReport(
        submission_id=submission_id,
        attempt=row.attempt,
        finished_at=row.finished_at,
        content=row.report,
        sha256=row.report_sha256,
        cases=_cases(session, row),
    )


def _latest_grading(submission_id: str) -> Select[GradingRow]:
    return (
        select(GradingRow)
        .join(
            SubmissionRow,
            (col(SubmissionRow.id) == col(GradingRow.submission_id))
            & (col(SubmissionRow.graded_attempt) == col(GradingRow.attempt)),
        )
        .where(col(SubmissionRow.id) == submission_id)
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


def _submission(row: SubmissionRow) -> Submission:
    return Submission(
        id=row.id,
        course=row.course,
        student=row.student,
        assignment=row.assignment,
        file_name=row.file_name,
        sha256=row.source_sha256,
        size_bytes=row.size_bytes,
        state=SubmissionState(row.state),
        received_at=row.received_at,
        queued_at=row.queued_at,
        started_at=row.started_at,
        finished_at=row.finished_at,
        attempt=row.attempt,
        tries=row.tries,
        trouble=row.trouble,
        verdict=None if row.verdict is None else GradeStatus(row.verdict),
        score=row.score,
        max_score=row.max_score,
        report_sha256=row.report_sha256,
        graded_attempt=row.graded_attempt,
    )
