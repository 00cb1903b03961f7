"""What an instructor sees of a class, as the store counts it."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime

from grader.contracts.report import GradeStatus
from grader.contracts.submission import SubmissionState


@dataclass(frozen=True, slots=True, kw_only=True)
class StudentProgress:
    """One student at one assignment.

    Attributes:
        attempts: submissions that count; those that failed through the grader's fault do not.
        best_score: highest score so far, None while nothing was scored.
        best_submission: the earliest that reached it.
        counted_score: what the rules keep of the attempt that counts, None while none does.
        counted_submission: that attempt.
        state, verdict: of the latest submission.
        last_activity_at: instant of the latest upload.
        waits_for_person: an answer of theirs is still to be judged.
        crashes: how many of the latest attempts, one after the other, did not run to their end.
        shares: of each attempt that counts against limits, in order, the share of the points it earned.
    """

    student: str
    assignment: str
    attempts: int
    best_score: float | None
    max_score: float | None
    best_submission: str | None
    counted_score: float | None
    counted_submission: str | None
    latest_submission: str
    state: SubmissionState
    verdict: GradeStatus | None
    last_activity_at: datetime
    crashes: int = 0
    shares: tuple[float | None, ...] = ()
    waits_for_person: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class ItemFailures:
    """How many students fail one rubric item of an assignment.

    Attributes:
        item: id of the item, ``case/id`` when there are several cases.
        ever: students who failed it in at least one graded submission. still: in their best one.
    """

    item: str
    ever: int
    still: int


@dataclass(frozen=True, slots=True, kw_only=True)
class MistakeCount:
    """How many students made one recognised mistake at least once."""

    code: str
    students: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AssignmentState:
    """What a class has done at one assignment; the same object for as long as nothing of it changes.

    Attributes:
        progress: in order of student. failures, mistakes: the most frequent first.
    """

    progress: tuple[StudentProgress, ...]
    failures: tuple[ItemFailures, ...]
    mistakes: tuple[MistakeCount, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StudentState:
    """What one student has done; the same object for as long as nothing of it changes.

    Attributes:
        progress: in order of assignment.
    """

    progress: tuple[StudentProgress, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ClassState:
    """Everything the store knows about a class, from one snapshot.

    Attributes:
        students, assignments: in order of id.
        mark: differs between snapshots that differ.
    """

    students: Mapping[str, StudentState]
    assignments: Mapping[str, AssignmentState]
    mark: str = ""

    @property
    def progress(self) -> tuple[StudentProgress, ...]:
        """Return all cells of the class, in order of student and assignment."""
        return tuple(cell for student in self.students.values() for cell in student.progress)
