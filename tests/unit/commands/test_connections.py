"""A client that never ends its request: what `grader serve` makes of it, with deadlines of an instant."""

import resource
import socket
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
import uvicorn

from grader.commands.serve import BoundedConnection, most_connections
from grader.contracts.errors import SettingsError
from tests.fakes.server import running_server
from tests.fakes.waiting import PATIENCE_S, wait_until

LARGE = 16 << 20  # more than a system takes for a client that does not read


async def application(scope, receive, send) -> None:
    """Read the body and say how long it was."""
    if scope["type"] != "http":
        return
    length, more = 0, True
    while more:
        message = await receive()
        if message["type"] == "http.disconnect":
            return
        length, more = length + len(message["body"]), message.get("more_body", False)
    body = b"%d" % length + b" " * (LARGE if scope["path"] == "/large" else 0)
    headers = [(b"content-length", b"%d" % len(body))]
    await send({"type": "http.response.start", "status": 200, "headers": headers})
    await send({"type": "http.response.body", "body": body})


@contextmanager
def serving(limit: int | None = None, **deadlines: float) -> Iterator[tuple[str, int]]:
    """Serve in a thread; give the address."""
    with server_of(limit, deadlines) as server:
        yield address_of(server)


def address_of(server: uvicorn.Server) -> tuple[str, int]:
    address: tuple[str, int] = server.servers[0].sockets[0].getsockname()
    return address


@contextmanager
def server_of(limit: int | None, deadlines: dict[str, float]) -> Iterator[uvicorn.Server]:
    config = uvicorn.Config(
        application,
        port=0,
        log_config=None,
        lifespan="off",
        http=type("Quick", (BoundedConnection,), deadlines),
        limit_concurrency=limit,
        timeout_keep_alive=PATIENCE_S,
    )
    with running_server(config) as server:
        yield server


def is_closed(connection: socket.socket) -> bool:
    """Wait for the server to close the connection without a word."""
    connection.settimeout(PATIENCE_S)
    try:
        return connection.recv(1) == b""
    except ConnectionResetError:
        return True


@pytest.mark.parametrize(
    "sent", [b"", b"GET / HTTP/1.1\r\nHost: x\r\nX-a: "], ids=["nothing", "half of the headers"]
)
def test_headers_that_never_end_end_the_connection(sent: bytes) -> None:
    with serving(headers_s=0.05) as address, socket.create_connection(address) as client:
        client.sendall(sent)
        assert is_closed(client)


def test_a_body_that_never_ends_ends_the_connection() -> None:
    with serving(body_s=0.05) as address, socket.create_connection(address) as client:
        client.sendall(b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 10\r\n\r\n12")
        assert is_closed(client)


def posted_in_chunks(address: tuple[str, int], chunks: list[bytes]) -> bytes:
    """Send a body in these chunks; return the last line of the answer, empty if the connection is ended."""
    with socket.create_connection(address) as client:
        client.settimeout(PATIENCE_S)
        head = b"POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\nConnection: close\r\n\r\n"
        framed = b"".join(b"%x\r\n%b\r\n" % (len(chunk), chunk) for chunk in chunks)
        try:
            client.sendall(head + framed + b"0\r\n\r\n")
            with client.makefile("rb") as answer:
                return answer.read().rpartition(b"\r\n")[2]
        except (ConnectionResetError, BrokenPipeError):
            return b""


def test_a_body_in_crumbs_ends_the_connection_and_one_in_chunks_does_not() -> None:
    with serving() as address:
        assert posted_in_chunks(address, [b"x" * 8_192] * 20) == b"163840"
        assert posted_in_chunks(address, [b"x" * 10] * 200) == b"2000"
        assert posted_in_chunks(address, [b"x"] * 30_000) == b""


def test_an_answer_that_nobody_reads_ends_the_connection() -> None:
    with (
        server_of(None, {"answer_s": 0.05}) as server,
        socket.create_connection(address_of(server)) as client,
    ):
        client.sendall(b"GET /large HTTP/1.1\r\nHost: x\r\n\r\n")
        wait_until(lambda: server.server_state.total_requests)
        wait_until(lambda: not server.server_state.connections)


def test_a_stop_does_not_wait_for_a_request_that_is_still_arriving() -> None:
    with server_of(None, {}) as server, socket.create_connection(address_of(server)) as client:
        client.sendall(b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 10\r\n\r\n12")
        wait_until(lambda: server.server_state.tasks)
        server.should_exit = True
        assert is_closed(client)


def test_the_next_request_of_a_connection_has_a_deadline_and_the_time_before_it_none_here() -> None:
    with server_of(None, {}) as server, socket.create_connection(address_of(server)) as client:
        client.settimeout(PATIENCE_S)
        client.sendall(b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 2\r\n\r\n12")
        answer = b""
        while not answer.endswith(b"\r\n\r\n2"):
            answer += client.recv(1_000)
        (connection,) = server.server_state.connections
        assert connection._deadline is None
        connection.headers_s = 0.05
        client.sendall(b"GET / HT")
        assert is_closed(client)


def test_there_are_only_so_many_connections() -> None:
    with (
        serving(limit=2) as address,
        socket.create_connection(address),
        socket.create_connection(address),
        socket.create_connection(address) as third,
    ):
        assert is_closed(third)


def test_connections_leave_files_for_the_rest() -> None:
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (700, limits[1]))
    try:
        most = most_connections(streams=10)
        assert most < resource.getrlimit(resource.RLIMIT_NOFILE)[0]
        assert most == 1_510 or resource.getrlimit(resource.RLIMIT_NOFILE)[0] == limits[1]
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)


def test_a_system_that_leaves_no_connections_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resource, "getrlimit", lambda _: (256, 256))
    monkeypatch.setattr(resource, "setrlimit", lambda *_: None)
    with pytest.raises(
        SettingsError, match=r"may open 256 files only: let it open 272 or more \(ulimit -n\)"
    ):
        most_connections(streams=10)


@pytest.mark.parametrize("length", [b"4", b"44"])
def test_a_request_whose_end_can_be_read_in_two_ways_is_refused(length: bytes) -> None:
    """Its rest would be another request to whoever goes by the other header."""
    rest = b"0\r\n\r\nGET /second HTTP/1.1\r\nHost: x\r\n\r\n"
    head = b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: %b\r\nTransfer-Encoding: chunked\r\n\r\n" % length
    with serving() as address, socket.create_connection(address, PATIENCE_S) as client:
        client.sendall(head + rest)
        answer = b""
        while part := client.recv(65_536):
            answer += part
    assert answer.startswith(b"HTTP/1.1 400 ")
    assert answer.count(b"HTTP/1.1") == 1
