"""Taking an upload in.

In one transaction: find out whether the same upload was sent before, ask the rules whether it is accepted, give it
a turn in the queue, and store it.
"""

import hashlib
import uuid
from collections.abc import Iterable, Sequence
from dataclasses import replace
from datetime import datetime, timedelta
from itertools import pairwise
from typing import Any, NamedTuple
from zoneinfo import ZoneInfo

from sqlalchemy import (
    ColumnElement,
    Select,
    and_,
    bindparam,
    case,
    delete,
    func,
    insert,
    or_,
    select,
    true,
    union,
    update,
)
from sqlmodel import Session, col

from grader.contracts.assignment import DEFAULT_DISTRO, DEFAULT_WAY, Distro, RunsAs, stored_assignment
from grader.contracts.errors import RefusedError
from grader.contracts.python import UTC
from grader.contracts.report import GradeStatus
from grader.contracts.rules import Attempt, Extension, Refusal, Rules
from grader.contracts.submission import NewSubmission, Submission, SubmissionState
from grader.contracts.text import EMPTY, Text
from grader.store.audit import Signature, record
from grader.store.database import StorePart, add_once, one_at_a_time
from grader.store.own_assignments import still_used
from grader.store.rules import ABOUT, ABOUT_FROM, OF_COURSE, rules_about
from grader.store.tables import (
    ExplanationRow,
    GradedAssignmentRow,
    GradingRow,
    SourceRow,
    SubmissionRow,
    TeamMemberRow,
    UploadKeyRow,
    UtcDateTime,
    submission_of,
    table_of,
)
from grader.store.teams import members_of
from grader.store.work import tell_workers

LATELY = timedelta(minutes=10)
"""Far longer than anybody waits, so that a first grading goes before anybody's second."""
_COST_WEIGHT = 10
_MOST_LATELY = 100
"""Bound on the latest and on the waiting submissions of a person that decide about the next one's turn, so that
an upload costs the same after any number of others."""
_MOST_EXPLAINED_S = 1.5
"""What one explanation counts at most: on a busy host it waits for the processor behind everybody."""
_KEY_LIFE = timedelta(days=7)
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
_OPEN_STATES = (SubmissionState.QUEUED.value, SubmissionState.RUNNING.value)
_SMALLEST_STEP = timedelta(microseconds=1)
_UUID_VERSION_7 = 0x7 << 76
_UUID_VARIANT = 0b10 << 62
_row, _key, _explanation, _team_of = (
    table_of(row).c for row in (SubmissionRow, UploadKeyRow, ExplanationRow, TeamMemberRow)
)
_COLUMNS = tuple(_row.keys())
_INSERT_SUBMISSION, _INSERT_KEY = (insert(table_of(row)) for row in (SubmissionRow, UploadKeyRow))
_FORGET_OLD_KEYS = delete(table_of(UploadKeyRow)).where(
    _key.owner == bindparam("of"), _key.at < bindparam("before", type_=UtcDateTime())
)
_SET_TURN = (
    update(table_of(SubmissionRow)).where(_row.id == bindparam("moved")).values(turn_at=bindparam("turn"))
)
_OF_COURSE, _OF_NO_COURSE = _row.course == bindparam("course"), _row.course.is_(None)


class _Earlier(NamedTuple):
    """An earlier submission of the student: the columns that decide about a new one."""

    id: str
    received_at: datetime
    score: float | None
    state: str
    verdict: str | None
    source_sha256: str
    graded_attempt: int | None
    priority: int
    assignment: str
    started_at: datetime | None
    finished_at: datetime | None


class _State(NamedTuple):
    """What decides about an upload.

    Attributes:
        archived: the course is. distro, runs_as: its settings; None without courses.
        member: the student is in it; without courses everybody is.
        keyed: digest and submission of what was sent under the upload's key before; None: nothing was.
        latest: the student's last submission to the assignment.
        lately: the student's submissions to any assignment that wait, are graded or were graded lately.
        explained: how long explanations of the latter took.
        team: the code of the student's team for the assignment; None: the student hands in alone.
    """

    archived: bool
    distro: Distro | None
    runs_as: RunsAs | None
    member: bool
    keyed: tuple[str, str] | None
    rules: Rules
    extension: Extension
    zone: ZoneInfo
    latest: _Earlier | None
    lately: Sequence[_Earlier]
    explained: timedelta
    team: str | None


_EARLIER = tuple(_row[name] for name in _Earlier._fields)


def _question(of_course: ColumnElement[bool]) -> Select[Any]:
    """Return the query that reads all of `_State` at once, because each query is a round trip to PostgreSQL.

    Its rows are those of the student's submissions that decide, however many others there are; what does not
    depend on a submission stands in every row.
    """
    keyed = and_(
        _key.owner == bindparam("owner"),
        _key.key == bindparam("key"),
        _key.at >= bindparam("since", type_=UtcDateTime()),
    )
    own = select(*_EARLIER).where(of_course, _row.student == bindparam("student"))
    of_assignment = own.where(_row.assignment == bindparam("assignment"))
    latest = of_assignment.order_by(_row.received_at.desc(), _row.id.desc()).limit(1)
    waiting = own.where(_row.finished_at.is_(None)).limit(_MOST_LATELY)
    since = bindparam("lately", type_=UtcDateTime())
    graded = own.where(_row.finished_at >= since).order_by(_row.finished_at.desc()).limit(_MOST_LATELY)
    parts = (select(part.subquery()) for part in (latest, waiting, graded))
    deciding = union(*parts).subquery()
    tables = ABOUT_FROM.outerjoin(table_of(UploadKeyRow), keyed).outerjoin(deciding, true())
    explained = (
        select(
            func.sum(
                case((_explanation.took_s > _MOST_EXPLAINED_S, _MOST_EXPLAINED_S), else_=_explanation.took_s)
            )
        )
        .join(table_of(SubmissionRow), _row.id == _explanation.submission_id)
        .where(of_course, _row.student == bindparam("student"), _row.finished_at >= since)
        .scalar_subquery()
    )
    team = select(_team_of.team).where(
        _team_of.course == bindparam("course"),
        _team_of.assignment == bindparam("assignment"),
        _team_of.person == bindparam("student"),
    )
    more = (explained, team.scalar_subquery(), _key.digest, _key.submission_id)
    asked = select(*OF_COURSE, *more, *ABOUT, *deciding.c)
    asked = asked.select_from(tables)
    return asked.order_by(deciding.c.received_at, deciding.c.id)


def _costly_of(of_course: ColumnElement[bool]) -> Select[Any]:
    """Return the query for a student's latest submissions to an assignment that cost an attempt."""
    own = select(*_EARLIER).where(
        of_course,
        _row.student == bindparam("student"),
        _row.assignment == bindparam("assignment"),
        _row.state != SubmissionState.INFRASTRUCTURE_ERROR.value,
        or_(_row.verdict.is_(None), _row.verdict != GradeStatus.SYNTAX_ERROR.value),
    )
    return own.order_by(_row.received_at.desc(), _row.id.desc()).limit(bindparam("most"))


_IN_COURSE, _WITHOUT_COURSE = _question(_OF_COURSE), _question(_OF_NO_COURSE)
_COSTLY_IN_COURSE, _COSTLY_WITHOUT_COURSE = _costly_of(_OF_COURSE), _costly_of(_OF_NO_COURSE)


class Intake(StorePart):
    """Takes uploads in; safe to share between threads."""

    def accept(self, upload: NewSubmission, received_at: datetime) -> tuple[Submission, bool]:
        """Store an upload and queue it, in one transaction: once this returns, it is not lost.

        A student's uploads that arrive at the same moment are counted one after the other. What the student sent
        before is not stored again: an upload under the same key or, when `upload.assignment_version` is given, one
        with the bytes of the student's latest submission.

        Returns:
            The submission, and whether it is an earlier one.

        Raises:
            RefusedError: as `take_in`.
        """
        with self._database.writing() as session:
            row, repeated = take_in(session, upload, received_at)
            if not repeated or row.team_upload is not None:
                tell_workers(session.connection())
            if upload.by is not None and not repeated:
                _record_handed_in(session, upload.by, row)
            return submission_of(row), repeated

    def refusal(self, upload: NewSubmission, received_at: datetime) -> Refusal | None:
        """Return why the rules refuse an upload, or None. Its content is not looked at."""
        if not upload.ruled:
            return None
        with self._database.reading() as session:
            state = _state_of(session, upload)
            return _refusal(session, upload, state, received_at)

    def attempts(self, student: str, assignment: str, course: str | None) -> tuple[Attempt, ...]:
        """Return a student's submissions to an assignment as the rules see them, in order of arrival."""
        # SQLAlchemy writes IS NULL for None.
        own = select(*_EARLIER).where(
            _row.course == course, _row.student == student, _row.assignment == assignment
        )
        return as_attempts(self._rows(own.order_by(_row.received_at, _row.id)))

    def open_count(self, student: str, course: str | None) -> int:
        """Count a student's submissions that are not graded yet."""
        is_open = _row.state.in_(_OPEN_STATES)
        own = select(func.count()).where(is_open, _row.student == student, _row.course == course)
        with self._database.reading() as session:
            return int(session.execute(own).scalar_one())


def take_in(session: Session, upload: NewSubmission, now: datetime) -> tuple[SubmissionRow, bool]:
    """Store and queue `upload`, unless the student sent the same before; with it those of the student's team.

    Returns:
        The row of the student's submission, and whether it is an earlier one.

    Raises:
        RefusedError: the rules of the assignment refuse the upload, to the student or to somebody of the team; the
            course is archived, the student is not in it, or its own assignment was removed; or ``key_reused``: its
            key came with another upload before.
        InfrastructureError: the database does not answer.
    """
    one_at_a_time(session, "uploads", upload.course, upload.student)  # limits and keys are counted by student
    state, first = _state_of(session, upload, (upload.key, now)), new_id(now)
    if state.team is None or state.keyed is not None:
        return _take_in(session, upload, state, now, first)
    # after the student's own lock, and no other one after it: so no two uploads wait for each other
    one_at_a_time(session, "team", upload.course, upload.assignment, state.team)
    team = members_of(session, upload.course, upload.assignment, state.team)
    mates = [member for member in team if member != upload.student]
    row, repeated = _take_in(
        session, upload, _state_of(session, upload), now, first, first if mates else None
    )
    if mates:
        row.team_upload = row.team_upload or row.id  # the same file, sent before the others joined
    for mate in mates:
        _take_in_for(session, replace(upload, student=mate, key=None), now, row.team_upload)
    return row, repeated


def _take_in_for(session: Session, upload: NewSubmission, now: datetime, team_upload: str | None) -> None:
    """Store what somebody of the student's team handed in."""
    try:
        _take_in(session, upload, _state_of(session, upload), now, new_id(now), team_upload)
    except RefusedError as refused:
        detail = refused.detail or EMPTY
        zh = f"这是队友 {upload.student} 的限制：文件要算作全队每个人的提交。{detail.zh}"
        en = f"That holds for {upload.student} of your team: the file would count for all of you. {detail.en}"
        raise RefusedError(refused.code, Text(zh=zh, en=en.strip()), **refused.members) from None


def _take_in(  # noqa: PLR0913, PLR0917
    session: Session,
    upload: NewSubmission,
    state: _State,
    now: datetime,
    id_: str,
    team_upload: str | None = None,
) -> tuple[SubmissionRow, bool]:
    digest = hashlib.sha256(upload.source).hexdigest()
    same = _under_key(upload, digest, state) or _same_as_latest(session, upload, state, digest)
    if same is not None:
        return session.get_one(SubmissionRow, same), True
    _require_accepted(session, upload, state, now)
    row = SubmissionRow(
        id=id_,
        course=upload.course,
        student=upload.student,
        assignment=upload.assignment,
        file_name=upload.file_name,
        source_sha256=digest,
        size_bytes=len(upload.source),
        state=SubmissionState.QUEUED.value,
        received_at=now,
        queued_at=now,
        turn_at=_turn(session, upload, state, now),
        not_before=now,
        team_upload=team_upload,
    )
    _insert(session, upload, row)
    return row, False


def _require_accepted(session: Session, upload: NewSubmission, state: _State, now: datetime) -> None:
    if not state.member:  # removed since they asked
        raise RefusedError("unknown_student", field="student")
    if state.archived:
        raise RefusedError("course_archived")
    if upload.own and not still_used(session, upload.course, upload.assignment):
        raise RefusedError("unknown_assignment", field="assignment")
    if upload.ruled and (refused := _refusal(session, upload, state, now)) is not None:
        raise refused.error()


def as_attempts(submissions: Iterable[Any]) -> tuple[Attempt, ...]:
    """Return rows of submissions as the rules see them.

    A submission that the service failed to grade costs no attempt, and neither does one with a syntax error.
    """
    return tuple(
        Attempt(
            id=submission.id,
            received_at=submission.received_at,
            score=submission.score,
            costs=submission.state != SubmissionState.INFRASTRUCTURE_ERROR.value
            and submission.verdict != GradeStatus.SYNTAX_ERROR.value,
        )
        for submission in submissions
    )


def _record_handed_in(session: Session, by: str, row: SubmissionRow) -> None:
    signed = Signature(row.received_at, row.course, by)
    what = {"student": row.student, "assignment": row.assignment, "sha256": row.source_sha256}
    record(session, signed, "submission.hand_in", f"submission {row.id}", after=what)


def new_id(now: datetime) -> str:
    """Return a UUID version 7 (RFC 9562): sorts by instant, and 74 random bits keep it unguessable."""
    milliseconds = int(now.timestamp() * 1000) & ((1 << 48) - 1)
    random_bits = uuid.uuid4().int
    high, low = (random_bits >> 64) & 0xFFF, random_bits & ((1 << 62) - 1)
    return str(uuid.UUID(int=(milliseconds << 80) | _UUID_VERSION_7 | (high << 64) | _UUID_VARIANT | low))


def _state_of(
    session: Session, upload: NewSubmission, keyed: tuple[str | None, datetime] = (None, _EPOCH)
) -> _State:
    key, now = keyed
    assignment, course = upload.assignment, upload.course
    asked = {
        "student": upload.student,
        "assignment": assignment,
        "course": course,
        "owner": _owner(course, upload.student),
        "key": key,
        "since": now - _KEY_LIFE,
        "lately": now - LATELY,
    }
    rows = session.connection().execute(_WITHOUT_COURSE if course is None else _IN_COURSE, asked).all()
    of_course, more, about = rows[0][:4], rows[0][4:8], rows[0][8 : -len(_EARLIER)]
    archived_at, distro, runs_as, member = of_course
    explained_s, team, digest, submission_id = more
    rules, extension, zone = rules_about(*about)
    own = [_Earlier(*values) for row in rows if (values := row[-len(_EARLIER) :])[0] is not None]
    recent = now - LATELY
    return _State(
        archived_at is not None,
        distro,
        runs_as,
        course is None or member is not None,
        None if digest is None else (digest, submission_id),
        rules,
        extension,
        zone,
        next((submission for submission in reversed(own) if submission.assignment == assignment), None),
        [
            submission
            for submission in own
            if submission.finished_at is None or submission.finished_at >= recent
        ],
        timedelta(seconds=explained_s or 0.0),
        team if rules.team_size > 1 else None,
    )


def _under_key(upload: NewSubmission, digest: str, state: _State) -> str | None:
    """Return the submission that was sent under the upload's key before."""
    if state.keyed is None:
        return None
    known_digest, submission_id = state.keyed
    if known_digest != _upload_digest(upload, digest):
        raise RefusedError("key_reused")
    return submission_id


def _insert(session: Session, upload: NewSubmission, row: SubmissionRow) -> None:
    """Insert a new row and what belongs to it."""
    connection = session.connection()
    add_once(connection, SourceRow, sha256=row.source_sha256, content=upload.source)
    connection.execute(_INSERT_SUBMISSION, {name: getattr(row, name) for name in _COLUMNS})
    if upload.key is not None:
        owner = _owner(upload.course, upload.student)
        connection.execute(_FORGET_OLD_KEYS, {"of": owner, "before": row.received_at - _KEY_LIFE})
        key = {"owner": owner, "key": upload.key, "digest": _upload_digest(upload, row.source_sha256)}
        connection.execute(_INSERT_KEY, {**key, "submission_id": row.id, "at": row.received_at})


def _refusal(session: Session, upload: NewSubmission, state: _State, received_at: datetime) -> Refusal | None:
    if state.archived:
        return Refusal(code="course_archived")
    counted = _counted(session, state, upload.student, upload.assignment, upload.course)
    return state.rules.refusal(state.extension, counted, received_at, state.zone)


def _counted(
    session: Session, state: _State, student: str, assignment: str, course: str | None
) -> tuple[Attempt, ...]:
    """Return a student's latest attempts, as many as decide whether there may be another one."""
    rules, extra = state.rules, state.extension.extra_attempts
    in_all = 0 if rules.attempts is None else rules.attempts + extra
    most = max(in_all, rules.attempts_per_day or 0)
    if not most:
        return ()
    asked = {"student": student, "assignment": assignment, "course": course, "most": most}
    costly = _COSTLY_WITHOUT_COURSE if course is None else _COSTLY_IN_COURSE
    return as_attempts(session.connection().execute(costly, asked).all()[::-1])


def _same_as_latest(session: Session, upload: NewSubmission, state: _State, digest: str) -> str | None:
    """Return the student's latest submission if it has the same bytes and would be graded the same."""
    latest = state.latest
    if upload.assignment_version is None or latest is None or latest.source_sha256 != digest:
        return None
    if latest.state == SubmissionState.INFRASTRUCTURE_ERROR.value:
        return None
    if latest.graded_attempt is not None:
        release = upload.distro or state.distro or DEFAULT_DISTRO
        way = upload.runs_as or state.runs_as or DEFAULT_WAY
        now = (upload.assignment_version, release, way)
        if _graded_as(session, latest.id, latest.graded_attempt) != now:
            return None
    return latest.id


def _graded_as(session: Session, submission_id: str, attempt: int) -> tuple[int, Distro, RunsAs]:
    """Return by which version of the assignment, release of ROS 2 and way to run a grading was made."""
    version, graded = session.execute(
        select(col(GradingRow.assignment_version), col(GradedAssignmentRow.content))
        .join(GradedAssignmentRow, col(GradedAssignmentRow.sha256) == col(GradingRow.assignment_sha256))
        .where(col(GradingRow.submission_id) == submission_id, col(GradingRow.attempt) == attempt)
    ).one()
    assignment = stored_assignment(graded)
    return version, assignment.release, assignment.started_as


def _turn(session: Session, upload: NewSubmission, state: _State, now: datetime) -> datetime:
    """Return the new upload's turn in the queue, and move the student's uploads that wait for the same assignment.

    The new upload takes the first turn of those that wait, each of them the turn of the next, and the last one
    the end of the student's own. So the newest upload is graded first, and no other student waits longer for it.
    """
    last = now + _behind(state, now)
    of_assignment = (submission for submission in state.lately if submission.assignment == upload.assignment)
    if not any(
        submission.state == SubmissionState.QUEUED.value and submission.priority == 0
        for submission in of_assignment
    ):
        return last
    statement = select(_row.id, _row.turn_at).where(
        _row.assignment == upload.assignment,
        _row.student == upload.student,
        _row.course == upload.course,
        _row.state == SubmissionState.QUEUED.value,
        _row.priority == 0,
    )
    connection = session.connection()
    in_order = statement.order_by(_row.turn_at, _row.id)
    waiting = connection.execute(
        in_order.with_for_update()
    ).all()  # locked, so that none is claimed meanwhile
    turns: list[datetime] = [*(row.turn_at for row in waiting), last]
    for index, (before, after) in enumerate(pairwise(turns), start=1):
        turns[index] = max(after, before + _SMALLEST_STEP)
    moves = [{"moved": row.id, "turn": turn} for row, turn in zip(waiting, turns[1:], strict=True)]
    if moves:
        connection.execute(_SET_TURN, moves)
    return turns[0]


def _behind(state: _State, now: datetime) -> timedelta:
    """Return how far behind its arrival an upload is placed."""
    waits, cost = 0, state.explained
    for submission in state.lately:
        if submission.priority:
            continue  # a re-grade, which nobody asked of the student
        if submission.state == SubmissionState.QUEUED.value:
            waits += 1
        elif submission.started_at is not None:
            cost += max((submission.finished_at or now) - submission.started_at, timedelta())
    return handicap(waits, cost)


def handicap(waits: int, cost: timedelta) -> timedelta:
    """Return how far behind its arrival somebody's work is placed, so that people take turns and not uploads.

    What comes from a person of whom something waits goes behind what others bring within the next ten minutes,
    and so does that of a person whose work took a minute or more in the last ten. It is never more than that: on a
    slow host everybody's gradings take long, and then those who come back take turns in order of arrival.
    """
    return waits * LATELY + min(_COST_WEIGHT * cost, LATELY)


def _owner(course: str | None, student: str) -> str:
    return f"{course or ''}/{student}"


def _upload_digest(upload: NewSubmission, digest: str) -> str:
    return hashlib.sha256(f"{upload.assignment}\n{upload.file_name}\n{digest}".encode()).hexdigest()
