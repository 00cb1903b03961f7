"""Assignments, reports and a grader that needs no physics."""

import hashlib
import json
import threading
from collections.abc import Callable, Collection

from grader.contracts.assignment import Assignment, Case, ItemSpec
from grader.contracts.errors import InfrastructureError, UnknownAssignmentError
from grader.contracts.explanation import Explanation
from grader.contracts.grading import (
    AssignmentSource,
    Grader,
    GradingJob,
    GradingResult,
    RunProgress,
    SyntaxProblem,
)
from grader.contracts.outcome import Endpoint, LogRecord, RunOutcome, RunStatus, Stream, StudentError
from grader.contracts.report import CaseRun, GradeReport, GradeStatus, Measurements
from grader.contracts.rubric import ItemStatus, RubricItem
from grader.contracts.submission import Claim
from grader.contracts.text import Text
from grader.grading.slot import Slot
from grader.store.queue import Queue
from tests.fakes.waiting import PATIENCE_S

MEASUREMENTS = Measurements(
    wall_s=0.2, jail_cpu_s=0.1, jail_peak_bytes=1 << 20, sim_steps=3840, isolation="strict"
)
POINTS = 5.0


class Lent:
    """A grader that outlives the command or worker that uses it, for its `Slot`."""

    def __init__(self, grader: Grader) -> None:
        self._grader = grader

    def __enter__(self) -> "Lent":
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def grade(self, job: GradingJob, on_run: Callable[[], None] = lambda: None) -> GradingResult:
        return self._grader.grade(job, on_run)

    def explain(self, job: GradingJob) -> Explanation:
        """Nothing, of a grader that only grades."""
        return self._grader.explain(job) if isinstance(self._grader, Slot) else Explanation()

    def start(self) -> None:
        """It has started."""

    close = abort = start


def assignment(assignment_id: str = "square", order: int = 5) -> Assignment:
    return Assignment(
        id=assignment_id,
        version=3,
        order=order,
        title=Text(zh=f"作业 {assignment_id}", en=f"Exercise {assignment_id}"),
        brief=Text(zh="让小车走起来", en="Make the car move"),
        check="polygon",
        options={"sides": 4},
        items=(
            ItemSpec(
                id="sides", title=Text(zh="边数", en="Sides"), points=POINTS, measure="sides", low=4, high=4
            ),
            ItemSpec(
                id="closed",
                title=Text(zh="回到起点", en="Back at the start"),
                points=POINTS,
                measure="gap_pct",
                high=4.0,
                ramp=12.0,
                needs=("sides",),
            ),
        ),
        file_patterns=(f"{assignment_id}*.py",),
        cases=(Case(id="default"),),
    )


class FakeAssignments:
    """Two assignments."""

    def __init__(self) -> None:
        self.assignments = (assignment("straight", 2), assignment("square", 5))

    def all(self) -> tuple[Assignment, ...]:
        return self.assignments

    def get(self, assignment_id: str) -> Assignment:
        for candidate in self.assignments:
            if candidate.id == assignment_id:
                return candidate
        raise UnknownAssignmentError(assignment_id)

    def of(self, course: str | None) -> "FakeAssignments":
        return self

    def look_again(self) -> None:
        pass

    def troubles(self) -> dict[str, Text]:
        return {}

    def starter(self, assignment_id: str) -> bytes:
        return f"# {assignment_id}\n".encode()

    def files(self, assignment_id: str) -> dict[str, bytes]:
        return {}

    def given_code(self) -> tuple[bytes, ...]:
        return ()


def trajectory() -> bytes:
    document = {
        "t_ns": [0, 1_000_000_000],
        "x_m": [5.5, 6.5],
        "y_m": [5.5, 5.5],
        "heading_rad": [0.0, 0.0],
        "v_mps": [1.0, 1.0],
        "w_radps": [0.0, 0.0],
        "end_ns": 2_000_000_000,
        "jumps": [],
        "contacts": [],
        "commands": [[0, 1.0, 0.0]],
    }
    return json.dumps(document, separators=(",", ":")).encode()


def _item(spec: ItemSpec, earned: float) -> RubricItem:
    passed = earned == spec.points
    return RubricItem(
        id=spec.id,
        title=spec.title,
        points=spec.points,
        earned=earned,
        status=ItemStatus.PASSED if passed else ItemStatus.FAILED,
        measured=4.0,
        target=spec.high,
        tolerance=0.0,
        message=Text(zh="看到了", en="seen"),
        hint=Text(zh="", en="") if passed else Text(zh="再试试", en="try again"),
    )


def _outcome(source: bytes) -> RunOutcome:
    crashed = b"raise" in source
    return RunOutcome(
        status=RunStatus.CRASHED if crashed else RunStatus.INTERRUPTED,
        duration_ns=2_000_000_000,
        error=StudentError(type="ValueError", message="boom", line=1, traceback="line 1")
        if crashed
        else None,
        stdout=Stream(text="<b>hi</b>\x1b[31m\n", dropped_bytes=3),
        stderr=Stream(text="x" * 40_000),
        nodes=("/square_mover",),
        endpoints=(
            Endpoint(
                kind="publisher",
                node="/square_mover",
                name="/turtle1/cmd_vel",
                type="geometry_msgs/msg/Twist",
            ),
        ),
        logs=tuple(LogRecord(t_ns=i, level=20, name="square_mover", message=f"log {i}") for i in range(300)),
    )


def grade(job: GradingJob) -> GradingResult:
    """Earn as many points as the source says ``good``; a pure function of the job."""
    specs, good = job.assignment.items, job.source.count(b"good")
    items = tuple(_item(spec, POINTS if index < good else 0.0) for index, spec in enumerate(specs))
    outcome, recorded = _outcome(job.source), trajectory()
    digest = hashlib.sha256(recorded).hexdigest()
    report = GradeReport(
        submission_sha256=hashlib.sha256(job.source).hexdigest(),
        assignment=job.assignment.id,
        assignment_version=job.assignment.version,
        grader_version="0.1.0",
        simulator="fake 1",
        seed=0,
        status=GradeStatus.CRASHED if outcome.status is RunStatus.CRASHED else GradeStatus.GRADED,
        score=sum(item.earned for item in items),
        max_score=job.assignment.max_score,
        items=items,
        runs=(CaseRun(case="default", outcome=outcome, trajectory_sha256=digest),),
        summary=Text(zh="做得不错", en="well done"),
        hint=Text(zh="继续", en="go on"),
        mistakes=() if good >= len(specs) else ("interior_angle", "wall_hit"),
    )
    return GradingResult(report=report, trajectories={"default": recorded}, measurements=MEASUREMENTS)


def grade_next(
    queue: Queue, assignments: AssignmentSource, grading: Callable[[GradingJob], GradingResult] = grade
) -> Claim | None:
    """Claim what is due next and grade it as a worker does; return its claim, None when nothing waits."""
    claim = queue.claim("w")
    if claim is not None:
        finish(queue, assignments, claim, grading)
    return claim


def finish(
    queue: Queue,
    assignments: AssignmentSource,
    claim: Claim,
    grading: Callable[[GradingJob], GradingResult] = grade,
) -> None:
    """Grade what was claimed and store the result."""
    assignment = assignments.of(claim.course).get(claim.assignment).of_course(claim.distro, claim.runs_as)
    job = GradingJob(file_name=claim.file_name, source=claim.source, assignment=assignment)
    assert queue.finish(claim, grading(job), assignment)


class FakeGrader:
    """Grades in the calling thread; can be told to fail or to wait.

    Attributes:
        faults: exceptions to raise, one per grading, before grading works again.
        aborts: how often `abort` was called.
        runs: whether the script is running when a fault comes.
        progress: what it tells of each run.
        explanation: what it finds for each script that lacks marks. explained: files, and what was hidden of each.
        hold: when set, gradings wait until `release` (or `abort`, which makes them fail).
    """

    def __init__(self, grading: Callable[[GradingJob], GradingResult] = grade) -> None:
        self.faults: list[Exception] = []
        self.runs = False
        self.progress: list[RunProgress] = []
        self.graded: list[str] = []
        self.explanation = Explanation()
        self.explained: list[tuple[str, tuple[str, ...]]] = []
        self.starts = 0
        self.closed = 0
        self.aborts = 0
        self.busy = threading.Event()
        self._grading = grading
        self._go = threading.Event()
        self._go.set()
        self._aborted = False

    def hold(self) -> None:
        self._go.clear()

    def release(self) -> None:
        self._go.set()

    def start(self) -> None:
        self.starts += 1

    def explain(
        self,
        job: GradingJob,
        hidden: Collection[str] = (),
        before_each: Callable[[], None] = lambda: None,
    ) -> Explanation:
        self.explained.append((job.file_name, tuple(hidden)))
        before_each()
        if self.faults:
            raise self.faults.pop(0)
        return self.explanation

    def grade(
        self,
        job: GradingJob,
        on_run: Callable[[], None] = lambda: None,
        on_progress: Callable[[RunProgress], None] | None = None,
        /,
    ) -> GradingResult:
        if self.runs:
            on_run()
        if on_progress is not None:
            for one in self.progress:
                on_progress(one)
        self.busy.set()
        if not self._go.wait(PATIENCE_S):
            raise AssertionError("the test forgot to release the grader")
        if self._aborted:
            self._aborted = False
            raise InfrastructureError("the grading process was killed")
        if self.faults:
            raise self.faults.pop(0)
        self.graded.append(job.file_name)
        return self._grading(job)

    def abort(self) -> None:
        self.aborts += 1
        self._aborted = True
        self._go.set()

    def close(self) -> None:
        self.closed += 1
        self._aborted = False  # the next one is new


class FakePreflight:
    """Calls a file with ``def broken(`` a syntax error; can be told to fail itself."""

    def __init__(self) -> None:
        self.fault: Exception | None = None
        self.busy_s = 0.0

    def check(
        self,
        source: bytes,
        file_name: str,
        busy: Callable[[float], None] = lambda _: None,
        *,
        patience_s: float = 0.0,
    ) -> SyntaxProblem | None:
        if self.fault is not None:
            raise self.fault
        busy(self.busy_s)
        for number, line in enumerate(source.decode().splitlines(), start=1):
            if "def broken(" in line:
                return SyntaxProblem(message="'(' was never closed", line=number, column=11, text=line)
        return None
