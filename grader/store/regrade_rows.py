"""The rows of a re-grade's trials: what they would change, and moving their gradings to their submissions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import case, delete, func, insert, literal, or_, select, update
from sqlalchemy.orm import aliased
from sqlmodel import Session, SQLModel, col

from grader.contracts.judgement import ItemScore, Judgement, settled, total
from grader.contracts.regrade import ItemChange, ScoreChange
from grader.contracts.rubric import ItemStatus
from grader.contracts.submission import SubmissionState
from grader.store.judgement_rows import judgements_of, settle
from grader.store.tables import (
    GradedItemRow,
    GradedMistakeRow,
    GradingRow,
    JudgementRow,
    SubmissionRow,
    TrajectoryRow,
)

_OF_GRADING: tuple[type[SQLModel], ...] = (TrajectoryRow, GradedMistakeRow, GradedItemRow, GradingRow)
_AT_ONCE = 500  # below SQLite's limit of variables
Mark = tuple[Any, ...]
_STATUSES = {status.value: status for status in ItemStatus}
_ENDS = (SubmissionState.GRADED.value, SubmissionState.INFRASTRUCTURE_ERROR.value)


@dataclass(frozen=True, slots=True)
class Trial:
    """One trial grading, the submission it is made of, and what would change."""

    row: SubmissionRow
    original: SubmissionRow
    change: ScoreChange

    @property
    def waits(self) -> bool:
        """Whether it is still to be made."""
        return self.row.state not in _ENDS

    @property
    def failed(self) -> bool:
        """Whether the service failed to make it."""
        return self.row.state == SubmissionState.INFRASTRUCTURE_ERROR.value


def trials_of(session: Session, regrade_id: str) -> list[Trial]:
    """Return the trials of a re-grade in order of student and arrival."""
    rows = session.execute(select(SubmissionRow).where(col(SubmissionRow.regrade) == regrade_id)).scalars()
    trials = {row.original: row for row in rows}
    of_regrade = select(col(SubmissionRow.original)).where(col(SubmissionRow.regrade) == regrade_id)
    statement = (
        select(SubmissionRow)
        .where(col(SubmissionRow.id).in_(of_regrade))
        .order_by(col(SubmissionRow.student), col(SubmissionRow.received_at), col(SubmissionRow.id))
    )
    originals = list(session.execute(statement).scalars())
    scores = _scores(session, [*originals, *trials.values()])
    judgements = _judgements(session, originals)
    return [
        Trial(trials[one.id], one, _change(one, trials[one.id], scores, judgements.get(one.id, ())))
        for one in originals
    ]


def hold(session: Session, regrade_id: str) -> None:
    """Lock the trials of a re-grade and what they were made of: results that come now wait, and find them gone."""
    trial = select(col(SubmissionRow.original)).where(col(SubmissionRow.regrade) == regrade_id)
    concerned = or_(col(SubmissionRow.regrade) == regrade_id, col(SubmissionRow.id).in_(trial))
    in_order = select(col(SubmissionRow.id)).where(concerned).order_by(col(SubmissionRow.id))
    session.execute(in_order.with_for_update()).all()


def adopt(session: Session, trial: Trial, regrade_id: str, now: datetime) -> bool:
    """Copy a trial's grading to its submission as the latest one; False when that is being graded right now."""
    original, made = trial.original, trial.row
    if original.state not in _ENDS:
        return False
    attempt = original.attempt + 1  # fences off whoever still believes to grade it
    for table in reversed(_OF_GRADING):
        names = [name for name in table.model_fields if name not in ("submission_id", "attempt", "regrade")]
        columns = [getattr(table, name) for name in names]
        key: list[Any] = [literal(original.id), literal(attempt)]
        origin = [literal(regrade_id)] if table is GradingRow else []
        source = select(*key, *origin, *columns).where(
            table.submission_id == made.id,  # type: ignore[attr-defined]
            table.attempt == made.graded_attempt,  # type: ignore[attr-defined]
        )
        target = ["submission_id", "attempt", *(["regrade"] if origin else []), *names]
        session.execute(insert(table).from_select(target, source))
    session.execute(
        update(SubmissionRow)
        .where(col(SubmissionRow.id) == original.id)
        .values(
            state=SubmissionState.GRADED.value,
            attempt=attempt,
            graded_attempt=attempt,
            finished_at=now,
            trouble="",
            verdict=made.verdict,
            score=made.score,
            max_score=made.max_score,
            report_sha256=made.report_sha256,
            to_judge=made.to_judge,
        )
    )
    settle(session, original)
    return True


def delete_trials(session: Session, trials: list[Trial]) -> None:
    """Delete trials and their gradings; whoever still grades one finds its claim void."""
    for trial in trials:
        for table in _OF_GRADING:
            session.execute(delete(table).where(table.submission_id == trial.row.id))  # type: ignore[attr-defined]
        session.execute(delete(SubmissionRow).where(col(SubmissionRow.id) == trial.row.id))


def mark_of(session: Session, regrade_id: str) -> Mark:
    """Return what changes with everything that the trials of an open re-grade say."""
    trial, original = aliased(SubmissionRow), aliased(SubmissionRow)
    numbers = [func.sum(col(trial.attempt)), func.sum(func.coalesce(col(trial.graded_attempt), 0))]
    numbers += [func.sum(case((col(trial.state) == state.value, 1), else_=0)) for state in SubmissionState]
    numbers += [func.sum(col(original.attempt)), func.sum(func.coalesce(col(original.graded_attempt), 0))]
    statement = (
        select(func.count(), *numbers)
        .join_from(trial, original, col(original.id) == col(trial.original))
        .where(col(trial.regrade) == regrade_id)
    )
    judged = (
        select(func.count())
        .join_from(trial, JudgementRow, col(JudgementRow.submission_id) == col(trial.original))
        .where(col(trial.regrade) == regrade_id)
    )
    return (*session.execute(statement).one(), session.execute(judged).scalar_one())


def _scores(session: Session, rows: list[SubmissionRow]) -> dict[str, list[ItemScore]]:
    """Return what the machine gave for each item in the latest grading of each of `rows`, by submission."""
    latest = {row.id: row.graded_attempt for row in rows if row.graded_attempt is not None}
    scores: dict[str, list[ItemScore]] = {id_: [] for id_ in latest}
    item = GradedItemRow
    told = (col(item.item), col(item.points), col(item.earned), col(item.status))
    statement = select(col(item.submission_id), col(item.attempt), *told)
    ids = list(latest)
    for start in range(0, len(ids), _AT_ONCE):
        part = statement.where(col(item.submission_id).in_(ids[start : start + _AT_ONCE]))
        for submission, attempt, name, points, earned, status in session.execute(part):
            if attempt == latest[submission]:
                scores[submission].append(ItemScore(name, points, earned, _STATUSES[status]))
    return scores


def _judgements(session: Session, rows: list[SubmissionRow]) -> dict[str, list[Judgement]]:
    """Return what people decided about those of `rows` that are theirs to judge, by submission."""
    ids = [row.id for row in rows if row.to_judge is not None]
    judgements: dict[str, list[Judgement]] = {}
    for start in range(0, len(ids), _AT_ONCE):
        for one in judgements_of(session, ids[start : start + _AT_ONCE]):
            judgements.setdefault(one.submission, []).append(one)
    return judgements


def _change(
    original: SubmissionRow,
    made: SubmissionRow,
    scores: Mapping[str, Sequence[ItemScore]],
    judgements: Sequence[Judgement],
) -> ScoreChange:
    old, new = scores.get(original.id, ()), scores.get(made.id, ())
    settled_old, settled_new = settled(old, judgements), settled(new, judgements)
    before, after = _earned(settled_old), _earned(settled_new)
    items = tuple(
        ItemChange(item=item, before=before.get(item), after=after.get(item))
        for item in dict.fromkeys([*before, *after])
        if before.get(item) != after.get(item)
    )
    kept = _judged(new, settled_new)
    return ScoreChange(
        submission=original.id,
        student=original.student,
        before=original.score,
        after=total(settled_new) if made.to_judge else made.score,
        items=items,
        kept=kept,
        void=tuple(item for item in _judged(old, settled_old) if new and item not in kept),
    )


def _earned(items: Sequence[ItemScore]) -> dict[str, float]:
    return {item.item: item.earned for item in items}


def _judged(machine: Sequence[ItemScore], whole: Sequence[ItemScore]) -> tuple[str, ...]:
    """Return the items that a person's judgement counts for."""
    return tuple(
        one.item for one, other in zip(machine, whole, strict=True) if one.status is not other.status
    )
