"""Moving what was committed from SQLite's write-ahead log into its file, while nobody waits for it.

SQLite does so at the end of whichever commit makes the log long enough. That would be somebody's upload: some
thousand pages written here and there, and flushed, take a tenth of a second.
"""

import logging
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.exc import SQLAlchemyError

from grader.store.database import Database

_EVERY_S = 1.0
_log = logging.getLogger(__name__)


@contextmanager
def checkpoints(database: Database, every_s: float = _EVERY_S) -> Iterator[None]:
    """Make one every `every_s` seconds, in a thread; harmless on PostgreSQL, which does so itself.

    One that fails is made up for by the next, or by SQLite once the log is ten times as long as it would have it.
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
    """Make one now, as far as readers of older states let it; neither readers nor writers wait."""
    connection = database.engine.raw_connection()  # not in a transaction, as any other way here would be
    try:
        connection.cursor().execute("PRAGMA wal_checkpoint(PASSIVE)")
    finally:
        connection.close()
