"""Appeals: students ask for another look at a rubric item, staff answer. Every step is in the audit log."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, Select, case, exists, func, literal, select, update
from sqlmodel import Session, col

from grader.contracts.appeal import ANSWERS, Appeal, AppealState
from grader.contracts.errors import RefusedError
from grader.store.audit import Signature, record
from grader.store.courses import in_class
from grader.store.database import StorePart
from grader.store.tables import AppealRow, SectionRow, SubmissionRow, as_contract

_ANSWERED = [state.value for state in ANSWERS]


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """What a student asks: about which item, why, and what that item had in which grading."""

    item: str
    reason: str
    attempt: int
    earned: float
    points: float


@dataclass(frozen=True, slots=True, kw_only=True)
class AppealsWanted:
    """Which appeals of a class are meant.

    Attributes:
        open: those that wait, else those that were answered.
        students: only theirs; None: everybody's.
    """

    open: bool = True
    assignment: str | None = None
    section: str | None = None
    students: frozenset[str] | None = None


class Appeals(StorePart):
    """Keeps appeals; safe to share between threads."""

    def ask(self, submission_id: str, asked: Asked, signed: Signature) -> Appeal:
        """Store an appeal about an item of a submission; it replaces one that was withdrawn.

        Raises RefusedError: there is one about this item, or the submission was erased.
        """
        with self._database.writing() as session:
            submission = session.get(SubmissionRow, submission_id, with_for_update=True)
            if submission is None:
                raise RefusedError("appeal_not_found")
            row = session.get(AppealRow, (submission_id, asked.item))
            if row is not None and row.state != AppealState.WITHDRAWN.value:
                raise RefusedError("appeal_exists", field="item")
            row = session.merge(
                AppealRow(
                    submission_id=submission_id,
                    item=asked.item,
                    reason=asked.reason,
                    made_at=signed.at,
                    attempt=asked.attempt,
                    earned=asked.earned,
                    points=asked.points,
                    state=AppealState.OPEN.value,
                )
            )
            _record(session, signed, "make", row, after={"comment": asked.reason})
            return _appeal(row, submission)

    def withdraw(self, submission_id: str, item: str, signed: Signature) -> None:
        """Take an open appeal back. Raises RefusedError: there is none, or it is not open any more."""
        with self._database.writing() as session:
            row = _open_one(session, submission_id, item)
            row.state = AppealState.WITHDRAWN.value
            _record(session, signed, "withdraw", row)

    def pass_on(self, submission_id: str, item: str, note: str, signed: Signature) -> None:
        """Leave an open appeal to the instructors. Raises as `withdraw`."""
        with self._database.writing() as session:
            row = _open_one(session, submission_id, item)
            row.passed_on_by, row.note = signed.actor, note
            _record(session, signed, "pass_on", row, after={"comment": note})

    def answer(self, submission_id: str, item: str, state: AppealState, text: str, signed: Signature) -> None:
        """Answer an open appeal, leaving the points as they are. Raises as `withdraw`."""
        with self._database.writing() as session:
            _answer(session, _open_one(session, submission_id, item), state, text, signed)

    def of(self, submission_id: str) -> tuple[Appeal, ...]:
        """Return the appeals about a submission, in order of their items."""
        own = _with_submission().where(col(AppealRow.submission_id) == submission_id)
        return self._read(own.order_by(col(AppealRow.item)))

    def listed(
        self, course: str | None, wanted: AppealsWanted, offset: int, limit: int
    ) -> tuple[Appeal, ...]:
        """Return at most `limit` appeals of a class: open ones oldest first, answered ones latest first.

        Open ones that were passed on come before the others.
        """
        when = col(AppealRow.made_at) if wanted.open else col(AppealRow.answered_at).desc()
        others = case((col(AppealRow.passed_on_by) == "", 1), else_=0) if wanted.open else literal(0)
        order = (others, when, col(AppealRow.submission_id), col(AppealRow.item))
        of_class = _with_submission().where(*_fitting(course, wanted))
        return self._read(of_class.order_by(*order).offset(offset).limit(limit))

    def count(self, course: str | None, wanted: AppealsWanted) -> int:
        """Return how many appeals `listed` has in all."""
        statement = _joined(func.count()).where(*_fitting(course, wanted))
        return int(self._scalars(statement)[0])

    def of_student(self, course: str, student: str) -> tuple[Appeal, ...]:
        """Return what a student asked that is open, or whose answer the student has not seen; oldest first."""
        news = (col(AppealRow.state) == AppealState.OPEN.value) | (
            col(AppealRow.state).in_(_ANSWERED) & col(AppealRow.seen_at).is_(None)
        )
        theirs = (col(SubmissionRow.course) == course, col(SubmissionRow.student) == student)
        return self._read(_with_submission().where(*theirs, news).order_by(col(AppealRow.made_at)))

    def mark_seen(self, submission_id: str, items: Sequence[str], now: datetime) -> None:
        """Note that the student has seen the answers about some items of a submission."""
        with self._database.writing() as session:
            session.execute(
                update(AppealRow)
                .where(
                    col(AppealRow.submission_id) == submission_id,
                    col(AppealRow.item).in_(items),
                    col(AppealRow.state).in_(_ANSWERED),
                    col(AppealRow.seen_at).is_(None),
                )
                .values(seen_at=now)
            )

    def _read(self, statement: Select[Any]) -> tuple[Appeal, ...]:
        return tuple(_appeal(row, submission) for row, submission in self._rows(statement))


def is_open(session: Session, submission_id: str, item: str) -> bool:
    """Return whether an appeal about an item waits for an answer; nobody else answers it in this transaction."""
    return _waiting(session, submission_id, item) is not None


def answer_by_points(
    session: Session, submission_id: str, item: str, comment: str, signed: Signature
) -> None:
    """Answer the open appeal about an item, if there is one: other points were given for it."""
    row = _waiting(session, submission_id, item)
    if row is not None:
        _answer(session, row, AppealState.CORRECTED, comment, signed)


def _waiting(session: Session, submission_id: str, item: str) -> AppealRow | None:
    """Return the open appeal about an item, locked: nobody else answers it meanwhile."""
    row = session.get(AppealRow, (submission_id, item), with_for_update=True, populate_existing=True)
    return row if row is not None and row.state == AppealState.OPEN.value else None


def _answer(session: Session, row: AppealRow, state: AppealState, text: str, signed: Signature) -> None:
    row.state, row.answer = state.value, text
    row.answered_by, row.answered_at, row.seen_at = signed.actor, signed.at, None
    _record(session, signed, state.value, row, before={"comment": row.reason}, after={"comment": text})


def _record(session: Session, signed: Signature, action: str, row: AppealRow, **states: object) -> None:
    subject = f"submission {row.submission_id}, item {row.item}"
    record(session, signed, f"appeal.{action}", subject, **states)  # type: ignore[arg-type]


def _open_one(session: Session, submission_id: str, item: str) -> AppealRow:
    row = session.get(AppealRow, (submission_id, item), with_for_update=True)
    if row is None:
        raise RefusedError("appeal_not_found")
    if row.state != AppealState.OPEN.value:
        raise RefusedError("appeal_decided")
    return row


def _joined(*columns: Any) -> Select[Any]:
    return select(*columns).join_from(
        AppealRow, SubmissionRow, col(SubmissionRow.id) == col(AppealRow.submission_id)
    )


def _with_submission() -> Select[Any]:
    return _joined(AppealRow, SubmissionRow)


def _fitting(course: str | None, wanted: AppealsWanted) -> list[ColumnElement[bool]]:
    states = [AppealState.OPEN.value] if wanted.open else _ANSWERED
    conditions = [in_class(course, wanted.students), col(AppealRow.state).in_(states)]
    if wanted.assignment is not None:
        conditions.append(col(SubmissionRow.assignment) == wanted.assignment)
    if wanted.section is not None:
        section = SectionRow
        theirs = (
            col(section.course) == col(SubmissionRow.course),
            col(section.person) == col(SubmissionRow.student),
        )
        conditions.append(exists().where(*theirs, col(section.section) == wanted.section))
    return conditions


def _appeal(row: AppealRow, submission: SubmissionRow) -> Appeal:
    return as_contract(
        row,
        Appeal,
        submission=row.submission_id,
        student=submission.student,
        assignment=submission.assignment,
        state=AppealState(row.state),
        seen=row.seen_at is not None,
    )
