"""What is asked of other servers, and what their answers may not do."""

import socket
import ssl
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event

import httpx
import pytest

from grader.outside.signin import channel
from grader.outside.signin.channel import UnreachableError, get, host_of, post_json, trusting
from tests.fakes.authority import authority, https

Resolver = Callable[..., list[tuple[int, int, int, str, tuple[str, int]]]]


def resolving_to(*addresses: str) -> Resolver:
    def resolve(_host: str, port: int, **_: object) -> list[tuple[int, int, int, str, tuple[str, int]]]:
        return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (one, port)) for one in addresses]

    return resolve


@pytest.fixture
def forget_trust() -> Iterator[None]:
    channel._trust.cache_clear()
    yield
    channel._trust.cache_clear()


@pytest.mark.parametrize(
    "address",
    [
        "https://moodle.example; script-src *",
        "https://moodle.example,evil.example",
        "https://mood le.example",
        "https://a:b@moodle.example",
        "https://moodle.example?x=1",
        "https://大学.example",
        "https://[::1",
        "ftp://moodle.example",
    ],
)
def test_what_is_no_address_has_no_host(address: str) -> None:
    assert host_of(address) is None


@pytest.mark.parametrize(
    ("address", "host"),
    [("https://moodle.example/lti", "moodle.example"), ("http://[::1]:8000/x", "::1")],
)
def test_an_address_has_a_host(address: str, host: str) -> None:
    assert host_of(address) == host


@pytest.mark.parametrize("address", ["http://a..b/", f"http://{'a' * 70}.example/", "https://xn--/"])
@pytest.mark.parametrize("public_only", [False, True])
def test_a_name_that_cannot_be_looked_up_is_out_of_reach(address: str, public_only: bool) -> None:
    with pytest.raises(UnreachableError):
        post_json(address, b"{}", "application/json", "t", public_only=public_only)


def test_a_token_that_no_header_can_carry_is_told_without_it() -> None:
    with pytest.raises(UnreachableError) as raised:
        post_json("http://127.0.0.1:9/", b"{}", "application/json", "geheim-ö")
    assert "geheim" not in str(raised.value)


@pytest.mark.parametrize(
    "address",
    [
        "10.0.0.1",
        "127.0.0.1",
        "169.254.169.254",
        "224.0.0.1",
        "::1",
        "::127.0.0.1",
        "::ffff:127.0.0.1",
        "64:ff9b::a00:1",
        "2002:a00:1::",
        "fec0::1",
        "ff02::1",
    ],
)
def test_no_address_leads_into_a_private_network(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(channel.socket, "getaddrinfo", resolving_to("93.184.215.14", address))
    with pytest.raises(UnreachableError, match="private network"):
        get("https://moodle.example/keys", public_only=True)


def test_nobody_is_told_where_a_name_leads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(channel.socket, "getaddrinfo", resolving_to("127.0.0.1"))
    with pytest.raises(
        UnreachableError, match=r"^moodle\.example is in a private network \(allow_private_platforms\)$"
    ):
        get("https://moodle.example/keys", public_only=True)


@pytest.mark.parametrize(
    "told", ["[Errno 111] Connect call failed ('10.1.2.3', 9)", "no route ('fd00::1', 9, 0, 0)"]
)
def test_an_error_of_the_system_is_told_without_its_address(
    told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def fail(*_: object, **__: object) -> None:
        raise httpx.ConnectError(told)

    monkeypatch.setattr(channel, "_answer", fail)
    with pytest.raises(UnreachableError) as raised:
        get("https://moodle.example/keys")
    assert str(raised.value).startswith("https://moodle.example/keys: ConnectError: ")
    assert "10.1.2.3" not in str(raised.value)
    assert "fd00" not in str(raised.value)


def test_the_address_that_the_system_prefers_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine without IPv6 gets a server's IPv4 address first, though it is the greater text."""
    monkeypatch.setattr(channel.socket, "getaddrinfo", resolving_to("93.184.215.14", "2606:2800::1"))
    assert channel._public("moodle.example", 443) == "93.184.215.14"


@contextmanager
def dripping(begin: bytes, drop: bytes) -> Iterator[str]:
    """A server that sends `begin` and then, for as long as somebody listens, a `drop` every few milliseconds."""
    over = Event()

    def serve() -> None:
        connection, _ = server.accept()
        with connection, suppress(OSError):
            connection.sendall(begin)
            while not over.wait(0.005):
                connection.sendall(drop)

    with socket.create_server(("127.0.0.1", 0)) as server, ThreadPoolExecutor(1) as pool:
        serving = pool.submit(serve)
        try:
            yield f"http://127.0.0.1:{server.getsockname()[1]}/keys"
        finally:
            over.set()
            serving.result()


@pytest.mark.parametrize(
    "begin",
    [
        pytest.param(b"HTTP/1.1 200 OK\r\nX-Slow: ", id="headers"),
        pytest.param(b"HTTP/1.1 200 OK\r\nContent-Length: 200000\r\n\r\n", id="content"),
        pytest.param(b"", id="status"),
    ],
)
def test_an_answer_that_drips_is_given_up(begin: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    """However little it sends at a time: before the limit of the headers (100 KiB at a byte each 5 ms)."""
    monkeypatch.setattr(channel, "_LONGEST_S", 0.1)
    with dripping(begin, b"a") as address, pytest.raises(UnreachableError, match="longer"):
        get(address)


def test_an_answer_that_is_too_long_is_given_up() -> None:
    with (
        dripping(b"HTTP/1.1 200 OK\r\n\r\n", b"a" * 100_000) as address,
        pytest.raises(UnreachableError, match="more than 262144 bytes"),
    ):
        get(address)


def test_a_server_that_the_school_signs_is_believed_where_the_machine_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, forget_trust: None
) -> None:
    signer = authority(tmp_path)
    with https(signer, "localhost") as address:
        with pytest.raises(UnreachableError, match="CERTIFICATE_VERIFY_FAILED"):
            get(address)
        channel._trust.cache_clear()
        monkeypatch.setenv("SSL_CERT_FILE", str(signer))
        assert get(address) == b"secret"
        with pytest.raises(UnreachableError, match="CERTIFICATE_VERIFY_FAILED"):
            get(address.replace("localhost", "127.0.0.1"))


def test_a_machine_that_believes_nobody_believes_whom_browsers_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SSL_CERT_FILE", str(tmp_path / "none.pem"))
    monkeypatch.setenv("SSL_CERT_DIR", str(tmp_path))
    assert not ssl.create_default_context().get_ca_certs()
    assert len(trusting().get_ca_certs()) > 50
