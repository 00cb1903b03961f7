"""How often one student may ask: token buckets in the memory of this process."""

import math
import threading
from dataclasses import dataclass
from datetime import datetime

from grader.routes.problems import ProblemError
from grader.store.columns import Clock

_FORGET_ABOVE = 10_000


@dataclass(slots=True)
class _Bucket:
    left: float
    at: datetime


class RateLimit:
    """Lets each key through `per_minute` times a minute, all at once if need be; safe between threads."""

    def __init__(self, per_minute: int, clock: Clock) -> None:
        self._most = float(per_minute)
        self._per_s = per_minute / 60.0
        self._clock = clock
        self._lock = threading.Lock()
        self._buckets: dict[str, _Bucket] = {}

    def take(self, key: str) -> None:
        """Count one request of `key`.

        Raises:
            ProblemError: too many; Retry-After says when the next one is let through.
        """
        with self._lock:
            bucket = self._refilled(key)
            if bucket.left >= 1.0:
                bucket.left -= 1.0
                return
            wait_s = (1.0 - bucket.left) / self._per_s
        raise ProblemError("too_many_requests", headers={"Retry-After": str(math.ceil(wait_s))})

    def _refilled(self, key: str) -> _Bucket:
        now = self._clock()
        if len(self._buckets) > _FORGET_ABOVE:
            self._forget_full(now)
        bucket = self._buckets.setdefault(key, _Bucket(self._most, now))
        gained = max((now - bucket.at).total_seconds(), 0.0) * self._per_s  # a clock may be set back
        bucket.left, bucket.at = min(bucket.left + gained, self._most), now
        return bucket

    def _forget_full(self, now: datetime) -> None:
        full_s = self._most / self._per_s
        self._buckets = {
            key: bucket for key, bucket in self._buckets.items() if (now - bucket.at).total_seconds() < full_s
        }
