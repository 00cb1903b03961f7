"""Obeying what is told: the lines of a proven change, put into the script as a student would."""

from dataclasses import dataclass

from grader.contracts.errors import RefusedError
from grader.contracts.explanation import Explanation, ProvenChange
from grader.contracts.grading import GradingJob
from grader.contracts.report import GradeReport
from grader.contracts.upload import check_source, decoded
from grader.grading.slot import Slot
from tests.e2e.grading_slot import catalog
from tests.hints.beginners import Beginner


def obeyed(source: str, change: ProvenChange) -> str:
    """Return a script with the lines of one change as it was told."""
    lines = source.split("\n")
    for line in reversed(change.lines):
        if line.before is None:
            lines.insert(line.number, line.after or "")
        else:
            assert lines[line.number - 1] == line.before
            lines[line.number - 1 : line.number] = [] if line.after is None else [line.after]
    return "\n".join(lines)


@dataclass(frozen=True)
class Tried:
    """What came of obeying the first change that was told of a script; None: none was told."""

    before: float
    last: float
    most: float
    explanation: Explanation
    after: float | None

    @property
    def gains(self) -> bool | None:
        """Whether obeying it gained; None where nothing was told."""
        return None if self.after is None else self.after > self.before


def tried(slot: Slot, script: Beginner) -> Tried | None:
    """Look for changes of a script and obey the first one; None of what is no script, or has full marks."""
    task = catalog().get(script.assignment)
    try:
        check_source(script.source)
    except RefusedError:
        return None
    if task.input != "script":
        return None

    def graded(source: bytes) -> GradeReport:
        return slot.grade(GradingJob(file_name=script.file, source=source, assignment=task)).report

    before = graded(script.source)
    if before.score is None or before.score == before.max_score:
        return None
    explanation = slot.explain(GradingJob(file_name=script.file, source=script.source, assignment=task))
    if not explanation.changes:
        return Tried(before.score, before.score, before.max_score, explanation, None)
    after = graded(obeyed(decoded(script.source), explanation.changes[0]).encode())
    return Tried(before.score, explanation.changes[-1].after, before.max_score, explanation, after.score)
