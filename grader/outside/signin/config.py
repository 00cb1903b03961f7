"""What an operator says about sign-in: a TOML file, named by ``GRADER_SIGNIN``."""

import ipaddress
import tomllib
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    SecretStr,
    ValidationError,
    field_validator,
    model_validator,
)

from grader.contracts.errors import SettingsError
from grader.contracts.text import trouble
from grader.contracts.validation_words import said
from grader.outside.signin.channel import host_of, is_private_talk

_MOST_BYTES = 64 * 1024
_MOST_PROVIDERS = 8


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, hide_input_in_errors=True)

    id: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]{0,31}$")]
    """Names the provider in addresses and in the records of all who signed in by it, so it must not change."""
    title: Annotated[str, Field(min_length=1, max_length=60)]
    """Label of the button."""


class OidcEntry(_Entry):
    """OpenID Connect.

    Attributes:
        issuer: the issuer that its discovery document names.
        client_secret, client_secret_file: one of them, or neither for a client without a secret.
        claim: which claim is the id in the course's roster; ``email``, if verified, is looked up as an address.
    """

    kind: Literal["oidc"]
    issuer: str
    client_id: Annotated[str, Field(min_length=1, max_length=255)]
    client_secret: SecretStr | None = None
    client_secret_file: Path | None = None
    claim: Annotated[str, Field(min_length=1, max_length=100)] = "preferred_username"
    scopes: tuple[str, ...] = ("openid", "profile", "email")

    @field_validator("issuer")
    @classmethod
    def _encrypted(cls, value: str) -> str:
        return _checked_address(value)

    @model_validator(mode="after")
    def _one_secret(self) -> Self:
        if self.client_secret is not None and self.client_secret_file is not None:
            raise ValueError("client_secret and client_secret_file: give one of them")
        if "openid" not in self.scopes:
            raise ValueError("scopes: must have openid")
        return self


class CasEntry(_Entry):
    """Central Authentication Service, version 2 or 3 of its protocol.

    Attributes:
        url: where ``/login`` and ``/serviceValidate`` are.
        attribute: which attribute is the id in the course's roster; empty: the user's name itself.
    """

    kind: Literal["cas"]
    url: str
    version: Literal[2, 3] = 3
    attribute: Annotated[str, Field(max_length=100)] = ""

    @field_validator("url")
    @classmethod
    def _encrypted(cls, value: str) -> str:
        return _checked_address(value).rstrip("/")


class HeaderEntry(_Entry):
    """A proxy that authenticates people and names them in a header.

    Attributes:
        proxies: addresses or networks of the proxies; requests from elsewhere are not believed.
    """

    kind: Literal["header"]
    header: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9-]{0,63}$")]
    proxies: Annotated[tuple[str, ...], Field(min_length=1, max_length=32)]

    @field_validator("proxies")
    @classmethod
    def _networks(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        for one in value:
            try:
                network = ipaddress.ip_network(one)
            except ValueError:
                raise ValueError(
                    f"{one!r} is no address or network such as 10.0.0.5 or 10.1.0.0/16"
                ) from None
            if network.prefixlen == 0:
                raise ValueError(f"{one!r} is every address: name the proxies")
        return value


Entry = Annotated[OidcEntry | CasEntry | HeaderEntry, Field(discriminator="kind")]


class SignInConfig(BaseModel):
    """The whole file: where browsers reach the service, and who recognises people."""

    model_config = ConfigDict(extra="forbid", frozen=True, hide_input_in_errors=True)

    public_url: str
    allow_private_platforms: bool = False
    """Whether learning platforms, whose addresses instructors paste, may be in a private network."""
    providers: Annotated[tuple[Entry, ...], Field(max_length=_MOST_PROVIDERS)] = ()

    @field_validator("public_url")
    @classmethod
    def _origin(cls, value: str) -> str:
        address = _checked_address(value).rstrip("/")
        if address.count("/") != 2:
            raise ValueError("has a path: say only scheme, host and port, such as https://grader.example.edu")
        return address

    @model_validator(mode="after")
    def _names_differ(self) -> Self:
        ids = [one.id for one in self.providers]
        twice = {one for one in ids if ids.count(one) > 1}
        if twice:
            raise ValueError(f"providers: the id {min(twice)} is used twice")
        return self


def read_config(path: Path) -> SignInConfig:
    """Read the file.

    Raises:
        SettingsError: the file cannot be read, or a field is wrong; the message names the field.
    """
    try:
        with path.open("rb") as file:
            content = file.read(_MOST_BYTES + 1)
    except OSError as error:
        raise _wrong(path, "", trouble(error).en, trouble(error).zh) from None
    if len(content) > _MOST_BYTES:
        raise _wrong(path, "", "is larger than 64 KiB", "超过 64 KiB")
    try:
        document = tomllib.loads(content.decode())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise _wrong(path, "", f"is no TOML: {error}", f"不是 TOML 文件：{error}") from None
    try:
        return SignInConfig.model_validate(document)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise _wrong(path, place, said(first, "en"), said(first, "zh")) from None


def secret_of(entry: OidcEntry) -> str:
    """Return the client's secret, empty for a client without one.

    Raises:
        SettingsError: its file cannot be read, or is empty.
    """
    if entry.client_secret is not None:
        return entry.client_secret.get_secret_value()
    if entry.client_secret_file is None:
        return ""
    try:
        secret = entry.client_secret_file.read_text("utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        raise _wrong(entry.client_secret_file, "", str(error), str(error)) from None
    if not secret:
        raise _wrong(entry.client_secret_file, "", "is empty", "是空的")
    return secret


def _checked_address(value: str) -> str:
    if host_of(value) is None:
        raise ValueError(f"{value!r} is no address such as https://sso.example.edu")
    if not is_private_talk(value):
        raise ValueError(f"{value!r} must begin with https://: passwords and scores are sent there")
    return value


def _wrong(path: Path, place: str, en: str, zh: str) -> SettingsError:
    where = f"{path}: {place}: " if place else f"{path}: "
    return SettingsError(f"signin (GRADER_SIGNIN): {where}{en}", f"signin (GRADER_SIGNIN)：{where}{zh}")
