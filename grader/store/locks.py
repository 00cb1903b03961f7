"""Making transactions wait for each other where they read before they write.

On SQLite every writing transaction is alone, and the functions here have nothing to do. On PostgreSQL they take
an advisory lock that ends with the transaction. A transaction takes at most one, as its first statement: what it
reads afterwards is what the transaction before it left, and no two can wait for each other in a circle.
"""

import hashlib
from functools import cache
from typing import Any

from sqlalchemy import Connection, Insert, bindparam, func, select
from sqlalchemy.dialects import postgresql, sqlite
from sqlmodel import Session, SQLModel

from grader.store.tables import table_of
from grader.store.together import together

_KEY_BYTES = 8
_LOCK = select(func.pg_advisory_xact_lock(bindparam("key")))


def one_at_a_time(transaction: Session | Connection, *what: str | None) -> None:
    """Wait until no other transaction that named the same `what` is under way."""
    connection = _connection(transaction)
    if connection.dialect.name == "sqlite":
        return
    digest = hashlib.sha256(repr(what).encode()).digest()
    # equal keys of different names would only make two transactions wait that need not
    key = int.from_bytes(digest[:_KEY_BYTES], "big", signed=True)
    with together(connection):
        connection.execute(_LOCK, {"key": key})


def add_once(transaction: Session | Connection, table: type[SQLModel], **values: Any) -> None:
    """Add a row unless one of its primary key is there, or is being added by another transaction."""
    connection = _connection(transaction)
    connection.execute(_unless_there(table, connection.dialect.name), values)


def _connection(transaction: Session | Connection) -> Connection:
    return transaction.connection() if isinstance(transaction, Session) else transaction


@cache
def _unless_there(table: type[SQLModel], dialect: str) -> Insert:
    insert = sqlite.insert if dialect == "sqlite" else postgresql.insert
    return insert(table_of(table)).on_conflict_do_nothing()
