"""A queue on either kind of database, to be asked the same questions."""

import threading
from collections.abc import Callable
from datetime import UTC, datetime

from sqlalchemy import text

from grader.contracts.grading import GradingJob
from grader.contracts.submission import Claim, NewSubmission, SubmissionState
from grader.store.database import Database
from grader.store.queue import Queue, Retries
from grader.store.regrades import Regrades
from grader.store.work import Doorbell, PolledWork
from tests.fakes.clock import FakeClock
from tests.fakes.grading import assignment, grade
from tests.fakes.submissions import Submissions
from tests.fakes.waiting import wait_until

RETRIES = Retries(lease_s=15.0, max_tries=3, backoff_s=2.0)
# Long after the server's own clock: what is not due yet by the test's clock is not due by the server's either.
_FAR_OFF = datetime(2100, 3, 1, 8, 0, 0, tzinfo=UTC)


class Engine:
    """A queue, uploads for it, and `work`: slots take what is due until nothing comes any more."""

    def __init__(self, url: str) -> None:
        self.clock = FakeClock()
        self.clock.now = _FAR_OFF
        self.database = Database(url)
        self.queue = Queue(self.database, self.clock, RETRIES)
        self.submissions = Submissions(self.database, self.clock)
        self.regrades = Regrades(self.database)

    def upload(self, student: str = "s1", source: bytes = b"good good\n") -> str:
        new = NewSubmission(student=student, assignment="square", file_name="square.py", source=source)
        added = self.submissions.add(new)
        self.clock.advance(0.001)
        return added.id

    def state(self, submission_id: str) -> SubmissionState:
        found = self.submissions.get(submission_id)
        assert found is not None
        return found.state

    def finish(self, claim: Claim) -> bool:
        job = GradingJob(file_name=claim.file_name, source=claim.source, assignment=assignment())
        return self.queue.finish(claim, grade(job), job.assignment)

    def finish_and_claim(self, claim: Claim) -> tuple[bool, Claim | None]:
        graded = assignment()
        job = GradingJob(file_name=claim.file_name, source=claim.source, assignment=graded)
        return self.queue.finish_and_claim(claim, grade(job), graded, claim.worker)

    def graded_in_order(self) -> list[str]:
        """Let one slot grade everything that is due; return what it graded, in order."""
        order: list[str] = []

        def step() -> bool:
            claim = self.queue.claim("slot")
            if claim is None:
                return False
            assert self.finish(claim)
            order.append(claim.submission_id)
            return True

        self.work(step)
        return order

    def taken(self, worker: str = "w") -> Claim:
        """Let one slot claim one submission and then be silent for ever, as one that was killed."""
        claims: list[Claim] = []

        def step() -> bool:
            claim = self.queue.claim(worker) if not claims else None
            if claim is not None:
                claims.append(claim)
            return claim is not None

        self.work(step)
        (claim,) = claims
        return claim

    def graded_rows(self) -> int:
        with self.database.reading() as session:
            return int(session.execute(text("SELECT count(*) FROM grading")).scalar_one())

    def work(self, step: Callable[[], bool], slots: int = 1) -> None:
        """Have slots take what is due, until one has looked in vain."""
        source, in_vain = PolledWork(Doorbell(), 0.001), threading.Event()

        def watched() -> bool:
            busy = False
            try:
                busy = step()
            finally:
                if not busy:
                    in_vain.set()
            return busy

        threads = [threading.Thread(target=source.serve, args=(watched,)) for _ in range(slots)]
        for thread in threads:
            thread.start()
        wait_until(in_vain.is_set)
        source.drain()
        for thread in threads:
            thread.join()


class PostgresEngine(Engine):
    """The same, with a look at Procrastinate's tables."""

    def jobs(self) -> int:
        with self.database.reading() as session:
            return int(session.execute(text("SELECT count(*) FROM procrastinate_jobs")).scalar_one())

    def change(self, statement: str) -> None:
        """Do something to Procrastinate's tables behind everybody's back."""
        with self.database.writing() as session:
            session.execute(text(statement))
