import errno
import os
import sqlite3
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, ExitStack, closing, suppress
from dataclasses import asdict
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path
from unittest.mock import Mock

import pytest
from sqlalchemy import event, func, inspect, select
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from sqlmodel import Session, col

from grader.contracts.errors import InfrastructureError, SettingsError
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.submission import NewSubmission, WorkerState
from grader.store import database as store_database
from grader.store import schema
from grader.store.courses import Courses
from grader.store.database import Database, checkpoint, checkpoints, put
from grader.store.intake import new_id
from grader.store.queue import Queue, Retries
from grader.store.schema import expected_version, migrate, up_to_date
from grader.store.tables import CourseRow, WorkerRow
from grader.store.workers import Workers, presence
from tests.fakes.clock import START, FakeClock
from tests.fakes.submissions import Submissions
from tests.fakes.waiting import wait_until


def pragma(database: Database, name: str) -> object:
    with database.reading() as session:
        return session.connection().exec_driver_sql(f"PRAGMA {name}").scalar_one()


class Disk:
    """Stands for the disk: counts how often a log was written to it, and says whether that worked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.writes = 0
        self.entered = threading.Event()
        self.ready = threading.Event()
        self.ready.set()
        self.broken = False
        monkeypatch.setattr(store_database.os, "fdatasync", self._fdatasync)

    def _fdatasync(self, descriptor: int) -> None:
        assert os.readlink(f"/proc/self/fd/{descriptor}").endswith(".db-wal")
        self.writes += 1
        self.entered.set()
        assert self.ready.wait(60.0)
        if self.broken:
            raise OSError(errno.EIO, "Input/output error")


@pytest.fixture
def disk(durable: None, monkeypatch: pytest.MonkeyPatch) -> Disk:
    return Disk(monkeypatch)


def add(database: Database, name: str, *, lasting: bool = True) -> None:
    with database.writing(lasting=lasting) as session:
        session.add(CourseRow(id=name, title="", time_zone="UTC", created_at=START))
        session.flush()
        if name == "bad":
            raise ValueError


def course_ids(database: Database) -> set[str]:
    return {one.id for one in Courses(database, FakeClock()).all()}


def test_only_what_would_be_made_again_does_not_wait_for_the_disk(
    disk: Disk, sqlite_database: Database
) -> None:
    before, counts = disk.writes, []
    for number, lasting in enumerate((True, False, False, True)):
        add(sqlite_database, f"c{number}", lasting=lasting)
        counts.append(disk.writes - before)
    assert counts == [1, 1, 1, 2]


def test_what_waits_together_goes_to_the_disk_together(disk: Disk, sqlite_database: Database) -> None:
    """Seven write while the disk is busy: six of them share its next write, the one that is wrong fails alone."""
    disk.entered.clear()
    disk.ready.clear()
    before = disk.writes
    with ThreadPoolExecutor(8) as pool:
        first = pool.submit(add, sqlite_database, "first")
        assert disk.entered.wait(60.0)
        names = ["a", "b", "bad", "c", "d", "e", "f"]
        others = [pool.submit(add, sqlite_database, name) for name in names]
        wait_until(
            lambda: course_ids(sqlite_database) == {"first", *names} - {"bad"}
        )  # nobody waits to write
        assert [one.done() for one in (first, *others)] == [False, False, False, True, *[False] * 4]
        disk.ready.set()
    assert [type(one.exception()) for one in others if one.exception()] == [ValueError]
    assert disk.writes - before in (2, 3)  # the last of the six may have come while the next write began


def test_a_disk_that_fails_fails_everybody_who_waits_for_it(disk: Disk, sqlite_database: Database) -> None:
    disk.broken = True
    with pytest.raises(InfrastructureError, match="Input/output error"):
        add(sqlite_database, "lost?")
    disk.broken = False
    add(sqlite_database, "kept")
    assert "kept" in course_ids(sqlite_database)


def test_sqlite_is_set_up_to_lose_nothing(durable: None, sqlite_database: Database) -> None:
    assert pragma(sqlite_database, "journal_mode") == "wal"
    assert pragma(sqlite_database, "synchronous") == 1  # a commit; `_Disk` waits for the disk
    assert pragma(sqlite_database, "foreign_keys") == 1
    assert pragma(sqlite_database, "busy_timeout") == 30_000


def test_writers_write_in_order_of_arrival(sqlite_database: Database) -> None:
    order: list[int] = []

    def write(number: int) -> None:
        with sqlite_database.writing():
            order.append(number)

    threads = [threading.Thread(target=write, args=(number,)) for number in range(20)]
    with sqlite_database.writing():
        for count, thread in enumerate(threads, start=1):
            thread.start()
            wait_until(lambda wanted=count: len(sqlite_database._turns._waiting) == wanted)
    for thread in threads:
        thread.join()
    assert order == list(range(20))


def test_writers_of_one_process_take_turns(sqlite_database: Database) -> None:
    """They do not come to the point where SQLite lets one look again after a pause: here it would let none."""
    impatient = "PRAGMA busy_timeout=0"
    event.listen(sqlite_database.engine, "begin", lambda one: one.exec_driver_sql(impatient), insert=True)

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda number: add(sqlite_database, f"c{number}"), range(40)))
    with sqlite_database.reading() as session:
        assert session.execute(select(func.count()).select_from(CourseRow)).scalar_one() == 40


def test_what_one_thread_reads_within_a_reading_is_one_snapshot(database: Database) -> None:
    with database.reading() as outer:
        assert course_ids(database) == set()
        with ThreadPoolExecutor(1) as pool:
            pool.submit(add, database, "new").result()
            assert pool.submit(course_ids, database).result() == {"new"}
        with database.reading() as inner:
            assert inner is outer
        assert course_ids(database) == set()
    assert course_ids(database) == {"new"}


def test_a_checkpoint_empties_the_log_into_the_file(sqlite_database: Database, tmp_path: Path) -> None:
    Courses(sqlite_database, FakeClock()).create("ros2", "ROS 2", "UTC", "wang")
    checkpoint(sqlite_database)
    alone = tmp_path / "alone.db"
    alone.write_bytes(Path(sqlite_database.name).read_bytes())  # without the log
    with closing(Database(f"sqlite:///{alone}")) as database:
        assert [one.id for one in Courses(database, FakeClock()).all()] == ["ros2"]


def test_checkpoints_are_made_while_the_database_is_open(sqlite_database: Database, tmp_path: Path) -> None:
    with checkpoints(sqlite_database, every_s=0.001):
        Courses(sqlite_database, FakeClock()).create("ros2", "ROS 2", "UTC", "wang")
        wait_until(lambda: b"course.create" in Path(sqlite_database.name).read_bytes())


def test_checkpoints_go_on_after_every_connection_was_busy(
    sqlite_database: Database, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(sqlite_database.engine.pool, "_timeout", 0.001)
    with ExitStack() as busy:
        with suppress(PoolTimeoutError):
            while True:
                busy.callback(sqlite_database.engine.raw_connection().close)
        with checkpoints(sqlite_database, every_s=0.001):
            wait_until(lambda: "was not emptied" in caplog.text)
            busy.close()
            Courses(sqlite_database, FakeClock()).create("ros2", "ROS 2", "UTC", "wang")
            wait_until(lambda: b"course.create" in Path(sqlite_database.name).read_bytes())


def shown(session: Session, name: str) -> object:
    return session.connection().exec_driver_sql(f"SHOW {name}").scalar_one()


def test_postgresql_is_set_up_as_the_store_assumes(postgres_database: Database) -> None:
    with postgres_database.writing() as session:
        assert shown(session, "transaction_isolation") == "read committed"
        assert shown(session, "lock_timeout") == "30s"
        assert shown(session, "idle_in_transaction_session_timeout") == "15s"
    with postgres_database.reading() as session:
        assert shown(session, "transaction_isolation") == "repeatable read"
        assert shown(session, "transaction_read_only") == "on"
    with postgres_database.writing() as session:
        assert shown(session, "transaction_read_only") == "off"


def schema_of(database: Database) -> str:
    """Everything the database says about its tables, their columns and indexes, and what they hold."""
    with database.reading() as session:
        connection = session.connection()
        if database.is_sqlite:
            return repr(connection.exec_driver_sql("SELECT * FROM sqlite_master ORDER BY name").all())
        inspector, queue = inspect(connection), "SELECT obj_description('procrastinate_jobs'::regclass), oid"
        told = [
            (name, inspector.get_columns(name), inspector.get_indexes(name), inspector.get_foreign_keys(name))
            for name in sorted(inspector.get_table_names())
        ]
        made = connection.exec_driver_sql(
            f"{queue} FROM pg_class WHERE relname = 'procrastinate_jobs'"
        ).one()  # a table that was made anew has another number
        return repr((told, tuple(made)))


def test_migrating_twice_changes_nothing(database: Database, submissions: Submissions) -> None:
    added = submissions.add(NewSubmission(student="a", assignment="s", file_name="f.py", source=b"x"))
    before = schema_of(database)
    found, now = migrate(database)
    assert found == now
    assert schema_of(database) == before
    assert submissions.get(added.id) == added
    assert Queue(database, FakeClock(), Retries()).claim("w").submission_id == added.id


@pytest.mark.parametrize(
    ("there", "told"),
    [
        ("9999", f"of a newer grader: its tables are at 9999, this one knows up to {expected_version()}"),
        ("0009", "too old: its tables are at 0009, and this version upgrades from 0017 on"),
    ],
)
def test_a_database_that_cannot_be_upgraded_is_refused_and_says_which_it_is(
    database: Database, there: str, told: str
) -> None:
    with database.writing() as session:
        session.connection().exec_driver_sql(f"UPDATE alembic_version SET version_num = '{there}'")
    with pytest.raises(SettingsError, match=told):
        migrate(database)


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path}/typo/grader.db")
    with (
        pytest.raises(SettingsError, match=f"there is no folder {tmp_path}/typo: make it"),
        up_to_date(database),
    ):
        pass
    database.close()


def test_a_server_that_is_not_there_yet_is_waited_for(
    postgres_database: Database, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    tries, reading = [], Database.reading

    def answers_later(database: Database) -> AbstractContextManager[Session]:
        tries.append(None)
        if len(tries) < 70:
            raise InfrastructureError("connection refused")
        return reading(database)

    passed = [0.0]
    monkeypatch.setattr(Database, "reading", answers_later)
    monkeypatch.setattr(schema.time, "sleep", passed.append)
    monkeypatch.setattr(schema.time, "monotonic", lambda: sum(passed))
    with up_to_date(postgres_database, wait=True):
        pass
    told = [one.message for one in caplog.records if "connection refused" in one.message]
    assert (len(told), len(passed)) == (2, 70)  # at once, and once a minute
    monkeypatch.setattr(Database, "reading", Mock(side_effect=InfrastructureError("connection refused")))
    with pytest.raises(InfrastructureError, match="refused"), up_to_date(postgres_database, wait=True):
        pass
    assert sum(passed) >= 600


def test_a_file_that_cannot_be_opened_is_not_waited_for(tmp_path: Path) -> None:
    (tmp_path / "grader.db").mkdir()
    database = Database(f"sqlite:///{tmp_path}/grader.db")
    with pytest.raises(InfrastructureError), up_to_date(database, wait=True):
        pass
    database.close()


def test_everything_survives_a_restart(blank_url: str) -> None:
    url, clock = blank_url, FakeClock()
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
    assert Queue(second, clock, Retries()).claim("w").submission_id == added.id
    second.close()


def test_a_rolled_back_transaction_leaves_nothing(database: Database, submissions: Submissions) -> None:
    with pytest.raises(ZeroDivisionError), database.writing() as session:  # noqa: PT012
        session.connection().exec_driver_sql("INSERT INTO source VALUES ('abc', '')")
        raise ZeroDivisionError
    with database.reading() as session:
        assert session.connection().exec_driver_sql("SELECT count(*) FROM source").scalar_one() == 0


def test_text_sorts_by_code_point_whatever_the_servers_language(database: Database) -> None:
    courses = Courses(database, FakeClock())
    courses.create("ros", "ROS", "UTC", "me")
    ids = ["Z", "a", "B", "a_1", "a-1", "a1", "a@1"]
    courses.import_roster("ros", [RosterEntry(id=one, name="x", role=Role.STUDENT) for one in ids], "me")
    assert [one.id for one in courses.members("ros")] == sorted(ids)


def test_nothing_has_an_id_with_a_nul(submissions: Submissions, database: Database) -> None:
    assert submissions.get("a\0b") is None
    assert Courses(database, FakeClock()).member("ros\0", "\0") is None


def test_no_text_is_left_to_the_servers_language(postgres_database: Database) -> None:
    collations = (
        "SELECT collname, count(*) FROM pg_attribute JOIN pg_class c ON c.oid = attrelid "
        "JOIN pg_collation l ON l.oid = attcollation WHERE relkind = 'r' AND attnum > 0 "
        "AND relnamespace = 'public'::regnamespace AND relname <> 'alembic_version' "
        r"AND relname NOT LIKE 'procrastinate\_%%' GROUP BY collname"
    )
    with postgres_database.reading() as session:
        found = dict(session.connection().exec_driver_sql(collations).all())
    assert set(found) == {"C"}
    assert found["C"] > 50


def test_processes_that_start_at_once_migrate_one_after_the_other(blank_url: str) -> None:
    start = threading.Barrier(3)

    def open_and_migrate(_: int) -> str:
        database = Database(blank_url)
        start.wait()
        migrate(database)
        with database.reading() as session:
            version = (
                session.connection().exec_driver_sql("SELECT version_num FROM alembic_version").scalar_one()
            )
        database.close()
        return version

    with ThreadPoolExecutor(3) as pool:
        versions = set(pool.map(open_and_migrate, range(3)))
    assert len(versions) == 1


def test_equal_bytes_are_kept_once(database: Database, submissions: Submissions) -> None:
    for student in ("a", "b"):
        submissions.add(NewSubmission(student=student, assignment="s", file_name="f.py", source=b"same"))
    with database.reading() as session:
        assert session.connection().exec_driver_sql("SELECT count(*) FROM source").scalar_one() == 1


def test_readers_do_not_wait_for_a_writer(database: Database, submissions: Submissions) -> None:
    with database.writing() as session:
        session.connection().exec_driver_sql("INSERT INTO source VALUES ('abc', '')")
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
    clock.advance(-3_600)  # which was ahead until now
    assert workers.alive(10.0) == ()
    workers.report(worker(clock()))
    assert len(workers.alive(10.0)) == 1
    workers.leave("host:1")
    assert workers.alive(10.0) == ()


def test_no_heartbeat_waits_for_another_one(postgres_database: Database, clock: FakeClock) -> None:
    workers = Workers(postgres_database, clock)
    workers.report(worker(START - timedelta(days=1), "old:1"))
    with postgres_database.writing() as session:
        put(session.connection(), WorkerRow, **asdict(worker(clock(), "slow:1")))
        session.execute(select(WorkerRow).where(col(WorkerRow.id) == "old:1").with_for_update())
        workers.report(
            worker(clock(), "host:1")
        )  # waiting for the one above would end it after half a minute
    assert [one.id for one in workers.alive(10.0)] == ["host:1", "slow:1"]


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


def test_sqlite_itself_agrees_with_the_file(sqlite_database: Database, tmp_path: Path) -> None:
    connection = sqlite3.connect(tmp_path / "grader.db")
    assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    connection.close()
