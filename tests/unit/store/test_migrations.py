"""Changing the tables of a database that somebody works with."""

import shutil
import threading
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import CheckConstraint, inspect
from sqlmodel import SQLModel

from grader.store import schema
from grader.store.database import Database
from grader.store.occupancy import OccupiedError, in_use
from grader.store.schema import expected_version, migrate, up_to_date, version
from tests.fakes.waiting import wait_until

_OLDEST = Path(__file__).parents[2] / "golden" / "tables_0017.sql"
"""The tables of the oldest version that can be upgraded, as SQLite makes them."""
_ON_POSTGRESQL = {"DATETIME": "TIMESTAMP WITH TIME ZONE", "BLOB": "BYTEA"}
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


def make_oldest(database: Database) -> None:
    """Make the tables of the oldest version in an empty database."""
    told = _OLDEST.read_text()
    if not database.is_sqlite:
        for kind, name in _ON_POSTGRESQL.items():
            told = told.replace(f" {kind}", f" {name}")
    with database.writing() as session:
        for statement in (*told.split(";\n")[:-1], "CREATE TABLE alembic_version (version_num VARCHAR(32))"):
            session.connection().exec_driver_sql(statement)
        session.connection().exec_driver_sql("INSERT INTO alembic_version VALUES ('0017')")


@pytest.mark.parametrize("is_new", [True, False])
def test_new_tables_and_migrated_ones_are_those_the_code_expects(blank_url: str, is_new: bool) -> None:
    database = Database(blank_url)
    if not is_new:
        make_oldest(database)
    assert migrate(database) == (None if is_new else "0017", expected_version())
    options = {"include_name": lambda name, kind, _: kind != "table" or name in SQLModel.metadata.tables}
    with database.engine.begin() as connection:
        context = MigrationContext.configure(connection, opts=options)
        difference = compare_metadata(context, SQLModel.metadata)
        surplus = set(inspect(connection).get_table_names()) - set(SQLModel.metadata.tables)
        checks = {
            (table, check["name"])
            for table in SQLModel.metadata.tables
            for check in inspect(connection).get_check_constraints(table)
        }
    assert difference == []
    assert {name for name in surplus if not name.startswith("procrastinate_")} == {"alembic_version"}
    assert checks == {
        (table.name, one.name)
        for table in SQLModel.metadata.tables.values()
        for one in table.constraints
        if isinstance(one, CheckConstraint)
    }
    database.close()


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
