"""Erasing submissions with all that belongs to them: of one person, or of a course from before an instant.

What is erased is named by the tables themselves: every row that names a submission goes, and every source that
nothing names any more. SQLite writes zeros over it (`grader.store.database`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, delete, exists, func, or_, select, update
from sqlmodel import Session, SQLModel, col

from grader.contracts.submission import SubmissionState
from grader.store.database import in_lots
from grader.store.tables import (
    AuditRow,
    GradingRow,
    JudgementRow,
    SourceRow,
    SubmissionRow,
    TrajectoryRow,
    table_of,
)

AT_ONCE = 200
"""Submissions erased by one statement, and in one transaction where there are more."""

_NOTHING = "null"
_FINAL_STATES = (SubmissionState.GRADED.value, SubmissionState.INFRASTRUCTURE_ERROR.value)


@dataclass(frozen=True, slots=True, kw_only=True)
class Space:
    """How many submissions there are, trial gradings included, and how many bytes are stored of them."""

    submissions: int = 0
    sources_bytes: int = 0
    reports_bytes: int = 0
    trajectories_bytes: int = 0

    @property
    def all_bytes(self) -> int:
        """Return what they take together; rows and indexes come on top."""
        return self.sources_bytes + self.reports_bytes + self.trajectories_bytes


def space_of(session: Session, *which: ColumnElement[bool]) -> dict[str | None, Space]:
    """Add up by course what is stored of the submissions `which`; one source of several courses counts in each."""
    row, course = SubmissionRow, col(SubmissionRow.course)
    used = select(course, col(row.source_sha256)).where(*which).distinct().subquery()
    sources = (
        select(used.c.course, func.sum(func.length(col(SourceRow.content))))
        .join_from(used, SourceRow, col(SourceRow.sha256) == used.c.source_sha256)
        .group_by(used.c.course)
    )
    counted = select(course, func.count()).where(*which).group_by(course)
    reports = _lengths(GradingRow, col(GradingRow.submission_id), col(GradingRow.report), which)
    paths = _lengths(TrajectoryRow, col(TrajectoryRow.submission_id), col(TrajectoryRow.content), which)
    rows = [
        {key: int(number or 0) for key, number in session.execute(statement)}
        for statement in (counted, sources, reports, paths)
    ]
    return {
        key: Space(
            submissions=number,
            sources_bytes=rows[1].get(key, 0),
            reports_bytes=rows[2].get(key, 0),
            trajectories_bytes=rows[3].get(key, 0),
        )
        for key, number in rows[0].items()
    }


def finished_before(instant: datetime, course: str | None) -> tuple[ColumnElement[bool], ...]:
    """Return the conditions that a submission of a course (None: any) arrived before an instant and has ended."""
    row = SubmissionRow
    old = (
        col(row.regrade).is_(None),
        col(row.received_at) < instant,
        col(row.state).in_(_FINAL_STATES),
        col(row.course).is_not(None),
    )
    return old if course is None else (*old, col(row.course) == course)


def erase(session: Session, submissions: Sequence[str]) -> None:
    """Delete submissions with their trials, gradings, judgements, comments and sources.

    Entries of the audit log about them stay, but say no more than who did what to which id, and when.
    """
    for some in in_lots(submissions, AT_ONCE):
        _erase(session, some)


def _erase(session: Session, named: Sequence[str]) -> None:
    row = SubmissionRow
    # Whatever is being written about them is there afterwards, or fails.
    _hold(session, col(row.id).in_(named))
    trials = _hold(session, col(row.original).in_(named))
    ids = [*named, *trials]
    sources = set(session.execute(select(col(row.source_sha256)).where(col(row.id).in_(ids))).scalars())
    for table in reversed(SQLModel.metadata.sorted_tables):
        if "submission_id" in table.c:
            session.execute(delete(table).where(table.c.submission_id.in_(ids)))
    for of in (trials, named):  # a trial refers to its original
        session.execute(delete(SubmissionRow).where(col(row.id).in_(of)))
    held = (
        select(col(SourceRow.sha256))
        .where(col(SourceRow.sha256).in_(sources))
        .order_by(col(SourceRow.sha256))
    )
    session.execute(held.with_for_update()).all()  # who hands in the same right now names it afterwards
    session.execute(delete(SourceRow).where(col(SourceRow.sha256).in_(sources), ~_named_source()))
    about = or_(*(col(AuditRow.subject).startswith(f"submission {id_}", autoescape=True) for id_ in named))
    blank = {"before": _NOTHING, "after": _NOTHING, "reason": ""}
    session.execute(update(AuditRow).where(about).values(blank))


def _hold(session: Session, *which: ColumnElement[bool]) -> list[str]:
    """Lock submissions and return their ids: what refers to them is written before, or not at all."""
    in_order = select(col(SubmissionRow.id)).where(*which).order_by(col(SubmissionRow.id))
    return list(session.execute(in_order.with_for_update()).scalars())


def _named_source() -> ColumnElement[bool]:
    return or_(
        *(
            exists().where(col(table.source_sha256) == col(SourceRow.sha256))
            for table in (SubmissionRow, JudgementRow)
        )
    )


def ids_of(session: Session, *which: ColumnElement[bool]) -> list[str]:
    """Return the ids of submissions in order of arrival."""
    row = SubmissionRow
    return list(session.execute(select(col(row.id)).where(*which).order_by(col(row.id))).scalars())


def _lengths(
    of: type[SQLModel], submission: Any, content: Any, which: tuple[ColumnElement[bool], ...]
) -> Any:
    course = col(SubmissionRow.course)
    return (
        select(course, func.sum(func.length(content)))
        .join_from(table_of(of), SubmissionRow, col(SubmissionRow.id) == submission)
        .where(*which)
        .group_by(course)
    )
