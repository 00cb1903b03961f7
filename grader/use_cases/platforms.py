"""Learning platforms: who comes from one, where that leads, and what an instructor sets up."""

import logging
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller
from grader.contracts.platform import NewPlatform, Platform, PlatformLink, PlatformScore
from grader.contracts.python import UTC
from grader.outside.lti import Kept, Launch, deployment_in, login_address
from grader.outside.signin import Person, SignInError
from grader.outside.signin.channel import is_confidential
from grader.store.audit import Signature
from grader.use_cases.callers import taught_course
from grader.use_cases.services import Services
from grader.use_cases.signing_in import Arrival, arrive

_log = logging.getLogger(__name__)
_ADDRESSES = ("issuer", "login_url", "token_url", "keys_url")
_LONGEST = {"title": 200, "issuer": 255, "client_id": 255, "deployment": 255}
_LONGEST_ADDRESS = 1_000


@dataclass(frozen=True, slots=True, kw_only=True)
class Arrived:
    """Somebody who came from a platform.

    Attributes:
        assignment: where the activity leads; empty: to all of them.
        picking: the secret by which they choose what the platform makes activities of; empty: they opened one.
    """

    arrival: Arrival = field(default_factory=Arrival)
    assignment: str = ""
    picking: str = ""


def begin(services: Services, said: dict[str, str]) -> tuple[Kept, str]:
    """Return what a browser keeps, and where it goes to be recognised; `said`: the fields of the login request.

    Raises RefusedError: no platform calls itself so.
    """
    back = f"{public_url(services)}/lti/launch"
    issuer, client = said.get("iss", ""), said.get("client_id", "")
    platform = services.platforms.named(issuer, client, said.get("lti_deployment_id", ""))
    if platform is None:
        _log.warning("a login of an unknown platform: issuer %.200r, client %.200r", issuer, client)
        raise RefusedError("platform_unknown")
    kept = Kept(platform=platform.id)
    hints = said.get("login_hint", ""), said.get("lti_message_hint")
    return kept, login_address(platform, kept, back, *hints)


def finish(services: Services, kept: Kept, token: str) -> Arrived:
    """Take in whom a platform's message names.

    Raises RefusedError: the message is not to be believed, or was used before.
    """
    asked = services.platforms.get(kept.platform)
    if asked is None:
        raise RefusedError("platform_unknown")
    # Several courses may use one platform. The message names which; everything in it is checked against that one.
    named = services.platforms.named(asked.issuer, asked.client_id, deployment_in(token))
    platform = named or asked
    try:
        with services.allowances.sign_ins.one_more(platform.provider):
            launch = services.launches.read(platform, token, kept.nonce)
    except SignInError as error:
        _log.warning("a launch from %s: %s: %s", platform.title, error.code, error.reason)
        raise RefusedError(error.code) from None
    if not services.platforms.use(kept.nonce, datetime.fromtimestamp(launch.until_s, UTC)):
        raise RefusedError("signin_expired")
    if launch.people_url and launch.people_url != platform.people_url:
        services.platforms.set_people_url(platform.id, launch.people_url)
    services.identities.bind_claimed(
        platform.provider, launch.subject, persons=launch.claimed, within=platform.course
    )
    if launch.picking is not None:
        picking = services.platforms.open_picking(platform.id, launch.subject, launch.picking)
        return Arrived(picking=picking)
    assignment = _opened(services, platform, launch)
    person = Person(subject=launch.subject)
    return Arrived(arrival=arrive(services, platform.provider, person), assignment=assignment)


def platforms_of(services: Services, caller: Caller) -> tuple[Platform, ...]:
    """Return the platforms of the caller's course. For instructors of a course."""
    return services.platforms.of_course(taught_course(caller))


def links_of(services: Services, caller: Caller) -> tuple[PlatformLink, ...]:
    """Return the activities of the caller's course's platforms. For instructors of a course."""
    return services.platforms.links(taught_course(caller))


def troubles_of(services: Services, caller: Caller) -> tuple[PlatformScore, ...]:
    """Return which scores of the caller's course a platform does not take. For instructors of a course."""
    return services.platform_scores.troubles(taught_course(caller))


def public_keys(services: Services) -> dict[str, Any]:
    """Return the keys by which platforms check what the service sends, as a JSON Web Key Set.

    Raises RefusedError: the service is not set up for platforms.
    """
    public_url(services)
    return services.platform_channel.public_keys()


def add_platform(services: Services, caller: Caller, new: NewPlatform) -> Platform:
    """Add a platform, which may then send people to the caller's course.

    Raises RefusedError: the caller is no instructor, a field is wrong, or the platform is there already.
    """
    taught_course(caller)
    public_url(services)
    return add_signed(services, new, services.signature(caller))


def add_signed(services: Services, new: NewPlatform, signed: Signature) -> Platform:
    """Add a platform to the course of `signed`, for an instructor of it.

    Raises RefusedError: a field is wrong, or the platform is there already.
    """
    wrong = wrong_field(new)
    if wrong is not None:
        raise RefusedError("invalid_platform", field=wrong)
    return services.platforms.add(new, signed)


def wrong_field(new: NewPlatform) -> str | None:
    """Return which field of a platform cannot be right; None: none."""
    for name in NewPlatform.__dataclass_fields__:
        value = getattr(new, name)
        if not value or len(value) > _LONGEST.get(name, _LONGEST_ADDRESS) or not value.isprintable():
            return name
    for name in _ADDRESSES:
        if not is_confidential(getattr(new, name)):
            return name
    return None


def remove_platform(services: Services, caller: Caller, platform_id: str) -> None:
    """Remove a platform. People who signed in by it need a token again.

    Raises RefusedError: the caller is no instructor, or there is no such platform.
    """
    taught_course(caller)
    if not services.platforms.remove(platform_id, services.signature(caller)):
        raise RefusedError("platform_not_found")


def _opened(services: Services, platform: Platform, launch: Launch) -> str:
    """Remember the activity; return the assignment where it leads, if the course has that one."""
    offered = {assignment.id for assignment in services.assignments.of(platform.course).all()}
    link = services.platforms.open_link(
        PlatformLink(
            platform=platform.id,
            resource=launch.resource,
            title=launch.title[:255],
            assignment=launch.assignment if launch.assignment in offered else "",
            line_item=launch.line_item,
            used_at=services.clock(),
        )
    )
    return link.assignment


def public_url(services: Services) -> str:
    """Return where the service is.

    Raises RefusedError: it does not know that, so that no platform can lead to it.
    """
    if not services.providers.public_url:
        raise RefusedError("platforms_not_set_up")
    return services.providers.public_url
