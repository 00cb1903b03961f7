"""The audit log: every change of a grade or a setting, written in the transaction that makes the change."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import select
from sqlmodel import Session, col

from grader.contracts.errors import RefusedError
from grader.contracts.identity import AuditEntry, no_course
from grader.store.database import StorePart
from grader.store.tables import AuditRow, CourseRow, as_contract

IN_ARCHIVE = frozenset({
    "course.archive", "course.copy", "course.retain", "course.reopen", "member.forget", "signin.bind",
    "signin.unbind", "platform.remove", "token.issue", "token.revoke",
    "webhook.remove",
})  # fmt: skip
"""Actions that an archived course allows. Every other action would change what the archive keeps."""


@dataclass(frozen=True, slots=True)
class Signature:
    """Who changes something in a course, and when."""

    at: datetime
    course: str | None
    actor: str

    def in_course(self) -> str:
        """Return the course. Raises CourseError: there is none."""
        if self.course is None:
            raise no_course()
        return self.course


class AuditLog(StorePart):
    """Reads the log; safe to share between threads."""

    def entries(self, course: str | None, limit: int, before_id: int | None = None) -> tuple[AuditEntry, ...]:
        """Return at most `limit` entries of a course, newest first; only those older than `before_id`."""
        statement = select(AuditRow).where(col(AuditRow.course) == course)
        if before_id is not None:
            statement = statement.where(col(AuditRow.id) < before_id)
        newest_first = statement.order_by(col(AuditRow.id).desc()).limit(limit)
        return tuple(_entry(row) for row in self._scalars(newest_first))


def record(  # noqa: PLR0913
    session: Session,
    signed: Signature,
    action: str,
    subject: str,
    *,
    before: object = None,
    after: object = None,
    reason: str = "",
) -> None:
    """Add an entry in the transaction of `session`; `before` and `after` are JSON-ready data.

    Raises RefusedError: the course is archived, and `action` would change what the archive keeps.
    """
    _require_allowed(session, signed, action)
    session.add(_row(signed, action, subject, before, after, reason))


def record_all(session: Session, signed: Signature, action: str, afters: Mapping[str, object]) -> None:
    """Add an entry, as `record` does, for each subject of `afters`, with what it was made."""
    _require_allowed(session, signed, action)
    session.add_all(_row(signed, action, subject, None, after, "") for subject, after in afters.items())


def _require_allowed(session: Session, signed: Signature, action: str) -> None:
    if action not in IN_ARCHIVE:
        require_open(session, signed.course)


def _row(  # noqa: PLR0913, PLR0917
    signed: Signature, action: str, subject: str, before: object, after: object, reason: str
) -> AuditRow:
    return AuditRow(
        at=signed.at,
        course=signed.course,
        actor=signed.actor,
        action=action,
        subject=subject,
        before=json.dumps(before, ensure_ascii=False, sort_keys=True),
        after=json.dumps(after, ensure_ascii=False, sort_keys=True),
        reason=reason,
    )


def require_open(session: Session, course: str | None) -> None:
    """Require that a course may be changed. Until the transaction ends nobody can archive it.

    Raises RefusedError: the course is archived.
    """
    held = {"read": True, "key_share": True}
    row = None if course is None else session.get(CourseRow, course, with_for_update=held)
    if row is not None and row.archived_at is not None:
        raise RefusedError.saying(
            "course_archived",
            zh=f"课程 {course} 已归档，只能查看；要修改请先取消归档。",
            en=f"Course {course} is archived and can only be read; reopen it to change something.",
        )


def _entry(row: AuditRow) -> AuditEntry:
    return as_contract(row, AuditEntry, before=json.loads(row.before), after=json.loads(row.after))
