"""The graded report: the same bytes for the same submission, today or in a re-grade next term."""

import hashlib
from collections.abc import Iterable
from dataclasses import asdict

from grader.contracts.outcome import RunOutcome, RunStatus, Stream
from grader.contracts.python import StrEnum
from grader.contracts.record import Record, canonical, from_json
from grader.contracts.rubric import RubricItem, to_judge
from grader.contracts.text import EMPTY, Text

SCHEMA_VERSION = 1


class GradeStatus(StrEnum):
    """State of a grading as a whole. A fault of an assignment or of the grader makes no report."""

    GRADED = "graded"
    NEEDS_MANUAL = "needs_manual"
    SYNTAX_ERROR = "syntax_error"
    CRASHED = "crashed"
    CPU_LIMIT = "cpu_limit"
    MEMORY_LIMIT = "memory_limit"
    OUTPUT_LIMIT = "output_limit"
    STALLED = "stalled"
    FORBIDDEN = "forbidden"
    PROTOCOL = "protocol"


_UNUSUAL = {
    RunStatus.SYNTAX_ERROR: GradeStatus.SYNTAX_ERROR,
    RunStatus.CRASHED: GradeStatus.CRASHED,
    RunStatus.STALLED: GradeStatus.STALLED,
    RunStatus.CPU_LIMIT: GradeStatus.CPU_LIMIT,
    RunStatus.MEMORY_LIMIT: GradeStatus.MEMORY_LIMIT,
    RunStatus.OUTPUT_LIMIT: GradeStatus.OUTPUT_LIMIT,
    RunStatus.FORBIDDEN: GradeStatus.FORBIDDEN,
    RunStatus.PROTOCOL: GradeStatus.PROTOCOL,
}


def status_of(items: Iterable[RubricItem], outcomes: Iterable[RunOutcome]) -> GradeStatus:
    """Return the first unusual end among the runs; scripts that ended, or idled to the horizon, are graded.

    While an item waits for a person nothing is final, however the script ended.
    """
    if to_judge(items):
        return GradeStatus.NEEDS_MANUAL
    unusual = (_UNUSUAL[outcome.status] for outcome in outcomes if outcome.status in _UNUSUAL)
    return next(unusual, GradeStatus.GRADED)


class CaseRun(Record):
    """One run of the script under one of the assignment's cases (most assignments have one, ``default``).

    Attributes:
        trajectory_sha256: digest of the recorded trajectory, which is stored beside the report.
    """

    case: str
    outcome: RunOutcome
    trajectory_sha256: str


class GradeReport(Record):
    """The graded part of a result. Instants, CPU time and isolation mode stand beside it, never in it.

    Attributes:
        score, max_score: sums over `items`; score is None while a person has still to grade.
        summary: one sentence for the student. hint: the one next step that matters most.
        mistakes: codes of recognised mistakes, most likely first (see docs/feedback).
        interface: what the script found: ``ros2-humble`` or ``ros2-jazzy``.
    """

    submission_sha256: str
    assignment: str
    assignment_version: int
    grader_version: str
    simulator: str
    seed: int
    status: GradeStatus
    score: float | None
    max_score: float
    items: tuple[RubricItem, ...]
    runs: tuple[CaseRun, ...]
    summary: Text = EMPTY
    hint: Text = EMPTY
    mistakes: tuple[str, ...] = ()
    interface: str = "ros2-humble"
    schema_version: int = SCHEMA_VERSION

    def run_of(self, case: str | None) -> CaseRun | None:
        """Return the run of a case, the first one if `case` is None; None if there is no such run."""
        return next((run for run in self.runs if case is None or run.case == case), None)

    def to_dict(self) -> dict[str, object]:
        """Return plain JSON-ready data."""
        return asdict(self)

    def canonical_bytes(self) -> bytes:
        """Return the one byte form of this report."""
        return canonical(self)

    def sha256(self) -> str:
        """Return the hexadecimal digest of `canonical_bytes`."""
        return hashlib.sha256(self.canonical_bytes()).hexdigest()


def report_from(content: bytes | str) -> GradeReport:
    """Return the report whose `canonical_bytes`, as bytes or as text, are `content`.

    Raises ValueError: it is not a report; the message names the field.
    """
    return from_json(GradeReport, content)


class CaseOutput(Record):
    """What the script printed in one run."""

    case: str
    stdout: Stream
    stderr: Stream


class Measurements(Record):
    """What a grading cost and how it was isolated. Never part of the graded report.

    Attributes:
        missing_layers: names of isolation layers that were not active.
        cut_output: what scripts had printed that were ended while they were still printing. How much that
            is depends on the moment, so the report itself holds none of it.
    """

    wall_s: float
    jail_cpu_s: float
    jail_peak_bytes: int
    sim_steps: int
    isolation: str
    missing_layers: tuple[str, ...] = ()
    cut_output: tuple[CaseOutput, ...] = ()
