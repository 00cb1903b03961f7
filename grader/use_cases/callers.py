"""Who asks, and how often they may.

While no course exists the service is open: nobody is asked who they are, a submission's unguessable id is what
opens it, and the instructor token opens the class. As soon as there is a course, everything personal needs the
token of one of its members.
"""

import hashlib
import hmac
import math
import secrets
import threading
from dataclasses import dataclass
from datetime import datetime

from grader.contracts.errors import RefusedError
from grader.contracts.identity import ANYBODY, OPERATOR, Caller
from grader.store.clock import Clock
from grader.store.courses import Courses
from grader.store.tokens import Tokens

_TOKEN_BYTES = 24
_FORGET_ABOVE = 10_000


class Callers:
    """Recognises callers by the token they show.

    Args:
        courses: tells whether the service is open. tokens: those of the courses' members.
        instructor_token: opens the class of a service without courses; only its digest is kept.
    """

    def __init__(self, courses: Courses, tokens: Tokens, instructor_token: str) -> None:
        self._courses = courses
        self._tokens = tokens
        self._digest = _digest(instructor_token)

    def identify(self, token: str | None) -> Caller | None:
        """Return who shows `token` (None: shows nothing); None for those who may not come in."""
        if self._courses.exist():
            return None if token is None else self._tokens.caller(token)
        if token is None:
            return ANYBODY
        # compared in a time that does not tell how close the token was
        return OPERATOR if hmac.compare_digest(_digest(token), self._digest) else None


def require_staff(caller: Caller) -> None:
    """Let assistants and instructors through.

    Raises:
        RefusedError: the caller is neither.
    """
    if not caller.is_staff:
        raise RefusedError("unauthorized" if caller.role is None else "forbidden")


def require_instructor(caller: Caller) -> None:
    """Let instructors through.

    Raises:
        RefusedError: the caller is no instructor.
    """
    require_staff(caller)
    if not caller.is_instructor:
        raise RefusedError("forbidden")


def new_token() -> str:
    """Return a fresh token nobody can guess."""
    return secrets.token_urlsafe(_TOKEN_BYTES)


@dataclass(slots=True)
class _Bucket:
    left: float
    at: datetime


class RateLimit:
    """Lets each key through `per_minute` times a minute, also all at once: a token bucket for each key.

    It counts in the memory of this process. Safe to share between threads.
    """

    def __init__(self, per_minute: int, clock: Clock) -> None:
        self._most = float(per_minute)
        self._per_s = per_minute / 60.0
        self._clock = clock
        self._lock = threading.Lock()
        self._buckets: dict[str, _Bucket] = {}

    def take(self, key: str) -> None:
        """Count one request of `key`.

        Raises:
            RefusedError: too many; says when the next one is let through.
        """
        with self._lock:
            bucket = self._refilled(key)
            if bucket.left >= 1.0:
                bucket.left -= 1.0
                return
            wait_s = (1.0 - bucket.left) / self._per_s
        raise RefusedError("too_many_requests", retry_after_s=math.ceil(wait_s))

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


def _digest(token: str) -> bytes:
    return hashlib.sha256(token.encode()).digest()
