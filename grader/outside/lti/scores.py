"""Telling a platform what somebody reached, and asking it who is in its course.

Sources: 1EdTech, "Assignment and Grade Services 2.0" and "Names and Role Provisioning Services 2.0"; RFC 7523.
"""

import secrets
import threading
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Final
from urllib.parse import urlsplit, urlunsplit

import msgspec

from grader.contracts.platform import Platform
from grader.outside.lti.roster import (
    MOST_PAGES,
    MOST_PEOPLE,
    ROSTER_SCOPE,
    ROSTER_TYPE,
    Listed,
    first_page,
    next_page,
    people_in,
)
from grader.outside.signin.channel import UnreachableError, decoded, get_page, post_form, post_json

SCORE_SCOPE: Final = "https://purl.imsglobal.org/spec/lti-ags/scope/score"
_SCORE_TYPE = "application/vnd.ims.lis.v1.score+json"
_ASSERTION_TYPE = "urn:ietf:params:oauth:client-assertion-type:jwt-bearer"
_LIFE_S = 60
_LONGEST_GRANT_S = 24 * 3600
_JTI_BYTES = 16
_OK = (200, 201, 202, 204)


class NotTakenError(Exception):
    """A platform answered, and refuses what it was asked; the message is for people who set platforms up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """What somebody reached at an activity.

    Attributes:
        subject: the platform's name for the person.
        given: points; None: a person still has to give some. most: the points there are.
        comment: for the student.
    """

    subject: str
    given: float | None
    most: float
    comment: str

    def body(self, at: datetime) -> dict[str, Any]:
        """Return what the platform is sent; `at` must be later, in whole seconds, than of what it has."""
        progress = "PendingManual" if self.given is None else "FullyGraded"
        reached = {} if self.given is None else {"scoreGiven": self.given}
        return {
            "userId": self.subject,
            "scoreMaximum": self.most,
            "comment": self.comment,
            "timestamp": at.isoformat(timespec="milliseconds"),
            "activityProgress": "Completed",
            "gradingProgress": progress,
            **reached,
        }


class _Granted(msgspec.Struct, frozen=True):
    access_token: str
    expires_in: int = 3600


class Signer:
    """Signs what the service says to platforms, by the first of its keys.

    Args:
        secrets_: the keys as JSON Web Keys.
    """

    def __init__(self, secrets_: tuple[str, ...]) -> None:
        from joserfc.jwk import KeySet, RSAKey

        self._keys = [RSAKey.import_key(msgspec.json.decode(secret)) for secret in secrets_]
        self._set = KeySet(list(self._keys))

    def public(self) -> dict[str, Any]:
        """Return the keys by which platforms check what they are sent."""
        return dict(self._set.as_dict(private=False))

    def signed(self, claims: dict[str, Any]) -> str:
        """Return a signed message."""
        from joserfc import jwt

        key = self._keys[0]
        return jwt.encode({"alg": "RS256", "typ": "JWT", "kid": key.kid}, claims, key)


def new_key() -> tuple[str, str]:
    """Return id and secret of a new key for `Signer`."""
    from joserfc.jwk import RSAKey

    key = RSAKey.generate_key(2048, parameters={"use": "sig", "alg": "RS256"}, auto_kid=True)
    return str(key.kid), msgspec.json.encode(key.as_dict(private=True)).decode()


class PlatformChannel:
    """Speaks to platforms; keeps their access tokens as long as they are good. Safe to share between threads.

    Args:
        signer: gives what signs now.
        clock_s: the time.
        private: whether platforms may have addresses of a private network.
    """

    def __init__(self, signer: Callable[[], Signer], clock_s: Callable[[], float], *, private: bool) -> None:
        self._signer = signer
        self._clock_s = clock_s
        self._private = private
        self._lock = threading.Lock()
        self._tokens: dict[tuple[str, str], tuple[str, float]] = {}  # by platform and scope

    def send(self, platform: Platform, line_item: str, score: Score, at: datetime) -> None:
        """Send a score.

        Raises:
            UnreachableError: the platform does not answer.
            NotTakenError: it answers, and does not take it.
        """
        token = self._token(platform, SCORE_SCOPE)
        status, content = post_json(
            _scores_of(line_item),
            msgspec.json.encode(score.body(at)),
            _SCORE_TYPE,
            token,
            public_only=not self._private,
        )
        if status == 401:  # the token may have been withdrawn; the next time another is asked for
            with self._lock:
                self._tokens.pop((platform.id, SCORE_SCOPE), None)
        if status not in _OK:
            raise NotTakenError(f"status {status}: {content[:200].decode(errors='replace')}")

    def people(self, platform: Platform) -> tuple[Listed, ...]:
        """Return who is in the platform's course.

        Raises:
            UnreachableError: the platform does not answer, or not in a form that can be read, or without end.
            NotTakenError: it gives us no access.
        """
        people: list[Listed] = []
        token = self._token(platform, ROSTER_SCOPE)
        address: str | None = first_page(platform.people_url)
        pages = 0
        while address is not None and pages < MOST_PAGES and len(people) <= MOST_PEOPLE:
            content, links = get_page(address, ROSTER_TYPE, token, public_only=not self._private)
            people += people_in(content)
            address = next_page(address, links)
            pages += 1
        if address is None and len(people) <= MOST_PEOPLE:
            return tuple(people)
        raise UnreachableError(
            f"{platform.people_url}: more than {MOST_PEOPLE} people, or {MOST_PAGES} pages"
        )

    def public_keys(self) -> dict[str, Any]:
        """Return the keys by which platforms check what they are sent."""
        return self._signer().public()

    def signed(self, claims: dict[str, Any]) -> str:
        """Return a message that a browser brings to a platform."""
        return self._signer().signed(claims)

    def _token(self, platform: Platform, scope: str) -> str:
        with self._lock:
            token, until_s = self._tokens.get((platform.id, scope), ("", 0.0))
        now_s = self._clock_s()
        if until_s > now_s:
            return token
        claims = {
            "iss": platform.client_id,
            "sub": platform.client_id,
            "aud": platform.token_url,
            "iat": int(now_s),
            "exp": int(now_s) + _LIFE_S,
            "jti": secrets.token_urlsafe(_JTI_BYTES),
        }
        form = {
            "grant_type": "client_credentials",
            "client_assertion_type": _ASSERTION_TYPE,
            "client_assertion": self._signer().signed(claims),
            "scope": scope,
        }
        status, content = post_form(platform.token_url, form, None, public_only=not self._private)
        if status not in _OK:
            raise NotTakenError(f"no token, status {status}: {content[:200].decode(errors='replace')}")
        try:
            granted = decoded(content, _Granted)
        except ValueError as error:
            raise UnreachableError(f"{platform.token_url}: {error}") from None
        with self._lock:
            good_s = min(granted.expires_in, _LONGEST_GRANT_S)
            self._tokens[platform.id, scope] = granted.access_token, now_s + good_s - _LIFE_S
        return granted.access_token


def _scores_of(line_item: str) -> str:
    """Return where a line item's scores are sent: ``/scores`` stands before its query."""
    parts = urlsplit(line_item)
    return urlunsplit((parts.scheme, parts.netloc, f"{parts.path.rstrip('/')}/scores", parts.query, ""))
