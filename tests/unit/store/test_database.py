import sqlite3
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlmodel import SQLModel

from grader.contracts.errors import InfrastructureError, SettingsError
from grader.contracts.submission import NewSubmission, WorkerState
from grader.store.database import Database
from grader.store.intake import new_id
from grader.store.queue import Queue, RetryPolicy
from grader.store.schema import migrate
from grader.store.submissions import Submissions
from grader.store.workers import Workers, presence
from tests.fakes.clock import START, FakeClock


def pragma(database: Database, name: str) -> object:
    with database.reading() as session:
        return session.connection().exec_driver_sql(f"PRAGMA {name}").scalar_one()


def test_sqlite_is_set_up_to_lose_nothing(database: Database) -> None:
    assert pragma(database, "journal_mode") == "wal"
    assert pragma(database, "synchronous") == 2
    assert pragma(database, "foreign_keys") == 1
    assert pragma(database, "busy_timeout") == 30_000


def test_migrations_make_the_tables_the_code_expects(database: Database) -> None:
    with database.engine.begin() as connection:
        difference = compare_metadata(MigrationContext.configure(connection), SQLModel.metadata)
    assert difference == []


def test_migrating_twice_changes_nothing(database: Database) -> None:
    migrate(database)


def test_a_database_of_a_newer_grader_is_refused(database: Database) -> None:
    with database.writing() as session:
        session.connection().exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
    with pytest.raises(SettingsError, match="9999"):
        migrate(database)


def test_everything_survives_a_restart(tmp_path: Path) -> None:
    url, clock = f"sqlite:///{tmp_path / 'grader.db'}", FakeClock()
    first = Database(url)
    migrate(first)
    added = Submissions(first, clock).add(
        NewSubmission(student="张三", assignment="square", file_name="方.py", source=b"x = 1\n")
    )
    first.close()
    second = Database(url)
    migrate(second)
    again = Submissions(second, clock)
    assert again.get(added.id) == added
    assert again.source(added.id) == b"x = 1\n"
    assert Queue(second, clock, RetryPolicy()).claim("w").submission_id == added.id
    second.close()


def test_a_rolled_back_transaction_leaves_nothing(database: Database, submissions: Submissions) -> None:
    with pytest.raises(ZeroDivisionError), database.writing() as session:  # noqa: PT012
        session.connection().exec_driver_sql("INSERT INTO source VALUES ('abc', x'00')")
        raise ZeroDivisionError
    with database.reading() as session:
        assert session.connection().exec_driver_sql("SELECT count(*) FROM source").scalar_one() == 0


def test_an_unreachable_database_is_an_infrastructure_fault(tmp_path: Path) -> None:
    unreachable = Database(f"sqlite:///{tmp_path / 'no' / 'such' / 'folder' / 'grader.db'}")
    with pytest.raises(InfrastructureError, match="database"), unreachable.reading() as session:
        session.connection().exec_driver_sql("SELECT 1")
    unreachable.close()


def test_equal_bytes_are_kept_once(database: Database, submissions: Submissions) -> None:
    for student in ("a", "b"):
        submissions.add(NewSubmission(student=student, assignment="s", file_name="f.py", source=b"same"))
    with database.reading() as session:
        assert session.connection().exec_driver_sql("SELECT count(*) FROM source").scalar_one() == 1


def test_readers_do_not_wait_for_a_writer(database: Database, submissions: Submissions) -> None:
    with database.writing() as session:
        session.connection().exec_driver_sql("INSERT INTO source VALUES ('abc', x'00')")
        assert submissions.get("none") is None


def test_instants_are_kept_in_utc(database: Database, clock: FakeClock, submissions: Submissions) -> None:
    beijing = timezone(timedelta(hours=8))
    clock.now = datetime(2026, 3, 2, 23, 59, 59, 123456, tzinfo=beijing)
    added = submissions.add(NewSubmission(student="a", assignment="s", file_name="f.py", source=b"x"))
    received = submissions.get(added.id).received_at
    assert received == clock.now
    assert received.tzinfo is UTC
    assert received.isoformat() == "2026-03-02T15:59:59.123456+00:00"


def test_a_naive_instant_is_refused(clock: FakeClock, submissions: Submissions) -> None:
    clock.now = datetime(2026, 3, 2, 8, 0)
    with pytest.raises(Exception, match="time zone"):
        submissions.add(NewSubmission(student="a", assignment="s", file_name="f.py", source=b"x"))


def test_ids_sort_by_instant_and_differ() -> None:
    ids = [new_id(START + timedelta(milliseconds=number)) for number in range(50)]
    assert ids == sorted(ids)
    assert len({new_id(START) for _ in range(50)}) == 50
    assert ids[0][14] == "7"


def worker(seen_at: datetime, worker_id: str = "host:1") -> WorkerState:
    return WorkerState(
        id=worker_id,
        slots=2,
        busy=1,
        sandbox_ready=True,
        isolation="strict",
        detail="",
        started_at=START,
        seen_at=seen_at,
    )


def test_silent_workers_are_not_alive(database: Database, clock: FakeClock) -> None:
    workers = Workers(database, clock)
    workers.report(worker(clock()))
    assert workers.alive(10.0) == (worker(START),)
    clock.advance(10.5)
    assert workers.alive(10.0) == ()
    workers.report(worker(clock()))
    assert len(workers.alive(10.0)) == 1
    workers.leave("host:1")
    assert workers.alive(10.0) == ()


def test_only_the_first_process_finds_itself_alone(tmp_path: Path) -> None:
    url, alone = f"sqlite:///{tmp_path / 'grader.db'}", []
    with presence(url, lambda: alone.append("first")), presence(url, lambda: alone.append("second")):
        pass
    with presence(url, lambda: alone.append("third")):
        pass
    assert alone == ["first", "third"]


def test_a_running_row_without_a_lease_cannot_exist(database: Database, submissions: Submissions) -> None:
    submissions.add(NewSubmission(student="a", assignment="s", file_name="f.py", source=b"x"))
    with pytest.raises(Exception, match="running_has_a_lease"), database.writing() as session:
        session.connection().exec_driver_sql("UPDATE submission SET state = 'running'")


def test_sqlite_itself_agrees_with_the_file(database: Database, tmp_path: Path) -> None:
    connection = sqlite3.connect(tmp_path / "grader.db")
    assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    connection.close()
