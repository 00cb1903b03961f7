"""Instants come from the database's server, whatever the machine's own clock says."""

import time
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from grader.contracts.errors import InfrastructureError
from grader.store import clock as clock_module
from grader.store.clock import ServerClock, clock_of
from grader.store.database import Database

LONG_AGO = datetime(2001, 1, 1, tzinfo=UTC)


class Elapsed:
    """Seconds that only the test lets pass; each look costs `step_s`."""

    def __init__(self) -> None:
        self.now_s = 100.0
        self.step_s = 0.0

    def __call__(self) -> float:
        self.now_s += self.step_s
        return self.now_s


@pytest.fixture
def wrong_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clock_module, "utc_now", lambda: LONG_AGO)


def test_on_sqlite_it_is_the_machines_own(sqlite_database: Database, wrong_clock: None) -> None:
    with clock_of(sqlite_database) as clock:
        assert clock() == LONG_AGO


def test_on_postgresql_the_machines_own_does_not_matter(
    postgres_database: Database, wrong_clock: None
) -> None:
    with clock_of(postgres_database) as clock:
        assert clock().tzinfo is UTC
        assert clock() - LONG_AGO > timedelta(days=9_000)


def test_a_machine_without_linux_clocks_can_do_without_them(
    postgres_database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr(time, "CLOCK_BOOTTIME")  # as on macOS
    with clock_of(postgres_database) as clock:
        assert clock() <= clock()


def test_it_counts_on_between_looks(postgres_database: Database) -> None:
    elapsed = Elapsed()
    clock = ServerClock(postgres_database, elapsed)
    before = clock()
    elapsed.now_s += 12.5
    assert clock() - before == timedelta(seconds=12.5)


def test_setting_it_corrects_it_unless_the_answer_was_slow(postgres_database: Database) -> None:
    elapsed = Elapsed()
    clock = ServerClock(postgres_database, elapsed)
    honest = clock()
    elapsed.now_s += 3_600  # this machine's count runs fast
    elapsed.step_s = 1.0
    clock.set()
    elapsed.step_s = 0.0
    assert clock() - honest > timedelta(minutes=59)
    clock.set()
    assert clock() - honest < timedelta(minutes=59)


def test_a_database_that_is_away_does_not_stop_it(postgres_database: Database, tmp_path: Path) -> None:
    clock = ServerClock(postgres_database)
    clock._database = Database(f"postgresql+psycopg://nobody@/none?host={tmp_path}")
    with pytest.raises(InfrastructureError):
        clock.set()
    assert clock() > LONG_AGO
