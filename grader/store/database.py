"""Connections and transactions, on SQLite and on PostgreSQL.

There are two ways to begin a transaction, on both databases:

`Database.reading` gives one snapshot for as long as it lasts. On PostgreSQL it is ``REPEATABLE READ READ ONLY``.

`Database.writing` commits at the end, or rolls back on any exception. On PostgreSQL it is ``READ COMMITTED``: each
statement sees what is committed by then. So two writers could read the same row and both act on it. Whoever reads
before writing therefore first locks what the decision is about: by `one_at_a_time`, or by the row itself.
``SERIALIZABLE`` would need no such locks, but any statement could then fail and the whole transaction would have
to run again, most often on the evening of a deadline.

SQLite: WAL, so that readers never wait for the writer. There is one writer at a time. Writers begin with ``BEGIN
IMMEDIATE``: a transaction that reads first and writes later fails at once when another wrote in between. Writers
of one process queue here, in order of arrival (`_Turns`): SQLite itself makes a writer sleep for up to a tenth of
a second between two looks, while writers who came later get in.

A commit itself does not wait for the disk (``synchronous=NORMAL``), because the next writer would wait as well.
Whoever wrote waits after its turn, and all who wait at one moment share one ``fdatasync`` of the log
(`_Disk`): so an acknowledged upload survives a power cut, and a class that hands in at once costs the disk a few
writes and not hundreds. Each transaction still succeeds or fails alone. What has been committed is seen by readers
a moment before it lasts. What would be made again, the same, does not wait at all (``lasting=False``); the log is
one sequence, so whatever lasts takes with it all that was committed before.

PostgreSQL: a process keeps to the connections that it used last. It groups commits by itself.
"""

import hashlib
import logging
import os
import select as polling
import sqlite3
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager, nullcontext, suppress
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from sqlalchemy import (
    URL,
    Connection,
    Dialect,
    Engine,
    Insert,
    Select,
    bindparam,
    event,
    func,
    make_url,
    select,
)
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import (
    DataError,
    DBAPIError,
    IntegrityError,
    InvalidatePoolError,
    NotSupportedError,
    ProgrammingError,
    SQLAlchemyError,
)
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from sqlalchemy.sql import Executable
from sqlmodel import Session, SQLModel, create_engine

from grader.contracts.errors import InfrastructureError, SettingsError
from grader.store.tables import table_of

_log = logging.getLogger(__name__)
_LOCK_TIMEOUT_MS = 30_000
# After so many pages a commit empties the log itself: ten times SQLite's default, because `checkpoints` does it
# every second. A commit that does it keeps an upload waiting for a tenth of a second.
_LONGEST_LOG_PAGES = 10_000
_CHECKPOINT_EVERY_S = 1.0
# Errors that are a statement's own fault. Any other error means that the database does not answer.
_STATEMENT_ERRORS = (IntegrityError, DataError, ProgrammingError, NotSupportedError)
_BEGIN_OPTION = "grader_begin"
_WAL_TRIES = 20
_CONNECTIONS = 10
PATIENCE = {
    "connect_timeout": 10,
    "keepalives_idle": 10,
    "keepalives_interval": 5,
    "keepalives_count": 3,
    "tcp_user_timeout": 25_000,
}
"""libpq's settings (in seconds; the last one in ms), unless the URL sets them. With them a connection fails within
half a minute when its server vanishes silently, as in a power cut. Linux' defaults wait for two hours."""
_IDLE_TIMEOUT_MS = 15_000  # a frozen process must lose its locks no later than its leases
# A network may forget a connection that was idle for longer; such a connection is tried before use.
_LONG_IDLE_S = 5.0
_IDLE_SINCE = "grader_idle_since_s"
_KEY_BYTES = 8
_IDS_AT_ONCE = 500  # below SQLite's limit of variables
_One = TypeVar("_One")
_RowOf = TypeVar("_RowOf", bound=SQLModel)
_LOCK = select(func.pg_advisory_xact_lock(bindparam("key")))


def sqlite_address(file: Path) -> str:
    """Return the address of the SQLite database in a file, whatever the file is called."""
    return "sqlite:///" + str(file.resolve()).replace("%", "%25").replace("?", "%3F")


class Database:
    """One database; safe to share between threads. Close it when done."""

    def __init__(self, url: str, connections: int = _CONNECTIONS) -> None:
        """Prepare; nothing is opened yet.

        `connections`: most of this process to a PostgreSQL server; threads beyond that wait for one.

        Raises SettingsError: the driver that `url` needs is not installed.
        """
        self._engine = _engine(make_url(url), connections)
        self._snapshots = self._engine.execution_options(
            **{_BEGIN_OPTION: "BEGIN DEFERRED"}
            if self.is_sqlite
            else {"isolation_level": "REPEATABLE READ", "postgresql_readonly": True}
        )
        self._turns = _Turns()
        self._disk = _Disk(f"{self._engine.url.database}-wal")
        self._own = threading.local()
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
    def writing(self, *, lasting: bool = True) -> Iterator[Session]:
        """One transaction that may write; committed at the end, rolled back on any exception.

        Args:
            lasting: what is committed survives a power cut. False: it may be lost, with all that was committed
                after it in the same way, unless a lasting commit came later.

        Raises:
            InfrastructureError: the database cannot be reached or stays locked. When the connection breaks
                during the commit, it is unknown whether the transaction took place.
        """
        with (
            self._turns.mine() if self.is_sqlite else nullcontext(),
            self._transaction(self._engine) as session,
        ):
            if not (lasting or self.is_sqlite):
                session.connection().exec_driver_sql("SET LOCAL synchronous_commit = off")
            yield session
        if lasting and self.is_sqlite:
            self._disk.take_in()

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """One transaction that only reads, on one consistent snapshot. Raises as `writing` does.

        Within another one of the same thread it is that one: whoever asks several parts of the store for one
        answer gets one snapshot, and pays for one transaction.
        """
        outer: Session | None = getattr(self._own, "session", None)
        if outer is not None:
            yield outer
            return
        with self._transaction(self._snapshots) as session:
            self._own.session = session
            try:
                yield session
            finally:
                self._own.session = None

    def free_bytes(self) -> int | None:
        """Return how much room its disk has; None of a server, which watches its own."""
        if not self.is_sqlite:
            return None
        disk = os.statvfs(Path(self.name).parent)
        return disk.f_bavail * disk.f_frsize

    def close(self) -> None:
        """Close every connection; those in use by other threads as soon as their transactions end."""
        self._closed = True
        self._engine.dispose()

    def _close_late(self, connection: Any, _record: Any) -> None:
        if self._closed and connection is not None:
            connection.close()

    @contextmanager
    def _transaction(self, engine: Engine) -> Iterator[Session]:
        with explained(), Session(engine, expire_on_commit=False) as session, session.begin():
            yield session


class _Turns:
    """One writer of this process at a time, in order of arrival."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._waiting: deque[threading.Event] = deque()
        self._taken = False

    @contextmanager
    def mine(self) -> Iterator[None]:
        """Wait for a turn and hold it. Raises InfrastructureError: it does not come."""
        self._wait()
        try:
            yield
        finally:
            with self._lock:
                if self._waiting:
                    self._waiting.popleft().set()
                else:
                    self._taken = False

    def _wait(self) -> None:
        with self._lock:
            if not self._taken:
                self._taken = True
                return
            mine = threading.Event()
            self._waiting.append(mine)
        if mine.wait(_LOCK_TIMEOUT_MS / 1_000):
            return
        with self._lock:
            if mine.is_set():  # it came at the last moment
                return
            self._waiting.remove(mine)
        raise _no_answer("another writer is at it", "另一个写操作一直没有结束")


class _Disk:
    """Has SQLite's log written to the disk; all who ask while one write is under way share the next one."""

    def __init__(self, log: str) -> None:
        self._log = log
        self._lock = threading.Lock()
        self._busy = threading.Lock()
        self._next: Future[None] | None = None

    def take_in(self) -> None:
        """Return once everything that was committed before this call survives a power cut.

        Raises InfrastructureError: the disk failed. What was committed may be lost in a power cut.
        """
        with self._lock:
            ours, first = self._next, self._next is None
            if ours is None:
                ours = self._next = Future()
        if first:
            with self._busy:
                with self._lock:
                    self._next = None  # whoever comes from now on may have committed too late for this write
                _settle(ours, self._write)
        ours.result()

    def _write(self) -> None:
        try:
            descriptor = os.open(self._log, os.O_RDONLY | os.O_CLOEXEC)
        except FileNotFoundError:
            return  # the last connection was closed meanwhile, and has put everything into the database's file
        try:
            os.fdatasync(descriptor)
        except OSError as error:
            raise _no_answer(str(error), str(error)) from error
        finally:
            os.close(descriptor)


def _settle(future: Future[None], work: Callable[[], None]) -> None:
    try:
        work()
    except BaseException as error:
        future.set_exception(error)
    else:
        future.set_result(None)


class StorePart:
    """A part of the store, by its subject: reads and writes one database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def _rows(self, statement: Executable) -> Sequence[Any]:
        """Return the rows that one statement finds, in a transaction of its own."""
        with self._database.reading() as session:
            return session.execute(statement).all()

    def _scalars(self, statement: Executable) -> Sequence[Any]:
        """Return the first column of these rows, which may be whole objects."""
        with self._database.reading() as session:
            return session.execute(statement).scalars().all()

    def _get(self, table: type[_RowOf], key: object) -> _RowOf | None:
        """Return the row of a primary key, None where there is none."""
        with self._database.reading() as session:
            return session.get(table, key)

    def _finds(self, statement: Select[Any]) -> bool:
        """Whether a statement would find any row."""
        return bool(self._rows(statement.limit(1)))


def one_at_a_time(session: Session, *what: str | None) -> None:
    """Wait until no other transaction that named the same `what` is under way.

    SQLite has one writer at a time anyway. On PostgreSQL this takes an advisory lock that ends with the
    transaction. Call it first and once: what the transaction reads afterwards is what the one before it left,
    and two transactions with one lock each cannot wait for each other in a circle. Only an upload of a team takes
    a second one, the team's, and nobody asks for another while holding that.
    """
    if session.get_bind().dialect.name == "sqlite":
        return
    digest = hashlib.sha256(repr(what).encode()).digest()
    # if two names happen to have one key, their transactions wait for each other without need, and no more
    key = int.from_bytes(digest[:_KEY_BYTES], "big", signed=True)
    session.connection().execute(_LOCK, {"key": key})


def in_lots(whole: Iterable[_One], most: int = _IDS_AT_ONCE) -> Iterator[list[_One]]:
    """Cut ids, or what else there are many of, into lists that are not too long for one statement."""
    listed = list(whole)
    for start in range(0, len(listed), most):
        yield listed[start : start + most]


def add_once(connection: Connection, table: type[SQLModel], **values: Any) -> None:
    """Add a row unless one with its primary key is there, or is being added by another transaction."""
    connection.execute(_unless_there(table, connection.dialect.name), values)


@cache
def _unless_there(table: type[SQLModel], dialect: str) -> Insert:
    insert = sqlite.insert if dialect == "sqlite" else postgresql.insert
    return insert(table_of(table)).on_conflict_do_nothing()


def put(connection: Connection, table: type[SQLModel], **values: Any) -> None:
    """Add a row, or give the one with its primary key these values."""
    insert = sqlite.insert if connection.dialect.name == "sqlite" else postgresql.insert
    keys = [column.name for column in table_of(table).primary_key]
    others = {name: value for name, value in values.items() if name not in keys}
    statement = insert(table_of(table)).values(**values)
    connection.execute(statement.on_conflict_do_update(index_elements=keys, set_=others))


@contextmanager
def checkpoints(database: Database, every_s: float = _CHECKPOINT_EVERY_S) -> Iterator[None]:
    """Move what was committed from SQLite's log into its file, every `every_s` seconds, in a thread.

    SQLite does so at the end of the commit that makes the log long enough. That commit would be somebody's upload.
    PostgreSQL needs no help: nothing happens there. If a checkpoint fails, the next one does its work.
    """
    if not database.is_sqlite:
        yield
        return
    ended = threading.Event()

    def go_on() -> None:
        while not ended.wait(every_s):
            try:
                checkpoint(database)
            except (SQLAlchemyError, sqlite3.Error) as error:  # also when every connection is busy
                _log.warning("the write-ahead log was not emptied: %s", error)

    thread = threading.Thread(target=go_on, name="grader-checkpoints", daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def checkpoint(database: Database) -> None:
    """Make one checkpoint now, as far as readers of older snapshots allow; nobody waits for it."""
    _checkpoint(database, "PASSIVE")


def empty_log(database: Database) -> None:
    """Leave nothing in SQLite's log of what was deleted; waits for readers of older snapshots."""
    if database.is_sqlite:
        with explained():
            _checkpoint(database, "TRUNCATE")


def _checkpoint(database: Database, how: str) -> None:
    connection = database.engine.raw_connection()  # a checkpoint cannot run inside a transaction
    try:
        connection.cursor().execute(f"PRAGMA wal_checkpoint({how})")
    finally:
        connection.close()


@contextmanager
def explained() -> Iterator[None]:
    """Raise InfrastructureError for what is not a statement's own fault."""
    try:
        yield
    except DBAPIError as error:
        of_statement = isinstance(error, _STATEMENT_ERRORS) and error.statement is not None
        if of_statement and not error.connection_invalidated:
            raise
        reason = " ".join(str(error.orig).split())
        raise _no_answer(reason, reason) from error
    except PoolTimeoutError as error:
        raise _no_answer("every connection is busy", "全部连接都在使用") from error


def _no_answer(en: str, zh: str) -> InfrastructureError:
    return InfrastructureError(f"the database does not answer: {en}", f"数据库没有回应：{zh}")


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
            pool_use_lifo=True,  # the connection used last has prepared what is asked most
            connect_args={
                "client_encoding": "utf8",  # before anything is asked: of SQL_ASCII psycopg makes no text
                **{name: value for name, value in PATIENCE.items() if name not in url.query},
            },
        )
    except ImportError:
        raise SettingsError(
            "PostgreSQL needs packages that are not installed: install the grader with its extra 'postgres'",
            "没有安装 PostgreSQL 所需的软件包：安装 grader 时请带上附加项 'postgres'",
        ) from None
    # psycopg warns again of what it already raised
    logging.getLogger("psycopg").setLevel(logging.ERROR)
    event.listen(engine, "connect", _configure_postgresql)
    _replace_dead_connections(engine)
    return engine


def _create_private(_dialect: Dialect, _record: Any, arguments: Sequence[Any], _options: Any) -> None:
    """Create a SQLite file that only its owner reads: it holds people's work. Its logs get the same mode."""
    # if anything else is wrong with the path, SQLite says so
    with suppress(OSError):
        os.close(os.open(arguments[0], os.O_CREAT | os.O_EXCL | os.O_WRONLY | os.O_CLOEXEC, 0o600))


def _configure_sqlite(connection: Any, _record: Any) -> None:
    connection.isolation_level = None  # the driver must not begin transactions of its own
    connection.execute(f"PRAGMA busy_timeout={_LOCK_TIMEOUT_MS}")
    _write_ahead(connection)
    for pragma in (
        "synchronous=NORMAL",  # `_Disk` does the rest
        "foreign_keys=ON",
        "secure_delete=ON",  # what is deleted is overwritten: somebody may have asked to be forgotten
        f"wal_autocheckpoint={_LONGEST_LOG_PAGES}",
    ):
        connection.execute(f"PRAGMA {pragma}")


def _write_ahead(connection: Any) -> None:
    """Switch to a write-ahead log. SQLite refuses at once if another connection is switching, too."""
    for _ in range(_WAL_TRIES):
        try:
            connection.execute("PRAGMA journal_mode=WAL")
            return
        except sqlite3.OperationalError:
            connection.execute("BEGIN IMMEDIATE")  # waits for the other connection, or says what is wrong
            connection.execute("ROLLBACK")
    connection.execute("PRAGMA journal_mode=WAL")


def _begin_sqlite(connection: Connection) -> None:
    connection.exec_driver_sql(connection.get_execution_options().get(_BEGIN_OPTION, "BEGIN IMMEDIATE"))


def _configure_postgresql(connection: Any, _record: Any) -> None:
    _send_no_nul(connection)
    connection.autocommit = True
    connection.execute(
        f"SET lock_timeout = {_LOCK_TIMEOUT_MS}; SET idle_in_transaction_session_timeout = {_IDLE_TIMEOUT_MS}"
    )
    connection.autocommit = False


def _send_no_nul(connection: Any) -> None:
    """Have U+FFFD sent for NUL, which PostgreSQL takes in no text: whoever asks for an id with one finds nothing.

    As `PlainText` does for what is stored. SQLite, which takes any text, finds nothing either.
    """
    # What a string is sent as unless somebody says otherwise.
    from psycopg.types.string import (
        StrDumperUnknown,
    )

    class _WithoutNul(StrDumperUnknown):
        def dump(self, obj: str) -> Any:
            return super().dump(obj.replace("\0", "\ufffd") if "\0" in obj else obj)

    connection.adapters.register_dumper(str, _WithoutNul)


def _replace_dead_connections(engine: Engine) -> None:
    """Have the pool replace dead connections before use, so that no request fails after a restart of the server.

    A server that stops closes its end: there is something to read on a connection on which nothing was asked.
    Seeing that needs no round trip to the server. Only such a connection, and one that was idle for long, is
    asked.
    """

    def rest(_connection: Any, record: Any) -> None:
        record.info[_IDLE_SINCE] = time.monotonic()

    def wake(connection: Any, record: Any, _fairy: Any) -> None:
        since_s = record.info.get(_IDLE_SINCE)
        if since_s is None:  # just made: if something is wrong with it, its first statement says so
            return
        short = time.monotonic() - since_s < _LONG_IDLE_S
        if short and not connection.closed and not _something_to_read(connection):
            return
        if connection.closed or not _answers(engine, connection):
            raise InvalidatePoolError

    event.listen(engine, "checkin", rest)
    event.listen(engine, "checkout", wake)


def _something_to_read(connection: Any) -> bool:
    look = polling.poll()
    look.register(connection.fileno(), polling.POLLIN)
    return bool(look.poll(0))


def _answers(engine: Engine, connection: Any) -> bool:
    try:
        return bool(engine.dialect.do_ping(connection))
    except engine.dialect.loaded_dbapi.Error:
        return False
