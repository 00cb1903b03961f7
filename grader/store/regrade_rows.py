"""The rows of a re-grade's trials: what they would change, and moving their gradings to their submissions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Insert, Select, and_, case, delete, func, insert, literal, or_, select
from sqlalchemy.orm import aliased
from sqlmodel import Session, SQLModel, col

from grader.contracts.judgement import ItemScore, Judgement, settled, standing, total
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


def adopt(session: Session, trials: Sequence[Trial], regrade_id: str) -> list[Trial]:
    """Copy trials' gradings to their submissions as the latest ones; return the trials it was done with.

    Left out are failed ones and those whose submission is being graded right now. The number of statements does
    not grow with the number of trials, as other writers of a SQLite database wait meanwhile.
    """
    adopted = [one for one in trials if not one.failed and one.original.state in _ENDS]
    for table in reversed(_OF_GRADING):
        session.execute(_copy(table, regrade_id))
    for trial in adopted:
        _take_over(trial.original, trial.row)
    session.flush()
    judged = set(session.execute(_judged_ones(regrade_id)).scalars())
    for trial in adopted:
        if trial.original.id in judged:
            settle(session, trial.original)
    return adopted


def _judged_ones(regrade_id: str) -> Select[str]:
    """Select which submissions of a re-grade have judgements by people."""
    of_regrade = select(col(SubmissionRow.original)).where(col(SubmissionRow.regrade) == regrade_id)
    return (
        select(col(JudgementRow.submission_id))
        .distinct()
        .where(col(JudgementRow.submission_id).in_(of_regrade))
    )


def _copy(table: type[SQLModel], regrade_id: str) -> Insert:
    """Copy what belongs to the trials' gradings to the next attempts of their submissions."""
    trial, original, rows = aliased(SubmissionRow), aliased(SubmissionRow), table.__table__  # type: ignore[attr-defined]
    of_its_own = ("submission_id", "attempt", "regrade")
    names = [column.name for column in rows.columns if column.name not in of_its_own]
    key: list[Any] = [col(original.id), col(original.attempt) + 1]
    origin = [literal(regrade_id)] if table is GradingRow else []
    of_trial = and_(rows.c.submission_id == trial.id, rows.c.attempt == trial.graded_attempt)
    source = (
        select(*key, *origin, *(rows.c[name] for name in names))
        .select_from(rows)
        .join(trial, of_trial)
        .join(original, col(original.id) == col(trial.original))
        .where(
            col(trial.regrade) == regrade_id,
            col(trial.state) == SubmissionState.GRADED.value,
            col(original.state).in_(_ENDS),
        )
    )
    return insert(rows).from_select(
        ["submission_id", "attempt", *(["regrade"] if origin else []), *names], source
    )


def _take_over(original: SubmissionRow, made: SubmissionRow) -> None:
    original.state = SubmissionState.GRADED.value
    original.attempt += 1  # fences off whoever still believes to grade it
    original.graded_attempt = original.attempt
    # both instants: their difference tells the pace of gradings
    original.started_at, original.finished_at = made.started_at, made.finished_at
    original.trouble = ""
    original.verdict = made.verdict
    original.score, original.max_score = made.score, made.max_score
    original.report_sha256 = made.report_sha256
    original.to_judge = made.to_judge


def delete_trials(session: Session, regrade_id: str) -> None:
    """Delete trials and their gradings; whoever still grades one finds its claim void."""
    ids = select(col(SubmissionRow.id)).where(col(SubmissionRow.regrade) == regrade_id)
    statements = [delete(table).where(table.submission_id.in_(ids)) for table in _OF_GRADING]  # type: ignore[attr-defined]
    for statement in (*statements, delete(SubmissionRow).where(col(SubmissionRow.regrade) == regrade_id)):
        session.execute(statement, execution_options={"synchronize_session": False})


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
    """Return what people decided about `rows`, by submission."""
    ids = [row.id for row in rows]
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
    old, new = tuple(scores.get(original.id, ())), tuple(scores.get(made.id, ()))
    settled_old, settled_new = settled(old, judgements), settled(new, judgements)
    before, after = _earned(settled_old), _earned(settled_new)
    items = tuple(
        ItemChange(item=item, before=before.get(item), after=after.get(item))
        for item in dict.fromkeys([*before, *after])
        if before.get(item) != after.get(item)
    )
    kept = _judged(new, judgements)
    return ScoreChange(
        submission=original.id,
        student=original.student,
        before=original.score,
        after=made.score if settled_new == new else total(settled_new),
        items=items,
        kept=kept,
        void=tuple(item for item in _judged(old, judgements) if new and item not in kept),
    )


def _earned(items: Sequence[ItemScore]) -> dict[str, float]:
    return {item.item: item.earned for item in items}


def _judged(items: Sequence[ItemScore], judgements: Sequence[Judgement]) -> tuple[str, ...]:
    """Return the items that a person's judgement counts for."""
    return tuple(one.item for one in items if standing(one.item, one.points, judgements) is not None)
