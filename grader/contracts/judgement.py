"""What people decide about rubric items, and how it adds up with what a machine did.

People give points for what no machine judges, and instructors correct what a machine judged wrongly. A report is
never changed. Judgements stand beside it; `composed` is the one place that puts the two together.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from grader.contracts.notation import written
from grader.contracts.report import GradeReport, report_from, status_of
from grader.contracts.rubric import ItemScore, ItemStatus, RubricItem, score_of, to_judge, total
from grader.contracts.submission import Judgement, StoredReport
from grader.contracts.text import EMPTY, Text

_JUDGED = Text(zh="已人工评分。", en="A person has graded this.")


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedItem:
    """One rubric item of a grading, with what people gave for it.

    Attributes:
        machine: what the machine gave; None: it leaves the item to people.
        judgement: the one that counts; None while the item waits, or while the machine's points count.
        history: all judgements, oldest first.
        tag: names this state, for a change that holds only for what was looked at.
    """

    id: str
    title: Text
    points: float
    machine: float | None
    judgement: Judgement | None
    history: tuple[Judgement, ...]
    tag: str

    @property
    def waits(self) -> bool:
        """Whether it is left to people and still to be judged, perhaps again because its points changed."""
        return self.machine is None and self.judgement is None


def standing(item: str, points: float, judgements: Iterable[Judgement]) -> Judgement | None:
    """Return the judgement that stands for an item worth `points`, or None.

    A judgement no longer stands once the rubric gives the item other points, or once it was taken back.
    """
    own = [judgement for judgement in judgements if judgement.item == item]
    taken_back = max((judgement.revision for judgement in own if judgement.out_of == 0.0 < points), default=0)
    fitting = (
        judgement for judgement in own if judgement.out_of == points and judgement.revision > taken_back
    )
    return max(fitting, key=lambda one: one.revision, default=None)


def settled(items: Iterable[ItemScore], judgements: Sequence[Judgement]) -> tuple[ItemScore, ...]:
    """Return the items with the points that people gave, also where these replace a machine's."""
    return tuple(_settled(item, judgements) for item in items)


def composed(report: GradeReport, judgements: Sequence[Judgement]) -> GradeReport:
    """Return `report` with the judgements that stand: points, comments, and the total once nothing waits.

    The result is what people are shown; the report that was stored, and its digest, stay what they are. Each item
    stands for itself: one that depends on a corrected one keeps what the machine gave.
    """
    machine = tuple(score_of(item) for item in report.items)
    scores = settled(machine, judgements)
    if scores == machine:
        return report
    items = tuple(_judged(item, score, judgements) for item, score in zip(report.items, scores, strict=True))
    score, text = total(scores), report.summary
    if score is not None:
        points = f"{written(score)} / {written(report.max_score)}"
        text = Text(zh=f"已人工评分：{points} 分。", en=f"A person has graded this: {points} points.")
        if not to_judge(machine):
            text = Text(zh=f"教师改过分：{points} 分。", en=f"A teacher corrected this: {points} points.")
    followed = all(item.status is ItemStatus.PASSED for item in items) or (
        report.hint in [item.hint for item in report.items]
        and report.hint not in [item.hint for item in items]
    )
    return replace(
        report,
        items=items,
        score=score,
        status=status_of(items, (run.outcome for run in report.runs)),
        summary=text,
        hint=EMPTY if followed else report.hint,
    )


def judged(stored: StoredReport) -> GradeReport:
    """Return a stored report `composed` with the judgements that came with it."""
    return composed(report_from(stored.content), stored.judgements)


def _settled(item: ItemScore, judgements: Sequence[Judgement]) -> ItemScore:
    judgement = standing(item.item, item.points, judgements)
    if judgement is None or (item.status is not ItemStatus.NEEDS_MANUAL and judgement.points == item.earned):
        return item
    if judgement.points >= item.points:
        status = ItemStatus.PASSED
    else:
        status = ItemStatus.PARTIAL if judgement.points > 0.0 else ItemStatus.FAILED
    return replace(item, earned=judgement.points, status=status)


def _judged(item: RubricItem, score: ItemScore, judgements: Sequence[Judgement]) -> RubricItem:
    if score == score_of(item):
        return item
    judgement = standing(item.id, item.points, judgements)
    comment = "" if judgement is None else judgement.comment
    message = Text(zh=comment, en=comment) if comment else _JUDGED
    if item.status is not ItemStatus.NEEDS_MANUAL:
        message = _corrected(written(item.earned), written(score.earned), comment)
    hint = EMPTY if score.status is ItemStatus.PASSED else item.hint
    return replace(item, earned=score.earned, status=score.status, message=message, hint=hint)


def _corrected(machine: str, given: str, comment: str) -> Text:
    """Return the sentence that tells a student that somebody changed the machine's points."""
    return Text(
        zh=f"教师把得分从 {machine} 改为 {given}" + (f"：{comment}" if comment else "。"),
        en=f"A teacher changed the points from {machine} to {given}" + (f": {comment}" if comment else "."),
    )
