"""Statements that are sent to a PostgreSQL server together: one way there and back instead of one each.

What a way costs is not the statement but waiting for a processor, once there and once here. On SQLite, where there
is no way, nothing here changes anything.
"""

import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

from sqlalchemy import Connection

from grader.store.liveness import no_answer

_PIPELINE = "grader_pipeline"
_UNANSWERED = "grader_unanswered"


@contextmanager
def together(connection: Connection, *, last: bool = False) -> Iterator[None]:
    """Send what is executed within at once, and wait for all of it at the end; in `one_go`, not even then.

    Within, no result may be looked at, not even how many rows a statement changed.

    Args:
        connection: in a transaction.
        last: nothing else is executed in the transaction: its commit goes along.

    Raises:
        InfrastructureError: the database does not answer. Other errors of statements come as the driver's.
    """
    if connection.dialect.name == "sqlite":
        yield
        return
    about = connection.info  # cannot be asked for once the connection is lost
    if _PIPELINE not in about:
        with _pipeline(connection), _in_one_piece(connection):
            yield
            if last:
                _driver(connection).execute("COMMIT")  # SQLAlchemy's own finds nothing to do then
        return
    pipeline = about[_UNANSWERED] = about[_PIPELINE]
    try:
        yield
    finally:
        _forget(about, _UNANSWERED, pipeline)


@contextmanager
def one_go(connection: Connection) -> Iterator[None]:
    """Begin a transaction on PostgreSQL at the start and commit it at the end, with no ways for that alone.

    What is sent `together` goes with the next statement whose answer is needed, or with the commit, and what is
    wrong with it is said there. The server cannot be asked for a cursor, nor for several statements in one.

    Args:
        connection: in autocommit mode, so that nobody else begins a transaction; `wait_for_answer` listens to it.

    Raises:
        InfrastructureError: as `together`; whether the transaction took place is unknown then.
    """
    driver, about = _driver(connection), connection.info
    with _pipeline(connection) as pipeline:
        about[_PIPELINE] = pipeline
        try:
            driver.execute("BEGIN ISOLATION LEVEL READ COMMITTED")
            yield
            driver.execute("COMMIT")
        finally:
            _forget(about, _PIPELINE, pipeline)


def wait_for_answer(connection: Connection, *_executed: Any) -> None:
    """Wait, in `one_go`, for the answer to what has just been executed: SQLAlchemy looks at it next."""
    if _PIPELINE in connection.info and _UNANSWERED not in connection.info:
        connection.info[_PIPELINE].sync()


@contextmanager
def _pipeline(connection: Connection) -> Iterator[Any]:
    errors = connection.dialect.loaded_dbapi
    try:
        with _driver(connection).pipeline() as pipeline:
            yield pipeline
    except (errors.OperationalError, errors.InterfaceError, errors.InternalError) as error:
        # the last: such as a transaction that the server ended because it was idle for too long
        connection.invalidate()  # nothing can be asked on it, not even to roll back
        reason = " ".join(str(_first(error)).split())
        raise no_answer(reason, reason) from error


def _forget(about: dict[Any, Any], key: str, pipeline: object) -> None:
    """Delete what is known of a connection, unless it was lost: another thread's may be in its place already."""
    if about.get(key) is pipeline:
        del about[key]


@contextmanager
def _in_one_piece(connection: Connection) -> Iterator[None]:
    """Keep what is sent until the end. The driver sends each statement by itself, and wakes the server.

    Not where the driver is still to begin the transaction: it waits for the answer to what would be kept.
    """
    driver = _driver(connection)
    if driver.info.transaction_status.name == "IDLE":
        yield
        return
    with socket.fromfd(driver.fileno(), socket.AF_INET, socket.SOCK_STREAM) as wire:
        with suppress(OSError, AttributeError):  # a Unix socket has no cork, nor has macOS
            wire.setsockopt(socket.IPPROTO_TCP, socket.TCP_CORK, 1)
        try:
            yield
        finally:
            with suppress(OSError, AttributeError):
                wire.setsockopt(socket.IPPROTO_TCP, socket.TCP_CORK, 0)


def _first(error: BaseException) -> BaseException:
    """Return what went wrong first: a pipeline that is left because of it says something else."""
    return error if error.__context__ is None else _first(error.__context__)


def _driver(connection: Connection) -> Any:
    return connection.connection.driver_connection
