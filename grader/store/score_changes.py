"""How another grading changes a submission's score, item by item, with the points that people gave."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from sqlalchemy import select
from sqlmodel import Session, col

from grader.contracts.judgement import settled, standing
from grader.contracts.regrade import ItemChange, ScoreChange
from grader.contracts.rubric import ItemScore, ItemStatus, total
from grader.contracts.submission import Judgement
from grader.store.database import in_lots
from grader.store.judgements import judgements_of
from grader.store.tables import GradedItemRow

_STATUSES = {status.value: status for status in ItemStatus}


@dataclass(frozen=True, slots=True, kw_only=True)
class StandingScores:
    """A grading of a submission, by the machine: its items, none where there is no grading, and its score.

    `score`: with what people judged, of the one that stands now.
    """

    items: Sequence[ItemScore]
    score: float | None


def item_scores(session: Session, attempts: Mapping[str, int]) -> dict[str, list[ItemScore]]:
    """Return by submission what the machine gave for each item in the grading number `attempts` names."""
    scores: dict[str, list[ItemScore]] = {id_: [] for id_ in attempts}
    item = GradedItemRow
    columns = (col(item.item), col(item.points), col(item.earned), col(item.status))
    statement = select(col(item.submission_id), col(item.attempt), *columns)
    for part in in_lots(attempts):
        for submission, attempt, name, points, earned, status in session.execute(
            statement.where(col(item.submission_id).in_(part))
        ):
            if attempt == attempts[submission]:
                scores[submission].append(ItemScore(name, points, earned, _STATUSES[status]))
    return scores


def judgements_by(session: Session, submissions: Iterable[str]) -> dict[str, list[Judgement]]:
    """Return by submission what people decided about it; nothing where nobody did."""
    judgements: dict[str, list[Judgement]] = {}
    for part in in_lots(submissions):
        for judgement in judgements_of(session, part):
            judgements.setdefault(judgement.submission, []).append(judgement)
    return judgements


def score_change(
    submission: str, student: str, old: StandingScores, new: StandingScores, judgements: Sequence[Judgement]
) -> ScoreChange:
    """Return what changes for a submission when `new` takes the place of `old`."""
    settled_old, settled_new = settled(old.items, judgements), settled(new.items, judgements)
    before, after = _earned(settled_old), _earned(settled_new)
    items = tuple(
        ItemChange(item=item, before=before.get(item), after=after.get(item))
        for item in dict.fromkeys([*before, *after])
        if before.get(item) != after.get(item)
    )
    kept = _judged(new.items, judgements)
    return ScoreChange(
        submission=submission,
        student=student,
        before=old.score,
        after=new.score if settled_new == tuple(new.items) else total(settled_new),
        items=items,
        kept=kept,
        void=tuple(item for item in _judged(old.items, judgements) if new.items and item not in kept),
    )


def _earned(items: Sequence[ItemScore]) -> dict[str, float]:
    return {item.item: item.earned for item in items}


def _judged(items: Sequence[ItemScore], judgements: Sequence[Judgement]) -> tuple[str, ...]:
    """Return the items that a person's judgement counts for."""
    return tuple(item.item for item in items if standing(item.item, item.points, judgements) is not None)
