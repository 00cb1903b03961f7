"""Opening the providers that the operator's file names."""

from collections.abc import Callable

from grader.outside.signin.cas import Cas
from grader.outside.signin.config import CasEntry, Entry, HeaderEntry, SignInConfig
from grader.outside.signin.oidc import oidc
from grader.outside.signin.providers import Provider, Providers


def opened(config: SignInConfig, clock_s: Callable[[], float]) -> Providers:
    """Return the providers that are set up; nothing is asked yet.

    Raises SettingsError: a secret cannot be read, or the packages for OpenID Connect are not installed.
    """
    sending = [provider for provider in config.providers if not isinstance(provider, HeaderEntry)]
    return Providers(
        public_url=config.public_url,
        private_platforms=config.allow_private_platforms,
        away=tuple(_provider(settings, clock_s) for settings in sending),
        headers=tuple(provider for provider in config.providers if isinstance(provider, HeaderEntry)),
    )


def _provider(entry: Entry, clock_s: Callable[[], float]) -> Provider:
    if isinstance(entry, CasEntry):
        return Cas(entry)
    assert not isinstance(entry, HeaderEntry)
    return oidc(entry, clock_s)
