"""Upgrades of a database with rows in it, from the first release on."""

import re
import threading

import pytest
from alembic import command
from alembic.config import Config

from grader.contracts.submission import SubmissionState
from grader.store import schema
from grader.store.dashboard import Dashboard
from grader.store.database import Database
from grader.store.judgements import Judgements, WaitingFor
from grader.store.occupancy import OccupiedError, in_use
from grader.store.queue import Queue, Retries
from grader.store.schema import expected_version, migrate, up_to_date, version
from grader.store.submissions import Submissions
from tests.fakes.clock import FakeClock
from tests.fakes.waiting import wait_until

_FIRST_RELEASE = (
    "INSERT INTO source VALUES ('abc', x'783d31')",
    """INSERT INTO submission (id, student, assignment, file_name, source_sha256, size_bytes, state, priority,
       received_at, queued_at, not_before, lease_until, worker, attempt, tries, trouble, graded_attempt, verdict,
       score, max_score, report_sha256) VALUES
       ('one', 's1', 'square', 'a.py', 'abc', 3, 'graded', 0, '2026-03-02 08:00:00.000000',
        '2026-03-02 08:00:00.000000', '2026-03-02 08:00:00.000000',
        NULL, 'w', 1, 1, '', 1, 'graded', 5.0, 10.0, 'd'),
       ('two', 's2', 'square', 'a.py', 'abc', 3, 'queued', 0, '2026-03-02 08:00:01.000000',
        '2026-03-02 08:00:01.000000', '2026-03-02 08:00:01.000000',
        NULL, '', 0, 0, '', NULL, NULL, NULL, NULL, NULL)""",
    """INSERT INTO grading VALUES
       ('one', 1, 'w', '2026-03-02 08:00:02.000000', '0.1.0', 1, 'graded', 5.0, 10.0, 'd', x'7b7d', '{}')""",
    """INSERT INTO submission (id, student, assignment, file_name, source_sha256, size_bytes, state, priority,
       received_at, queued_at, not_before, lease_until, worker, attempt, tries, trouble, graded_attempt, verdict,
       score, max_score, report_sha256) VALUES
       ('essay', 's3', 'theory', 'a.txt', 'abc', 3, 'graded', 0, '2026-03-02 08:00:00.000000',
        '2026-03-02 08:00:00.000000', '2026-03-02 08:00:00.000000',
        NULL, 'w', 2, 1, '', 2, 'needs_manual', NULL, 10.0, 'd')""",
    """INSERT INTO grading VALUES
       ('essay', 1, 'w', '2026-03-02 08:00:02.000000', '0.1.0', 1, 'needs_manual', NULL, 10.0, 'd', x'7b7d', '{}'),
       ('essay', 2, 'w', '2026-03-02 08:00:03.000000', '0.1.0', 1, 'needs_manual', NULL, 10.0, 'd', x'7b7d', '{}')
    """,
    "INSERT INTO graded_item VALUES ('one', 1, 'sides', 'failed', 5.0, 0.0)",
    """INSERT INTO graded_item VALUES ('essay', 1, 'old', 'needs_manual', 5.0, 0.0),
       ('essay', 2, 'why', 'needs_manual', 6.0, 0.0), ('essay', 2, 'length', 'passed', 4.0, 4.0)""",
    "INSERT INTO trajectory VALUES ('one', 1, 'default', 0, 'e', x'00')",
)


def upgrade(database: Database, revision: str) -> None:
    config = Config()
    config.set_main_option("script_location", str(schema._MIGRATIONS))
    with database.engine.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, revision)


def at_first_release(url: str) -> Database:
    database = Database(url)
    upgrade(database, "0001")
    with database.writing() as session:
        for statement in _FIRST_RELEASE:
            session.connection().exec_driver_sql(statement if database.is_sqlite else _as_bytea(statement))
    return database


def _as_bytea(statement: str) -> str:
    return re.sub(r"x'([0-9a-f]*)'", r"'\\x\1'", statement)


def test_the_first_releases_rows_survive(blank_url: str) -> None:
    database, clock = at_first_release(blank_url), FakeClock()
    migrate(database)
    clock.advance(60)
    submissions = Submissions(database, clock)
    assert submissions.get("one").state is SubmissionState.GRADED
    assert submissions.get("one").course is None
    assert submissions.report("one").content == b"{}"
    assert [one.student for one in Dashboard(database).state().progress] == ["s1", "s2", "s3"]
    claim = Queue(database, clock, Retries()).claim("w")
    assert (claim.submission_id, claim.source) == ("two", b"x=1")
    with database.reading() as session:
        turns = session.connection().exec_driver_sql(
            "SELECT count(*) FROM submission WHERE turn_at = queued_at"
        )
        assert turns.scalar_one() == 3
    waiting = Judgements(database).waiting(None, WaitingFor(), 0, 10)
    assert [(one.submission, one.item) for one in waiting] == [("essay", "why")]
    assert (submissions.get("essay").to_judge, submissions.get("one").to_judge) == (1, None)
    if database.is_sqlite:
        check_file(database)
    database.close()


def test_essays_that_an_older_migration_left_out_wait_for_people(blank_url: str) -> None:
    database = at_first_release(blank_url)
    upgrade(database, "0008")
    with database.writing() as session:
        session.connection().exec_driver_sql("UPDATE submission SET to_judge = NULL")
    migrate(database)
    submissions = Submissions(database, FakeClock())
    assert (submissions.get("essay").to_judge, submissions.get("one").to_judge) == (1, None)
    database.close()


def test_rules_survive_their_new_name(blank_url: str) -> None:
    database = at_first_release(blank_url)
    upgrade(database, "0009")
    with database.writing() as session:
        for statement in (
            """INSERT INTO course (id, title, time_zone, created_at)
               VALUES ('ros', 'ROS', 'UTC', '2026-03-02 08:00:00.000000')""",
            """INSERT INTO audit (at, course, actor, action, subject, "before", "after", reason)
               VALUES ('2026-03-02 08:00:00.000000', 'ros', 'wang', 'policy.change', 'x', '{}', '{}', '')""",
        ):
            session.connection().exec_driver_sql(statement)
        session.connection().exec_driver_sql(
            "INSERT INTO policy VALUES ('ros', 'square', 'the rules', '2026-03-02 08:00:00.000000')"
        )
    migrate(database)
    with database.reading() as session:
        found = session.connection().exec_driver_sql("SELECT document FROM rules").scalar_one()
        action = session.connection().exec_driver_sql("SELECT action FROM audit").scalar_one()
    assert (found, action) == ("the rules", "rules.change")
    database.close()


def test_tables_are_not_changed_under_who_works_with_them(
    blank_url: str, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(schema, "_LEAVING_S", 0.0)
    database, other = at_first_release(blank_url), Database(blank_url)
    done: list[tuple[str | None, str]] = []

    def start() -> None:
        with up_to_date(other, "grader serve", wait=True) as versions:
            done.append(versions)

    starting = threading.Thread(target=start)
    with in_use(database, "grader worker"):
        with pytest.raises(OccupiedError, match="stop it first"), up_to_date(other):
            pass
        starting.start()
        wait_until(lambda: "older version" in caplog.text)
        with database.reading() as session:
            assert version(session.connection()) == "0001"
    starting.join()
    assert done == [("0001", expected_version())]
    for one in (database, other):
        one.close()


def check_file(database: Database) -> None:
    with database.reading() as session:
        assert session.connection().exec_driver_sql("PRAGMA foreign_key_check").all() == []
        assert session.connection().exec_driver_sql("PRAGMA integrity_check").scalar_one() == "ok"
