"""Launches by LTI: the address to which a browser is sent, and checking the message that it brings back."""

import base64
import secrets
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlencode

import msgspec

from grader.contracts.platform import Picking, Platform
from grader.outside.lti.picking import CLAIM, SETTINGS, read_picking
from grader.outside.lti.roster import address_in
from grader.outside.lti.scores import SCORE_SCOPE
from grader.outside.signin import SignInError
from grader.outside.signin.oidc import KeySet, check_token

_LINK, _PICK = "LtiResourceLinkRequest", "LtiDeepLinkingRequest"
_SCORES = "https://purl.imsglobal.org/spec/lti-ags/claim/endpoint"
_SECRET_BYTES = 32
_OLDEST_S = 600
_LONGEST = 2_000
_LONGEST_RESOURCE = 255  # says LTI
_KEY_SETS = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class Kept:
    """What a browser keeps until it comes back with the platform's message."""

    platform: str
    state: str = field(default_factory=lambda: secrets.token_urlsafe(_SECRET_BYTES))
    nonce: str = field(default_factory=lambda: secrets.token_urlsafe(_SECRET_BYTES))


@dataclass(frozen=True, slots=True, kw_only=True)
class Launch:
    """What a platform's message says of somebody who opened an activity.

    Attributes:
        subject: the platform's name for the person.
        claimed: ids that the person may have in a class list.
        resource, title: of the activity. assignment: where the activity says that it leads; may be empty.
        line_item: where its scores go; empty: nowhere.
        people_url: where the platform lists the people of its course; empty: nowhere.
        until_s: when the message ends.
        picking: what the platform asks to be chosen, where no activity was opened but new ones are made.
    """

    subject: str
    claimed: tuple[str, ...] = ()
    resource: str = ""
    title: str = ""
    assignment: str = ""
    line_item: str = ""
    people_url: str = ""
    until_s: float = 0.0
    picking: Picking | None = None


def login_address(platform: Platform, kept: Kept, back: str, hint: str, message_hint: str | None) -> str:
    """Return where a browser is sent, which shall come `back` with a message."""
    query = {
        "scope": "openid",
        "response_type": "id_token",
        "response_mode": "form_post",
        "prompt": "none",
        "client_id": platform.client_id,
        "redirect_uri": back,
        "login_hint": hint,
        "state": kept.state,
        "nonce": kept.nonce,
    }
    if message_hint is not None:
        query["lti_message_hint"] = message_hint
    return f"{platform.login_url}{'&' if '?' in platform.login_url else '?'}{urlencode(query)}"


def deployment_in(token: str) -> str:
    """Return the deployment that a message names; nothing of it is checked yet. Empty: it names none."""
    try:
        payload = token.split(".")[1]
        claims = msgspec.json.decode(base64.urlsafe_b64decode(payload + "=" * (-len(payload) % 4)))
    except (IndexError, ValueError, RecursionError):
        return ""
    return _text(claims.get(f"{CLAIM}deployment_id")) if isinstance(claims, dict) else ""


class Launches:
    """Reads messages, with the platforms' keys, which it keeps. Safe to share between threads.

    Args:
        clock_s: the time. private: whether platforms may have addresses of a private network.
    """

    def __init__(self, clock_s: Callable[[], float], *, private: bool) -> None:
        self._clock_s = clock_s
        self._private = private
        self._lock = threading.Lock()
        self._keys: dict[str, KeySet] = {}

    def read(self, platform: Platform, token: str, nonce: str) -> Launch:
        """Return what a message says.

        Raises SignInError: it is not the platform's, or not for us, or lacks what LTI asks for.
        """
        claims = self._keys_of(platform.keys_url).claims(token, algorithms=("RS256",), needs_id=True)
        now_s = self._clock_s()
        check_token(claims, platform.issuer, platform.client_id, nonce, now_s)
        if claims["iat"] < now_s - _OLDEST_S:
            raise SignInError("signin_failed", "the message is older than ten minutes")
        return _launch(claims, platform)

    def _keys_of(self, address: str) -> KeySet:
        with self._lock:
            if address not in self._keys:
                if len(self._keys) >= _KEY_SETS:
                    self._keys.clear()
                self._keys[address] = KeySet(lambda: address, self._clock_s, public_only=not self._private)
            return self._keys[address]


def _launch(claims: Mapping[str, Any], platform: Platform) -> Launch:
    roles, resource = claims.get(f"{CLAIM}roles"), _object(claims.get(f"{CLAIM}resource_link"))
    kind = claims.get(f"{CLAIM}message_type")
    picking = read_picking(claims.get(SETTINGS)) if kind == _PICK else None
    wrong = {
        "version": claims.get(f"{CLAIM}version") != "1.3.0",
        "deployment_id": claims.get(f"{CLAIM}deployment_id") != platform.deployment,
        "message_type": kind not in (_LINK, _PICK),
        "roles": not isinstance(roles, list) or not all(isinstance(role, str) for role in roles),
        "resource_link": kind != _PICK and not 1 <= len(_text(resource.get("id"))) <= _LONGEST_RESOURCE,
        "deep_linking_settings": kind == _PICK and picking is None,
    }
    failed = [name for name, is_wrong in wrong.items() if is_wrong]
    if failed:
        raise SignInError("signin_failed", f"the message's {', '.join(failed)}")
    custom, person = _object(claims.get(f"{CLAIM}custom")), _object(claims.get(f"{CLAIM}lis"))
    named = (person.get("person_sourcedid"), custom.get("idnumber"), custom.get("username"))
    scores = _object(claims.get(_SCORES))
    scopes = scores.get("scope")
    may_score = isinstance(scopes, list) and SCORE_SCOPE in scopes
    return Launch(
        subject=claims["sub"],
        claimed=tuple(dict.fromkeys(text for name in named if (text := _text(name)))),
        resource=_text(resource.get("id")),
        title=_line(resource.get("title")),
        assignment=_text(custom.get("assignment")),
        line_item=_text(scores.get("lineitem")) if may_score else "",
        people_url=address_in(claims),
        until_s=float(claims["exp"]),
        picking=picking,
    )


def _object(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, dict) else {}


def _text(value: object) -> str:
    usable = isinstance(value, str) and len(value) <= _LONGEST and value.isprintable()
    return str(value).strip() if usable else ""


def _line(value: object) -> str:
    """Return what people wrote as one line, with spaces for what cannot be printed."""
    return (
        _text("".join(letter if letter.isprintable() else " " for letter in value))
        if isinstance(value, str)
        else ""
    )
