"""What all providers have in common, and the list of those that are set up (`opening` makes it)."""

import secrets
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from grader.outside.signin.config import HeaderEntry

_SECRET_BYTES = 32
_MOST_SUBJECT = 255


class SignInError(Exception):
    """Somebody was not recognised.

    Attributes:
        code: ``signin_unreachable``, ``signin_refused`` (the provider said no), ``signin_failed`` (what came back
            is not to be believed).
        reason: for the operator's log.
    """

    def __init__(self, code: str, reason: str) -> None:
        super().__init__(reason)
        self.code = code
        self.reason = reason


@dataclass(frozen=True, slots=True, kw_only=True)
class SignInAttempt:
    """What a browser keeps while it is away; whoever else comes back with its `state` is not believed.

    Attributes:
        nonce, verifier: of OpenID Connect: what ties the token to this attempt, and PKCE's secret.
    """

    state: str = field(default_factory=lambda: secrets.token_urlsafe(_SECRET_BYTES))
    nonce: str = field(default_factory=lambda: secrets.token_urlsafe(_SECRET_BYTES))
    verifier: str = field(default_factory=lambda: secrets.token_urlsafe(_SECRET_BYTES))


@dataclass(frozen=True, slots=True, kw_only=True)
class Person:
    """Somebody who has signed in at a provider.

    Attributes:
        subject: the provider's name for them, which stays; 1 to 255 printable characters.
        claimed: the id in a roster that the provider says they have; may be empty.
        email: their address, verified by the provider; may be empty.
    """

    subject: str
    claimed: str = ""
    email: str = ""


def is_subject(name: str) -> bool:
    """Return whether a provider may call somebody so."""
    return 1 <= len(name) <= _MOST_SUBJECT and name.isprintable()


class Provider(Protocol):
    """Recognises people."""

    @property
    def id(self) -> str:
        """What addresses call it."""

    @property
    def title(self) -> str:
        """What people call it."""

    def login_address(self, attempt: SignInAttempt, back: str) -> str:
        """Return the provider's address at which people sign in; it then redirects the browser to `back`.

        Raises SignInError: it cannot be reached.
        """

    def recognised(self, attempt: SignInAttempt, back: str, answer: Mapping[str, str]) -> Person:
        """Return who came back with `answer`, the query's fields; its state has been compared.

        Raises SignInError: nobody, or nobody who is to be believed.
        """


@dataclass(frozen=True, slots=True, kw_only=True)
class Providers:
    """Those that are set up, in their order.

    Attributes:
        public_url: where browsers reach the service, without a slash at the end.
        private_platforms: whether learning platforms may be in a private network.
        headers: what proxies say, instead of sending anybody away.
    """

    public_url: str = ""
    private_platforms: bool = False
    away: tuple[Provider, ...] = ()
    headers: tuple[HeaderEntry, ...] = ()

    def __iter__(self) -> Iterator[Provider | HeaderEntry]:
        yield from self.away
        yield from self.headers

    def __bool__(self) -> bool:
        return bool(self.away or self.headers)

    def sending(self, id_: str) -> Provider | None:
        """Return the provider of that id that sends browsers away."""
        return next((provider for provider in self.away if provider.id == id_), None)

    def header(self, id_: str) -> HeaderEntry | None:
        """Return the proxies' header of that id."""
        return next((provider for provider in self.headers if provider.id == id_), None)
