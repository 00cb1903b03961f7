"""Procrastinate's tables. They come and go with its version, because nothing in them matters.

Alembic does not keep them: which tables are right depends on the installed Procrastinate, not on the grader.
Nor are Procrastinate's own migrations run, which come in two halves around an upgrade and partly outside of
transactions. When a newer Procrastinate brings another schema, what an earlier `install` made is replaced as
a whole, in the transaction of `grader.store.schema.migrate`.

A comment on one of the tables says who made them, by which version, and the name of everything that was made. Only
what stands there is ever dropped.
"""

import hashlib
import json
from dataclasses import asdict, dataclass

from procrastinate import __version__
from procrastinate.schema import SchemaManager
from sqlalchemy import Connection, text

from grader.contracts.errors import SettingsError

_MAKER = "grader"
_COMMENT = text("SELECT obj_description(to_regclass('procrastinate_jobs'), 'pg_class')")
_PRESENT = text("SELECT to_regclass('procrastinate_jobs') IS NOT NULL")
_OBJECTS = text(
    "SELECT 'TABLE', oid::regclass::text FROM pg_class"
    " WHERE relkind = 'r' AND relnamespace = current_schema()::regnamespace"
    " UNION ALL SELECT 'FUNCTION', oid::regprocedure::text FROM pg_proc"
    " WHERE prokind = 'f' AND pronamespace = current_schema()::regnamespace"
    " UNION ALL SELECT 'TYPE', pg_type.oid::regtype::text FROM pg_type"
    " LEFT JOIN pg_class ON pg_class.oid = typrelid"
    " WHERE typnamespace = current_schema()::regnamespace AND (typtype = 'e' OR relkind = 'c')"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Installed:
    """What the comment says.

    Attributes:
        schema: digest of the statements that were executed.
        objects: kind and name of everything that they made.
    """

    maker: str
    version: str
    schema: str
    objects: list[list[str]]


def install(connection: Connection) -> None:
    """Create or replace Procrastinate's tables if they are not those of the installed version.

    Raises SettingsError: a newer Procrastinate made them, or somebody else did.
    """
    statements = SchemaManager.get_schema()
    schema = hashlib.sha256(statements.encode()).hexdigest()[:16]
    if connection.execute(_PRESENT).scalar_one():
        installed = _installed(connection.execute(_COMMENT).scalar_one())
        if installed.schema == schema:
            return
        _check_not_newer(installed.version)
        for kind, name in installed.objects:
            # CASCADE: tables have triggers that call functions that return rows of the tables
            connection.exec_driver_sql(f"DROP {kind} IF EXISTS {name} CASCADE")
    before = _objects(connection)
    _execute_all(connection, statements)
    added = [list(object_) for object_ in sorted(_objects(connection) - before)]
    comment = json.dumps(asdict(_Installed(maker=_MAKER, version=__version__, schema=schema, objects=added)))
    quoted = comment.replace("'", "''")
    _execute_all(connection, f"COMMENT ON TABLE procrastinate_jobs IS '{quoted}'")


def _objects(connection: Connection) -> set[tuple[str, str]]:
    """Return kind and name of every table, function and type of the current schema."""
    return {(kind, name) for kind, name in connection.execute(_OBJECTS)}


def _installed(comment: str | None) -> _Installed:
    try:
        installed = _Installed(**json.loads(comment or ""))
    except (ValueError, TypeError):
        installed = None
    if installed is None or installed.maker != _MAKER:
        raise SettingsError(
            "the database holds tables of Procrastinate that the grader did not make: give it its own database",
            "数据库里有别的程序建的 Procrastinate 表：请给评分系统单独一个数据库",
        )
    return installed


def _check_not_newer(version: str) -> None:
    if _number(version) > _number(__version__):
        raise SettingsError(
            f"the queue's tables were made by Procrastinate {version}, newer than {__version__} that is installed",
            f"队列的表由 Procrastinate {version} 建立，比这里安装的 {__version__} 新",
        )


def _number(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in version.split(".")[:3] if part.isdigit())


def _execute_all(connection: Connection, statements: str) -> None:
    """Execute without looking for parameters: the schema has percent signs."""
    driver = connection.connection.driver_connection
    assert driver is not None
    driver.execute(statements)
