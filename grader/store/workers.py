"""Which worker processes are alive, and which process may requeue what a crash left behind."""

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
from grader.store.clock import TimedPart
from grader.store.database import put
from grader.store.tables import WorkerRow

_FORGOTTEN_AFTER_S = 3_600.0


class Workers(TimedPart):
    """What worker processes say about themselves; safe to share between threads."""

    def report(self, state: WorkerState) -> None:
        """Store what a worker says about itself; delete workers that have been silent for an hour."""
        long_ago = col(WorkerRow.seen_at) < self._clock() - timedelta(seconds=_FORGOTTEN_AFTER_S)
        forgotten = select(col(WorkerRow.id)).where(long_ago).with_for_update(skip_locked=True)
        with self._database.writing(lasting=False) as session:  # it is said again at the next beat
            session.execute(delete(WorkerRow).where(col(WorkerRow.id).in_(forgotten)))
            put(session.connection(), WorkerRow, **asdict(state))

    def leave(self, worker_id: str) -> None:
        """Delete a worker that has stopped in good order, instead of waiting until it counts as silent."""
        with self._database.writing() as session:
            session.execute(delete(WorkerRow).where(col(WorkerRow.id) == worker_id))

    def alive(self, silent_s: float) -> tuple[WorkerState, ...]:
        """Return the workers heard of within the last `silent_s` seconds, oldest first.

        A report with a later time than now does not count: it was written while the clock was ahead, and a worker
        that is alive reports again within seconds.
        """
        now, silent = self._clock(), timedelta(seconds=silent_s)
        heard = col(WorkerRow.seen_at).between(now - silent, now + silent)
        statement = select(WorkerRow).where(heard).order_by(col(WorkerRow.started_at), col(WorkerRow.id))
        return tuple(WorkerState(**row.model_dump()) for row in self._scalars(statement))


@contextmanager
def presence(database_url: str, when_alone: Callable[[], None]) -> Iterator[None]:
    """Mark this process, while the context lasts, as one that grades from this database.

    `when_alone` is called first if no other process is marked. Every claim in a SQLite database is then left over
    from a crash and need not wait for its lease to end. On a database server it is never called: processes on
    other machines cannot be seen from here.
    """
    url = make_url(database_url)
    if url.get_backend_name() != "sqlite" or not url.database:
        yield
        return
    descriptor = os.open(Path(f"{url.database}.lock"), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        if _locked(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB):
            when_alone()
        _locked(descriptor, fcntl.LOCK_SH)  # waits while another process runs its `when_alone`
        yield
    finally:
        os.close(descriptor)


def _locked(descriptor: int, operation: int) -> bool:
    """Lock the file; return False if the lock is another process's and `operation` does not wait."""
    try:
        fcntl.flock(descriptor, operation)
    except BlockingIOError:
        return False
    return True
