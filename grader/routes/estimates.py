"""When a submission will probably be graded, from how long gradings took lately."""

import threading
from datetime import datetime, timedelta

from grader.contracts.progress import Standing
from grader.contracts.submission import Submission, SubmissionState
from grader.store.columns import Clock
from grader.store.queue import Queue
from grader.store.workers import Workers

_FRESH_S = 5.0


class Estimates:
    """Guesses instants; what they rest on is measured anew every few seconds. Safe between threads."""

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

        Args:
            submission: waiting or being graded.
            position: how many are before it while it waits.
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
