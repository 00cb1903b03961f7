"""Setting a platform and this service up for each other by one address (1EdTech, "Dynamic Registration 1.0").

The platform opens the address with the place of its configuration; the service reads that, says what it is, and is
told what the platform calls it.
"""

from typing import Any, Final
from urllib.parse import urlsplit

import msgspec

from grader.contracts.platform import NewPlatform
from grader.outside.lti.roster import ROSTER_SCOPE
from grader.outside.lti.scores import SCORE_SCOPE
from grader.outside.signin.channel import (
    UnreachableError,
    decoded,
    get,
    host_of,
    is_confidential,
    post_json,
)

_TOOL: Final = "https://purl.imsglobal.org/spec/lti-tool-configuration"
_PLATFORM: Final = "https://purl.imsglobal.org/spec/lti-platform-configuration"
_OK = (200, 201)
_LONGEST = 300
_CUSTOM = {"idnumber": "$Person.sourcedId", "username": "$User.username"}


class RegistrationError(Exception):
    """A platform cannot be registered with; the message is for who set it up."""


class _Family(msgspec.Struct, frozen=True):
    product_family_code: str = ""


class _Configuration(msgspec.Struct, frozen=True):
    issuer: str
    authorization_endpoint: str
    registration_endpoint: str
    token_endpoint: str
    jwks_uri: str
    platform: _Family = msgspec.field(default=_Family(), name=_PLATFORM)


class _Deployed(msgspec.Struct, frozen=True):
    deployment_id: str | int = ""


class _Registered(msgspec.Struct, frozen=True):
    client_id: str
    tool: _Deployed = msgspec.field(default=_Deployed(), name=_TOOL)


def register(address: str, token: str, public_url: str, name: str, *, private: bool) -> NewPlatform:
    """Register with the platform whose configuration is at `address`; return what it is.

    The platform knows its own request again by `token`, which may be empty; the service is at `public_url` and is
    called `name` there. `private`: the platform may be in a private network.

    Raises RegistrationError: the platform does not answer, or says what cannot be used.
    """
    configuration = _configuration(address, private=private)
    body = msgspec.json.encode(_tool(public_url, name))
    try:
        status, content = post_json(
            configuration.registration_endpoint, body, "application/json", token, public_only=not private
        )
    except UnreachableError as error:
        raise RegistrationError(str(error)) from None
    if status not in _OK:
        raise RegistrationError(f"status {status}: {_words(content)}")
    try:
        registered = decoded(content, _Registered)
    except ValueError as error:
        raise RegistrationError(f"{configuration.registration_endpoint}: {error}") from None
    if not registered.client_id or registered.tool.deployment_id == "":
        raise RegistrationError(
            f"the platform names no deployment (client id {registered.client_id[:_LONGEST]!r})"
        )
    family = configuration.platform.product_family_code.strip().capitalize()
    return NewPlatform(
        title=f"{family} {urlsplit(configuration.issuer).hostname}".strip(),
        issuer=configuration.issuer,
        client_id=registered.client_id,
        deployment=str(registered.tool.deployment_id),
        login_url=configuration.authorization_endpoint,
        token_url=configuration.token_endpoint,
        keys_url=configuration.jwks_uri,
    )


def _configuration(address: str, *, private: bool) -> _Configuration:
    try:
        configuration = decoded(get(address, public_only=not private), _Configuration)
    except UnreachableError as error:
        raise RegistrationError(str(error)) from None
    except ValueError as error:
        raise RegistrationError(f"{address}: {error}") from None
    if host_of(configuration.issuer) != host_of(address.partition("?")[0]):  # says the specification, 3.5.1
        raise RegistrationError(f"{address} is of {configuration.issuer[:_LONGEST]!r}")
    if not is_confidential(configuration.registration_endpoint):
        raise RegistrationError(
            f"{configuration.registration_endpoint[:_LONGEST]!r} is no address with https://"
        )
    return configuration


def _tool(public_url: str, name: str) -> dict[str, Any]:
    """Return what the service says of itself."""
    return {
        "application_type": "web",
        "response_types": ["id_token"],
        "grant_types": ["implicit", "client_credentials"],
        "initiate_login_uri": f"{public_url}/lti/login",
        "redirect_uris": [f"{public_url}/lti/launch"],
        "client_name": name,
        "jwks_uri": f"{public_url}/lti/keys",
        "token_endpoint_auth_method": "private_key_jwt",
        "scope": f"{SCORE_SCOPE} {ROSTER_SCOPE}",
        _TOOL: {
            "domain": urlsplit(public_url).netloc,
            "target_link_uri": f"{public_url}/",
            "custom_parameters": _CUSTOM,
            "claims": ["iss", "sub"],
            "messages": [
                {"type": "LtiResourceLinkRequest"},
                {"type": "LtiDeepLinkingRequest", "target_link_uri": f"{public_url}/lti/pick", "label": name},
            ],
        },
    }


def _words(content: bytes) -> str:
    text = content[:_LONGEST].decode(errors="replace")
    return "".join(letter if letter.isprintable() else " " for letter in text)
