"""Who asks, how often they may, and how much at once.

While no course exists the service is open: nobody is asked who they are, a submission's unguessable id is what
opens it, and the instructor token opens the class. As soon as there is a course, everything personal needs the
token of one of its members.
"""

import hashlib
import hmac
import math
import secrets
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime

from grader.contracts.errors import RefusedError
from grader.contracts.identity import ANYBODY, OPERATOR, Caller, Role
from grader.contracts.python import Self
from grader.operation.settings import Settings
from grader.store.clock import Clock
from grader.store.courses import Courses
from grader.store.tokens import Tokens, code_in

_TOKEN_BYTES = 24
_FORGET_ABOVE = 10_000
PLOT_WEIGHT = 4
"""As how many costly requests a plot counts: drawing one takes a fifth of a second."""

_UPLOADS_AT_ONCE = 2  # a file, and the same once more by a client that got no answer
_SIGN_INS_AT_ONCE = 8  # of each provider; the service has forty threads for requests
_GUESSES_OF_ADDRESS, _GUESSES = 60, 600  # wrong codes a minute; a class at one address mistypes fewer
_TESTS_PER_MINUTE = 5  # bots take 20
_DRAFTS_PER_MINUTE = 30
_SOON_S = 1  # until one of the answers under way has probably been sent


class Callers:
    """Recognises callers by the token they show.

    A code has 47 random bits. At 600 wrong ones a minute from all addresses together, whoever guesses day and
    night for 200 days opens one of a class's 300 with a chance of 1 in 2,700.

    Args:
        courses: tells whether the service is open. tokens: those of the courses' members.
        instructor_token: opens the class of a service without courses; only its digest is kept.
    """

    def __init__(self, courses: Courses, tokens: Tokens, instructor_token: str, clock: Clock) -> None:
        self._courses = courses
        self._have_courses = False
        self._tokens = tokens
        self._digest = _digest(instructor_token)
        self._guesses = RateLimit(_GUESSES_OF_ADDRESS, clock), RateLimit(_GUESSES, clock)
        self._operator_session = hmac.new(instructor_token.encode(), b"session", "sha256").hexdigest()

    def _is_open(self) -> bool:
        """Whether nobody is asked who they are. That ends for good with the first course."""
        self._have_courses = self._have_courses or self._courses.exist()
        return not self._have_courses

    def identify(self, token: str | None, address: str = "") -> Caller | None:
        """Return who shows `token` (None: shows nothing) from `address`; None for those who may not come in.

        Raises RefusedError: too many wrong codes were shown lately.
        """
        if not self._is_open():
            return None if token is None else self._owner(token, address)
        if token is None:
            return ANYBODY
        # compared in a time that does not tell how close the token was
        return OPERATOR if hmac.compare_digest(_digest(token), self._digest) else None

    def _owner(self, token: str, address: str) -> Caller | None:
        if code_in(token) is None:
            return self._tokens.caller(token)
        keys = (address, "")
        for limit, key in zip(self._guesses, keys, strict=True):
            limit.take(key)
        caller = self._tokens.caller(token)
        if caller is not None:  # only wrong ones count
            for limit, key in zip(self._guesses, keys, strict=True):
                limit.charge(key, -1.0)
        return caller

    def open_session(self, token: str) -> str | None:
        """Return what a browser keeps in place of `token`, which `identify` knows; None if nothing is opened."""
        if not self._is_open():
            return self._tokens.open_session(token)
        return None if self.identify(token) is None else self._operator_session

    def of_session(self, session: str | None) -> Caller | None:
        """Return whose browser keeps `session` (None: it keeps nothing); None for those who may not come in."""
        if session is None:
            return self.identify(None)
        if not self._is_open():
            return self._tokens.session_caller(session)
        is_operator = hmac.compare_digest(session.encode(errors="replace"), self._operator_session.encode())
        return OPERATOR if is_operator else None

    def close_session(self, session: str) -> None:
        """End `session`; that of the operator of a service without courses stays."""
        self._tokens.close_session(session)


def require_staff(caller: Caller) -> None:
    """Require an assistant or instructor. Raises RefusedError: the caller is neither."""
    if not caller.is_staff:
        raise RefusedError("unauthorized" if caller.role is None else "forbidden")


def require_instructor(caller: Caller) -> None:
    """Require an instructor. Raises RefusedError: the caller is no instructor."""
    require_staff(caller)
    if not caller.is_instructor:
        raise RefusedError("forbidden")


def taught_course(caller: Caller) -> str:
    """Return the course of an instructor.

    Raises RefusedError: the caller is no instructor, or there is no course.
    """
    require_instructor(caller)
    if caller.course is None:
        raise RefusedError("no_course")
    return caller.course


def new_token() -> str:
    """Return a fresh token nobody can guess."""
    return secrets.token_urlsafe(_TOKEN_BYTES)


def name_of(caller: Caller) -> str | None:
    """Return under which name a caller's requests are counted; None where a token does not say who it is."""
    if caller.person is not None:
        return f"{caller.course}/{caller.person}"
    return "operator" if caller.is_staff else None


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

        Raises RefusedError: too many; says when the next one is let through.
        """
        with self._lock:
            bucket = self._refilled(key)
            if bucket.left >= 1.0:
                bucket.left -= 1.0
                return
            wait_s = (1.0 - bucket.left) / self._per_s
        raise RefusedError("too_many_requests", retry_after_s=math.ceil(wait_s))

    def charge(self, key: str, requests: float) -> None:
        """Charge a request that `take` let through as `requests` more, because it cost more than others do.

        A key never owes more than it gets in a minute.
        """
        with self._lock:
            bucket = self._refilled(key)
            bucket.left = max(bucket.left - requests, -self._most)

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


class AtOnce:
    """Lets each key have at most `most` requests under way. It counts in the memory of this process.

    Safe to share between threads.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._lock = threading.Lock()
        self._under_way: Counter[str] = Counter()

    @contextmanager
    def one_more(self, key: str) -> Iterator[None]:
        """Count a request of `key` as under way until the context ends.

        Raises RefusedError: `key` has as many under way as it may.
        """
        with self._lock:
            if self._under_way[key] >= self._most:
                raise RefusedError("too_many_at_once", retry_after_s=_SOON_S)
            self._under_way[key] += 1
        try:
            yield
        finally:
            with self._lock:
                self._under_way[key] -= 1
                if not self._under_way[key]:
                    del self._under_way[key]


class Costly:
    """Bounds the requests of students whose answers take much time to make.

    Without courses nobody says who they are; then a request is counted under the name that the door gives it.

    Args:
        at_once: how many each may have under way. per_minute: how many each may send in a minute.
    """

    def __init__(self, at_once: int, per_minute: int, clock: Clock) -> None:
        self._at_once = AtOnce(at_once)
        self._rate = RateLimit(per_minute, clock)

    @contextmanager
    def one_more(self, caller: Caller, otherwise: str, weight: int = 1) -> Iterator[None]:
        """Count a request until the context ends.

        `otherwise` names a caller without a token; `weight`: as how many the request counts in its minute.

        Raises RefusedError: there are too many, at once or in the last minute.
        """
        if caller.is_staff:
            yield
            return
        key = name_of(caller) or otherwise
        with self._at_once.one_more(key):
            self._rate.take(key)
            self._rate.charge(key, weight - 1)
            yield


@dataclass(frozen=True, slots=True)
class Allowances:
    """How much one person may ask for, so that nobody takes the service from others.

    Attributes:
        requests: of each student. uploads: under each student's name.
        requests_at_once: of each person, streams of events apart. uploads_at_once: under each student's name.
        costly: of each student's requests whose answers take much time to make.
        sign_ins: of those that wait for one provider, which may be slow.
        tests: of each course's messages that only try where notices go.
        practice, practice_at_once: of each person's practice runs. drafts: kept while somebody writes.
    """

    requests: RateLimit
    uploads: RateLimit
    requests_at_once: AtOnce
    uploads_at_once: AtOnce
    costly: Costly
    sign_ins: AtOnce
    tests: RateLimit
    practice: RateLimit
    practice_at_once: AtOnce
    drafts: RateLimit

    @classmethod
    def of(cls, settings: Settings, clock: Clock) -> Self:
        """Return the limits that the operator has set."""
        return cls(
            requests=RateLimit(settings.requests_per_minute, clock),
            uploads=RateLimit(settings.uploads_per_minute, clock),
            requests_at_once=AtOnce(settings.requests_at_once),
            uploads_at_once=AtOnce(_UPLOADS_AT_ONCE),
            costly=Costly(settings.costly_at_once, settings.costly_per_minute, clock),
            sign_ins=AtOnce(_SIGN_INS_AT_ONCE),
            tests=RateLimit(_TESTS_PER_MINUTE, clock),
            practice=RateLimit(settings.practice_per_minute, clock),
            practice_at_once=AtOnce(1),
            drafts=RateLimit(_DRAFTS_PER_MINUTE, clock),
        )

    def request(self, caller: Caller) -> None:
        """Count a request of a student. Raises RefusedError: there are too many."""
        if caller.role is Role.STUDENT:
            self.requests.take(f"{caller.course}/{caller.person}")


def _digest(token: str) -> bytes:
    return hashlib.sha256(token.encode()).digest()
