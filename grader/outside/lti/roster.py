"""Who is in a platform's course (1EdTech, "Names and Role Provisioning Services 2.0")."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final
from urllib.parse import urljoin

from grader.outside.signin.channel import UnreachableError, decoded, is_confidential

ROSTER_SCOPE: Final = "https://purl.imsglobal.org/spec/lti-nrps/scope/contextmembership.readonly"
ROSTER_CLAIM: Final = "https://purl.imsglobal.org/spec/lti-nrps/claim/namesroleservice"
ROSTER_TYPE: Final = "application/vnd.ims.lti-nrps.v2.membershipcontainer+json"
MOST_PEOPLE: Final = 5_000
MOST_PAGES: Final = 60
_PAGE: Final = 100  # people asked for at once; platforms may give others
_LONGEST: Final = 1_000
_LEARNER: Final = re.compile(r"(.*[#/])?(Learner|Student)")
_CJK: Final = re.compile("[\u3400-\u9fff\uf900-\ufaff·]+")
_NEXT: Final = re.compile(r"<([^<>]*)>[^,<]*;\s*rel=\"?next\"?", re.IGNORECASE)


@dataclass(frozen=True, slots=True, kw_only=True)
class Listed:
    """Somebody in a platform's course.

    Attributes:
        subject: the platform's name for the person. claimed: ids that the person may have in a class list.
        learns: is a student there, and active.
    """

    subject: str
    claimed: tuple[str, ...]
    name: str
    email: str
    learns: bool


def address_in(claims: Mapping[str, Any]) -> str:
    """Return the address at which the platform lists the people of its course; empty: there is none."""
    claim = claims.get(ROSTER_CLAIM)
    address = claim.get("context_memberships_url") if isinstance(claim, dict) else None
    fits = isinstance(address, str) and len(address) <= _LONGEST and is_confidential(address)
    return str(address) if fits else ""


def first_page(address: str) -> str:
    """Return what is asked for first."""
    return f"{address}{'&' if '?' in address else '?'}limit={_PAGE}"


def next_page(address: str, links: str) -> str | None:
    """Return which page follows the one at `address`, whose header Link is `links`.

    Raises UnreachableError: it is on another server, which must not see the token.
    """
    link = _NEXT.search(links)
    if link is None:
        return None
    following: str = urljoin(address, link[1])
    if len(following) > 2 * _LONGEST or _origin(following) != _origin(address):
        raise UnreachableError(f"{address}: the next page is on another server")
    return following


def people_in(content: bytes) -> Iterator[Listed]:
    """Yield the people that a page of the platform's list names.

    Raises UnreachableError: it cannot be read.
    """
    try:
        members = decoded(content, dict[str, Any]).get("members")
    except ValueError as error:
        raise UnreachableError(f"the class list cannot be read: {error}") from None
    if not isinstance(members, list):
        raise UnreachableError("the class list has no members")
    for member in members:
        if isinstance(member, dict):
            yield _listed(member)


def _listed(said: Mapping[str, Any]) -> Listed:
    roles = said.get("roles")
    named = (said.get("lis_person_sourcedid"), said.get("ext_user_username"))
    return Listed(
        subject=_text(said.get("user_id")),
        claimed=tuple(dict.fromkeys(text for name in named if (text := _text(name)))),
        name=_name(said),
        email=_text(said.get("email")),
        learns=_learns(roles) and said.get("status", "Active") == "Active",
    )


def _name(said: Mapping[str, Any]) -> str:
    """Return a person's name, a Chinese one as it is written: the family's first, which platforms turn round."""
    given, family = (_text(said.get(f"{part}_name")) for part in ("given", "family"))
    if given and family and _CJK.fullmatch(given + family):
        return family + given
    return _text(said.get("name")) or " ".join(filter(None, (given, family)))


def _learns(roles: object) -> bool:
    names: Sequence[object] = roles if isinstance(roles, list) else ()
    return any(isinstance(role, str) and _LEARNER.fullmatch(role) is not None for role in names)


def _text(value: object) -> str:
    text = str(value).strip() if isinstance(value, str | int) and not isinstance(value, bool) else ""
    return text if len(text) <= _LONGEST and text.isprintable() else ""


def _origin(address: str) -> str:
    return "/".join(address.split("/", 3)[:3])
