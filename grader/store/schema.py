"""Bringing a database to the schema this version of the grader expects.

An empty database gets the tables of `grader.store.tables`; one of an older version is changed by the migrations.
Alembic does it, and is imported only where there is something to do: that is 0.07 s of a start.
"""

import logging
import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Literal

from sqlalchemy import Connection, text
from sqlalchemy.exc import DBAPIError
from sqlalchemy.schema import CreateIndex, CreateTable
from sqlmodel import SQLModel

from grader.contracts.errors import InfrastructureError, SettingsError
from grader.store import tables  # noqa: F401  registers the tables in the metadata
from grader.store.database import Database, one_at_a_time
from grader.store.occupancy import OccupiedError, alone, in_use

_log = logging.getLogger(__name__)
_LOOK_S = 0.2
# A PostgreSQL server may take so long to notice that a connection was closed, even one of ours.
_LEAVING_S = 2.0
_SERVER_S, _SERVER_LOOK_S, _SAY_EVERY_S = 600.0, 1.0, 60.0
_MIGRATIONS = Path(__file__).parent / "migrations"


@contextmanager
def up_to_date(
    database: Database, who: str = "a command of the grader", *, wait: bool = False
) -> Iterator[tuple[str | None, str]]:
    """Bring the tables up to date as `migrate` does, then share the database as `occupancy.in_use` does.

    Existing tables are not changed while somebody works with them: that process may be of an older version.

    Nothing of `database` is open yet. `wait`: wait for a server that does not answer, as while machines start; and
    if tables must be changed, until nobody works with them. By default this gives up.

    Raises:
        SettingsError: as `migrate`; an OccupiedError if it does not `wait`.
        InfrastructureError: as `migrate` and `occupancy.in_use`.
    """
    if wait:
        _await_server(database)
    before: str | None = None
    last_reason = ""
    until_s = math.inf if wait else time.monotonic() + _LEAVING_S
    while True:
        with in_use(database, who):
            if not _outdated(database):
                earlier, now = migrate(database)
                yield before or earlier, now
                return
        try:
            with alone(database):
                before, _ = migrate(database)
        except OccupiedError as error:
            reason = f"the tables are of an older version, but {error}"
            if time.monotonic() >= until_s:
                raise OccupiedError(reason, f"表结构是旧版本的，但{error.zh}") from error
            if wait and reason != last_reason:
                _log.warning("waiting: %s", reason)
                last_reason = reason
            time.sleep(_LOOK_S)


def _await_server(database: Database) -> None:
    """Return once a server answers; say why not at once, and then each minute.

    Raises InfrastructureError: it does not for ten minutes; or it is a file, which nothing is about to start.
    """
    begun_s = time.monotonic()
    said_s = -math.inf
    while True:
        try:
            with database.reading() as session:
                session.connection()
                return
        except InfrastructureError as error:
            now_s = time.monotonic()
            if database.is_sqlite or now_s - begun_s >= _SERVER_S:
                raise
            if now_s - said_s >= _SAY_EVERY_S:
                _log.warning("waiting for %s, up to %g minutes: %s", database.name, _SERVER_S / 60, error)
                said_s = now_s
            time.sleep(_SERVER_LOOK_S)


def _outdated(database: Database) -> bool:
    """Whether there are tables, and they are of an older version."""
    with database.reading() as session:
        present = version(session.connection())
    return present in _versions(_MIGRATIONS)[1:]


def migrate(database: Database) -> tuple[str | None, str]:
    """Create or upgrade the tables; harmless when there is nothing to do.

    Processes that start at the same moment do it one after the other.

    Returns:
        The version of the schema before (None: there was none) and after.

    Raises:
        SettingsError: the database was written by a newer grader, belongs to something else, cannot hold
            Chinese, or the caller has no right to change it.
        InfrastructureError: the database cannot be reached.
    """
    try:
        return _migrated(database)
    except DBAPIError as error:
        reason = str(error.orig).partition("\n")[0]
        raise SettingsError(
            f"the tables of {database.name} cannot be brought up to date: {reason}",
            f"无法更新 {database.name} 的表结构：{reason}",
        ) from error


def _migrated(database: Database) -> tuple[str | None, str]:
    with database.writing() as session:
        connection = session.connection()
        one_at_a_time(session, "migrate")
        _check_encoding(connection)
        before = version(connection)
        if before is None:
            _create(connection)
            _alembic(connection, "stamp")
        elif before != expected_version():
            _check_upgradable(database, before)
            _alembic(connection, "upgrade")
        _sort_by_code_point(connection)
        _install_queue(connection)
        return before, expected_version()


def _check_upgradable(database: Database, present: str) -> None:
    versions = _versions(_MIGRATIONS)
    if present in versions:
        return
    newest, oldest = versions[0], versions[-1]
    if present > newest:
        raise SettingsError(
            f"{database.name} is of a newer grader: its tables are at {present}, this one knows up to {newest}; "
            "install that version again, or restore a backup of before the upgrade",
            f"{database.name} 是更新版本的评分系统建的：表结构是 {present}，这个版本只认识到 {newest}；"
            "请重新安装那个版本，或恢复升级前的备份",
        )
    raise SettingsError(
        f"{database.name} is too old: its tables are at {present}, and this version upgrades from {oldest} on; "
        f"start a version of the grader in between once, which brings them to {oldest} or later",
        f"{database.name} 太旧：表结构是 {present}，这个版本只能从 {oldest} 起升级；"
        f"请先用一个介于两者之间的版本启动一次，把它更新到 {oldest} 或更新",
    )


def _create(connection: Connection) -> None:
    """Create the tables, each with its indexes in one order: SQLite chooses between equally good ones by it."""
    for table in SQLModel.metadata.sorted_tables:
        connection.execute(CreateTable(table))
        for index in sorted(table.indexes, key=lambda one: str(one.name)):
            connection.execute(CreateIndex(index))


def _alembic(connection: Connection, what: Literal["stamp", "upgrade"]) -> None:
    """Upgrade the tables, or only note that they are of the newest version."""
    from alembic import command
    from alembic.config import Config
    from alembic.util.exc import CommandError

    config = Config()
    config.set_main_option("script_location", str(_MIGRATIONS).replace("%", "%%"))
    config.attributes["connection"] = connection
    try:
        getattr(command, what)(config, "head")
    except CommandError as error:
        raise SettingsError(
            f"this database does not fit this version of the grader: {error}",
            f"这个数据库和这个版本的评分系统不配套：{error}",
        ) from error


def version(connection: Connection) -> str | None:
    """Return the version of a database's schema, or None when it has none."""
    if not connection.dialect.has_table(connection, "alembic_version"):
        return None
    present: str | None = connection.exec_driver_sql("SELECT version_num FROM alembic_version").scalar()
    return present


def expected_version() -> str:
    """Return the version of the schema that this grader works with."""
    return _versions(_MIGRATIONS)[0]


@cache
def _versions(migrations: Path) -> tuple[str, ...]:
    """Return the versions of the schema, the newest first: each module of one begins with it, and they sort."""
    names = sorted((path.stem for path in (migrations / "versions").glob("[!_]*.py")), reverse=True)
    return tuple(name.partition("_")[0] for name in names)


def _install_queue(connection: Connection) -> None:
    if connection.dialect.name == "sqlite":
        return
    from grader.store.jobs.schema import install

    install(connection)


def _check_encoding(connection: Connection) -> None:
    if connection.dialect.name == "sqlite":
        return
    encoding = connection.execute(text("SHOW server_encoding")).scalar_one()
    if encoding != "UTF8":
        raise SettingsError(
            f"the database is encoded in {encoding}: create one with ENCODING 'UTF8'",
            f"数据库的编码是 {encoding}：请用 ENCODING 'UTF8' 新建一个",
        )


def _sort_by_code_point(connection: Connection) -> None:
    """Make PostgreSQL compare and sort text as SQLite and Python do, whatever the locale of its server.

    Otherwise the gradebook's order of students would change when the database moves.
    """
    if connection.dialect.name == "sqlite":
        return
    ours = text(
        "SELECT c.relname, a.attname, format_type(a.atttypid, a.atttypmod) FROM pg_attribute a "
        "JOIN pg_class c ON c.oid = a.attrelid JOIN pg_collation l ON l.oid = a.attcollation "
        "WHERE c.relkind = 'r' AND c.relnamespace = current_schema()::regnamespace "
        "AND c.relname = ANY(:tables) AND a.attnum > 0 AND NOT a.attisdropped AND l.collname <> 'C'"
    )
    quote = connection.dialect.identifier_preparer.quote
    changes: dict[str, list[str]] = {}
    for table, column, kind in connection.execute(ours, {"tables": list(SQLModel.metadata.tables)}):
        changes.setdefault(table, []).append(f'ALTER COLUMN {quote(column)} TYPE {kind} COLLATE "C"')
    for table, parts in changes.items():
        connection.exec_driver_sql(f"ALTER TABLE {quote(table)} {', '.join(parts)}")
