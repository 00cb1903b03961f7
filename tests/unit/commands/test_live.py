"""`grader live` as clients meet it: real websockets, one process for the server and one for its car."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeAlias

import pytest
import websocket
from websocket import WebSocket, WebSocketBadStatusException

from tests.fakes.waiting import PATIENCE_S

POSE = "/turtle1/pose"


@pytest.fixture(scope="module")
def server() -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-m", "grader", "live", "--port", "0"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as server:
        yield server
        server.send_signal(signal.SIGINT)
        assert server.wait(PATIENCE_S) == 0
        assert server.stderr is not None
        assert server.stderr.read() == ""


@pytest.fixture(scope="module")
def address(server: subprocess.Popen[str]) -> str:
    assert server.stderr is not None
    line = server.stderr.readline()
    assert "ws://127.0.0.1:" in line, line
    return line.split()[-1]


Connect: TypeAlias = Callable[[str], WebSocket]


@pytest.fixture
def connect() -> Iterator[Connect]:
    clients: list[WebSocket] = []

    def one_more(address: str) -> WebSocket:
        clients.append(websocket.create_connection(address, timeout=PATIENCE_S, suppress_origin=True))
        return clients[-1]

    yield one_more
    for client in clients:
        client.shutdown()


def ask(client: WebSocket, service: str, args: Any = None) -> Any:
    client.send(json.dumps({"op": "call_service", "id": service, "service": service, "args": args}))
    while (answer := json.loads(client.recv()))["op"] != "service_response":
        pass
    return answer["values"]


def test_a_turtle_is_driven_and_seen_by_another_client(address: str, connect: Connect) -> None:
    driver, watcher = connect(address), connect(f"{address}/any/path")
    ask(driver, "/reset")
    ask(driver, "/turtle1/teleport_absolute", {"x": 2, "y": 2, "theta": 0})
    watcher.send(json.dumps({"op": "subscribe", "topic": POSE}))
    driver.send(json.dumps({"op": "publish", "topic": "/turtle1/cmd_vel", "msg": {"linear": {"x": 1}}}))
    while (pose := json.loads(watcher.recv())["msg"])["x"] < 2.5:
        pass
    driver.send(json.dumps({"op": "publish", "topic": "/turtle1/cmd_vel", "msg": {}}))
    while (pose := json.loads(watcher.recv())["msg"])["linear_velocity"] > 0.0:
        pass
    assert 2.5 <= pose["x"] < 3.02


@pytest.mark.parametrize(
    ("origin", "let_in"),
    [
        ("http://localhost:3000", True),
        ("http://127.0.0.1:8000", True),
        ("https://evil.example", False),
        ("null", False),
    ],
)
def test_pages_of_other_hosts_are_refused(address: str, origin: str, let_in: bool) -> None:
    if let_in:
        websocket.create_connection(address, timeout=PATIENCE_S, origin=origin).close()
        return
    with pytest.raises(WebSocketBadStatusException, match="403"):
        websocket.create_connection(address, timeout=PATIENCE_S, origin=origin)


def test_one_that_sends_too_much_is_let_go_and_one_that_never_reads_harms_nobody(
    address: str, connect: Connect
) -> None:
    quiet, flood = connect(address), connect(address)
    quiet.send(json.dumps({"op": "subscribe", "topic": "/odom"}))
    for _ in range(5_000):  # more than are let through in a dozen seconds
        try:
            flood.send(json.dumps({"op": "set_level", "level": "none"}))
        except (BrokenPipeError, ConnectionResetError):
            break
    opcode, data = flood.recv_data()
    assert (opcode, int.from_bytes(data[:2])) == (8, 1008)
    assert ask(connect(address), "/rosapi/get_ros_version") == {"version": 2, "distro": "humble"}


def test_one_that_sends_too_many_bytes_is_let_go(address: str, connect: Connect) -> None:
    client = connect(address)
    frame = json.dumps({"op": "set_level", "level": "x" * 60_000})
    for _ in range(100):  # 6 MB
        try:
            client.send(frame)
        except (BrokenPipeError, ConnectionResetError):
            break
    opcode, data = client.recv_data()
    assert (opcode, int.from_bytes(data[:2]), data[2:]) == (8, 1008, b"more than 128 KiB a second")


def test_a_frame_that_is_too_long_closes_its_connection_only(address: str, connect: Connect) -> None:
    client, other = connect(address), connect(address)
    client.send("x" * 70_000)
    opcode, data = client.recv_data()
    assert (opcode, int.from_bytes(data[:2])) == (8, 1009)
    assert "/rosout" in ask(other, "/rosapi/topics")["topics"]


def test_a_car_whose_process_dies_comes_back_for_the_next_client(
    server: subprocess.Popen[str], address: str, connect: Connect
) -> None:
    client = connect(address)
    ask(client, "/rosapi/get_time")
    for pid in Path(f"/proc/{server.pid}/task/{server.pid}/children").read_text().split():
        os.kill(int(pid), signal.SIGKILL)
    opcode, data = client.recv_data()
    assert (opcode, int.from_bytes(data[:2])) == (8, 1013)
    again = connect(address)
    assert "time" in ask(again, "/rosapi/get_time")
