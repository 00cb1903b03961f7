"""Changing the tables of a database that somebody works with."""

import shutil
import threading
from pathlib import Path

import pytest
from alembic.script import ScriptDirectory

from grader.store import schema
from grader.store.database import Database
from grader.store.occupancy import OccupiedError, in_use
from grader.store.schema import expected_version, migrate, up_to_date, version
from tests.fakes.waiting import wait_until

_NOW = expected_version()
_NEXT_MIGRATION = """
from alembic import op

revision = "next"
down_revision = {before!r}


def upgrade():
    op.execute("CREATE TABLE added_by_next (id INTEGER PRIMARY KEY)")
"""


@pytest.fixture
def outdated(blank_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Database:
    """A database at the version of this grader, which then gets one more migration."""
    database = Database(blank_url)
    _, now = migrate(database)
    migrations = tmp_path / "migrations"
    shutil.copytree(schema._MIGRATIONS, migrations)
    (migrations / "versions" / "next.py").write_text(_NEXT_MIGRATION.format(before=now))
    monkeypatch.setattr(schema, "_MIGRATIONS", migrations)
    assert expected_version() == "next"
    return database


def test_the_migrations_come_in_the_order_of_their_names() -> None:
    written = ScriptDirectory(str(schema._MIGRATIONS)).walk_revisions()
    assert schema._versions(schema._MIGRATIONS) == tuple(one.revision for one in written)


def test_tables_are_brought_up_to_date_with_their_rows(outdated: Database) -> None:
    with outdated.writing() as session:
        session.connection().exec_driver_sql(
            "INSERT INTO course (id, title, time_zone, created_at) "
            "VALUES ('ros', 'ROS', 'UTC', '2026-03-02 08:00:00.000000')"
        )
    before, now = migrate(outdated)
    assert (before, now) == (_NOW, "next")
    with outdated.reading() as session:
        connection = session.connection()
        assert connection.exec_driver_sql("SELECT id FROM course").scalar_one() == "ros"
        assert connection.exec_driver_sql("SELECT count(*) FROM added_by_next").scalar_one() == 0
    outdated.close()


def test_tables_are_not_changed_under_who_works_with_them(
    outdated: Database, blank_url: str, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(schema, "_LEAVING_S", 0.0)
    other = Database(blank_url)
    done: list[tuple[str | None, str]] = []

    def start() -> None:
        with up_to_date(other, "grader serve", wait=True) as versions:
            done.append(versions)

    starting = threading.Thread(target=start)
    with in_use(outdated, "grader worker"):
        with pytest.raises(OccupiedError, match="stop it first"), up_to_date(other):
            pass
        starting.start()
        wait_until(lambda: "older version" in caplog.text)
        with outdated.reading() as session:
            assert version(session.connection()) == _NOW
    starting.join()
    assert done == [(_NOW, "next")]
    for one in (outdated, other):
        one.close()
