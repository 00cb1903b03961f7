"""Statements about the rows of the queue, of which `grader.store.queue` makes its transactions."""

from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, CursorResult, Select, select, update
from sqlmodel import Session, col

from grader.contracts.submission import Claim, SubmissionState
from grader.store.announcing import Waiting
from grader.store.tables import GradingRow, SubmissionRow

WAITING = (
    col(SubmissionRow.id),
    col(SubmissionRow.attempt),
    col(SubmissionRow.priority),
    col(SubmissionRow.not_before),
)
"""The columns that `waiting` takes."""


def due(now: datetime) -> Select[str]:
    """The submission to grade next: by priority, then by turn."""
    return (
        select(col(SubmissionRow.id))
        .where(
            col(SubmissionRow.state) == SubmissionState.QUEUED.value,
            col(SubmissionRow.not_before) <= now,
        )
        .order_by(col(SubmissionRow.priority), col(SubmissionRow.turn_at), col(SubmissionRow.id))
        .limit(1)
    )


def change(session: Session, claim: Claim, values: Mapping[str, Any]) -> bool:
    """Write `values` to the claimed row if the claim is still the latest: the fence."""
    valid = (
        col(SubmissionRow.id) == claim.submission_id,
        col(SubmissionRow.attempt) == claim.attempt,
        col(SubmissionRow.state) == SubmissionState.RUNNING.value,
    )
    return _update(session, valid, values) == 1


def stored_already(session: Session, grading: GradingRow) -> bool:
    """Whether `grading` was stored under this very claim: the answer to an earlier commit got lost."""
    there = session.get(GradingRow, (grading.submission_id, grading.attempt))
    return there is not None and (there.worker, there.report_sha256) == (
        grading.worker,
        grading.report_sha256,
    )


def void(
    session: Session, condition: Sequence[ColumnElement[bool]], now: datetime, state: SubmissionState
) -> list[Waiting]:
    """Move running rows to `state` because nobody grades them any more; return them.

    Rows that another transaction holds are left out: somebody still does something about them.
    """
    ended = state is SubmissionState.INFRASTRUCTURE_ERROR
    values = {
        "state": state.value,
        "not_before": now,
        "finished_at": now if ended else None,
        "lease_until": None,
        "trouble": "the worker that graded this stopped without an answer",
    }
    found = select(col(SubmissionRow.id)).where(*condition).order_by(col(SubmissionRow.id))
    ids = found.with_for_update(skip_locked=True)
    statement = update(SubmissionRow).where(col(SubmissionRow.id).in_(ids)).values(**values)
    unsynchronized = {"synchronize_session": False}
    return waiting(session.execute(statement.returning(*WAITING), execution_options=unsynchronized))


def waiting(rows: Iterable[Any]) -> list[Waiting]:
    """Return rows of `WAITING` as what is to be announced."""
    return [Waiting(submission_id=row[0], attempt=row[1], priority=row[2], due_at=row[3]) for row in rows]


def _update(session: Session, condition: Sequence[ColumnElement[bool]], values: Mapping[str, Any]) -> int:
    statement = update(SubmissionRow).where(*condition).values(**values)
    result = session.execute(statement, execution_options={"synchronize_session": False})
    assert isinstance(result, CursorResult)
    return result.rowcount
