"""Undoing an applied re-grade: the gradings that it replaced stand again."""

from collections.abc import Mapping, Sequence

from sqlalchemy import and_, select
from sqlmodel import Session, col

from grader.contracts.errors import RefusedError
from grader.contracts.regrade import ScoreChange
from grader.contracts.rubric import ItemStatus
from grader.contracts.submission import SubmissionState
from grader.store.database import in_lots
from grader.store.judgements import settle
from grader.store.score_changes import StandingScores, item_scores, judgements_by, score_change
from grader.store.tables import GradingRow, SubmissionRow


def undo(session: Session, regrade_id: str) -> list[ScoreChange]:
    """Make the gradings count again that those of a re-grade replaced; return what changes, by student.

    Raises RefusedError: a grading that stands is not the re-grade's any more.
    """
    regraded = _replacements(session, regrade_id)
    rows = _held(session, regrade_id)
    if any(row.graded_attempt != regraded[row.id][0] for row in rows):
        raise RefusedError("regrade_superseded")
    earlier = {id_: attempt for id_, (_, attempt) in regraded.items() if attempt is not None}
    now = item_scores(session, {id_: attempt for id_, (attempt, _) in regraded.items()})
    then, gradings = item_scores(session, earlier), _gradings(session, earlier)
    judgements = judgements_by(session, regraded)
    changes = []
    for row in rows:
        old = StandingScores(items=tuple(now[row.id]), score=row.score)
        grading = gradings.get(row.id)
        _stand(row, grading, sum(item.status is ItemStatus.NEEDS_MANUAL for item in then.get(row.id, ())))
        new = StandingScores(items=tuple(then.get(row.id, ())), score=row.score)
        changes.append(score_change(row.id, row.student, old, new, judgements.get(row.id, ())))
    session.flush()
    for row in rows:
        if row.id in judgements:
            settle(session, row)
    return changes


def _replacements(session: Session, regrade_id: str) -> dict[str, tuple[int, int | None]]:
    """Return by submission the number of a re-grade's grading, and of the one that stood before, if any did."""
    grading = GradingRow
    columns = (col(grading.submission_id), col(grading.attempt), col(grading.replaced))
    of_regrade = select(*columns).where(col(grading.regrade) == regrade_id)
    return {row[0]: (row[1], row[2]) for row in session.execute(of_regrade)}


def _held(session: Session, regrade_id: str) -> Sequence[SubmissionRow]:
    """Lock the submissions that a re-grade gave gradings, and return them in order of student and arrival."""
    of_regrade = select(col(GradingRow.submission_id)).where(col(GradingRow.regrade) == regrade_id)
    concerned = col(SubmissionRow.id).in_(of_regrade)
    in_order = select(SubmissionRow).where(concerned).order_by(col(SubmissionRow.id)).with_for_update()
    rows = session.execute(in_order).scalars().all()
    return sorted(rows, key=lambda row: (row.student, row.received_at, row.id))


def _gradings(session: Session, attempts: Mapping[str, int]) -> dict[str, GradingRow]:
    """Return one grading of each submission, by number."""
    rows: dict[str, GradingRow] = {}
    for part in in_lots(attempts):
        numbers = {attempts[id_] for id_ in part}
        theirs = and_(col(GradingRow.submission_id).in_(part), col(GradingRow.attempt).in_(numbers))
        for row in session.execute(select(GradingRow).where(theirs)).scalars():
            if row.attempt == attempts[row.submission_id]:
                rows[row.submission_id] = row
    return rows


def _stand(row: SubmissionRow, grading: GradingRow | None, to_judge: int) -> None:
    """Make a grading the one that counts for a submission; None: it had none, because the service failed."""
    row.started_at = None  # nobody knows any more, and no pace of gradings follows from it
    row.to_judge = to_judge or None
    if grading is None:
        row.state = SubmissionState.INFRASTRUCTURE_ERROR.value
        row.graded_attempt = row.verdict = row.score = row.max_score = row.report_sha256 = None
        return
    row.graded_attempt, row.finished_at = grading.attempt, grading.finished_at
    row.verdict, row.report_sha256 = grading.verdict, grading.report_sha256
    row.score, row.max_score = grading.score, grading.max_score
