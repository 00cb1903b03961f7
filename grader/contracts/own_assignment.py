"""Assignments of a course's own: uploaded as a folder, examined, then taken by the course."""

from datetime import datetime

from grader.contracts.python import StrEnum
from grader.contracts.record import Record
from grader.contracts.text import Text


class OwnState(StrEnum):
    """What became of an upload: its scripts wait to be run, it can be used, or they did not get what they must."""

    WAITING = "waiting"
    READY = "ready"
    REFUSED = "refused"


class Misfit(Record):
    """Something wrong in one of the files.

    Attributes:
        file: its path in the folder. line: from 1; None where no line is meant.
        field: such as ``items.2.low``; may be empty.
        told: what is wrong and what to do.
    """

    file: str
    line: int | None = None
    field: str = ""
    told: Text


class ScriptVerdict(Record):
    """What one of an assignment's own scripts scored.

    Attributes:
        score: None while a person has still to grade.
        problem: why this is not what it must get; `EMPTY` when it is.
    """

    script: str
    score: float | None
    max_score: float
    problem: Text


class Examined(Record):
    """What running an upload's scripts showed; `misfits` only where the scripts could not be run.

    Attributes:
        begun, scripts: how many were begun, of how many, while they are run; then 0.
    """

    verdicts: tuple[ScriptVerdict, ...] = ()
    misfits: tuple[Misfit, ...] = ()
    begun: int = 0
    scripts: int = 0


class OwnAssignment(Record):
    """An upload of an assignment to a course.

    Attributes:
        number: from 1 for the first upload of the assignment; what is shown and downloaded is the latest.
        version: as the file says.
        examined: what running the scripts showed; empty while they wait.
        trouble: why they could not be run yet, through a fault of the service.
        size_bytes: of the zip that is stored.
    """

    assignment: str
    number: int
    version: int
    state: OwnState
    uploaded_at: datetime
    uploaded_by: str
    examined: Examined
    trouble: str
    size_bytes: int
