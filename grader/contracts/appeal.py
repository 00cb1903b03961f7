"""A student's request for another look at one rubric item of a graded submission."""

from dataclasses import dataclass
from datetime import datetime

from grader.contracts.python import StrEnum

LONGEST_TEXT = 2_000
"""Characters of a student's reason, and of the staff's answer."""


class AppealState(StrEnum):
    """Where an appeal is. All but ``open`` are final, except that a withdrawn one may be made again."""

    OPEN = "open"
    ANSWERED = "answered"
    CORRECTED = "corrected"
    REFUSED = "refused"
    WITHDRAWN = "withdrawn"


ANSWERS = (AppealState.ANSWERED, AppealState.CORRECTED, AppealState.REFUSED)
"""What staff make of an open appeal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Appeal:
    """One appeal: there is one for each item of a submission at most.

    Attributes:
        item: of the submission's rubric. earned, points: what it had, out of how many, when the student asked.
        attempt: the grading that the student looked at.
        answer: of staff, in words; empty while it is open.
        passed_on_by: which assistant left it to the instructors, with `note`; students are not told.
        seen: the student has opened the submission since it was answered.
    """

    submission: str
    student: str
    assignment: str
    item: str
    reason: str
    made_at: datetime
    attempt: int
    earned: float
    points: float
    state: AppealState
    answer: str
    answered_by: str
    answered_at: datetime | None
    seen: bool
    passed_on_by: str = ""
    note: str = ""

    @property
    def is_open(self) -> bool:
        """Whether it waits for an answer."""
        return self.state is AppealState.OPEN
