"""A whole worker: waking and stopping."""

import threading
from collections.abc import Iterator
from dataclasses import replace
from typing import NoReturn

import pytest

from grader.contracts.errors import InfrastructureError
from grader.contracts.grading import SandboxState
from grader.contracts.submission import SubmissionState
from grader.service.worker import Worker, WorkerConfig
from grader.store.work import Doorbell
from tests.fakes.grading import FakeGrader
from tests.fakes.waiting import PATIENCE_S, wait_until
from tests.fakes.worker_bench import Bench


@pytest.fixture
def bench(database_url: str) -> Iterator[Bench]:
    made = Bench(database_url)
    yield made
    made.database.close()


def worker(bench: Bench, **config: float) -> Worker:
    return Worker(bench.parts, WorkerConfig(slots=1, poll_s=PATIENCE_S, heartbeat_s=PATIENCE_S, **config))


def test_a_worker_wakes_for_an_upload_and_stops_in_order(bench: Bench) -> None:
    made = worker(bench)
    made.start()
    wait_until(lambda: bool(bench.workers.alive(60)))
    id_ = bench.upload()
    bench.doorbell.ring()
    wait_until(lambda: bench.row(id_).state is SubmissionState.GRADED)
    made.stop()
    assert bench.workers.alive(60) == ()
    assert bench.grader.closed == 1


def test_stopping_lets_a_running_grading_finish(bench: Bench) -> None:
    id_, waiting = bench.upload(), bench.upload()
    bench.grader.hold()
    made = worker(bench, drain_s=PATIENCE_S)
    made.start()
    assert bench.grader.busy.wait(PATIENCE_S)
    stopping = threading.Thread(target=made.stop)
    stopping.start()
    bench.grader.release()
    stopping.join()
    states = {bench.row(one).state for one in (id_, waiting)}
    assert SubmissionState.GRADED in states
    assert SubmissionState.RUNNING not in states


def test_stopping_returns_a_grading_that_takes_too_long(bench: Bench) -> None:
    id_ = bench.upload()
    bench.grader.hold()
    made = worker(bench, drain_s=0.0)
    made.start()
    assert bench.grader.busy.wait(PATIENCE_S)
    made.stop()
    row = bench.row(id_)
    assert (row.state, row.tries) == (SubmissionState.QUEUED, 0)


def test_stopping_returns_what_was_claimed_by_a_commit_that_nobody_heard_of(bench: Bench) -> None:
    bench.probed = [SandboxState(ready=False, detail="so that no slot takes anything")]
    id_, others = bench.upload(), bench.upload()
    made = worker(bench)
    made.start()
    assert all(bench.queue.claim(name) for name in (f"{made.id}/0", "other/0"))
    made.stop()
    rows = [bench.row(one) for one in (id_, others)]
    assert sorted((row.state, row.tries) for row in rows) == [
        (SubmissionState.QUEUED, 0),
        (SubmissionState.RUNNING, 1),
    ]


def test_stopping_without_the_database_ends_every_grading(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    for student in ("s1", "s2"):
        bench.upload(student=student)
    graders = [FakeGrader(), FakeGrader()]
    for grader in graders:
        grader.hold()
    left = iter(graders)
    bench.parts = replace(bench.parts, make_grader=lambda: next(left))
    made = Worker(bench.parts, WorkerConfig(slots=2, poll_s=PATIENCE_S, heartbeat_s=PATIENCE_S, drain_s=0.0))
    made.start()
    assert all(grader.busy.wait(PATIENCE_S) for grader in graders)

    def refuse(*_: object) -> NoReturn:
        raise InfrastructureError("the database does not answer")

    for name in ("hand_back_all", "fail"):
        monkeypatch.setattr(bench.queue, name, refuse)
    made.stop()
    assert [grader.aborts for grader in graders] == [1, 1]


def test_a_bell_rung_between_looking_and_waiting_is_heard() -> None:
    bell = Doorbell()
    mark = bell.heard()
    bell.ring()
    bell.wait(mark, timeout_s=1e6)
