"""Procrastinate's tables. They come and go with its version, because nothing in them matters.

Alembic does not keep them: which tables are right depends on the installed Procrastinate, not on the grader. Nor
are Procrastinate's own migrations run, which come in two halves around an upgrade and partly outside of
transactions. What is there is replaced as a whole, in the transaction of `grader.store.schema.migrate`, when a
newer Procrastinate brings another schema; the sweep then gives every waiting row a new permit.
"""

import hashlib

from procrastinate import __version__
from procrastinate.schema import SchemaManager
from sqlalchemy import Connection, text

from grader.contracts.errors import SettingsError

_PREFIX = "grader"
_INSTALLED = text("SELECT obj_description(to_regclass('procrastinate_jobs'), 'pg_class')")
_PRESENT = text("SELECT to_regclass('procrastinate_jobs') IS NOT NULL")
_INDEX = "CREATE INDEX grader_not_waiting ON procrastinate_jobs (queue_name) WHERE status <> 'todo'"
"""Ours, for the sweep, which looks for a few such jobs among many that wait."""
_DROP = r"""
DO $$
DECLARE victim record;
BEGIN
  FOR victim IN SELECT oid::regclass AS name FROM pg_class WHERE relkind = 'r'
      AND relnamespace = current_schema()::regnamespace AND relname LIKE 'procrastinate\_%' LOOP
    EXECUTE format('DROP TABLE %s CASCADE', victim.name);
  END LOOP;
  FOR victim IN SELECT oid::regprocedure AS name FROM pg_proc
      WHERE pronamespace = current_schema()::regnamespace AND proname LIKE 'procrastinate\_%' LOOP
    EXECUTE format('DROP FUNCTION %s CASCADE', victim.name);
  END LOOP;
  FOR victim IN SELECT oid::regtype AS name FROM pg_type WHERE typtype IN ('e', 'c')
      AND typnamespace = current_schema()::regnamespace AND typname LIKE 'procrastinate\_%' LOOP
    EXECUTE format('DROP TYPE %s CASCADE', victim.name);
  END LOOP;
END
$$
"""


def install(connection: Connection) -> None:
    """Create or replace Procrastinate's tables if they are not those of the installed version.

    Raises:
        SettingsError: a newer Procrastinate made them, or somebody else did.
    """
    schema = f"{SchemaManager.get_schema()};\n{_INDEX};"
    digest = hashlib.sha256(schema.encode()).hexdigest()[:16]
    if connection.execute(_PRESENT).scalar_one():
        found = connection.execute(_INSTALLED).scalar_one()
        if not _replaceable(found, digest):
            return
        _raw(connection, _DROP)
    _raw(connection, schema)
    _raw(connection, f"COMMENT ON TABLE procrastinate_jobs IS '{_PREFIX} {__version__} {digest}'")


def _replaceable(found: str | None, digest: str) -> bool:
    owner, version, known = (found or "").split() if len((found or "").split()) == 3 else ("", "", "")
    if owner != _PREFIX:
        raise SettingsError(
            "the database holds tables of Procrastinate that the grader did not make: give it its own database",
            "数据库里有别的程序建的 Procrastinate 表：请给评分系统单独一个数据库",
        )
    if known == digest:
        return False
    if _number(version) > _number(__version__):
        raise SettingsError(
            f"the queue's tables were made by Procrastinate {version}, newer than {__version__} that is installed",
            f"队列的表由 Procrastinate {version} 建立，比这里安装的 {__version__} 新",
        )
    return True


def _number(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in version.split(".")[:3] if part.isdigit())


def _raw(connection: Connection, statements: str) -> None:
    """Execute without looking for parameters: the schema has percent signs."""
    driver = connection.connection.driver_connection
    assert driver is not None
    driver.execute(statements)
