"""The clock: this machine's, or that of the database server that several machines share.

Leases, turns and due dates compare instants of different processes. On SQLite they are all on one machine. On
PostgreSQL the server's clock decides, so that a machine whose own clock is wrong takes nobody's grading away,
accepts nothing late and is not believed dead.
"""

import logging
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import text

from grader.contracts.python import UTC
from grader.store.database import Database, StorePart

# Well within a lease: if the server's clock is set, leases must not end before all have noticed.
_AGAIN_S = 5.0
_SLOWEST_S = 0.5  # the instant of a slower answer is less exact than the one that is known already
_NOW = text("SELECT clock_timestamp()")
_MOST_DOUBLINGS = 60  # any pause reaches an hour before; further ones would overflow a float
_log = logging.getLogger(__name__)

LONGEST_PAUSE = timedelta(hours=1)
"""The longest pause between two tries. No lease of a submission is as long."""

Clock = Callable[[], datetime]
"""Returns the current instant as an aware datetime in UTC."""


def utc_now() -> datetime:
    """Return the current instant. Rows carry instants; gradings never see one."""
    return datetime.now(UTC)


def longer_pause(first_s: float, failures: int) -> timedelta:
    """Return how long to wait after failures: `first_s` after one, doubled for each further one, up to an hour."""
    doublings = min(failures - 1, _MOST_DOUBLINGS)
    return timedelta(seconds=min(first_s * 2.0**doublings, LONGEST_PAUSE.total_seconds()))


def ahead(instant: Any, now: datetime) -> Any:
    """Return whether an instant, or each of a column's, is still to come.

    What is further away than the longest pause was written while the clock was ahead: nothing waits for it.
    """
    return (instant > now) & (instant <= now + LONGEST_PAUSE)


def _elapsed_s() -> float:
    """Seconds of a clock that nobody sets and that goes on while the machine sleeps."""
    return time.clock_gettime(getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC))  # macOS: does so itself


class ServerClock:
    """The database server's clock: asked now and then, extrapolated in between. Reading it asks no server."""

    def __init__(self, database: Database, elapsed_s: Callable[[], float] = _elapsed_s) -> None:
        """Ask for the first time. Raises InfrastructureError: the database does not answer."""
        self._database = database
        self._elapsed_s = elapsed_s
        self._known, _ = self._asked()

    def __call__(self) -> datetime:
        """Return the current instant."""
        instant, at_s = self._known
        return instant + timedelta(seconds=self._elapsed_s() - at_s)

    def set(self) -> None:
        """Ask again; a slow answer is not used. Raises InfrastructureError: the database does not answer."""
        answer, took_s = self._asked()
        if took_s <= _SLOWEST_S:
            self._known = answer

    def _asked(self) -> tuple[tuple[datetime, float], float]:
        with self._database.reading() as session:
            session.connection()  # connect first: that time must not count as the answer's
            before_s = self._elapsed_s()
            instant: datetime = session.execute(_NOW).scalar_one()
            took_s = self._elapsed_s() - before_s
        return (instant.astimezone(UTC), before_s + took_s / 2), took_s


class TimedPart(StorePart):
    """A part of the store that needs the current instant, too."""

    def __init__(self, database: Database, clock: Clock) -> None:
        super().__init__(database)
        self._clock = clock


@contextmanager
def clock_of(database: Database) -> Iterator[Clock]:
    """Give the clock of a database for as long as the context lasts.

    Raises InfrastructureError: the database does not answer.
    """
    if database.is_sqlite:
        yield utc_now
        return
    clock, ended = ServerClock(database), threading.Event()

    def set_now_and_then() -> None:
        while not ended.wait(_AGAIN_S):
            try:
                clock.set()
            except Exception as error:  # the last answer is still extrapolated
                _log.warning("the database's clock could not be asked: %s", error)

    thread = threading.Thread(target=set_now_and_then, name="grader-clock", daemon=True)
    thread.start()
    try:
        yield clock
    finally:
        ended.set()
        thread.join(_SLOWEST_S)
