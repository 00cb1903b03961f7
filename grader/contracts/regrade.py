"""A re-grade: a trial first, then applied or discarded as a whole."""

from dataclasses import dataclass
from datetime import datetime
from typing import Literal

from grader.contracts.python import StrEnum
from grader.contracts.record import Record

Which = Literal["latest", "best", "all", "faults"]


class RegradeState(StrEnum):
    """Where a re-grade is. While ``open``, its trial gradings run or wait for a decision.

    ``undone``: it was applied, and the gradings from before it stand again.
    """

    OPEN = "open"
    APPLIED = "applied"
    DISCARDED = "discarded"
    UNDONE = "undone"


class Wanted(Record):
    """Which submissions to one assignment are graded again.

    Attributes:
        which: each student's ``latest`` or ``best`` graded one, ``all`` that are graded, or those that the
            service failed to grade (``faults``).
        students: only theirs; empty: everybody's.
    """

    assignment: str
    which: Which = "all"
    students: tuple[str, ...] = ()


def _difference(before: float | None, after: float | None) -> float:
    return round((after or 0.0) - (before or 0.0), 2)


class ItemChange(Record):
    """What one rubric item earned before and earns now; None where the item is not in the rubric."""

    item: str
    before: float | None
    after: float | None

    @property
    def by(self) -> float:
        """How many points more it earns; no points at all count as 0."""
        return _difference(self.before, self.after)


class ScoreChange(Record):
    """What a re-grade does to one submission. Scores are None where there is no grading, or no total yet.

    Attributes:
        kept: rubric items whose judgement by a person stands in the new grading, too.
        void: those whose judgement does not, because the rubric gives them other points or none: they wait for
            a person again, or the machine's points count.
    """

    submission: str
    student: str
    before: float | None
    after: float | None
    items: tuple[ItemChange, ...]
    kept: tuple[str, ...] = ()
    void: tuple[str, ...] = ()

    @property
    def by(self) -> float:
        """By how much the score rises; no score counts as 0."""
        return _difference(self.before, self.after)


@dataclass(frozen=True, slots=True, kw_only=True)
class Regrade:
    """A re-grade and what it does.

    Attributes:
        waiting: trial gradings still to be made. failed: those that the service failed to make, which leave
            their submissions as they are.
        changes: of the submissions whose score or items change, by student. same: how many stay as they are.
        kept: judgements by people that stand in the new gradings, of all submissions.
        decided_by, decided_at: who applied or discarded it, and when; empty and None while it is open.
        undone_by, undone_at, undone_reason: who undid an applied one, when and why.
    """

    id: str
    course: str | None
    wanted: Wanted
    state: RegradeState
    created_at: datetime
    created_by: str
    decided_at: datetime | None
    decided_by: str
    reason: str
    waiting: int
    failed: int
    same: int
    changes: tuple[ScoreChange, ...]
    kept: int = 0
    undone_at: datetime | None = None
    undone_by: str = ""
    undone_reason: str = ""

    @property
    def gain(self) -> int:
        """How many submissions' scores rise."""
        return sum(change.by > 0 for change in self.changes)

    @property
    def lose(self) -> int:
        """How many submissions' scores fall."""
        return sum(change.by < 0 for change in self.changes)

    @property
    def changed(self) -> int:
        """How many submissions' scores or items change."""
        return len(self.changes)

    @property
    def total(self) -> int:
        """Of how many submissions a trial grading is made."""
        return self.waiting + self.failed + self.same + self.changed


@dataclass(frozen=True, slots=True, kw_only=True)
class PastGrading:
    """One grading in a submission's history. `by` is who applied the re-grade it came from, or empty.

    Attributes:
        stands: it is the one that counts.
    """

    attempt: int
    finished_at: datetime
    grader_version: str
    assignment_version: int
    status: str
    score: float | None
    max_score: float
    report_sha256: str
    by: str
    reason: str
    stands: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ToldChange:
    """What a re-grade changed of a submission, as its student is told.

    Attributes:
        undone: the re-grade was undone, which changed this. reason: why, as whoever did it said.
        seen: the student has opened the submission since.
    """

    submission: str
    assignment: str
    change: ScoreChange
    undone: bool
    reason: str
    at: datetime
    seen: bool
