"""Taking an upload in: recognised when it was sent before, ruled, and given its turn in the queue."""

import hashlib
import uuid
from collections.abc import Iterable, Sequence
from datetime import datetime, timedelta
from itertools import pairwise
from typing import Any, NamedTuple

from sqlalchemy import delete, insert, select, tuple_
from sqlmodel import Session, col

from grader import policy as rules
from grader.contracts.errors import SubmissionError, UploadRefusedError
from grader.contracts.policy import Attempt, Refusal
from grader.contracts.report import GradeStatus
from grader.contracts.submission import NewSubmission, SubmissionState
from grader.store.announcing import Announcer, waiting_as
from grader.store.locks import add_once, one_at_a_time
from grader.store.policies import rules_of
from grader.store.tables import GradingRow, SourceRow, SubmissionRow, UploadKeyRow, table_of
from grader.store.together import together

_FREE_VERDICTS = (GradeStatus.SYNTAX_ERROR.value, GradeStatus.ASSIGNMENT_ERROR.value)
_KEY_LIFE = timedelta(days=7)
_TICK = timedelta(microseconds=1)
_UUID_VERSION_7 = 0x7 << 76
_UUID_VARIANT = 0b10 << 62


class _Own(NamedTuple):
    """What is asked of every submission of a student to an assignment."""

    id: str
    received_at: datetime
    score: float | None
    state: str
    verdict: str | None
    source_sha256: str
    graded_attempt: int | None
    priority: int


_row = table_of(SubmissionRow).c
_COLUMNS = tuple(_row.keys())
_OWN = tuple(_row[name] for name in _Own._fields)
_SUBMISSION, _KEY = (insert(table_of(row)) for row in (SubmissionRow, UploadKeyRow))


def take_in(
    session: Session, upload: NewSubmission, now: datetime, announcer: Announcer
) -> tuple[SubmissionRow, bool]:
    """Store `upload` and announce it; return its row, and whether it is that of one that was sent before.

    Raises:
        UploadRefusedError: the rules of the assignment do not accept it.
        SubmissionError: ``key_reused``: its key belongs to another upload.
        InfrastructureError: the database does not answer.
    """
    one_at_a_time(session, "uploads", upload.course, upload.student)  # limits and keys are theirs
    digest = hashlib.sha256(upload.source).hexdigest()
    known = _under_key(session, upload, digest, now)
    if known is not None:
        return known, True
    own = _own_rows(session, upload.student, upload.assignment, upload.course)
    known = _same_as_latest(session, upload, own, digest)
    if known is not None:
        return known, True
    if upload.ruled and (refused := _refusal(session, upload, as_attempts(own), now)) is not None:
        raise UploadRefusedError(refused)
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
        turn_at=_turn(session, upload, own, now),
        not_before=now,
    )
    _put(session, upload, row, announcer)
    return row, False


def refusal_of(session: Session, upload: NewSubmission, received_at: datetime) -> Refusal | None:
    """Return why the rules do not accept an upload, or None."""
    earlier = attempts_of(session, upload.student, upload.assignment, upload.course)
    return _refusal(session, upload, earlier, received_at)


def attempts_of(session: Session, student: str, assignment: str, course: str | None) -> tuple[Attempt, ...]:
    """Return a student's submissions to an assignment as the rules see them, in order of arrival."""
    return as_attempts(_own_rows(session, student, assignment, course))


def as_attempts(own: Iterable[Any]) -> tuple[Attempt, ...]:
    """Return rows of submissions as the rules see them; what nobody could have graded costs no attempt."""
    return tuple(
        Attempt(
            id=one.id,
            received_at=one.received_at,
            score=one.score,
            costs=one.state != SubmissionState.INFRASTRUCTURE_ERROR.value
            and one.verdict not in _FREE_VERDICTS,
        )
        for one in own
    )


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


def _put(session: Session, upload: NewSubmission, row: SubmissionRow, announcer: Announcer) -> None:
    """Insert a new row and what belongs to it, and announce it, all sent at once."""
    session.flush()  # other rows' turns, whose answers are looked at
    connection = session.connection()
    with together(connection):
        add_once(session, SourceRow, sha256=row.source_sha256, content=upload.source)
        connection.execute(_SUBMISSION, {name: getattr(row, name) for name in _COLUMNS})
        if upload.key is not None:
            key = {"owner": _owner(upload), "key": upload.key, "digest": _meaning(upload, row.source_sha256)}
            connection.execute(_KEY, {**key, "submission_id": row.id, "at": row.received_at})
        announcer.added(session, waiting_as(row), row.queued_at)


def _own_rows(session: Session, student: str, assignment: str, course: str | None) -> Sequence[_Own]:
    """Return a student's submissions to an assignment, in order of arrival."""
    statement = select(*_OWN).where(
        _row.assignment == assignment, _row.student == student, _row.course == course
    )
    in_order = session.execute(statement.order_by(_row.received_at, _row.id))
    return [_Own(*one) for one in in_order]


def _refusal(
    session: Session, upload: NewSubmission, earlier: tuple[Attempt, ...], received_at: datetime
) -> Refusal | None:
    known = rules_of(session, upload.course, about=(upload.assignment, upload.student))
    extension = known.extension(upload.assignment, upload.student)
    return rules.refusal(known.policy(upload.assignment), extension, earlier, received_at, known.zone)


def _same_as_latest(
    session: Session, upload: NewSubmission, own: Sequence[_Own], digest: str
) -> SubmissionRow | None:
    """Return the student's latest submission if it has the same bytes and would be graded the same."""
    if upload.assignment_version is None or not own or own[-1].source_sha256 != digest:
        return None
    latest = own[-1]
    if latest.state == SubmissionState.INFRASTRUCTURE_ERROR.value:
        return None
    if latest.graded_attempt is not None:
        version = select(col(GradingRow.assignment_version)).where(
            col(GradingRow.submission_id) == latest.id, col(GradingRow.attempt) == latest.graded_attempt
        )
        if session.execute(version).scalar_one_or_none() != upload.assignment_version:
            return None
    return session.get(SubmissionRow, latest.id)


def _turn(session: Session, upload: NewSubmission, own: Sequence[_Own], now: datetime) -> datetime:
    """Return the new upload's turn: the first that the student's waiting uploads to the assignment have.

    They pass their turns on, newest first, and the last takes the end of the queue: nobody else waits longer.
    """
    if not any(one.state == SubmissionState.QUEUED.value and one.priority == 0 for one in own):
        return now
    statement = select(SubmissionRow).where(
        col(SubmissionRow.assignment) == upload.assignment,
        col(SubmissionRow.student) == upload.student,
        col(SubmissionRow.course) == upload.course,
        col(SubmissionRow.state) == SubmissionState.QUEUED.value,
        col(SubmissionRow.priority) == 0,
    )
    in_order = statement.order_by(col(SubmissionRow.turn_at), col(SubmissionRow.id))
    waiting = list(session.execute(in_order.with_for_update()).scalars())  # none is claimed meanwhile
    turns: list[datetime] = [*(row.turn_at for row in waiting), now]
    for index, (before, after) in enumerate(pairwise(turns), start=1):
        turns[index] = max(after, before + _TICK)
    for row, turn in zip(waiting, turns[1:], strict=True):
        row.turn_at = turn
    return turns[0]


def _owner(upload: NewSubmission) -> str:
    return f"{upload.course or ''}/{upload.student}"


def _meaning(upload: NewSubmission, digest: str) -> str:
    return hashlib.sha256(f"{upload.assignment}\n{upload.file_name}\n{digest}".encode()).hexdigest()
