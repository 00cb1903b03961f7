"""A worker on PostgreSQL: woken by uploads, cut off, frozen, stopped, told to abort."""

import logging
import threading
from datetime import timedelta

import pytest
from procrastinate.exceptions import ConnectorException
from sqlalchemy import text

from grader.contracts.submission import SubmissionState
from grader.store.permits.loop import PermitLoop
from tests.fakes.engines import PostgresEngine
from tests.fakes.postgres import PostgresServer
from tests.fakes.waiting import PATIENCE_S, wait_until


class Running:
    """A loop with one slot, which claims and grades by the database's rows."""

    def __init__(self, permits: PostgresEngine, poll_s: float = PATIENCE_S, hold: bool = False) -> None:
        self.permits = permits
        self.go = threading.Event()
        if not hold:
            self.go.set()
        self.busy = threading.Event()
        self.loop = PermitLoop(permits.database, permits.clock, poll_s=poll_s)
        self.slot = threading.Thread(target=self.loop.serve, args=(self.step,))

    def step(self) -> bool:
        claim = self.permits.queue.claim("slot")
        if claim is None:
            return False
        self.busy.set()
        assert self.go.wait(PATIENCE_S)
        return self.permits.finish(claim)

    def __enter__(self) -> "Running":
        self.loop.start(1, lambda: True)
        self.slot.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.go.set()
        self.loop.drain()
        self.slot.join()
        self.loop.close()


def listens(permits: PostgresEngine) -> bool:
    with permits.database.reading() as session:
        query = "SELECT count(*) FROM pg_stat_activity WHERE datname = current_database() AND query LIKE 'LISTEN%'"
        return bool(session.execute(text(query)).scalar_one())


def test_an_upload_wakes_an_idle_worker(permits: PostgresEngine) -> None:
    with Running(permits):  # which would look by itself after a minute
        wait_until(lambda: listens(permits))
        id_ = permits.upload()
        wait_until(lambda: permits.state(id_) is SubmissionState.GRADED)


def test_a_worker_survives_losing_every_connection(
    permits: PostgresEngine, postgres_server: PostgresServer
) -> None:
    with Running(permits, poll_s=0.05):
        wait_until(lambda: listens(permits))
        postgres_server.disconnect()
        id_ = permits.upload()
        wait_until(lambda: permits.state(id_) is SubmissionState.GRADED)


def test_only_tracebacks_about_the_database_being_away_are_left_out(
    permits: PostgresEngine, caplog: pytest.LogCaptureFixture
) -> None:
    with Running(permits):
        log = logging.getLogger("procrastinate.worker")
        for error in (ConnectorException("away"), ValueError("news")):
            log.error("a job failed", exc_info=error)
        log.warning("no exception", exc_info=False)
    assert "away" not in caplog.text
    assert "news" in caplog.text
    assert "no exception" in caplog.text


def test_a_job_that_is_aborted_costs_no_slot(permits: PostgresEngine) -> None:
    first = permits.upload("a")
    with Running(permits, hold=True) as worker:
        assert worker.busy.wait(PATIENCE_S)
        permits.change(
            "SELECT procrastinate_cancel_job_v1(id, true, false) FROM procrastinate_jobs WHERE status = 'doing'"
        )
        wait_until(lambda: not permits.jobs("status = 'doing'"))
        worker.go.set()
        wait_until(lambda: permits.state(first) is SubmissionState.GRADED)
        second = permits.upload("b")
        wait_until(lambda: permits.state(second) is SubmissionState.GRADED)


def test_stopping_finishes_what_runs_and_leaves_the_rest_to_others(permits: PostgresEngine) -> None:
    running, waiting = permits.upload("a"), permits.upload("b")
    with Running(permits, hold=True) as worker:
        assert worker.busy.wait(PATIENCE_S)
        worker.loop.drain()
    assert [permits.state(one) for one in (running, waiting)] == [
        SubmissionState.GRADED,
        SubmissionState.QUEUED,
    ]
    assert permits.jobs("status = 'todo'") == permits.jobs() == 1
    permits.clock.advance(0.2)
    assert permits.graded_in_order() == [waiting]


def test_a_worker_that_was_frozen_past_its_lease_writes_nothing(permits: PostgresEngine) -> None:
    id_ = permits.upload()
    with Running(permits, hold=True) as frozen:
        assert frozen.busy.wait(PATIENCE_S)
        permits.clock.now += timedelta(seconds=16)
        assert permits.queue.reconcile().requeued == 1
        second = permits.queue.claim("another")
        assert second is not None
        assert permits.finish(second)
    assert permits.graded_rows() == 1
    row = permits.submissions.get(id_)
    assert row is not None
    assert row.graded_attempt == 2
