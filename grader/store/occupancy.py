"""Who works with a database: services hold a lock on its file, and what replaces or moves it wants to be alone."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

from grader.contracts.errors import SettingsError
from grader.store.database import Database
from grader.store.server_clock import ServerClock
from grader.store.workers import Workers

_LIVES_S = 30.0  # a worker says every few seconds that it lives


@contextmanager
def in_use(database: Database) -> Iterator[None]:
    """Keep others from replacing or moving the database for as long as the context lasts; wait while one does."""
    if not database.is_sqlite:
        yield
        return
    with _lock_file(f"{database.name}.open") as descriptor:
        fcntl.flock(descriptor, fcntl.LOCK_SH)
        yield


@contextmanager
def alone(database: Database) -> Iterator[None]:
    """Keep services from a SQLite database for as long as the context lasts.

    On PostgreSQL, where nothing keeps them away, only workers show, by what they say about themselves.

    Raises:
        SettingsError: a service or a worker works with the database.
    """
    busy = SettingsError(f"a service works with {database.name}: stop it first")
    if not database.is_sqlite:
        if Workers(database, ServerClock(database)).alive(_LIVES_S):
            raise busy
        yield
        return
    with ExitStack() as stack:
        for kind in ("open", "lock"):  # the second is `grader.store.workers.presence`
            descriptor = stack.enter_context(_lock_file(f"{database.name}.{kind}"))
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise busy from None
        yield


@contextmanager
def _lock_file(path: str) -> Iterator[int]:
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    except OSError as error:
        raise SettingsError(f"{path}: {error.strerror}") from error
    try:
        yield descriptor
    finally:
        os.close(descriptor)
