"""Rubric items: what was asked, what was measured, what it earned, and what they add up to."""

import math
from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from grader.contracts.python import StrEnum
from grader.contracts.record import Record
from grader.contracts.text import EMPTY, Text

Unit = Literal["s", "ms", "min", "m", "cm", "km", "rad", "deg", "m/s", "rad/s", "deg/s", "Hz", "%", "1", ""]
"""Unit of a number; `grader.messages.quantity` knows how each is written. ``1``: a ratio. Empty: a count."""
_SLIGHT: Final = 0.9  # of an item's points: what earned more is not what to begin with


class ItemStatus(StrEnum):
    """State of one rubric item."""

    PASSED = "passed"
    PARTIAL = "partial"
    FAILED = "failed"
    NOT_CHECKED = "not_checked"  # an item it depends on failed, so measuring it would mean nothing
    NEEDS_MANUAL = "needs_manual"  # a person judges it: see `grader.contracts.judgement`


class RubricItem(Record):
    """One line of the checklist, judged.

    Attributes:
        id: stable name inside the assignment, e.g. ``sides``; ``case/id`` when there are several cases.
        points: most it can earn; earned: 0 <= earned <= points, rounded to 1e-2.
        measured: the measured quantity, None when nothing could be measured.
        target, tolerance: what full credit needs: |measured - target| <= tolerance, or as `message` says.
        unit: of `measured`, `target` and `tolerance`.
        wanted: what earns full credit, in words and numbers: ``90° ± 3°``, ``at least 0.5 m``, ``yes``.
        message: what was seen. hint: one next step, empty when nothing is to be done.
    """

    id: str
    title: Text
    points: float
    earned: float
    status: ItemStatus
    measured: float | None = None
    target: float | None = None
    tolerance: float | None = None
    unit: Unit = ""
    message: Text = EMPTY
    hint: Text = EMPTY
    wanted: Text = EMPTY

    @property
    def is_in_band(self) -> bool:
        """Whether its own measurement earns all: it lost points only because others did."""
        if self.measured is None or self.target is None:
            return False
        return abs(self.measured - self.target) <= (self.tolerance or 0.0)


class PublishedItem(Record):
    """One line of the rubric as it is published before anything is submitted.

    Attributes:
        measure: what is measured. wanted: what earns full credit. partial: where credit ends.
        needs: which items must have earned points, and what this one earns if they earned few; or empty.
    """

    id: str
    title: Text
    points: float
    measure: Text
    wanted: Text
    partial: Text
    needs: Text = EMPTY


class PublishedRubric(Record):
    """What a student reads before submitting, generated from the data the scores come from.

    Attributes:
        remarks: how this kind of check looks at a motion.
    """

    assignment: str
    title: Text
    brief: Text
    horizon_s: float
    max_score: float
    items: tuple[PublishedItem, ...]
    remarks: Text = EMPTY


def summed(points: Iterable[float]) -> float:
    """Return the sum of points to the hundredth, as each of them is: a sum of floats is a little off."""
    return round(math.fsum(points), 2)


@dataclass(frozen=True, slots=True)
class ItemScore:
    """What one rubric item earned: all that a total needs."""

    item: str
    points: float
    earned: float
    status: ItemStatus


def score_of(item: RubricItem) -> ItemScore:
    """Return what a total needs of a rubric item."""
    return ItemScore(item.id, item.points, item.earned, item.status)


def total(items: Sequence[ItemScore]) -> float | None:
    """Return the sum of what the items earned; None while one waits for a person."""
    return None if to_judge(items) else summed(item.earned for item in items)


def first_lost(items: Iterable[RubricItem], following: Container[str] = ()) -> RubricItem | None:
    """Return the item to begin with of those that lost points; None where there is none.

    Last come what was not measured, what lost points only through others, what follows from another one (the ids
    in `following`), and what lost little.
    """
    return min(
        items,
        key=lambda item: (
            item.status is ItemStatus.NOT_CHECKED,
            item.is_in_band,
            item.id in following,
            item.earned >= _SLIGHT * item.points,
        ),
        default=None,
    )


def to_judge(items: Iterable[ItemScore | RubricItem]) -> int:
    """Count the items that wait for a person."""
    return sum(item.status is ItemStatus.NEEDS_MANUAL for item in items)
