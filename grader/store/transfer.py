"""Copying everything from one database into another, SQLite or PostgreSQL, with a proof that nothing changed.

It moves databases, and makes backups of PostgreSQL: every backup is a SQLite file.
"""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from sqlalchemy import Row, Table, delete, func, insert, select, text
from sqlalchemy.exc import DBAPIError, OperationalError
from sqlmodel import Session, SQLModel

from grader.contracts.errors import InfrastructureError, SettingsError
from grader.store.database import Database
from grader.store.schema import expected_version, version

_ROWS_AT_ONCE = 100  # trajectories are the largest: some tens of KB each


@dataclass(frozen=True, slots=True, kw_only=True)
class TableContent:
    """What a table holds: its rows, and the SHA-256 of them all in order of their primary key."""

    table: str
    rows: int
    sha256: str


def transfer(source: Database, target: Database, *, replace: bool = False) -> tuple[TableContent, ...]:
    """Copy every row, read what arrived, and keep it only if it is the same; return what was copied.

    The source is read from one snapshot and may be in use; nothing is written to it. The target is written in one
    transaction that locks its tables.

    Both have the schema of this version. The target is empty, or `replace`: what is in it is deleted first.

    Raises:
        SettingsError: one of them has another schema, the target is not empty, or cannot hold a row.
        InfrastructureError: what arrived is not what was sent, or a database does not answer.
    """
    with source.reading() as origin, target.writing() as goal:
        for database, session in ((source, origin), (target, goal)):
            _check_schema(database, session)
            _take_time(session)
        _reserve(goal)
        _make_room(target, goal, replace)
        sent = tuple(_copied(table, origin, goal) for table in _tables())
        arrived = contents(goal)
        if sent != arrived:
            raise _difference(sent, arrived)
        _continue_numbers(goal)
        if not target.is_sqlite:
            goal.execute(text("ANALYZE"))  # else the first questions are planned as if the tables were empty
    return sent


def check_source(database: Database) -> None:
    """Check that there is something to copy.

    Raises:
        SettingsError: it is not a database of the grader, or its schema is of another version.
        InfrastructureError: it does not answer.
    """
    if database.is_sqlite and not Path(database.name).is_file():  # opening it would create one
        raise SettingsError(f"{database.name}: there is no such file", f"{database.name}：没有这个文件")
    with database.reading() as session:
        _check_schema(database, session)


def contents(session: Session) -> tuple[TableContent, ...]:
    """Return what every table holds, as the transaction of `session` sees it."""
    return tuple(_summed(table, _rows(table, session)) for table in _tables())


def _tables() -> Sequence[Table]:
    """Every table, those first that others refer to."""
    return SQLModel.metadata.sorted_tables


def _check_schema(database: Database, session: Session) -> None:
    schema = version(session.connection())
    if schema is None:
        raise SettingsError(
            f"{database.name} holds no tables of the grader: is it the right one?",
            f"{database.name} 里没有评分系统的表：是不是写错了数据库？",
        )
    if schema != expected_version():
        raise SettingsError(
            f"{database.name} is at schema {schema}, not {expected_version()}: "
            "run `grader db migrate` on it first",
            f"{database.name} 的表结构是 {schema}，不是 {expected_version()}：先对它运行 `grader db migrate`",
        )


def _take_time(session: Session) -> None:
    if session.connection().dialect.name == "postgresql":
        # each database is idle while the other one works
        session.execute(text("SET LOCAL idle_in_transaction_session_timeout = 0"))


def _reserve(goal: Session) -> None:
    connection = goal.connection()
    if connection.dialect.name == "postgresql":
        names = ", ".join(connection.dialect.identifier_preparer.quote(table.name) for table in _tables())
        goal.execute(text(f"LOCK TABLE {names} IN ACCESS EXCLUSIVE MODE"))


def _make_room(target: Database, goal: Session, replace: bool) -> None:
    for table in reversed(_tables()):
        if replace:
            goal.execute(delete(table))
        elif goal.execute(select(table).limit(1)).first() is not None:
            raise SettingsError(
                f"{target.name} is not empty: there are rows in its table {table.name}; "
                "only `grader db restore --replace` deletes them",
                f"{target.name} 不是空的：表 {table.name} 里有数据；只有 grader db restore --replace 会删除它们",
            )


def _rows(table: Table, session: Session) -> Iterator[Row[Any]]:
    """Read in order of the primary key; rows that others of the same table refer to come before these."""
    inner = [
        column.is_not(None)
        for column in table.columns
        if any(key.column.table is table for key in column.foreign_keys)
    ]
    statement = select(table).order_by(*inner, *table.primary_key.columns)
    options = {"stream_results": True, "yield_per": _ROWS_AT_ONCE}
    yield from session.connection().execute(statement, execution_options=options)


def _copied(table: Table, origin: Session, goal: Session) -> TableContent:
    """Copy a table; return what was read of it."""

    def passed_on() -> Iterator[Row[Any]]:
        batch: list[dict[str, Any]] = []
        for row in _rows(table, origin):
            batch.append(row._asdict())
            if len(batch) == _ROWS_AT_ONCE:
                goal.connection().execute(insert(table), batch)
                batch.clear()
            yield row
        if batch:
            goal.connection().execute(insert(table), batch)

    try:
        return _summed(table, passed_on())
    except OperationalError:
        raise
    except DBAPIError as error:
        reason = " ".join(str(error.orig).split())
        raise SettingsError(
            f"nothing was copied: a row of {table.name} does not fit: {reason}",
            f"什么也没有复制：表 {table.name} 有一行放不进去：{reason}",
        ) from error


def _summed(table: Table, rows: Iterator[Row[Any]]) -> TableContent:
    count, digest = 0, hashlib.sha256()
    for row in rows:
        count += 1
        for value in row:
            kind, content = _canonical(value)
            digest.update(b"%b%d:%b" % (kind, len(content), content))
    return TableContent(table=table.name, rows=count, sha256=digest.hexdigest())


def _canonical(value: object) -> tuple[bytes, bytes]:
    """Return the kind of a value and its content, the same on every database."""
    match value:
        case None:
            return b"n", b""
        case bool() | int():
            return b"i", b"%d" % value
        case float():
            return b"f", value.hex().encode()
        case str():
            return b"s", value.encode()
        case bytes():
            return b"b", value
        case datetime():
            return b"t", value.isoformat(timespec="microseconds").encode()
    raise TypeError(f"no column holds {type(value).__name__}")


def _difference(sent: Sequence[TableContent], arrived: Sequence[TableContent]) -> InfrastructureError:
    (before, after) = next(pair for pair in zip(sent, arrived, strict=True) if pair[0] != pair[1])
    return InfrastructureError(
        f"nothing was copied: {after.rows} rows of {after.table} arrived, {before.rows} were sent, "
        "and they are not the same",
        f"什么也没有复制：表 {after.table} 发出 {before.rows} 行，收到 {after.rows} 行，内容不一致",
    )


def _continue_numbers(goal: Session) -> None:
    """Make PostgreSQL number new rows after the copied ones; SQLite does so by itself."""
    if goal.connection().dialect.name == "sqlite":
        return
    for table in _tables():
        column = table.autoincrement_column
        if column is not None:
            sequence = func.pg_get_serial_sequence(table.name, column.name)
            following = func.coalesce(func.max(column), 0) + 1
            goal.execute(select(func.setval(sequence, following, False)))
