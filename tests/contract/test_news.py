"""Jobs of Procrastinate: what tells a worker on another machine that something was uploaded."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from unittest.mock import Mock

import pytest
from procrastinate.exceptions import ConnectorException
from sqlalchemy import text

from grader.contracts.errors import InfrastructureError
from grader.store.jobs.news import heard
from grader.store.work import Doorbell
from tests.fakes.engines import PostgresEngine
from tests.fakes.postgres import PostgresServer
from tests.fakes.waiting import PATIENCE_S, wait_until


class Ears:
    """A doorbell that jobs ring."""

    def __init__(self) -> None:
        self.doorbell = Doorbell()

    def rang_since(self, before: int) -> bool:
        self.doorbell.wait(before, PATIENCE_S)
        return self.doorbell.heard() > before


@contextmanager
def listening(engine: PostgresEngine) -> Iterator[Ears]:
    ears = Ears()
    with heard(engine.database, ears.doorbell):
        wait_until(lambda: listens(engine))
        yield ears


def listens(engine: PostgresEngine) -> bool:
    with engine.database.reading() as session:
        query = "SELECT count(*) FROM pg_stat_activity WHERE datname = current_database() AND query LIKE 'LISTEN%'"
        return bool(session.execute(text(query)).scalar_one())


def test_an_upload_rings_a_worker_that_is_elsewhere_and_leaves_nothing(on_server: PostgresEngine) -> None:
    with listening(on_server) as ears:
        before = ears.doorbell.heard()
        on_server.upload()
        assert ears.rang_since(before)
        wait_until(lambda: not on_server.jobs())


def test_an_upload_that_is_rolled_back_tells_nobody(
    on_server: PostgresEngine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "grader.store.intake.submission_of", Mock(side_effect=InfrastructureError("power cut"))
    )
    with pytest.raises(InfrastructureError):
        on_server.upload()
    assert on_server.jobs() == 0


def test_a_worker_hears_again_after_losing_every_connection(
    on_server: PostgresEngine, postgres_server: PostgresServer
) -> None:
    with listening(on_server) as ears:
        postgres_server.disconnect()
        before = ears.doorbell.heard()
        on_server.upload()
        assert ears.rang_since(before)
        wait_until(lambda: not on_server.jobs())  # taken, though perhaps not at once


def test_whoever_begins_to_listen_looks_and_forgets_what_nobody_heard(on_server: PostgresEngine) -> None:
    for number in range(3):
        on_server.upload(f"s{number}")
    on_server.change(
        "UPDATE procrastinate_jobs SET status = 'doing' WHERE id = (SELECT min(id) FROM procrastinate_jobs)"
    )
    assert on_server.jobs() == 3  # one of them was a dead worker's
    with listening(on_server) as ears:
        assert ears.rang_since(0)
        wait_until(lambda: not on_server.jobs())


def test_waiting_for_a_job_that_somebody_else_takes_hinders_nobody(on_server: PostgresEngine) -> None:
    on_server.upload()
    with on_server.database.writing() as other:
        other.execute(text("SELECT FROM procrastinate_jobs FOR UPDATE"))
        with listening(on_server) as ears:
            assert ears.rang_since(0)
            assert on_server.jobs() == 1


def test_only_tracebacks_about_the_database_being_away_are_left_out(
    on_server: PostgresEngine, caplog: pytest.LogCaptureFixture
) -> None:
    with listening(on_server):
        log = logging.getLogger("procrastinate.worker")
        for error in (ConnectorException("away"), ValueError("news")):
            log.error("a job failed", exc_info=error)
        log.warning("no exception", exc_info=False)
    assert "away" not in caplog.text
    assert "news" in caplog.text
    assert "no exception" in caplog.text
