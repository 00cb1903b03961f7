"""Connections and transactions, on SQLite and on PostgreSQL.

SQLite: WAL, so that readers never wait for the writer; ``synchronous=FULL``, so that an acknowledged upload
survives a power cut; writers begin with ``BEGIN IMMEDIATE``, because a transaction that starts by reading and
then wants to write can fail without waiting when another wrote in between. So writers are one after the other.
Those of one process wait for each other here: SQLite itself lets a writer look again after ever longer pauses, up
to a tenth of a second, while others go first who came at the right moment.

PostgreSQL: a reader has one snapshot (``REPEATABLE READ READ ONLY``), a writer sees with each statement what is
committed (``READ COMMITTED``). That alone would let two writers read the same and both act on it. What reads
before it writes therefore first takes a lock on what it decides about: `grader.store.locks`, or the row itself.
``SERIALIZABLE`` would do without such locks, but a transaction could then fail at any statement and would have
to be run again as a whole, most often on deadline evenings.
"""

import logging
import os
import sqlite3
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from typing import Any

from sqlalchemy import URL, Connection, Dialect, Engine, event, make_url
from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, NotSupportedError, ProgrammingError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from sqlmodel import Session, create_engine

from grader.contracts.errors import SettingsError
from grader.store.announcing import Announcer, Unannounced
from grader.store.liveness import check_before_use, no_answer
from grader.store.together import one_go, wait_for_answer

_LOCK_TIMEOUT_MS = 30_000
_LONGEST_LOG_PAGES = 10_000  # before a commit empties it, where `grader.store.checkpoints` did not
# of a statement, by its fault; other errors are of the database
_OF_STATEMENTS = (IntegrityError, DataError, ProgrammingError, NotSupportedError)
_BEGIN_OPTION = "grader_begin"
_CHANCES = 20
_CONNECTIONS = 10
PATIENCE = {
    "connect_timeout": 10,
    "keepalives_idle": 10,
    "keepalives_interval": 5,
    "keepalives_count": 3,
    "tcp_user_timeout": 25_000,
}
"""libpq's settings (seconds; the last one ms), unless the URL has others: a connection to a PostgreSQL server that
vanished without a word, as in a power cut, fails within half a minute. Linux' own defaults wait for two hours."""
_IDLE_TIMEOUT_MS = 15_000  # a frozen process must not keep its locks for longer than its lease


class Database:
    """One database; safe to share between threads. Close it when done.

    Attributes:
        announcer: is told of every row that a transaction makes ``queued``.
    """

    def __init__(self, url: str, connections: int = _CONNECTIONS) -> None:
        """Prepare; nothing is opened yet.

        Args:
            url: address of the database.
            connections: most of this process to a PostgreSQL server; threads beyond that wait for one.

        Raises:
            SettingsError: the driver that `url` needs is not installed.
        """
        self._engine = _engine(make_url(url), connections)
        self._reading = self._engine.execution_options(
            **{_BEGIN_OPTION: "BEGIN DEFERRED"}
            if self.is_sqlite
            else {"isolation_level": "REPEATABLE READ", "postgresql_readonly": True}
        )
        self._quick = self._engine.execution_options(isolation_level="AUTOCOMMIT")
        event.listen(self._quick, "after_cursor_execute", wait_for_answer)
        self.announcer = _announcer(self._engine)
        self._writer = threading.Lock()
        self._closed = False
        event.listen(self._engine, "checkin", self._close_late)

    @property
    def engine(self) -> Engine:
        """The engine, for migrations."""
        return self._engine

    @property
    def is_sqlite(self) -> bool:
        """Whether it is a SQLite file, else it is on a PostgreSQL server."""
        return self._engine.dialect.name == "sqlite"

    @property
    def name(self) -> str:
        """What to call it in messages: its address without a password."""
        url = self._engine.url
        return str(url.database) if self.is_sqlite else url.set(query={}).render_as_string(hide_password=True)

    @contextmanager
    def writing(self, *, quick: bool = False) -> Iterator[Session]:
        """One transaction that may write; committed at the end, rolled back on any exception.

        Args:
            quick: go to a PostgreSQL server and back as seldom as `grader.store.together.one_go` does.

        Raises:
            InfrastructureError: the database cannot be reached or stays locked. When the connection breaks
                during the commit, it is unknown whether the transaction took place.
        """
        if quick and not self.is_sqlite:
            with self._transaction(self._quick) as session, one_go(session.connection()):
                yield session
                session.flush()
            return
        with self._turn() if self.is_sqlite else nullcontext(), self._transaction(self._engine) as session:
            yield session

    @contextmanager
    def changing(self) -> Iterator[Connection]:
        """Do what `writing` does, for statements of tables: without a session, which keeps account of objects."""
        with (
            self._turn() if self.is_sqlite else nullcontext(),
            _explained(),
            self._engine.begin() as connection,
        ):
            yield connection

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """One transaction that only reads, on one consistent snapshot. Raises as `writing` does."""
        with self._transaction(self._reading) as session:
            yield session

    @contextmanager
    def asking(self) -> Iterator[Session]:
        """For one statement that only reads: one way to a PostgreSQL server, of which a transaction takes three.

        Another statement would see another state. Raises as `writing` does.
        """
        with self._transaction(self._reading if self.is_sqlite else self._quick) as session:
            yield session

    def close(self) -> None:
        """Close every connection; those in use by other threads as soon as their transactions end."""
        self._closed = True
        self._engine.dispose()

    def _close_late(self, connection: Any, _record: Any) -> None:
        if self._closed and connection is not None:
            connection.close()

    @contextmanager
    def _turn(self) -> Iterator[None]:
        if not self._writer.acquire(timeout=_LOCK_TIMEOUT_MS / 1_000):
            raise no_answer("another writer is at it", "另一个写操作一直没有结束")
        try:
            yield
        finally:
            self._writer.release()

    @contextmanager
    def _transaction(self, engine: Engine) -> Iterator[Session]:
        with _explained(), Session(engine, expire_on_commit=False) as session, session.begin():
            yield session


@contextmanager
def _explained() -> Iterator[None]:
    """Raise InfrastructureError for what is no fault of a statement."""
    try:
        yield
    except DBAPIError as error:
        if isinstance(error, _OF_STATEMENTS) and not error.connection_invalidated:
            raise
        reason = " ".join(str(error.orig).split())
        raise no_answer(reason, reason) from error
    except PoolTimeoutError as error:
        raise no_answer("every connection is busy", "全部连接都在使用") from error


def _engine(url: URL, connections: int) -> Engine:
    if url.get_backend_name() == "sqlite":
        engine = create_engine(url)
        event.listen(engine, "do_connect", _create_private)
        event.listen(engine, "connect", _configure_sqlite)
        event.listen(engine, "begin", _begin_sqlite)
        return engine
    try:
        engine = create_engine(
            url,
            isolation_level="READ COMMITTED",
            pool_size=connections,
            max_overflow=0,
            connect_args={name: value for name, value in PATIENCE.items() if name not in url.query},
        )
    except ImportError:
        raise SettingsError(
            "PostgreSQL needs packages that are not installed: install the grader with its extra 'postgres'",
            "没有安装 PostgreSQL 所需的软件包：安装 grader 时请带上附加项 'postgres'",
        ) from None
    # it warns of what fails after the error that it raised
    logging.getLogger("psycopg").setLevel(logging.ERROR)
    event.listen(engine, "connect", _configure_postgresql)
    check_before_use(engine)
    return engine


def _announcer(engine: Engine) -> Announcer:
    if engine.dialect.name == "sqlite":
        return Unannounced()
    # the embedded default does without Procrastinate
    from grader.store.permits.announcer import PermitAnnouncer

    return PermitAnnouncer()


def _create_private(_dialect: Dialect, _record: Any, arguments: Sequence[Any], _options: Any) -> None:
    """Create a SQLite file for its owner only: it has names and people's work. Its logs get the same mode."""
    # whatever else is wrong with the path, SQLite says
    with suppress(OSError):
        os.close(os.open(arguments[0], os.O_CREAT | os.O_EXCL | os.O_WRONLY | os.O_CLOEXEC, 0o600))


def _configure_sqlite(connection: Any, _record: Any) -> None:
    connection.isolation_level = None  # the driver must not begin transactions of its own
    connection.execute(f"PRAGMA busy_timeout={_LOCK_TIMEOUT_MS}")
    _write_ahead(connection)
    for pragma in (
        "synchronous=FULL",
        "foreign_keys=ON",
        f"wal_autocheckpoint={_LONGEST_LOG_PAGES}",
    ):
        connection.execute(f"PRAGMA {pragma}")


def _write_ahead(connection: Any) -> None:
    """Use a log beside the file. Who asks for that while another does is refused at once."""
    for _ in range(_CHANCES):
        try:
            connection.execute("PRAGMA journal_mode=WAL")
            return
        except sqlite3.OperationalError:
            connection.execute("BEGIN IMMEDIATE")  # this waits for the other, or says what is wrong
            connection.execute("ROLLBACK")
    connection.execute("PRAGMA journal_mode=WAL")


def _begin_sqlite(connection: Connection) -> None:
    connection.exec_driver_sql(connection.get_execution_options().get(_BEGIN_OPTION, "BEGIN IMMEDIATE"))


def _configure_postgresql(connection: Any, _record: Any) -> None:
    connection.autocommit = True
    connection.execute(
        f"SET client_encoding = 'UTF8'; SET lock_timeout = {_LOCK_TIMEOUT_MS}; "
        f"SET idle_in_transaction_session_timeout = {_IDLE_TIMEOUT_MS}"
    )
    connection.autocommit = False
