"""Both ways from waiting rows to slots, to be asked the same questions."""

import threading
from collections.abc import Callable
from datetime import UTC, datetime

from sqlalchemy import text

from grader.contracts.grading import GradingJob
from grader.contracts.submission import Claim, NewSubmission, SubmissionState
from grader.store.database import Database
from grader.store.permits.loop import PermitLoop
from grader.store.queue import Queue, Retries
from grader.store.regrades import Regrades
from grader.store.work import Doorbell, PolledWork, WorkSource
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

    def source(self) -> WorkSource:
        raise NotImplementedError

    def idle(self) -> bool:
        """Whether nothing brings work to slots at present."""
        raise NotImplementedError

    def work(self, step: Callable[[], bool], slots: int = 1) -> None:
        source = self.source()
        threads = [threading.Thread(target=source.serve, args=(step,)) for _ in range(slots)]
        source.start(slots, lambda: True)
        for thread in threads:
            thread.start()
        try:
            wait_until(self.idle)
        finally:
            source.drain()
            for thread in threads:
                thread.join()
            source.close()


class EmbeddedEngine(Engine):
    """Slots look by themselves: idle as soon as one looked in vain."""

    def __init__(self, url: str) -> None:
        super().__init__(url)
        self._in_vain = threading.Event()

    def source(self) -> WorkSource:
        return PolledWork(Doorbell(), 0.001)

    def idle(self) -> bool:
        return self._in_vain.is_set()

    def work(self, step: Callable[[], bool], slots: int = 1) -> None:
        self._in_vain.clear()

        def watched() -> bool:
            found = False
            try:
                found = step()
            finally:
                if not found:
                    self._in_vain.set()
            return found

        super().work(watched, slots)


class PostgresEngine(Engine):
    """Permits: idle as soon as Procrastinate has none to hand out."""

    def source(self) -> WorkSource:
        self._let_time_pass()
        return PermitLoop(self.database, self.clock, poll_s=0.01)

    def idle(self) -> bool:
        return not self.jobs(
            "status = 'doing' OR (status = 'todo' AND coalesce(scheduled_at <= now(), true))"
        )

    def jobs(self, condition: str = "true") -> int:
        with self.database.reading() as session:
            found = session.execute(text(f"SELECT count(*) FROM procrastinate_jobs WHERE {condition}"))
            return int(found.scalar_one())

    def change(self, statement: str) -> None:
        """Do something to Procrastinate's tables behind everybody's back."""
        with self.database.writing() as session:
            session.execute(text(statement))

    def _let_time_pass(self) -> None:
        """Make due what is due by the test's clock: Procrastinate goes by the server's."""
        with self.database.writing() as session:
            session.execute(
                text("UPDATE procrastinate_jobs SET scheduled_at = NULL WHERE scheduled_at <= :now"),
                {"now": self.clock()},
            )
