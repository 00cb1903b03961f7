"""The lock of a database: services share it, a command that replaces or moves the database takes it exclusively.

SQLite: a lock on a file beside the database. PostgreSQL: an advisory lock. Every connection of a service
shares it, so every new connection takes it again.
"""

import fcntl
import logging
import os
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from sqlalchemy import Connection, event, func, select, text
from sqlmodel import Session

from grader.contracts.errors import InfrastructureError, SettingsError
from grader.contracts.text import trouble
from grader.store.database import Database, explained

_log = logging.getLogger(__name__)
_LOCK = (0x67726164, 1)  # a pair of numbers, unlike the locks of `grader.store.database`
_SOLE_LOCK = (0x67726164, 2)
_LOOK_S = 0.5
_LOOKS = 20
_LEAVING_S = 0.05  # between two looks at who seems to leave
_NAME_LENGTH = 63  # longer ones PostgreSQL cuts
_NAMED = 5
_OTHER_USERS = text(
    "SELECT DISTINCT coalesce(application_name, 'another role''s process') AS name"
    " FROM pg_locks JOIN pg_stat_activity USING (pid)"
    " WHERE locktype = 'advisory' AND classid = :space AND objid = :number AND objsubid = 2 AND granted"
    " AND database = (SELECT oid FROM pg_database WHERE datname = current_database())"
    " AND pid <> pg_backend_pid() ORDER BY name"
)


_ROOM = text(  # pg_stat_activity tells little of other roles' connections, this one tells their number
    "SELECT current_setting('max_connections')::int - current_setting('superuser_reserved_connections')::int,"
    " coalesce(sum(numbackends), 0)::int FROM pg_stat_database"
)


class ServerRoom(NamedTuple):
    """How many connections a PostgreSQL server takes from ordinary roles, and how many there are."""

    most: int
    taken: int


class OccupiedError(SettingsError):
    """Somebody works with the database."""


@contextmanager
def in_use(database: Database, who: str = "a command of the grader") -> Iterator[None]:
    """Keep others from replacing or moving the database while the context lasts; first wait until nobody does.

    No transaction of `database` may be under way. Connections from before are not used again. On PostgreSQL a
    command that wants to be alone is told `who` works with the database.

    Raises:
        InfrastructureError: the database does not answer. Within the context a new connection also raises it if
            somebody began to replace the database during an outage that cut all connections.
    """
    if database.is_sqlite:
        with _lock_file(f"{database.name}.open") as descriptor:
            _wait_until_free(lambda: _share_file(database, descriptor))
            database.engine.dispose()  # the file may have been replaced
            yield
        return
    with _sharing(database, who):
        _wait_until_free(lambda: _connect(database))
        yield


def room(database: Database) -> ServerRoom | None:
    """Return how many connections the server of a database has room for; None of SQLite.

    Raises InfrastructureError: the database does not answer.
    """
    if database.is_sqlite:
        return None
    with database.reading() as session:
        return ServerRoom(*session.execute(_ROOM).one())


def check_room(database: Database, needed: int) -> None:
    """Refuse to work where the server cannot take `needed` connections; warn where it cannot just now.

    Raises:
        SettingsError: it never can.
        InfrastructureError: the database does not answer.
    """
    there = room(database)
    if there is None:
        return
    if needed > there.most:
        raise SettingsError(
            f"{database.name} takes {there.most} connections, this process needs {needed}: raise max_connections, "
            "or lower GRADER_DATABASE_CONNECTIONS or GRADER_SLOTS",
            f"{database.name} 最多允许 {there.most} 个连接，这个进程需要 {needed} 个：请调大 max_connections，"
            "或调小 GRADER_DATABASE_CONNECTIONS、GRADER_SLOTS",
        )
    if needed > there.most - there.taken + 1:  # one is this process's own
        _log.warning(
            "%s takes %d connections and has %d; this process needs up to %d: raise max_connections",
            database.name,
            there.most,
            there.taken,
            needed,
        )


@contextmanager
def alone(database: Database) -> Iterator[None]:
    """Keep services from a database for as long as the context lasts.

    Raises:
        OccupiedError: a service, a worker or a command works with the database; on PostgreSQL it says which.
        InfrastructureError: the database does not answer.
    """
    if not database.is_sqlite:
        with database.writing() as session:
            _take(session, database.name)
            yield
        return
    with _lock_file(f"{database.name}.open") as descriptor:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise OccupiedError(
                f"a service works with {database.name}: stop it first",
                f"有服务正在使用 {database.name}：请先停止它",
            ) from None
        yield


class Sole:
    """What one process alone may have of all that share a database. Safe to share between threads.

    It is taken when first asked for, and kept until this is closed.
    """

    def __init__(self, database: Database) -> None:
        self._database = database
        self._asking = threading.Lock()
        self._kept = ExitStack()
        self._connection: Connection | None = None
        self._descriptor: int | None = None

    def is_mine(self) -> bool:
        """Return whether this process has it, now or from now on.

        Raises InfrastructureError: the database does not answer.
        """
        with self._asking:
            return self._of_file() if self._database.is_sqlite else self._of_server()

    def close(self) -> None:
        """Leave it to others."""
        self._kept.close()
        self._descriptor = None
        self._let_go()

    def _of_file(self) -> bool:
        if self._descriptor is None:
            self._descriptor = self._kept.enter_context(_lock_file(f"{self._database.name}.live"))
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True

    def _of_server(self) -> bool:
        """Ask again each time: with a broken connection the lock was lost."""
        try:
            with explained():
                self._connection = self._connection or self._database.engine.connect()
                question = select(func.pg_try_advisory_lock(*_SOLE_LOCK))
                granted: bool = self._connection.execute(question).scalar_one()
                self._connection.commit()
        except InfrastructureError:
            self._let_go()
            raise
        if not granted:
            self._let_go()
        return granted

    def _let_go(self) -> None:
        if self._connection is not None:
            if not self._connection.invalidated:
                self._connection.invalidate()
            self._connection.close()
            self._connection = None


class _ReplacedError(InfrastructureError):
    """The database is being replaced, moved or upgraded."""

    def __init__(self, database: Database) -> None:
        name = database.name
        super().__init__(f"{name} is being replaced, moved or upgraded", f"{name} 正在被替换、迁移或升级")


@contextmanager
def _sharing(database: Database, who: str) -> Iterator[None]:
    """Let every new connection share the lock; close all connections at the end."""

    def share(connection: Any, _record: Any) -> None:
        connection.autocommit = True
        connection.execute("SELECT set_config('application_name', %s, false)", (_name(who),))
        ((granted,),) = connection.execute("SELECT pg_try_advisory_lock_shared(%s, %s)", _LOCK).fetchall()
        connection.autocommit = False
        if not granted:
            connection.close()
            raise _ReplacedError(database)

    database.engine.dispose()
    event.listen(database.engine, "connect", share)
    try:
        yield
    finally:
        event.remove(database.engine, "connect", share)
        database.engine.dispose()


def _wait_until_free(enter: Callable[[], None]) -> None:
    is_told = False
    while True:
        try:
            return enter()
        except _ReplacedError as error:
            if not is_told:
                _log.warning("%s: waiting until that has ended", error)
                is_told = True
            time.sleep(_LOOK_S)


def _share_file(database: Database, descriptor: int) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        raise _ReplacedError(database) from None


def _connect(database: Database) -> None:
    with database.reading() as session:
        session.connection()


def _take(session: Session, name: str) -> None:
    """Take the lock until the transaction ends. A transaction that takes long is not ended for being idle."""
    session.execute(text("SET LOCAL idle_in_transaction_session_timeout = 0"))
    session.execute(select(func.set_config("application_name", _name("grader db"), True)))
    space, number = _LOCK
    for _ in range(_LOOKS):
        if session.execute(select(func.pg_try_advisory_xact_lock(*_LOCK))).scalar_one():
            return
        there = session.execute(_OTHER_USERS, {"space": space, "number": number}).scalars().all()
        if there:
            break
        time.sleep(_LEAVING_S)
    more = [f"{len(there) - _NAMED} more"] if len(there) > _NAMED else []
    names = "; ".join([*there[:_NAMED], *more]) or "somebody who is leaving"
    raise OccupiedError(f"{name} is in use by {names}: stop it first", f"{name} 正被 {names} 使用：请先停止")


def _name(who: str) -> str:
    name = f"{who}, process {os.getpid()} on {socket.gethostname()}"
    return name.encode("ascii", "replace").decode()[:_NAME_LENGTH]


@contextmanager
def _lock_file(path: str) -> Iterator[int]:
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    except OSError as error:
        folder, told = Path(path).parent, trouble(error)
        if not folder.is_dir():
            raise SettingsError(
                f"there is no folder {folder}: make it, or check where the database is to be",
                f"没有文件夹 {folder}：请先建立，或检查数据库的位置",
            ) from error
        raise SettingsError.about(path, told) from error
    try:
        yield descriptor
    finally:
        os.close(descriptor)
