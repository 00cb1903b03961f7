"""Asking a provider directly: short waits, small answers, no redirects.

Addresses that an operator set up are believed. Those that an instructor pasted must not lead into the network
behind the service (`public_only`): the name is looked up once, and the connection goes to what was looked at.
"""

import asyncio
import functools
import ipaddress
import re
import socket
import ssl
from collections.abc import Container, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar
from urllib.parse import urlsplit

from grader.contracts.record import from_json
from grader.operation.settings import is_loopback

if TYPE_CHECKING:
    import httpx

PATIENCE_S = 5.0
MOST_BYTES = 256 * 1024
_LONGEST_S = 20.0
_HOST = re.compile(r"[A-Za-z0-9._-]+|[0-9A-Fa-f:.]+")  # the second one stands in brackets
_UNICAST = ipaddress.IPv6Network("2000::/3")
_SOCKET_ADDRESS = re.compile(r" ?\('[^']*', \d+(?:, \d+)*\)")
_T = TypeVar("_T")


class _Answer(NamedTuple):
    """What came back. `links`: the header Link."""

    status: int
    content: bytes
    links: str


class UnreachableError(Exception):
    """The other side did not answer in time, or not in a form that can be read; the message is for operators."""


def host_of(address: str) -> str | None:
    """Return the host of an http or https address without user, query and fragment; None for anything else."""
    try:
        parts = urlsplit(address)
        host, _ = parts.hostname, parts.port
    except ValueError:
        return None
    plain = not (parts.username or parts.password or parts.query or parts.fragment)
    named = host is not None and _HOST.fullmatch(host) is not None
    return host if plain and named and parts.scheme in ("http", "https") and address.isprintable() else None


def is_private_talk(address: str) -> bool:
    """Whether nobody on the way to an address reads along: it is encrypted, or on this machine."""
    return address.startswith("https://") or is_loopback(host_of(address.partition("?")[0]) or "")


def is_confidential(address: str) -> bool:
    """Return whether it is an address, perhaps with a query, and nobody on the way reads along.

    Where it leads is looked at when it is asked.
    """
    plain = address.partition("?")[0]
    readable = address.isascii() and address.isprintable()
    return readable and host_of(plain) is not None and is_private_talk(address)


def get(address: str, parameters: Mapping[str, str] | None = None, *, public_only: bool = False) -> bytes:
    """Return what an address answers.

    Raises UnreachableError: nothing, nothing in time, too much, or no success.
    """
    return _exchange("GET", address, public_only=public_only, params=parameters).content


def get_page(address: str, media_type: str, token: str, *, public_only: bool) -> tuple[bytes, str]:
    """Return what an address answers to who shows `token`, and its header Link, which names what follows.

    Raises as `get`.
    """
    headers = {"Accept": media_type, "Authorization": f"Bearer {token}"}
    answer = _exchange("GET", address, public_only=public_only, headers=headers)
    return answer.content, answer.links


def post_form(
    address: str, form: Mapping[str, str], credentials: tuple[str, str] | None, *, public_only: bool = False
) -> tuple[int, bytes]:
    """Send a form, with a client's credentials (RFC 6749, 2.3.1); return status and answer.

    Raises as `get`; but a refusal, which is status 400 or 401, is an answer.
    """
    answer = _exchange(
        "POST", address, accepted=(200, 400, 401), public_only=public_only, data=form, auth=credentials
    )
    return answer.status, answer.content


def post_json(  # noqa: PLR0913
    address: str,
    content: bytes,
    media_type: str,
    token: str = "",
    *,
    public_only: bool = False,
    shown: str = "",
) -> tuple[int, bytes]:
    """Send a document, with a bearer token unless that is empty; return status and answer.

    `public_only`: the address must not lead into a private network. `shown`: what errors call it, where it is a
    secret.

    Raises UnreachableError: as `get`; but whatever is no fault of the other side's, below 500, is an answer.
    """
    headers = {"Content-Type": media_type, **({"Authorization": f"Bearer {token}"} if token else {})}
    answers = range(200, 500)
    try:
        answer = _exchange(
            "POST", address, accepted=answers, public_only=public_only, headers=headers, content=content
        )
    except UnreachableError as error:
        raise UnreachableError(str(error).replace(address, shown or address)) from None
    return answer.status, answer.content


def decoded(content: bytes, kind: type[_T]) -> _T:
    """Return what somebody else wrote as JSON. Raises ValueError: it is none, or not of this kind."""
    try:
        return from_json(kind, content)
    except RecursionError:
        raise ValueError("JSON is nested too deep") from None


def _exchange(
    method: str,
    address: str,
    *,
    accepted: Container[int] = (200,),
    public_only: bool = False,
    headers: Mapping[str, str] = MappingProxyType({}),
    **request: Any,
) -> _Answer:
    import httpx  # takes 10 MiB, which a service that asks nobody does without

    host = host_of(address.partition("?")[0])
    if host is None:
        raise UnreachableError(f"{address!r} is no address")
    sent, extensions = {"Accept-Encoding": "identity", **headers}, {}
    try:
        url = httpx.URL(address)
        if public_only:
            sent["Host"] = url.netloc.decode()
            extensions["sni_hostname"] = host  # for which the certificate must be
            url = url.copy_with(host=_public(host, url.port or (443 if url.scheme == "https" else 80)))
        answer = asyncio.run(_answer(method, url, headers=sent, extensions=extensions, **request))
    except TimeoutError:
        raise UnreachableError(f"{address} answers for longer than {_LONGEST_S:.0f} s") from None
    except (httpx.HTTPError, httpx.InvalidURL, ValueError) as error:  # ValueError: no host, no header's text
        reason = _SOCKET_ADDRESS.sub("", str(error))  # whoever reads this need not know where a name leads
        raise UnreachableError(f"{address}: {type(error).__name__}: {reason}") from error
    if answer.status not in accepted:
        raise UnreachableError(f"{address} answers {answer.status}")
    if len(answer.content) > MOST_BYTES:
        raise UnreachableError(f"{address} answers with more than {MOST_BYTES} bytes")
    return answer


async def _answer(method: str, url: "httpx.URL", **request: Any) -> _Answer:
    """Return what comes; its content is cut off after `MOST_BYTES` and one more part.

    Each wait of httpx is short, but a server that sends a byte at a time could make very many of them, also
    before its headers end. Only an asynchronous exchange can be given up as a whole.
    """
    import httpx

    async with (
        asyncio.timeout(_LONGEST_S),
        httpx.AsyncClient(
            timeout=PATIENCE_S, follow_redirects=False, trust_env=False, verify=_trust()
        ) as client,
        client.stream(method, url, **request) as answer,
    ):
        content = b""
        async for part in answer.aiter_raw():
            content += part
            if len(content) > MOST_BYTES:
                break
        return _Answer(answer.status_code, content, answer.headers.get("Link", ""))


def trusting() -> ssl.SSLContext:
    """Return a context that trusts the authorities that browsers trust, and those that this machine trusts.

    A school often signs the certificates of its servers itself; an operator adds the school's authority to the
    machine's. A slim container has none of its own, so those that come with `httpx` are needed.
    """
    import httpx

    context = httpx.create_ssl_context(trust_env=False)
    context.load_default_certs()
    return context


_trust = functools.cache(trusting)  # takes longer to make than many an exchange


def _public(host: str, port: int) -> str:
    """Return the address that the system would try first: it knows which protocols have a route."""
    try:
        addresses = [str(info[4][0]) for info in socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)]
    except OSError as error:
        raise UnreachableError(f"{host}: {error}") from error
    private = [address for address in addresses if not _is_public(address)]
    if private:
        raise UnreachableError(f"{host} is in a private network (allow_private_platforms)")
    return addresses[0]


def _is_public(address: str) -> bool:
    """Return whether it is one host's of the public network; not an IPv6 address that stands for an IPv4 one."""
    ip = ipaddress.ip_address(address)
    if isinstance(ip, ipaddress.IPv6Address):
        return ip.is_global and ip in _UNICAST and ip.sixtofour is None and ip.teredo is None
    return ip.is_global and not ip.is_multicast
