"""What goes into one grading and what comes out of it."""

from collections.abc import Callable, Mapping
from typing import Protocol

from grader.contracts.assignment import Assignment
from grader.contracts.record import Record, field
from grader.contracts.report import GradeReport, Measurements
from grader.contracts.text import Text


class GradingJob(Record):
    """One submission to be graded.

    Attributes:
        file_name: as the student named it; shown in tracebacks, never used as a path.
        source: the uploaded bytes, untouched.
    """

    file_name: str
    source: bytes
    assignment: Assignment


class WorldRequest(Record):
    """A call of one of turtlesim's services by the script; `values` are the fields of the request."""

    t_ns: int
    service: str
    values: str = ""


class GradingResult(Record):
    """A finished grading.

    Attributes:
        trajectories: per case id, the bytes of `grader.contracts.encode_trajectory`.
        requests: per case id, the first calls of the world's services; not stored.
        unmet: what items expected and did not get, as `grader.checks.unmet` names it; not stored.
        encoded: `report` in its one byte form, if that is at hand already.
    """

    report: GradeReport
    trajectories: Mapping[str, bytes]
    measurements: Measurements
    requests: Mapping[str, tuple[WorldRequest, ...]] = field(default_factory=dict)
    unmet: tuple[str, ...] = ()
    encoded: bytes | None = None

    def report_bytes(self) -> bytes:
        """Return the one byte form of the report (`GradeReport.canonical_bytes`)."""
        return self.report.canonical_bytes() if self.encoded is None else self.encoded


class RunProgress(Record):
    """How far a run has come: virtual time, and the last lines that the script has printed."""

    t_ns: int = 0
    stdout: str = ""
    stderr: str = ""


class SyntaxProblem(Record):
    """Why a file is not Python: what the compiler said and where (1-based, None when unknown)."""

    message: str
    line: int | None
    column: int | None = None
    text: str = ""


class Grader(Protocol):
    """Grades one job at a time."""

    def grade(self, job: GradingJob, on_run: Callable[[], None] = ..., /) -> GradingResult:
        """Grade `job`; call `on_run` whenever a run of the script has begun.

        Raises InfrastructureError: a fault of the grader or its host; the job may be tried again.
        """


class Preflight(Protocol):
    """Looks at a file without running it."""

    def check(
        self, source: bytes, file_name: str, busy: Callable[[float], None] = ..., *, patience_s: float = ...
    ) -> SyntaxProblem | None:
        """Compile `source` in a confined process; return what is wrong with it, or None.

        `busy` is told for how many seconds the process was busy with it, without what the check had to wait,
        at most `patience_s`.

        Raises InfrastructureError: the check itself could not be done, or not in time.
        """


class AssignmentSource(Protocol):
    """Some assignments, such as those of one course."""

    def all(self) -> tuple[Assignment, ...]:
        """Return every assignment in the order of the checklist."""

    def get(self, assignment_id: str) -> Assignment:
        """Return one assignment. Raises UnknownAssignmentError: no assignment has that id."""

    def troubles(self) -> Mapping[str, Text]:
        """Return by id what is wrong with assignments that cannot be read now."""

    def starter(self, assignment_id: str) -> bytes:
        """Return the script that students of an assignment begin with; empty where it has none."""

    def files(self, assignment_id: str) -> Mapping[str, bytes]:
        """Return the files of an assignment's folder by their paths in it; empty where there is no folder."""

    def given_code(self) -> tuple[bytes, ...]:
        """Return the scripts that every student can read: starters, solutions and the lesson's listings."""


class SandboxState(Record):
    """Whether submissions can be confined on this host.

    Attributes:
        ready: every required layer is active; otherwise nothing is graded.
        isolation: the mode, e.g. ``strict``. missing_layers: names of the layers that are not active.
        detail: one sentence for the operator, empty when all is well.
    """

    ready: bool
    isolation: str = ""
    missing_layers: tuple[str, ...] = ()
    detail: str = ""
