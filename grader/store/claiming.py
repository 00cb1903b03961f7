"""Claims: the statements that make, fence and end one.

Statements that every grading needs are of tables, not of objects, and are built once, when this module is
imported: building them, and keeping account of objects, would cost more than the database takes to execute them.
"""

from collections.abc import Mapping, Sequence
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import Connection, Select, and_, bindparam, or_, select, update

from grader.contracts.python import UTC
from grader.contracts.submission import Claim, SubmissionState
from grader.store.intake import LATELY
from grader.store.tables import CourseRow, SourceRow, SubmissionRow, UtcDateTime, table_of

_LAST_TURN = datetime(9999, 1, 1, tzinfo=UTC)
LONG = timedelta(seconds=5)
"""A grading that others should not have to wait for. An ordinary one takes a fraction of a second."""

_submission = table_of(SubmissionRow)
_row = _submission.c
_source = table_of(SourceRow)
_course = table_of(CourseRow)

DUE: Select[str] = (
    select(_row.id)
    .where(
        _row.state == SubmissionState.QUEUED.value,
        _row.not_before <= bindparam("now", type_=UtcDateTime()),
        _row.turn_at <= bindparam("turn_by", type_=UtcDateTime()),
    )
    .order_by(_row.priority, _row.turn_at, _row.id)
    .limit(1)
)
"""The submission to grade next: by priority, then by turn. Takes the instants `now` and `turn_by`."""

_DUE_EARLY = DUE.add_columns(_row.course, _row.student, _row.tries)
_LATELY_OF = select(_row.started_at, _row.finished_at).where(
    _row.course.is_not_distinct_from(bindparam("course")),
    _row.student == bindparam("student"),
    or_(
        _row.state == SubmissionState.RUNNING.value,
        and_(_row.state == SubmissionState.QUEUED.value, _row.tries > 0),
        _row.finished_at >= bindparam("since", type_=UtcDateTime()),
    ),
)
"""When a student's gradings began and ended: those under way or to be tried again, and those that ended lately."""

_CLAIM_COLUMNS = (
    _row.id,
    _row.attempt,
    _row.tries,
    _row.assignment,
    _row.file_name,
    _row.queued_at,
    _row.course,
    select(_source.c.content)
    .where(_source.c.sha256 == _row.source_sha256)
    .scalar_subquery()
    .label("content"),
    *(
        select(setting).where(_course.c.id == _row.course).scalar_subquery().label(setting.name)
        for setting in (_course.c.distro, _course.c.runs_as)
    ),
)

CLAIMING = (
    update(_submission)
    .values(
        state=SubmissionState.RUNNING.value,
        attempt=_row.attempt + 1,
        tries=_row.tries + 1,
        worker=bindparam("by"),
        started_at=bindparam("now", type_=UtcDateTime()),
        lease_until=bindparam("until", type_=UtcDateTime()),
    )
    .returning(*_CLAIM_COLUMNS)
)
_TAKE = CLAIMING.where(_row.id == DUE.with_for_update(skip_locked=True).scalar_subquery())
_TAKE_EARLY = CLAIMING.where(_row.id == bindparam("early"), _row.state == SubmissionState.QUEUED.value)
_RESUME = (
    update(_submission)
    .where(_row.state == SubmissionState.RUNNING.value, _row.worker == bindparam("by"))
    .values(lease_until=bindparam("until", type_=UtcDateTime()))
    .returning(*_CLAIM_COLUMNS)
)
CHANGE = update(_submission).where(
    _row.id == bindparam("claimed"),
    _row.attempt == bindparam("under"),
    _row.worker == bindparam("held_by"),
    _row.state == SubmissionState.RUNNING.value,
)


def instants(now: datetime, in_turn: bool) -> dict[str, datetime]:
    """Return what `DUE` takes: whose turn has come by now, or whatever is due."""
    return {"now": now, "turn_by": now if in_turn else _LAST_TURN}


def claim_values(worker: str, now: datetime, lease_s: float, in_turn: bool) -> dict[str, Any]:
    """Return what `CLAIMING` and `DUE` take."""
    return {"by": worker, "until": now + timedelta(seconds=lease_s), **instants(now, in_turn)}


def take(connection: Connection, worker: str, now: datetime, lease_s: float, in_turn: bool) -> Claim | None:
    """Claim the submission that is due first; None when nothing is due, or another worker was quicker."""
    values = claim_values(worker, now, lease_s, in_turn)
    row = connection.execute(_TAKE, values).first()
    if row is None and in_turn and (early := due_early(connection, now)) is not None:
        row = connection.execute(_TAKE_EARLY, {**values, "early": early}).first()
    return None if row is None else claim_of(row, worker)


def due_early(connection: Connection, now: datetime) -> str | None:
    """Return the submission due first if everybody's turn had come; None if grading it may take long.

    It may if it was tried before, or if other gradings of its student are under way, wait for another try or took
    long.
    """
    first = connection.execute(_DUE_EARLY, instants(now, in_turn=False)).first()
    if first is None or first.tries:
        return None
    id_, course, student, _ = first
    asked = {"course": course, "student": student, "since": now - LATELY}
    for started_at, finished_at in connection.execute(_LATELY_OF, asked):
        if finished_at is None or started_at is None or finished_at - started_at > LONG:
            return None
    return str(id_)


def resume(connection: Connection, worker: str, now: datetime, lease_s: float) -> Claim | None:
    """Return a claim of `worker` that it never heard of, under a new lease; None if there is none.

    Only right where `worker` has ended every claim that it knows of.
    """
    until = now + timedelta(seconds=lease_s)
    row = connection.execute(_RESUME, {"by": worker, "until": until}).first()
    return None if row is None else claim_of(row, worker)


def claim_of(row: Sequence[Any], worker: str) -> Claim:
    """Return the claim of `worker` that `CLAIMING` returned as `row`."""
    id_, attempt, tries, assignment, file_name, queued_at, course, source, distro, runs_as = row
    return Claim(
        submission_id=id_,
        attempt=attempt,
        tries=tries,
        worker=worker,
        assignment=assignment,
        file_name=file_name,
        source=source,
        queued_at=queued_at,
        course=course,
        distro=distro,
        runs_as=runs_as,
    )


def change(connection: Connection, claim: Claim, values: Mapping[str, Any]) -> bool:
    """Write `values` to the claimed row if the claim is still the latest: the fence."""
    return connection.execute(CHANGE, {**fence(claim), **values}).rowcount == 1


def fence(claim: Claim) -> dict[str, Any]:
    """Return what `CHANGE` finds the row of a valid claim by.

    The number of the claim alone does not do on PostgreSQL: a server that crashed may have lost a claim whose
    worker lives, and another worker's next claim then has the same number.
    """
    return {"claimed": claim.submission_id, "under": claim.attempt, "held_by": claim.worker}
