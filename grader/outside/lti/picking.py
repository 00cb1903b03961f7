"""Making activities on a platform: what it asks for, and what it is answered (1EdTech, "Deep Linking 2.0")."""

import json
import secrets
from collections.abc import Iterable
from typing import Any, Final

from grader.contracts.assignment import Assignment
from grader.contracts.platform import Picking, Platform
from grader.contracts.text import Language
from grader.outside.signin.channel import is_confidential

CLAIM: Final = "https://purl.imsglobal.org/spec/lti/claim/"
_CLAIM = "https://purl.imsglobal.org/spec/lti-dl/claim/"
SETTINGS: Final = f"{_CLAIM}deep_linking_settings"
_ANSWER = "LtiDeepLinkingResponse"
_ITEM = "ltiResourceLink"
_LIFE_S = 300
_NONCE_BYTES = 32
_LONGEST_ADDRESS = 2_000
_LONGEST_DATA = 8_000


def read_picking(said: object) -> Picking | None:
    """Return what a message's settings ask for; None: they are none, or take nothing that there is here."""
    if not isinstance(said, dict):
        return None
    back, data, types = (
        said.get("deep_link_return_url"),
        _opaque(said.get("data")),
        said.get("accept_types", [_ITEM]),
    )
    if not isinstance(back, str) or len(back) > _LONGEST_ADDRESS or not is_confidential(back):
        return None
    if not isinstance(types, list) or _ITEM not in types:
        return None
    if data is None:
        return None
    return Picking(
        back=back,
        data=data,
        several=said.get("accept_multiple") is True,
        scored=said.get("accept_lineitem") is not False,
    )


def answer(
    platform: Platform, picking: Picking, items: Iterable[dict[str, Any]], now_s: float
) -> dict[str, Any]:
    """Return what the platform is answered, to be signed: the activities to be made."""
    claims = {
        "iss": platform.client_id,
        "aud": [platform.issuer],
        "iat": int(now_s),
        "exp": int(now_s) + _LIFE_S,
        "nonce": secrets.token_urlsafe(_NONCE_BYTES),
        f"{CLAIM}message_type": _ANSWER,
        f"{CLAIM}version": "1.3.0",
        f"{CLAIM}deployment_id": platform.deployment,
        f"{_CLAIM}content_items": list(items),
    }
    return claims | {f"{_CLAIM}data": json.loads(picking.data)} if picking.data else claims


def _opaque(data: object) -> str | None:
    """Return what is given back unchanged, as JSON in ASCII, which any database has; None: it is too much.

    LTI calls it opaque; most platforms send a text, some an object.
    """
    try:
        json.dumps(data, ensure_ascii=False).encode()  # half of a surrogate pair cannot be signed
        text = "" if data in (None, "") else json.dumps(data, separators=(",", ":"))
    except (RecursionError, UnicodeEncodeError):
        return None
    return text if len(text) <= _LONGEST_DATA else None


def activity(assignment: Assignment, language: Language, address: str, *, scored: bool) -> dict[str, Any]:
    """Return an activity that leads to an assignment, by the service's `address`, in a window of its own."""
    title = assignment.title.get(language)
    item: dict[str, Any] = {
        "type": _ITEM,
        "title": title,
        "url": address,
        "custom": {"assignment": assignment.id},
        "window": {"targetName": "_blank"},
    }
    if scored:
        item["lineItem"] = {
            "scoreMaximum": assignment.max_score,
            "label": title,
            "resourceId": assignment.id,
        }
    return item
