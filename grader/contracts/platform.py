"""Learning platforms from which a course is used, by LTI 1.3."""

from dataclasses import dataclass
from datetime import datetime
from typing import Final

_PROVIDER: Final = "lti:"  # no id of a sign-in provider has a colon


@dataclass(frozen=True, slots=True, kw_only=True)
class NewPlatform:
    """What an instructor copies from the platform, whose page shows it once the service is registered as a tool.

    Attributes:
        issuer: names the platform. client_id: names this service there. deployment: one installation of it.
        login_url: where browsers are sent to sign in. token_url, keys_url: asked by the service itself.
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
        """Return the name of the platform in identities of members (`Identity.provider`)."""
        return provider_of(self.id)


def provider_of(platform: str) -> str:
    """Return the name in identities of the platform with an id; `platform_of` is the inverse."""
    return f"{_PROVIDER}{platform}"


def platform_of(provider: str) -> str | None:
    """Return the id of the platform that identities call `provider`; None if that is no platform."""
    return provider.removeprefix(_PROVIDER) if provider.startswith(_PROVIDER) else None


@dataclass(frozen=True, slots=True, kw_only=True)
class PlatformLink:
    """An activity of a platform that leads to an assignment.

    Attributes:
        resource: the platform's id of the activity.
        assignment: where it leads; empty: to the list of assignments.
        line_item: address for its scores; empty: the platform takes none.
    """

    platform: str
    resource: str
    title: str
    assignment: str
    line_item: str
    used_at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class PlatformScore:
    """The score of a member at an activity that a platform was sent last.

    Attributes:
        sha256: of the message that it accepted; empty: none yet. sent_at: the instant named in that message.
        not_before: when the next try is due. tries: failed ones in a row.
        trouble: why the latest try failed.
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
    """A platform's request to choose assignments, of which it then makes activities ("deep linking").

    Attributes:
        back: address for the answer. data: JSON that must be returned with it; empty: none.
        several: more than one assignment may be chosen. scored: an activity may have a column in the gradebook.
    """

    back: str
    data: str
    several: bool
    scored: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenPicking(Picking):
    """A request that the person whom the platform calls `subject` may answer until `until`."""

    platform: str
    subject: str
    until: datetime
