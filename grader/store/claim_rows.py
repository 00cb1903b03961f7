"""Statements about the rows of the queue, of which `grader.store.queue` makes its transactions.

Those that every grading needs are of tables, not of objects, and put together once: see `grader.store.results`.
"""

from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import ColumnElement, Connection, Select, bindparam, or_, select, update
from sqlmodel import Session, col

from grader.contracts.submission import Claim, SubmissionState
from grader.store.announcing import Waiting
from grader.store.columns import UtcDateTime
from grader.store.results import Values
from grader.store.tables import GradingRow, SourceRow, SubmissionRow, table_of

LONGEST_PAUSE = timedelta(hours=1)
"""Between two tries of a submission. No lease is as long."""

WAITING = (
    col(SubmissionRow.id),
    col(SubmissionRow.attempt),
    col(SubmissionRow.priority),
    col(SubmissionRow.not_before),
)
"""The columns that `waiting` takes."""

_submission = table_of(SubmissionRow)
_row = _submission.c
_source = table_of(SourceRow)
_grading = table_of(GradingRow).c

DUE: Select[str] = (
    select(_row.id)
    .where(
        _row.state == SubmissionState.QUEUED.value,
        _row.not_before <= bindparam("now", type_=UtcDateTime()),
    )
    .order_by(_row.priority, _row.turn_at, _row.id)
    .limit(1)
)
"""The submission to grade next: by priority, then by turn. Takes the instant `now`."""

_CLAIMED = (
    _row.id,
    _row.attempt,
    _row.tries,
    _row.assignment,
    _row.file_name,
    _row.queued_at,
    select(_source.c.content).where(_source.c.sha256 == _row.source_sha256).scalar_subquery(),
)

_TAKE = (
    update(_submission)
    .where(_row.id == DUE.with_for_update(skip_locked=True).scalar_subquery())
    .values(
        state=SubmissionState.RUNNING.value,
        attempt=_row.attempt + 1,
        tries=_row.tries + 1,
        worker=bindparam("by"),
        started_at=bindparam("now", type_=UtcDateTime()),
        lease_until=bindparam("until", type_=UtcDateTime()),
    )
    .returning(*_CLAIMED)
)
_RESUME = (
    update(_submission)
    .where(_row.state == SubmissionState.RUNNING.value, _row.worker == bindparam("by"))
    .values(lease_until=bindparam("until", type_=UtcDateTime()))
    .returning(*_CLAIMED)
)
_CHANGE = update(_submission).where(
    _row.id == bindparam("claimed"),
    _row.attempt == bindparam("under"),
    _row.state == SubmissionState.RUNNING.value,
)

_STORED = select(_grading.worker, _grading.report_sha256).where(
    _grading.submission_id == bindparam("id"), _grading.attempt == bindparam("under")
)


def take(connection: Connection, worker: str, now: datetime, lease_s: float) -> Claim | None:
    """Claim the submission that is due first; None when nothing is due, or another worker was quicker."""
    until = now + timedelta(seconds=lease_s)
    row = connection.execute(_TAKE, {"now": now, "by": worker, "until": until}).first()
    return None if row is None else _claim(row, worker)


def resume(connection: Connection, worker: str, now: datetime, lease_s: float) -> Claim | None:
    """Return what `worker` has claimed without having heard of it, under a new lease; None if there is nothing.

    Only right where `worker` has ended every claim that it knows of.
    """
    until = now + timedelta(seconds=lease_s)
    row = connection.execute(_RESUME, {"by": worker, "until": until}).first()
    return None if row is None else _claim(row, worker)


def _claim(row: Sequence[Any], worker: str) -> Claim:
    id_, attempt, tries, assignment, file_name, queued_at, source = row
    return Claim(
        submission_id=id_,
        attempt=attempt,
        tries=tries,
        worker=worker,
        assignment=assignment,
        file_name=file_name,
        source=source,
        queued_at=queued_at,
    )


def change(connection: Connection, claim: Claim, values: Mapping[str, Any]) -> bool:
    """Write `values` to the claimed row if the claim is still the latest: the fence."""
    fence = {"claimed": claim.submission_id, "under": claim.attempt}
    return connection.execute(_CHANGE, {**fence, **values}).rowcount == 1


def stored_already(connection: Connection, grading: Values) -> bool:
    """Whether `grading` was stored under this very claim: the answer to an earlier commit got lost."""
    there = connection.execute(_STORED, {"id": grading["submission_id"], "under": grading["attempt"]}).first()
    return there is not None and tuple(there) == (grading["worker"], grading["report_sha256"])


def void(
    session: Session, condition: Sequence[ColumnElement[bool]], values: Mapping[str, Any]
) -> list[Waiting]:
    """Write `values` to running rows because nobody grades them any more; return them.

    Rows that another transaction holds are left out: somebody still does something about them.
    """
    running = col(SubmissionRow.state) == SubmissionState.RUNNING.value
    found = select(col(SubmissionRow.id)).where(running, *condition).order_by(col(SubmissionRow.id))
    ids = found.with_for_update(skip_locked=True)
    statement = update(SubmissionRow).where(col(SubmissionRow.id).in_(ids))
    statement = statement.values(**values, lease_until=None).returning(*WAITING)
    return waiting(session.execute(statement, execution_options={"synchronize_session": False}))


def lease_ended(now: datetime) -> ColumnElement[bool]:
    """Return whether a claim is void. Also one for longer than any lease is: the clock was ahead when it began."""
    until = col(SubmissionRow.lease_until)
    return or_(until < now, until > now + LONGEST_PAUSE)


def bring_forward(session: Session, now: datetime) -> None:
    """Make due what waits for an instant that no pause reaches: the clock was ahead when it was queued.

    Rows that another transaction holds are left to the next time: two could wait for each other in a circle.
    """
    row = SubmissionRow
    ahead = or_(col(row.tries) == 0, col(row.not_before) > now + LONGEST_PAUSE)
    waits = col(row.state) == SubmissionState.QUEUED.value
    found = select(col(row.id)).where(waits, col(row.not_before) > now, ahead)
    ids = found.with_for_update(skip_locked=True)
    statement = update(row).where(col(row.id).in_(ids)).values(not_before=now)
    session.execute(statement, execution_options={"synchronize_session": False})


def found(session: Session, claim: Claim) -> list[Waiting]:
    """Return the claimed row as what is to be announced, now that it waits again."""
    return waiting(session.execute(select(*WAITING).where(col(SubmissionRow.id) == claim.submission_id)))


def waiting(rows: Iterable[Any]) -> list[Waiting]:
    """Return rows of `WAITING` as what is to be announced."""
    return [Waiting(submission_id=row[0], attempt=row[1], priority=row[2], due_at=row[3]) for row in rows]
