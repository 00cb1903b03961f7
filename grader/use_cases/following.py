"""Following the state of submissions and classes, and estimating when a grading will be done.

One thread reads the rows for everybody who watches in this process. The rows are the truth, so it makes no
difference which process grades. Each watcher keeps only the latest standing: a slow one misses steps in between
and delays nobody.
"""

import asyncio
import logging
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from typing import TypeAlias

from grader.contracts.errors import InfrastructureError, RefusedError
from grader.contracts.progress import ClassStanding, ExplanationStanding, Standing
from grader.contracts.submission import Submission, SubmissionState
from grader.store.clock import Clock
from grader.store.queue import Queue
from grader.store.standings import Standings
from grader.store.work import Doorbell
from grader.store.workers import Workers

Subject = tuple[str, str | None]
"""``("submission", id)``, ``("explanation", id)`` of a submission, or ``("class", course)``."""
AnyStanding: TypeAlias = Standing | ExplanationStanding | ClassStanding

_FRESH_S = 5.0  # the mean of gradings and the number of slots change slowly
_PAUSE_S = 0.1  # between two looks, however often the doorbell rings: a busy class rings it all the time
_RESTS = 9.0  # times as long as a look took, however many wait: it numbers the whole queue
_CLASS_EVERY = 4  # classes read more rows, so they are looked at less often than submissions
_LATER_S = 5  # a place becomes free when a page is closed or a stream reaches its age
_log = logging.getLogger(__name__)


class Estimates:
    """Guesses when gradings will be done, from how long they took lately; safe to share between threads."""

    def __init__(self, queue: Queue, workers: Workers, clock: Clock, silent_s: float) -> None:
        self._queue = queue
        self._workers = workers
        self._clock = clock
        self._silent_s = silent_s
        self._lock = threading.Lock()
        self._measured_at: datetime | None = None
        self._mean_s: float | None = None
        self._slots = 0

    def finish(self, submission: Submission | Standing, position: int | None) -> datetime | None:
        """Return when a submission will probably be graded; None when it is, or nobody can say.

        `position`: how many are before it while it waits.
        """
        now = self._clock()
        mean_s, slots = self._measured(now)
        if mean_s is None or slots == 0:
            return None
        if submission.state is SubmissionState.RUNNING and submission.started_at is not None:
            return max(submission.started_at + timedelta(seconds=mean_s), now)
        if position is None:
            return None
        return now + timedelta(seconds=(position // slots + 1) * mean_s)

    def _measured(self, now: datetime) -> tuple[float | None, int]:
        with self._lock:
            if self._measured_at is None or (now - self._measured_at).total_seconds() >= _FRESH_S:
                alive = self._workers.alive(self._silent_s)
                self._slots = sum(worker.slots for worker in alive if worker.sandbox_ready)
                self._mean_s = self._queue.mean_duration_s()
                self._measured_at = now
            return self._mean_s, self._slots


@dataclass(frozen=True, slots=True, kw_only=True)
class WatchLimits:
    """How many streams there may be, and how long one lasts.

    Attributes:
        most: streams of this process. Visitors from one address without a token share half of them.
        most_each: streams of one person.
        life_s: a stream ends after this time, and a client that still watches opens another. So a revoked token
            keeps no stream open for longer.
        poll_s: how often rows are read when no process has announced a change.
    """

    most: int
    most_each: int
    life_s: float = 60.0
    poll_s: float = 0.5


class SubjectWatch:
    """One client's watch over a subject. It belongs to the event loop in which it was made."""

    def __init__(self, subject: Subject) -> None:
        self.subject = subject
        self.latest: AnyStanding | None = None
        self._loop = asyncio.get_running_loop()
        self._news = asyncio.Event()
        self._ended = False

    def tell(self, standing: AnyStanding) -> None:
        """Put a standing in place of the one before; from any thread."""
        self._later(lambda: self._take(standing))

    def end(self) -> None:
        """Tell the watcher that nothing more will come; from any thread."""
        self._later(self._finish)

    async def news(self, timeout_s: float) -> AnyStanding | None:
        """Return the next standing that differs from the one before, or None at the end or after `timeout_s`."""
        try:
            async with asyncio.timeout(timeout_s):
                await self._news.wait()
        except TimeoutError:
            return None
        self._news.clear()
        return None if self._ended else self.latest

    def _take(self, standing: AnyStanding) -> None:
        if standing != self.latest:
            self.latest = standing
            self._news.set()

    def _finish(self) -> None:
        self._ended = True
        self._news.set()

    def _later(self, call: Callable[[], None]) -> None:
        try:
            self._loop.call_soon_threadsafe(call)
        except RuntimeError:  # the loop is closed, and with it the connection
            _log.debug("a watcher is gone")


class Watching:
    """All watchers of this process. Its thread lives while somebody watches."""

    def __init__(
        self, standings: Standings, estimates: Estimates, doorbell: Doorbell, limits: WatchLimits
    ) -> None:
        self.limits = limits
        self._standings = standings
        self.estimates = estimates
        self._doorbell = doorbell
        self._lock = threading.Lock()
        self._watches: dict[SubjectWatch, tuple[str, ...]] = {}
        self._taken: Counter[str] = Counter()  # by owner and by address
        self._thread: threading.Thread | None = None
        self._closing = threading.Event()

    @property
    def streams(self) -> int:
        """How many watch."""
        with self._lock:
            return len(self._watches)

    @contextmanager
    def watch(self, subject: Subject, owner: str, address: str | None = None) -> Iterator[SubjectWatch]:
        """Watch `subject` in the running event loop, counted as one of `owner`'s streams.

        `address`: where it comes from if `owner` is only what somebody says.

        Raises RefusedError: too many watch, or the service stops.
        """
        watch, shares = SubjectWatch(subject), {owner: self.limits.most_each}
        if address is not None:
            shares[f"from {address}"] = max(self.limits.most // 2, 1)
        self._add(watch, shares)
        try:
            yield watch
        finally:
            self._remove(watch)

    def look(self, subject: Subject) -> AnyStanding | None:
        """Return where `subject` stands now; None when there is no such thing."""
        return self._look({subject}).get(subject)

    def end(self) -> None:
        """End all streams and refuse new ones; returns at once."""
        self._closing.set()
        self._doorbell.ring()
        with self._lock:
            for watch in self._watches:
                watch.end()

    def close(self) -> None:
        """Do what `end` does and wait until the rows are no longer looked at."""
        self.end()
        with self._lock:
            thread = self._thread
        if thread is not None:
            thread.join()

    def _add(self, watch: SubjectWatch, shares: Mapping[str, int]) -> None:
        with self._lock:
            if self._closing.is_set():
                raise RefusedError("unavailable")
            if any(self._taken[name] >= most for name, most in shares.items()):
                raise RefusedError("too_many_streams", retry_after_s=_LATER_S)
            if len(self._watches) >= self.limits.most:
                raise RefusedError("streams_full", retry_after_s=_LATER_S)
            self._watches[watch] = tuple(shares)
            self._taken.update(shares.keys())
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="grader-watching", daemon=True)
                self._thread.start()

    def _remove(self, watch: SubjectWatch) -> None:
        with self._lock:
            for name in self._watches.pop(watch):
                self._taken[name] -= 1
                if not self._taken[name]:
                    del self._taken[name]

    def _run(self) -> None:
        looks = 0
        while True:
            heard = self._doorbell.heard()
            with self._lock:
                if not self._watches or self._closing.is_set():
                    self._thread = None
                    return
                watches = list(self._watches)
            begun_s = time.monotonic()
            with_classes = looks % _CLASS_EVERY == 0
            self._notify([watch for watch in watches if with_classes or watch.subject[0] != "class"])
            took_s = time.monotonic() - begun_s
            looks += 1
            self._doorbell.wait(heard, self.limits.poll_s)
            self._closing.wait(max(_PAUSE_S, _RESTS * took_s))

    def _notify(self, watches: list[SubjectWatch]) -> None:
        try:
            standings = self._look({one.subject for one in watches})
        except InfrastructureError as error:
            _log.warning("nobody who watches is told: %s", error)
            return
        except Exception:  # watchers would wait for ever for a thread that died
            _log.exception("nobody who watches is told")
            return
        for watch in watches:
            if (standing := standings.get(watch.subject)) is not None:
                watch.tell(standing)

    def _look(self, subjects: set[Subject]) -> dict[Subject, AnyStanding]:
        ids = {name for what, name in subjects if what == "submission" and name is not None}
        courses = {name for what, name in subjects if what == "class"}
        standings: dict[Subject, AnyStanding] = {}
        for id_, standing in self._standings.of(ids).items():
            estimated_at = self.estimates.finish(standing, standing.position)
            standings["submission", id_] = replace(standing, estimated_at=estimated_at)
        explained = {name for what, name in subjects if what == "explanation" and name is not None}
        for id_, explanation in self._standings.of_explanations(explained).items():
            standings["explanation", id_] = explanation
        for course, class_standing in self._standings.of_classes(courses).items():
            standings["class", course] = class_standing
        return standings
