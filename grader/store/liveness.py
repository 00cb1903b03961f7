"""Whether a pooled connection to a PostgreSQL server still lives, asked without a way to the server and back.

A server that stops, or ends a connection, closes its end: something can be read from a connection on which nothing
was asked. Only a connection like that, and one idle for so long that the network may have forgotten it, is tried.
"""

import select
import time
from typing import Any

from sqlalchemy import Engine, event
from sqlalchemy.exc import InvalidatePoolError

from grader.contracts.errors import InfrastructureError

_LONG_IDLE_S = 5.0
_SINCE = "grader_idle_since_s"


def check_before_use(engine: Engine) -> None:
    """Have the pool of `engine` replace dead connections: no request fails on one from before a restart."""

    def rest(_connection: Any, record: Any) -> None:
        record.info[_SINCE] = time.monotonic()

    def wake(connection: Any, record: Any, _fairy: Any) -> None:
        since_s = record.info.get(_SINCE)
        if since_s is None:  # just made: what is wrong with it, its first statement says
            return
        short = time.monotonic() - since_s < _LONG_IDLE_S
        if short and not connection.closed and not _something_to_read(connection):
            return
        if connection.closed or not _answers(engine, connection):
            raise InvalidatePoolError

    event.listen(engine, "checkin", rest)
    event.listen(engine, "checkout", wake)


def no_answer(en: str, zh: str) -> InfrastructureError:
    """Return the error of a database that does not answer, for the reason given."""
    return InfrastructureError(f"the database does not answer: {en}", f"数据库没有回应：{zh}")


def _something_to_read(connection: Any) -> bool:
    look = select.poll()
    look.register(connection.fileno(), select.POLLIN)
    return bool(look.poll(0))


def _answers(engine: Engine, connection: Any) -> bool:
    try:
        return bool(engine.dialect.do_ping(connection))
    except engine.dialect.loaded_dbapi.Error:
        return False
