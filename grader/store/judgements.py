"""Points that people give for rubric items or correct, and the list of what still waits for them.

Judgements are rows of their own and stand beside the report, which never changes. The score and the verdict of the
submission's row follow from both; see `settle`.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, Select, and_, case, exists, func, or_, select
from sqlalchemy.orm import aliased
from sqlmodel import Session, col

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Seen
from grader.contracts.judgement import composed, standing
from grader.contracts.notation import written
from grader.contracts.report import GradeReport, report_from
from grader.contracts.rubric import ItemStatus, RubricItem, to_judge
from grader.contracts.submission import Judgement
from grader.contracts.text import Text
from grader.store import appeals
from grader.store.audit import Signature, record
from grader.store.courses import in_class
from grader.store.database import StorePart
from grader.store.tables import GradedItemRow, GradingRow, JudgementRow, SubmissionRow, as_contract
from grader.store.teams import locked_upload

_REASON = Text(
    zh="修改自动评分给的分，或者有复核申请等待答复时，要写原因，学生会看到。",
    en="Say why, where a machine's points are changed or an appeal waits for an answer; the student sees it.",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Given:
    """What somebody gives for an item. `points` were checked to be a finite number and no more.

    Attributes:
        corrects: whether they may change what the machine judged, too. That needs a `comment`; the machine's own
            points take earlier corrections back.
        answers: whether they are the answer to an appeal, which must be open then.
    """

    item: str
    points: float
    comment: str
    corrects: bool = False
    answers: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Waiting:
    """One rubric item of one submission that waits for a person."""

    submission: str
    student: str
    assignment: str
    item: str
    points: float
    received_at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class WaitingFor:
    """Which waiting items are meant.

    Attributes:
        newest: of each student's submissions to an assignment the newest only.
        students: only theirs; None: everybody's.
    """

    assignment: str | None = None
    item: str | None = None
    newest: bool = True
    students: frozenset[str] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Neighbours:
    """Submissions that wait around one in order of arrival.

    After the last comes the first, so that nothing that was passed over is forgotten.

    Attributes:
        previous: None before the first. next: None when no other waits. waiting: how many wait in all.
    """

    previous: str | None
    next: str | None
    waiting: int


class Judgements(StorePart):
    """Takes and shows judgements; every one is in the audit log. Safe to share between threads."""

    def judge_all(
        self, submission_id: str, wanted: Sequence[tuple[Given, Seen | None]], signed: Signature
    ) -> None:
        """Add judgements, and the submission's score and verdict with them, all in one transaction or none.

        Other submissions of the same upload get the same, as far as they are graded.

        Each answers the open appeal about its item, if there is one.

        Args:
            submission_id: of the course of `signed`.
            wanted: the points, each with the states of its item, by their `tag`, that are meant; None: nobody had
                judged the item then.
            signed: who gives them.

        Raises:
            RefusedError: there is no such grading or item; the machine judged the item and they may not correct
                that; the points are below 0 or above the item's, or the machine's own without a correction before;
                a comment is missing; or somebody judged or graded it meanwhile. Nothing is changed.
        """
        with self._database.writing() as session:
            row, mates = locked_upload(session, submission_id)
            report = None if row is None or row.course != signed.course else report_of(session, row)
            if row is None or report is None or row.regrade is not None:  # a trial is nobody's to judge
                raise RefusedError("submission_not_found")
            for given, seen in wanted:
                _judge(session, row, _item(report, given), given, seen, signed)
            for mate in mates:
                _judge_too(session, mate, [given for given, _ in wanted], signed)

    def waiting(self, course: str | None, which: WaitingFor, offset: int, limit: int) -> tuple[Waiting, ...]:
        """Return what waits for a person, question by question, each in order of arrival."""
        item, submission = GradedItemRow, SubmissionRow
        columns = (
            col(submission.id),
            col(submission.student),
            col(submission.assignment),
            col(item.item),
            col(item.points),
            col(submission.received_at),
        )
        order = (
            col(submission.assignment),
            col(item.item),
            col(submission.received_at),
            col(submission.id),
        )
        statement = _waiting(columns, course, which).order_by(*order).offset(offset).limit(limit)
        names = ("submission", "student", "assignment", "item", "points", "received_at")
        return tuple(Waiting(**dict(zip(names, row, strict=True))) for row in self._rows(statement))

    def around(
        self, course: str | None, which: WaitingFor, submission_id: str, received_at: datetime
    ) -> Neighbours:
        """Return what waits before and after a submission, which need not wait itself any more."""
        received, id_ = col(SubmissionRow.received_at), col(SubmissionRow.id)
        before = or_(received < received_at, and_(received == received_at, id_ < submission_id))
        others = _waiting((id_,), course, which).where(id_ != submission_id)
        backwards = others.where(before).order_by(received.desc(), id_.desc()).limit(1)
        onwards = others.order_by(case((before, 1), else_=0), received, id_).limit(1)
        count = _waiting((func.count(func.distinct(id_)),), course, which)
        with self._database.reading() as session:
            return Neighbours(
                previous=session.execute(backwards).scalar(),
                next=session.execute(onwards).scalar(),
                waiting=session.execute(count).scalar_one(),
            )

    def questions(self, course: str | None, which: WaitingFor) -> dict[tuple[str, str], int]:
        """Return how much waits, by assignment and rubric item, in the order of `waiting`."""
        key = (col(SubmissionRow.assignment), col(GradedItemRow.item))
        statement = _waiting((*key, func.count()), course, which).group_by(*key).order_by(*key)
        return {(row[0], row[1]): row[2] for row in self._rows(statement)}


def tag(latest: Judgement | None, report_sha256: str | None) -> str:
    """Return what names the state of an item: its latest judgement, and the report that was judged."""
    revision = 0 if latest is None else latest.revision
    return f"{revision}.{(report_sha256 or '')[:16]}"


def _judge(  # noqa: PLR0913, PLR0917
    session: Session, row: SubmissionRow, item: RubricItem, given: Given, seen: Seen | None, signed: Signature
) -> None:
    own = [one for one in judgements_of(session, [row.id]) if one.item == item.id]
    latest = own[-1] if own else None
    if not (latest is None if seen is None else seen.includes(tag(latest, row.report_sha256))):
        raise RefusedError("judged_meanwhile")
    if _takes_back(item, given) and (latest is None or latest.out_of == 0.0):
        raise RefusedError("points_unchanged")
    if given.answers and not appeals.is_open(session, row.id, item.id):
        raise RefusedError("judged_meanwhile")  # and the appeal with it
    if not given.comment.strip() and appeals.is_open(session, row.id, item.id):
        raise RefusedError("invalid_request", _REASON, field="comment")
    before = _counting(item, own)
    if before is not None:
        before["score"] = row.score
    session.add(_row(row, item, given, signed, 1 if latest is None else latest.revision + 1))
    session.flush()
    settle(session, row)
    after = {**_plain(given.points, given.comment), "score": row.score}
    subject = f"submission {row.id}, item {item.id}"
    record(session, signed, "grade.judge", subject, before=before, after=after)
    appeals.answer_by_points(session, row.id, item.id, given.comment, signed)


def _judge_too(session: Session, row: SubmissionRow, wanted: Sequence[Given], signed: Signature) -> None:
    """Give a submission of the same upload the same points, as far as it is graded and takes them."""
    report = report_of(session, row)
    if report is None:
        return
    for given in wanted:
        with suppress(RefusedError):  # theirs has been judged otherwise
            _judge(session, row, _item(report, given), replace(given, answers=False), Seen(None), signed)


def _item(report: GradeReport, given: Given) -> RubricItem:
    """Return the item that points are given for, once it is sure that they may be."""
    item = next((other for other in report.items if other.id == given.item), None)
    if item is None:
        allowed = [other.id for other in report.items if given.corrects or _is_manual(other)]
        raise RefusedError("item_not_found", field="item", allowed=allowed)
    if not (_is_manual(item) or given.corrects):
        raise RefusedError("forbidden")
    if not 0.0 <= given.points <= item.points:
        most = written(item.points)
        detail = Text(zh=f"这一项可以给 0 到 {most} 分。", en=f"This item takes points from 0 to {most}.")
        raise RefusedError("invalid_points", detail, field="points")
    if not (_is_manual(item) or given.comment.strip()):
        raise RefusedError("invalid_request", _REASON, field="comment")
    return item


def _is_manual(item: RubricItem) -> bool:
    return item.status is ItemStatus.NEEDS_MANUAL


def _takes_back(item: RubricItem, given: Given) -> bool:
    return not _is_manual(item) and given.points == item.earned


def _counting(item: RubricItem, own: Sequence[Judgement]) -> dict[str, object] | None:
    """Return what counts for an item as the audit log tells it; None while it waits for a person."""
    judgement = standing(item.id, item.points, own)
    if judgement is not None:
        return _plain(judgement.points, judgement.comment)
    return None if _is_manual(item) else _plain(item.earned, "")


def _row(
    submission: SubmissionRow, item: RubricItem, given: Given, signed: Signature, revision: int
) -> JudgementRow:
    takes_back = _takes_back(item, given)
    return JudgementRow(
        submission_id=submission.id,
        item=item.id,
        revision=revision,
        points=0.0 if takes_back else given.points,
        out_of=0.0 if takes_back else item.points,
        comment=given.comment,
        judged_by=signed.actor,
        judged_at=signed.at,
        attempt=submission.graded_attempt or 0,
        source_sha256=submission.source_sha256,
    )


def _waiting(columns: Sequence[Any], course: str | None, which: WaitingFor) -> Select[Any]:
    """Select from items that wait: of latest gradings, without a judgement out of as many points."""
    submission, item = SubmissionRow, GradedItemRow
    conditions: list[ColumnElement[bool]] = [
        in_class(course, which.students),
        col(submission.to_judge) > 0,
        col(item.status) == ItemStatus.NEEDS_MANUAL.value,
        ~_done(),
        ~_with_mates(which),
    ]
    if which.assignment is not None:
        conditions.append(col(submission.assignment) == which.assignment)
    if which.item is not None:
        conditions.append(col(item.item) == which.item)
    if which.newest:
        conditions.append(~_newer())
    return (
        select(*columns)
        .join_from(
            submission,
            item,
            and_(
                col(submission.id) == col(item.submission_id),
                col(submission.graded_attempt) == col(item.attempt),
            ),
        )
        .where(*conditions)
    )


def _done() -> ColumnElement[bool]:
    """Whether an item has a judgement out of as many points, which has not been taken back."""
    item, judgement, later = GradedItemRow, JudgementRow, aliased(JudgementRow)
    taken_back = exists().where(
        col(later.submission_id) == col(judgement.submission_id),
        col(later.item) == col(judgement.item),
        col(later.revision) > col(judgement.revision),
        col(later.out_of) == 0.0,
        col(judgement.out_of) > 0.0,
    )
    return exists().where(
        col(judgement.submission_id) == col(item.submission_id),
        col(judgement.item) == col(item.item),
        col(judgement.out_of) == col(item.points),
        ~taken_back,
    )


def _with_mates(which: WaitingFor) -> ColumnElement[bool]:
    """Whether the same upload of a team is listed as another's: points for one are points for all."""
    first, submission = aliased(SubmissionRow), SubmissionRow
    theirs = [] if which.students is None else [col(first.student).in_(which.students)]
    return exists().where(
        col(first.team_upload) == col(submission.team_upload),
        col(first.id) < col(submission.id),
        col(first.to_judge) > 0,
        *theirs,
    )


def _newer() -> ColumnElement[bool]:
    """Whether the student handed in another one later that is a person's to judge."""
    later, submission = aliased(SubmissionRow), SubmissionRow
    after = or_(
        col(later.received_at) > col(submission.received_at),
        and_(col(later.received_at) == col(submission.received_at), col(later.id) > col(submission.id)),
    )
    return exists().where(
        col(later.course).is_not_distinct_from(col(submission.course)),
        col(later.assignment) == col(submission.assignment),
        col(later.student) == col(submission.student),
        col(later.regrade).is_(None),
        col(later.to_judge).is_not(None),
        after,
    )


def _plain(points: float, comment: str) -> dict[str, object]:
    return {"points": points, "comment": comment}


def judgements_of(session: Session, submissions: Sequence[str]) -> tuple[Judgement, ...]:
    """Return everything that people decided about submissions, in order of submission, item and revision."""
    row = JudgementRow
    statement = (
        select(row)
        .where(col(row.submission_id).in_(submissions))
        .order_by(col(row.submission_id), col(row.item), col(row.revision))
    )
    return tuple(judgement(one) for one in session.execute(statement).scalars())


def report_of(session: Session, submission: SubmissionRow) -> GradeReport | None:
    """Return the report of a submission's latest grading as the machine made it, or None."""
    if submission.graded_attempt is None:
        return None
    grading = session.get(GradingRow, (submission.id, submission.graded_attempt))
    return None if grading is None else report_from(grading.report)


def settle(session: Session, submission: SubmissionRow) -> GradeReport | None:
    """Put what people judged into the row's score and verdict; return the report with it.

    Called whenever a judgement changes, or the latest grading of a submission that has some.
    """
    report = report_of(session, submission)
    if report is None:
        return None
    whole = composed(report, judgements_of(session, [submission.id]))
    submission.score, submission.verdict = whole.score, whole.status.value
    if submission.to_judge is not None:  # something was left to people, not only corrected by them
        submission.to_judge = to_judge(whole.items)
    session.flush()
    return whole


def judgement(row: JudgementRow) -> Judgement:
    """Return what a row says."""
    others = {"submission": row.submission_id, "by": row.judged_by, "at": row.judged_at}
    return as_contract(row, Judgement, **others)
