"""Why a script lacks marks, as far as that was proven: changes of its text that were graded like the script."""

from grader.contracts.assignment import Assignment
from grader.contracts.record import Record
from grader.contracts.report import GradeReport
from grader.contracts.text import Text

MOST_COMMANDS = 20_000
"""A script that sends more makes ever more of something, and each of its runs takes many seconds."""


class ChangedText(Record):
    """A line before and after a change; None: there was none, or there is none any more.

    Attributes:
        number: of the line in the script as it was; of a new line the number of the line that it follows.
    """

    number: int
    before: str | None
    after: str | None


class ProvenChange(Record):
    """A change that was tried: it gains points and loses none.

    Attributes:
        code: which kind of change. text: line, cause, change, and that it was tried.
        lines: what changes. before, after: scores without and with it, of the items that are not hidden.
        gains: ids of the items that earn more with it.
    """

    code: str
    text: Text
    lines: tuple[ChangedText, ...]
    before: float
    after: float
    gains: tuple[str, ...] = ()


class StatedCause(Record):
    """What the traced run shows of a fault where no change was proven: a line, and what was measured there."""

    code: str
    line: int
    text: Text


class Explanation(Record):
    """What trials say of a script, beside its report, whose marks they cannot touch.

    Attributes:
        changes: in the order in which they are to be made; each was tried on top of those before.
        tried: how many changes were graded. cause: None where changes say it, or the run shows none.
        hidden: items of the rubric that were left out, because the rules hid them from students.
    """

    changes: tuple[ProvenChange, ...] = ()
    tried: int = 0
    cause: StatedCause | None = None
    hidden: tuple[str, ...] = ()

    @property
    def codes(self) -> tuple[str, ...]:
        """What takes the place of a report's mistakes where something was found."""
        if self.changes:
            return tuple(f"change.{change.code}" for change in self.changes)
        return () if self.cause is None else (f"cause.{self.cause.code}",)


def is_worth_trying(assignment: Assignment, report: GradeReport) -> bool:
    """Whether changes are looked for: of a script that lacks marks, whose runs are short enough to be repeated."""
    if assignment.input != "script" or assignment.world.kind == "pybullet":
        return False
    lacks = report.score is not None and report.score < report.max_score
    commands = sum(run.outcome.command_count for run in report.runs)
    return lacks and bool(report.runs) and commands <= MOST_COMMANDS
