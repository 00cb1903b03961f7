"""What tests of workers and their slots share."""

from grader.contracts.grading import GradingJob, GradingResult, SandboxState
from grader.contracts.submission import Claim, NewSubmission, Submission
from grader.operation.metrics import Metrics
from grader.service.worker import SandboxHealth, WorkerParts, WorkerSlot
from grader.store.database import Database
from grader.store.queue import Queue, Retries
from grader.store.work import Doorbell
from grader.store.workers import Workers
from tests.fakes.clock import FakeClock
from tests.fakes.grading import FakeAssignments, FakeGrader, grade
from tests.fakes.submissions import Submissions

READY = SandboxState(ready=True, isolation="strict")


class Bench:
    """A store, one fake grader and what a worker needs besides."""

    def __init__(self, url: str) -> None:
        self.clock = FakeClock()
        self.database = Database(url)
        self.queue = Queue(self.database, self.clock, Retries(lease_s=15, max_tries=3, backoff_s=0))
        self.submissions = Submissions(self.database, self.clock)
        self.workers = Workers(self.database, self.clock)
        self.doorbell = Doorbell()
        self.grader = FakeGrader()
        self.probed = [READY]
        self.parts = WorkerParts(
            queue=self.queue,
            workers=self.workers,
            assignments=FakeAssignments(),
            make_grader=lambda: self.grader,
            probe=lambda: self.probed[-1],
            doorbell=self.doorbell,
            clock=self.clock,
            metrics=Metrics(),
        )

    def slot(self) -> WorkerSlot:
        sandbox = SandboxHealth(lambda: self.probed[-1])
        sandbox.try_out()
        return WorkerSlot("w/0", self.parts, sandbox)

    def upload(
        self,
        source: bytes = b"good good",
        assignment: str = "square",
        student: str = "s1",
        course: str | None = None,
    ) -> str:
        new = NewSubmission(
            student=student, assignment=assignment, file_name="square.py", source=source, course=course
        )
        return self.submissions.add(new).id

    def result(self, claim: Claim) -> GradingResult:
        """Grade what is claimed."""
        assignment = self.parts.assignments.get(claim.assignment)
        return grade(GradingJob(file_name=claim.file_name, source=claim.source, assignment=assignment))

    def row(self, submission_id: str) -> Submission:
        found = self.submissions.get(submission_id)
        assert found is not None
        return found
