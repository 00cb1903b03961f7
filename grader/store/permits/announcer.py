"""Permits as jobs of Procrastinate: how rows get theirs, and the sweep that keeps both in step."""

from collections.abc import Sequence
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import (
    BigInteger,
    ColumnElement,
    DateTime,
    Integer,
    SQLColumnExpression,
    String,
    bindparam,
    column,
    delete,
    func,
    literal,
    select,
    table,
    text,
)
from sqlalchemy.dialects.postgresql import JSONB, insert
from sqlmodel import Session, col

from grader.contracts.submission import Claim, SubmissionState
from grader.store.tables import SubmissionRow
from grader.store.work import Announcement

QUEUE = "grading"
TASK = "grade"
_LOCK = "sub"

JOBS = table(
    "procrastinate_jobs",
    column("id", BigInteger),
    column("queue_name", String),
    column("task_name", String),
    column("priority", Integer),
    column("queueing_lock", String),
    column("args", JSONB),
    column("status"),
    column("scheduled_at", DateTime(timezone=True)),
)
_NEW = insert(JOBS)
_DEFER = _NEW.on_conflict_do_update(
    index_elements=["queueing_lock"],
    index_where=text("status = 'todo'"),
    set_={"scheduled_at": _NEW.excluded.scheduled_at},
)
_LATE_S = 5.0  # a row due for so long should have met a permit, if permits are not scarce
_SILENT_S = 10.0  # workers tell Procrastinate that they live every two seconds
_STUCK_S = 600.0  # no grading takes so long: its job could not be ended when the database was away
_AGAIN_S = 0.2
_AT_ONCE = 1_000
_SWEEP_KEY = 0x67726164  # of the advisory lock: one sweep at a time
_LEFT_OVER = text(  # SKIP LOCKED: another process may be deleting the same jobs at this moment
    "DELETE FROM procrastinate_jobs WHERE id IN (SELECT job.id FROM procrastinate_jobs AS job"
    " WHERE job.queue_name = :queue AND job.status <> 'todo' AND ("
    " job.status <> 'doing' OR job.worker_id IS NULL"
    " OR EXISTS (SELECT FROM procrastinate_workers AS worker WHERE worker.id = job.worker_id"
    "  AND worker.last_heartbeat < now() - make_interval(secs => :silent_s))"
    " OR NOT EXISTS (SELECT FROM procrastinate_events AS event WHERE event.job_id = job.id"
    "  AND event.type = 'started' AND event.at > now() - make_interval(secs => :stuck_s)))"
    " ORDER BY job.id FOR UPDATE SKIP LOCKED)"
)
_PERMITS = text(
    "SELECT count(*) FROM (SELECT FROM procrastinate_jobs WHERE queue_name = :queue AND status = 'todo'"
    " AND (scheduled_at IS NULL OR scheduled_at <= :now) LIMIT :most) AS permit"
)
_TODO = JOBS.c.status == text("'todo'")


def lock_of(submission_id: str, attempt: int) -> str:
    """Return the queueing lock of a permit, which at most one waiting job can have.

    It contains `attempt`, because a row that is queued again needs another permit. Its first one may still wait,
    if the slot that claimed the row came with another row's permit, and there must be as many permits as waiting
    rows.
    """
    return f"{_LOCK}-{submission_id}-{attempt}"


def lock_of_row() -> ColumnElement[str]:
    """Return `lock_of` as an expression over the columns of `SubmissionRow`."""
    return _lock_of(col(SubmissionRow.id), col(SubmissionRow.attempt))


def _lock_of(id_: SQLColumnExpression[str], attempt: SQLColumnExpression[int]) -> ColumnElement[str]:
    return func.concat(f"{_LOCK}-", id_, "-", attempt)


def defer(session: Session, announcements: Sequence[Announcement], now: datetime) -> None:
    """Defer a permit for each announcement in the transaction of `session`; move a permit that is there already.

    Procrastinate's own function fails as a whole where one permit is there.
    """
    if announcements:
        session.connection().execute(_DEFER, [_values(one, now) for one in announcements])


def _values(announced: Announcement, now: datetime) -> dict[str, Any]:
    return {
        "queue_name": QUEUE,
        "task_name": TASK,
        "args": {"submission": announced.submission_id, "attempt": announced.attempt},
        "priority": -announced.priority,  # Procrastinate's larger numbers go first
        "queueing_lock": lock_of(announced.submission_id, announced.attempt),
        "scheduled_at": announced.due_at if announced.due_at > now else None,
    }


_WAITING_FOR = select(JOBS.c.id).where(JOBS.c.queueing_lock == bindparam("lock", type_=String), _TODO)
_USE_UP = delete(JOBS).where(JOBS.c.id == _WAITING_FOR.with_for_update(skip_locked=True).scalar_subquery())


class PermitAnnouncer:
    """Announces a row by a job of Procrastinate."""

    def queued(self, session: Session, announcements: Sequence[Announcement], now: datetime) -> None:
        """Defer a permit for each row."""
        defer(session, announcements, now)

    def claimed(self, session: Session, claim: Claim) -> None:
        """Use up the row's own permit, unless somebody took it already, or is doing so at this moment.

        Whoever took it claimed another row or found nothing, so there are never fewer permits than waiting rows.
        """
        session.execute(_USE_UP, {"lock": lock_of(claim.submission_id, claim.attempt - 1)})

    def mend(self, session: Session, now: datetime) -> int:
        """Sweep, unless another worker does so at this moment.

        Jobs that nobody runs any more are deleted. Their rows wait, and count as late after a while, or run under
        a lease, which ends. If there are fewer permits than late rows, the first of these get theirs. Both are
        counted up to a thousand: that many permits keep the workers busy until a later sweep. No look at all rows
        is made to find those without a permit, because it does not matter whose permits they are.
        """
        if not session.execute(select(func.pg_try_advisory_xact_lock(_SWEEP_KEY))).scalar_one():
            return 0
        left_over = {"queue": QUEUE, "silent_s": _SILENT_S, "stuck_s": _STUCK_S}
        session.execute(_LEFT_OVER, left_over)
        some = select(col(SubmissionRow.id)).where(*_late(now)).limit(_AT_ONCE).subquery()
        count = session.execute(select(func.count()).select_from(some)).scalar_one()
        permits = session.execute(_PERMITS, {"queue": QUEUE, "now": now, "most": _AT_ONCE}).scalar_one()
        return _permits_for_first(session, now) if count > permits else 0


def _permits_for_first(session: Session, now: datetime) -> int:
    """Give each of the first late rows a permit that can be taken; return how many had none."""
    row = SubmissionRow
    args = func.jsonb_build_object("submission", col(row.id), "attempt", col(row.attempt))
    first = (
        select(literal(QUEUE), literal(TASK), args, -col(row.priority), lock_of_row())
        .where(*_late(now))
        .order_by(col(row.priority), col(row.turn_at), col(row.id))
        .limit(_AT_ONCE)
    )
    columns = ["queue_name", "task_name", "args", "priority", "queueing_lock"]
    given = (
        insert(JOBS)
        .from_select(columns, first)
        .on_conflict_do_update(
            index_elements=["queueing_lock"],
            index_where=text("status = 'todo'"),
            set_={"scheduled_at": None},
            where=JOBS.c.scheduled_at > now,  # from a time when the clock was ahead
        )
    )
    return len(session.execute(given.returning(JOBS.c.id)).all())


def defer_again(session: Session, submission_id: str, attempt: int, now: datetime) -> None:
    """Give an unused permit of a row back if that row, or any other, waits.

    It is unused if its worker stops, if the worker's clock lags behind that of the process that queued the row, or
    if another transaction held the row.
    """
    soon = now + timedelta(seconds=_AGAIN_S)
    row = session.get(SubmissionRow, submission_id)
    waits = col(SubmissionRow.state) == SubmissionState.QUEUED.value
    if row is not None and row.state == SubmissionState.QUEUED.value and row.attempt == attempt:
        priority, due_at = row.priority, max(row.not_before, soon)
    elif session.execute(
        select(col(SubmissionRow.id)).where(waits, col(SubmissionRow.not_before) <= now)
    ).first():
        priority, due_at = 0, soon
    else:
        return
    again = Announcement(submission_id=submission_id, attempt=attempt, priority=priority, due_at=due_at)
    defer(session, [again], now)


def _late(now: datetime) -> tuple[ColumnElement[bool], ...]:
    return (
        col(SubmissionRow.state) == SubmissionState.QUEUED.value,
        col(SubmissionRow.not_before) <= now - timedelta(seconds=_LATE_S),
    )
