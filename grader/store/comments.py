"""Comments on submissions: written by staff and by the student, each side told what it has not seen yet."""

from datetime import datetime

from sqlalchemy import ColumnElement, func, select, update
from sqlmodel import Session, col

from grader.contracts.comment import MOST_COMMENTS, Comment
from grader.store.audit import Signature, require_open
from grader.store.courses import in_class
from grader.store.database import StorePart
from grader.store.tables import CommentRow, SubmissionRow, as_contract
from grader.store.teams import locked_upload


class Comments(StorePart):
    """Keeps comments; safe to share between threads."""

    def add(
        self, submission_id: str, text: str, line: int | None, signed: Signature, *, by_student: bool
    ) -> Comment | None:
        """Add a comment to a submission, and to those of the student's team.

        Nothing is added, and None returned, when there are `MOST_COMMENTS`.

        Raises RefusedError: the course is archived.
        """
        with self._database.writing() as session:
            require_open(session, signed.course)
            _, mates = locked_upload(session, submission_id)  # one number after the other
            comment = _added(session, submission_id, text, line, signed, by_student=by_student)
            for mate in mates if comment is not None else ():
                copied = _added(session, mate.id, text, line, signed, by_student=by_student)
                if copied is not None and by_student:  # staff is told once
                    copied.seen_at = signed.at
            return None if comment is None else _comment(comment)

    def of(self, submission_id: str) -> tuple[Comment, ...]:
        """Return the comments on a submission, oldest first."""
        with self._database.reading() as session:
            return _of(session, submission_id)

    def mark_seen(self, submission_id: str, now: datetime, *, by_student: bool) -> None:
        """Note that the student (else: somebody of the staff) has seen what the other side wrote."""
        with self._database.writing() as session:
            session.execute(
                update(CommentRow)
                .where(
                    col(CommentRow.submission_id) == submission_id,
                    col(CommentRow.by_student).is_(not by_student),
                    col(CommentRow.seen_at).is_(None),
                )
                .values(seen_at=now)
            )

    def unseen_by_student(self, course: str, student: str) -> dict[str, int]:
        """Count by submission what staff wrote to a student who has not seen it; the oldest submission first."""
        submission = (col(SubmissionRow.course) == course, col(SubmissionRow.student) == student)
        return self._unseen(*submission, by_student=False)

    def unseen_by_staff(self, course: str, students: frozenset[str] | None = None) -> dict[str, int]:
        """Count by submission what a class wrote and nobody of the staff has seen; the oldest submission first.

        With `students`: only what these wrote.
        """
        return self._unseen(in_class(course, students), by_student=True)

    def _unseen(self, *of: ColumnElement[bool], by_student: bool) -> dict[str, int]:
        count = func.count()
        statement = (
            select(col(CommentRow.submission_id), count)
            .join(SubmissionRow, col(SubmissionRow.id) == col(CommentRow.submission_id))
            .where(*of, col(CommentRow.seen_at).is_(None), col(CommentRow.by_student).is_(by_student))
            .group_by(col(CommentRow.submission_id))
            .order_by(col(CommentRow.submission_id))
        )
        return {row[0]: row[1] for row in self._rows(statement)}


def _added(  # noqa: PLR0913
    session: Session, submission_id: str, text: str, line: int | None, signed: Signature, *, by_student: bool
) -> CommentRow | None:
    last = session.execute(
        select(func.max(col(CommentRow.number))).where(col(CommentRow.submission_id) == submission_id)
    ).scalar_one()
    number = 1 + (last or 0)
    if number > MOST_COMMENTS:
        return None
    row = CommentRow(
        submission_id=submission_id,
        number=number,
        written_by=signed.actor,
        by_student=by_student,
        line=line,
        text=text,
        written_at=signed.at,
    )
    session.add(row)
    return row


def _of(session: Session, submission_id: str) -> tuple[Comment, ...]:
    own = select(CommentRow).where(col(CommentRow.submission_id) == submission_id)
    rows = session.execute(own.order_by(col(CommentRow.number))).scalars()
    return tuple(_comment(row) for row in rows)


def _comment(row: CommentRow) -> Comment:
    others = {"submission": row.submission_id, "by": row.written_by, "at": row.written_at}
    return as_contract(row, Comment, **others, seen=row.seen_at is not None)
