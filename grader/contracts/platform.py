"""Learning platforms that send students here, as LTI 1.3 has it."""

from dataclasses import dataclass
from datetime import datetime
from typing import Final

_PROVIDER: Final = "lti:"  # no id of a sign-in provider has a colon


@dataclass(frozen=True, slots=True, kw_only=True)
class NewPlatform:
    """What an instructor copies from a platform's page about the tool that it made of this service.

    Attributes:
        issuer, client_id: name the platform and what it calls us. deployment: id of the tool's use there.
        login_url: where browsers are sent to be recognised. token_url, keys_url: asked by the service itself.
    """

    title: str
    issuer: str
    client_id: str
    deployment: str
    login_url: str
    token_url: str
    keys_url: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Platform(NewPlatform):
    """A platform that a course is used from. `people_url`: where it tells who is in its course; may be empty."""

    id: str
    course: str
    created_at: datetime
    people_url: str = ""

    @property
    def provider(self) -> str:
        """Return under which name people are bound to members of the course (`Identity.provider`)."""
        return provider_of(self.id)


def provider_of(platform: str) -> str:
    """Return what the platform of an id is called beside its people; `platform_of` is the way back."""
    return f"{_PROVIDER}{platform}"


def platform_of(provider: str) -> str | None:
    """Return the id of the platform that is called `provider` beside its people; None: it is no platform."""
    return provider.removeprefix(_PROVIDER) if provider.startswith(_PROVIDER) else None


@dataclass(frozen=True, slots=True, kw_only=True)
class PlatformLink:
    """An activity of a platform that leads to an assignment.

    Attributes:
        resource: the platform's id of it.
        assignment: where it leads; empty: to the list of assignments.
        line_item: where its scores go; empty: the platform takes none for it.
    """

    platform: str
    resource: str
    title: str
    assignment: str
    line_item: str
    used_at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class PlatformScore:
    """What a platform was last told of a member at an activity.

    Attributes:
        sha256: of what it took; empty: nothing yet. sent_at: the instant named in it.
        not_before: nobody sends again before. tries: failed in a row.
        trouble: why it did not take the latest.
    """

    platform: str
    resource: str
    course: str
    person: str
    sha256: str
    sent_at: datetime | None
    not_before: datetime
    tries: int
    trouble: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Picking:
    """What a platform asks to be chosen: which assignments it makes activities of.

    Attributes:
        back: where the answer goes. data: JSON of what is given back with it; empty: nothing.
        several: more than one activity may be made. scored: each may bring a column of the gradebook.
    """

    back: str
    data: str
    several: bool
    scored: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenPicking(Picking):
    """A choice that somebody who came from a platform, there called `subject`, may make `until` then."""

    platform: str
    subject: str
    until: datetime
