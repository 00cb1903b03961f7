"""What an operator says about sign-in: a TOML file, named by ``GRADER_SIGNIN``."""

import ipaddress
import tomllib
from pathlib import Path
from typing import Annotated, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    SecretStr,
    ValidationError,
    field_validator,
    model_validator,
)

from grader.contracts.errors import SettingsError
from grader.contracts.python import Self
from grader.contracts.text import trouble
from grader.contracts.validation_words import said
from grader.outside.signin.channel import host_of, is_private_talk

_MOST_BYTES = 64 * 1024
_MOST_PROVIDERS = 8


def _checked_address(value: str) -> str:
    if host_of(value) is None:
        raise ValueError(
            f"{value!r} is no address such as https://sso.example.edu",
            f"{value!r} 不是地址，例如 https://sso.example.edu",
        )
    if not is_private_talk(value):
        raise ValueError(
            f"{value!r} must begin with https://: passwords and scores are sent there",
            f"{value!r} 要以 https:// 开头：密码和成绩要发到那里",
        )
    return value


Address = Annotated[str, AfterValidator(_checked_address)]


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
    issuer: Address
    client_id: Annotated[str, Field(min_length=1, max_length=255)]
    client_secret: SecretStr | None = None
    client_secret_file: Path | None = None
    claim: Annotated[str, Field(min_length=1, max_length=100)] = "preferred_username"
    scopes: tuple[str, ...] = ("openid", "profile", "email")

    @model_validator(mode="after")
    def _one_secret(self) -> Self:
        if self.client_secret is not None and self.client_secret_file is not None:
            raise ValueError(
                "client_secret and client_secret_file: give one of them",
                "client_secret 和 client_secret_file：只写一个",
            )
        if "openid" not in self.scopes:
            raise ValueError("scopes: must have openid", "scopes：要有 openid")
        return self


class CasEntry(_Entry):
    """Central Authentication Service, version 2 or 3 of its protocol.

    Attributes:
        url: where ``/login`` and ``/serviceValidate`` are.
        attribute: which attribute is the id in the course's roster; empty: the user's name itself.
    """

    kind: Literal["cas"]
    url: Annotated[Address, AfterValidator(lambda value: value.rstrip("/"))]
    version: Literal[2, 3] = 3
    attribute: Annotated[str, Field(max_length=100)] = ""


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
        for element in value:
            try:
                network = ipaddress.ip_network(element)
            except ValueError:
                raise ValueError(
                    f"{element!r} is no address or network such as 10.0.0.5 or 10.1.0.0/16",
                    f"{element!r} 不是地址或网段，例如 10.0.0.5 或 10.1.0.0/16",
                ) from None
            if network.prefixlen == 0:
                raise ValueError(
                    f"{element!r} is every address: name the proxies",
                    f"{element!r} 是全部地址：请写明代理的地址",
                )
        return value


Entry = Annotated[OidcEntry | CasEntry | HeaderEntry, Field(discriminator="kind")]


class SignInConfig(BaseModel):
    """The whole file: where browsers reach the service, and who recognises people."""

    model_config = ConfigDict(extra="forbid", frozen=True, hide_input_in_errors=True)

    public_url: Address
    allow_private_platforms: bool = False
    """Whether learning platforms, whose addresses instructors paste, may be in a private network."""
    providers: Annotated[tuple[Entry, ...], Field(max_length=_MOST_PROVIDERS)] = ()

    @field_validator("public_url")
    @classmethod
    def _origin(cls, value: str) -> str:
        address = value.rstrip("/")
        if address.count("/") != 2:
            raise ValueError(
                "has a path: say only scheme, host and port, such as https://grader.example.edu",
                "带了路径：只写协议、主机和端口，例如 https://grader.example.edu",
            )
        return address

    @model_validator(mode="after")
    def _names_differ(self) -> Self:
        ids = [provider.id for provider in self.providers]
        twice = {id_ for id_ in ids if ids.count(id_) > 1}
        if twice:
            raise ValueError(
                f"providers: the id {min(twice)} is used twice", f"providers：id {min(twice)} 用了两次"
            )
        return self


def read_config(path: Path) -> SignInConfig:
    """Read the file.

    Raises SettingsError: the file cannot be read, or a field is wrong; the message names the field.
    """
    try:
        document = tomllib.loads(_content(path))
    except tomllib.TOMLDecodeError as error:
        raise _wrong(path, "", f"is no TOML: {error}", f"不是 TOML 文件：{error}") from None
    try:
        return SignInConfig.model_validate(document)
    except ValidationError as error:
        errors = {".".join(map(str, problem["loc"])): problem for problem in error.errors()}
        wrong = [_wrong(path, place, said(one, "en"), said(one, "zh")) for place, one in errors.items()]
        en, zh = ("\n".join(problem.message_in(language) for problem in wrong) for language in ("en", "zh"))
        raise SettingsError(en, zh) from None


def secret_of(entry: OidcEntry) -> str:
    """Return the client's secret, empty for a client without one.

    Raises SettingsError: its file cannot be read, or is empty.
    """
    if entry.client_secret is not None:
        return entry.client_secret.get_secret_value()
    if entry.client_secret_file is None:
        return ""
    secret = _content(entry.client_secret_file).strip()
    if not secret:
        raise _wrong(entry.client_secret_file, "", "is empty", "是空的")
    return secret


def _content(path: Path) -> str:
    try:
        with path.open("rb") as file:
            content = file.read(_MOST_BYTES + 1)
    except OSError as error:
        raise _wrong(path, "", trouble(error).en, trouble(error).zh) from None
    if len(content) > _MOST_BYTES:
        raise _wrong(path, "", "is larger than 64 KiB", "超过 64 KiB")
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        raise _wrong(path, "", f"is no UTF-8: {error}", f"不是 UTF-8 编码：{error}") from None


def _wrong(path: Path, place: str, en: str, zh: str) -> SettingsError:
    where = f"{path}: {place}: " if place else f"{path}: "
    return SettingsError(f"signin (GRADER_SIGNIN): {where}{en}", f"signin (GRADER_SIGNIN)：{where}{zh}")
