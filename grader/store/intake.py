"""Taking an upload in: recognised when it was sent before, ruled, and given its turn in the queue."""

import hashlib
import uuid
from datetime import datetime, timedelta
from itertools import pairwise

from sqlalchemy import Select, delete, select, tuple_
from sqlmodel import Session, col

from grader import policy as rules
from grader.contracts.errors import SubmissionError, UploadRefusedError
from grader.contracts.policy import Attempt, Refusal
from grader.contracts.report import GradeStatus
from grader.contracts.submission import NewSubmission, SubmissionState
from grader.store.locks import add_once, one_at_a_time
from grader.store.policies import rules_of
from grader.store.tables import GradingRow, SourceRow, SubmissionRow, UploadKeyRow

_FREE_VERDICTS = (GradeStatus.SYNTAX_ERROR.value, GradeStatus.ASSIGNMENT_ERROR.value)
_KEY_LIFE = timedelta(days=7)
_TICK = timedelta(microseconds=1)
_UUID_VERSION_7 = 0x7 << 76
_UUID_VARIANT = 0b10 << 62


def take_in(session: Session, upload: NewSubmission, now: datetime) -> tuple[SubmissionRow, bool]:
    """Return the row of `upload`, and whether it is that of an earlier one that was sent again.

    Raises:
        UploadRefusedError: the rules of the assignment do not accept it.
        SubmissionError: ``key_reused``: its key belongs to another upload.
    """
    one_at_a_time(session, "uploads", upload.course, upload.student)  # limits and keys are theirs
    digest = hashlib.sha256(upload.source).hexdigest()
    known = _under_key(session, upload, digest, now) or _same_as_latest(session, upload, digest)
    if known is not None:
        return known, True
    if upload.ruled and (refused := refusal_of(session, upload, now)) is not None:
        raise UploadRefusedError(refused)
    add_once(session, SourceRow, sha256=digest, content=upload.source)
    row = SubmissionRow(
        id=new_id(now),
        course=upload.course,
        student=upload.student,
        assignment=upload.assignment,
        file_name=upload.file_name,
        source_sha256=digest,
        size_bytes=len(upload.source),
        state=SubmissionState.QUEUED.value,
        received_at=now,
        queued_at=now,
        turn_at=_turn(session, upload, now),
        not_before=now,
    )
    session.add(row)
    session.flush()
    if upload.key is not None:
        owner = _owner(upload)
        session.add(
            UploadKeyRow(
                owner=owner, key=upload.key, digest=_meaning(upload, digest), submission_id=row.id, at=now
            )
        )
    return row, False


def refusal_of(session: Session, upload: NewSubmission, received_at: datetime) -> Refusal | None:
    """Return why the rules do not accept an upload, or None."""
    known = rules_of(session, upload.course, about=(upload.assignment, upload.student))
    earlier = attempts_of(session, upload.student, upload.assignment, upload.course)
    extension = known.extension(upload.assignment, upload.student)
    return rules.refusal(known.policy(upload.assignment), extension, earlier, received_at, known.zone)


def attempts_of(session: Session, student: str, assignment: str, course: str | None) -> tuple[Attempt, ...]:
    """Return a student's submissions to an assignment as the rules see them, in order of arrival."""
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


def costs_an_attempt(state: str, verdict: str | None) -> bool:
    """Whether a submission counts against a student's limits: not when nobody could have graded it."""
    return state != SubmissionState.INFRASTRUCTURE_ERROR.value and verdict not in _FREE_VERDICTS


def new_id(now: datetime) -> str:
    """Return a UUID version 7 (RFC 9562): sorts by instant, and 74 random bits keep it unguessable."""
    milliseconds = int(now.timestamp() * 1000) & ((1 << 48) - 1)
    random_bits = uuid.uuid4().int
    high, low = (random_bits >> 64) & 0xFFF, random_bits & ((1 << 62) - 1)
    return str(uuid.UUID(int=(milliseconds << 80) | _UUID_VERSION_7 | (high << 64) | _UUID_VARIANT | low))


def _under_key(session: Session, upload: NewSubmission, digest: str, now: datetime) -> SubmissionRow | None:
    if upload.key is None:
        return None
    forgotten = (
        select(col(UploadKeyRow.owner), col(UploadKeyRow.key))
        .where(col(UploadKeyRow.at) < now - _KEY_LIFE)
        .with_for_update(skip_locked=True)  # which another upload is forgetting right now
    )
    session.execute(
        delete(UploadKeyRow).where(tuple_(col(UploadKeyRow.owner), col(UploadKeyRow.key)).in_(forgotten))
    )
    known = session.get(UploadKeyRow, (_owner(upload), upload.key))
    if known is None:
        return None
    if known.digest != _meaning(upload, digest):
        raise SubmissionError("key_reused", "this Idempotency-Key belongs to another upload")
    return session.get(SubmissionRow, known.submission_id)


def _same_as_latest(session: Session, upload: NewSubmission, digest: str) -> SubmissionRow | None:
    """Return the student's latest submission if it has the same bytes and would be graded the same."""
    if upload.assignment_version is None:
        return None
    statement = _own(upload).order_by(col(SubmissionRow.received_at).desc(), col(SubmissionRow.id).desc())
    latest: SubmissionRow | None = session.execute(statement.limit(1)).scalars().first()
    if latest is None or latest.source_sha256 != digest:
        return None
    if latest.state == SubmissionState.INFRASTRUCTURE_ERROR.value:
        return None
    if latest.graded_attempt is not None:
        version = select(col(GradingRow.assignment_version)).where(
            col(GradingRow.submission_id) == latest.id, col(GradingRow.attempt) == latest.graded_attempt
        )
        if session.execute(version).scalar_one_or_none() != upload.assignment_version:
            return None
    return latest


def _turn(session: Session, upload: NewSubmission, now: datetime) -> datetime:
    """Return the new upload's turn: the first that the student's waiting uploads to the assignment have.

    They pass their turns on, newest first, and the last takes the end of the queue: nobody else waits longer.
    """
    statement = _own(upload).where(
        col(SubmissionRow.state) == SubmissionState.QUEUED.value, col(SubmissionRow.priority) == 0
    )
    in_order = statement.order_by(col(SubmissionRow.turn_at), col(SubmissionRow.id))
    waiting = list(session.execute(in_order.with_for_update()).scalars())  # none is claimed meanwhile
    turns: list[datetime] = [*(row.turn_at for row in waiting), now]
    for index, (before, after) in enumerate(pairwise(turns), start=1):
        turns[index] = max(after, before + _TICK)
    for row, turn in zip(waiting, turns[1:], strict=True):
        row.turn_at = turn
    return turns[0]


def _own(upload: NewSubmission) -> Select[SubmissionRow]:
    return select(SubmissionRow).where(
        col(SubmissionRow.assignment) == upload.assignment,
        col(SubmissionRow.student) == upload.student,
        col(SubmissionRow.course) == upload.course,
    )


def _owner(upload: NewSubmission) -> str:
    return f"{upload.course or ''}/{upload.student}"


def _meaning(upload: NewSubmission, digest: str) -> str:
    return hashlib.sha256(f"{upload.assignment}\n{upload.file_name}\n{digest}".encode()).hexdigest()
