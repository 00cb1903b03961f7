"""A whole worker on permits: what its stopping leaves behind, and what it does not take."""

from collections.abc import Iterator

import pytest

from grader.contracts.grading import SandboxState
from grader.contracts.submission import SubmissionState
from grader.operation.metrics import Metrics
from grader.service.worker import Worker, WorkerConfig, WorkerParts
from grader.store.permits.loop import PermitLoop
from grader.store.work import Doorbell
from grader.store.workers import Workers
from tests.fakes.engines import PostgresEngine
from tests.fakes.grading import FakeAssignments, FakeGrader
from tests.fakes.waiting import PATIENCE_S, wait_until


class Bench:
    """Parts of a worker with one slot, whose grader the test holds."""

    def __init__(self, permits: PostgresEngine) -> None:
        self.permits = permits
        self.grader = FakeGrader()
        self.sandbox = SandboxState(ready=True)

    def worker(self, drain_s: float = PATIENCE_S) -> Worker:
        clock = self.permits.clock
        parts = WorkerParts(
            queue=self.permits.queue,
            workers=Workers(self.permits.database, clock),
            assignments=FakeAssignments(),
            make_grader=lambda: self.grader,
            probe=lambda: self.sandbox,
            doorbell=Doorbell(),
            clock=clock,
            metrics=Metrics(),
            work=PermitLoop(self.permits.database, clock, poll_s=0.01),
        )
        return Worker(parts, WorkerConfig(slots=1, heartbeat_s=0.05, drain_s=drain_s))


@pytest.fixture
def bench(permits: PostgresEngine) -> Iterator[Bench]:
    made = Bench(permits)
    yield made
    made.grader.release()


def test_work_begins_when_the_sandbox_is_ready_and_not_before(bench: Bench) -> None:
    id_ = bench.permits.upload()
    bench.sandbox = SandboxState(ready=False, detail="no seccomp")
    worker = bench.worker()
    worker.start()
    workers = Workers(bench.permits.database, bench.permits.clock)
    wait_until(lambda: bool(workers.alive(60)))
    assert bench.permits.jobs("status = 'todo'") == 1
    bench.sandbox = SandboxState(ready=True)
    wait_until(lambda: bench.permits.state(id_) is SubmissionState.GRADED)
    worker.stop()
    assert bench.permits.jobs() == 0


def test_stopping_returns_what_takes_too_long_with_a_permit_and_its_try(bench: Bench) -> None:
    id_ = bench.permits.upload()
    bench.grader.hold()
    worker = bench.worker(drain_s=0.0)
    worker.start()
    assert bench.grader.busy.wait(PATIENCE_S)
    worker.stop()
    row = bench.permits.submissions.get(id_)
    assert row is not None
    assert (row.state, row.tries) == (SubmissionState.QUEUED, 0)
    assert bench.permits.jobs("status = 'todo'") == bench.permits.jobs() == 1
    bench.permits.clock.advance(
        1.0
    )  # the stopping worker may have taken the permit once more, and put it off
    assert bench.permits.graded_in_order() == [id_]


def test_a_crashed_grading_process_is_one_retry(bench: Bench) -> None:
    id_ = bench.permits.upload()
    bench.grader.faults = [ValueError("the car fell over")]
    worker = bench.worker()
    worker.start()
    wait_until(lambda: bench.permits.jobs("scheduled_at IS NOT NULL") == 1)
    worker.stop()
    assert bench.permits.jobs("status = 'todo' AND scheduled_at IS NOT NULL") == 1
    bench.permits.clock.advance(2.0)
    assert bench.permits.graded_in_order() == [id_]
