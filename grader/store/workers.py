"""Which worker processes live, and which process may take over after a crash."""

import fcntl
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from datetime import timedelta
from pathlib import Path

from sqlalchemy import delete, make_url, select
from sqlmodel import col

from grader.contracts.submission import WorkerState
from grader.store.clock import Clock
from grader.store.database import Database, one_at_a_time
from grader.store.tables import WorkerRow

_FORGOTTEN_AFTER_S = 3_600.0


class Workers:
    """What worker processes say about themselves; safe to share between threads."""

    def __init__(self, database: Database, clock: Clock) -> None:
        self._database = database
        self._clock = clock

    def report(self, state: WorkerState) -> None:
        """Store what a worker says about itself; delete workers that have long been silent."""
        forgotten = col(WorkerRow.seen_at) < self._clock() - timedelta(seconds=_FORGOTTEN_AFTER_S)
        with self._database.writing() as session:
            one_at_a_time(session, "worker reports")
            session.execute(delete(WorkerRow).where(forgotten))
            session.merge(WorkerRow(**asdict(state)))

    def leave(self, worker_id: str) -> None:
        """Forget a worker that has stopped in good order."""
        with self._database.writing() as session:
            session.execute(delete(WorkerRow).where(col(WorkerRow.id) == worker_id))

    def alive(self, silent_s: float) -> tuple[WorkerState, ...]:
        """Return the workers heard of within the last `silent_s` seconds, oldest first.

        Not those heard of in the future: the clock was ahead then, and a living worker reports again soon.
        """
        now, silent = self._clock(), timedelta(seconds=silent_s)
        heard = col(WorkerRow.seen_at).between(now - silent, now + silent)
        statement = select(WorkerRow).where(heard).order_by(col(WorkerRow.started_at), col(WorkerRow.id))
        with self._database.reading() as session:
            return tuple(
                WorkerState(**row.model_dump()) for row in session.execute(statement).scalars().all()
            )


@contextmanager
def presence(database_url: str, when_alone: Callable[[], None]) -> Iterator[None]:
    """Be one of the processes that grade from this database, for as long as the context lasts.

    `when_alone` is called first if no other such process lives: then every claim in a SQLite database is left
    over from a crash and need not wait for its lease to end. It is never called on a database server, because
    processes on other machines cannot be seen from here.
    """
    url = make_url(database_url)
    if url.get_backend_name() != "sqlite" or not url.database:
        yield
        return
    descriptor = os.open(Path(f"{url.database}.lock"), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        if _locked(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB):
            when_alone()
        _locked(descriptor, fcntl.LOCK_SH)  # waits while another process does the above
        yield
    finally:
        os.close(descriptor)


def _locked(descriptor: int, operation: int) -> bool:
    try:
        fcntl.flock(descriptor, operation)
    except BlockingIOError:
        return False
    return True
