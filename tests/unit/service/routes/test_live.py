"""A live car in a course: who gets in, and when it ends. Real connections and real cars, one server for all."""

import asyncio
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import Any, TypeAlias

import httpx
import pytest
import uvicorn
import websocket
from websocket import WebSocket, WebSocketBadStatusException

from grader.api import create_app
from grader.commands.serve import BoundedConnection
from grader.contracts.errors import RefusedError
from grader.live.cars import LiveCars
from grader.live.protocol import SETTINGS, BoundedWebSocket
from grader.use_cases.services import Services
from tests.fakes.server import running_server
from tests.fakes.waiting import PATIENCE_S, wait_until

Connect: TypeAlias = Callable[..., WebSocket]


@pytest.fixture
def cars() -> LiveCars:
    return LiveCars(2)


@pytest.fixture
def server(services: Services, cars: LiveCars) -> Iterator[uvicorn.Server]:
    @contextmanager
    def opened() -> Iterator[Services]:
        yield replace(services, live=cars)

    config = uvicorn.Config(
        create_app(opened), port=0, log_config=None, http=BoundedConnection, ws=BoundedWebSocket, **SETTINGS
    )
    with running_server(config) as server:
        yield server


@pytest.fixture
def here(server: uvicorn.Server) -> Iterator[httpx.Client]:
    port = server.servers[0].sockets[0].getsockname()[1]
    with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=PATIENCE_S, trust_env=False) as client:
        yield client


@pytest.fixture
def connect() -> Iterator[Connect]:
    clients: list[WebSocket] = []

    def one_more(url: str, **options: Any) -> WebSocket:
        options = {"suppress_origin": "origin" not in options, **options}
        clients.append(websocket.create_connection(url, timeout=PATIENCE_S, **options))
        return clients[-1]

    yield one_more
    for client in clients:
        client.shutdown()


def have(client: httpx.Client, headers: dict[str, str]) -> dict[str, Any]:
    answer = client.post("/api/v1/live", headers=headers)
    assert answer.status_code == 201, answer.text
    told: dict[str, Any] = answer.json()
    return told


def status_of(told: tuple[int, bytes]) -> int:
    opcode, data = told
    assert opcode == 8
    return int.from_bytes(data[:2])


def refused(connect: Connect, url: str, **options: Any) -> tuple[int, str]:
    with pytest.raises(WebSocketBadStatusException) as caught:
        connect(url, **options)
    return caught.value.status_code, json.loads(caught.value.resp_body)["code"]


def test_a_member_drives_a_car_of_their_own(
    here: httpx.Client, school: Any, connect: Connect, services: Services, caplog: pytest.LogCaptureFixture
) -> None:
    mine = have(here, school.as_("li"))
    assert have(here, school.as_("li"))["url"] == mine["url"]
    assert have(here, school.as_("han"))["url"] != mine["url"]
    full = here.post("/api/v1/live", headers=school.as_("wang"))
    assert (full.status_code, full.json()["code"]) == (503, "live_full")
    assert "Retry-After" in full.headers

    client = connect(mine["url"])
    client.send(json.dumps({"op": "subscribe", "topic": "/turtle1/pose"}))
    client.send(json.dumps({"op": "publish", "topic": "/turtle1/cmd_vel", "msg": {"linear": {"x": 1}}}))
    while json.loads(client.recv())["msg"]["x"] < 5.7:
        pass
    assert here.get("/api/v1/live", headers=school.as_("li")).json()["clients"] == 1

    key = mine["url"].rstrip("/").rpartition("/")[2]
    origin = mine["url"].replace("ws:", "http:").partition("/live/")[0]
    connect(mine["url"], origin=origin)
    connect(mine["url"], header=[f"Authorization: {school.as_('li')['Authorization']}"])
    assert refused(connect, mine["url"], origin="https://evil.example") == (403, "forbidden")
    assert refused(connect, mine["url"].replace(key, key[::-1])) == (404, "live_not_found")
    other = [f"Authorization: {school.as_('han')['Authorization']}"]
    assert refused(connect, mine["url"], header=other) == (404, "live_not_found")
    for person, let_in in (("li", True), ("han", False)):
        cookie = f"grader_session={services.callers.open_session(school.tokens[person])}"
        if let_in:
            connect(mine["url"], cookie=cookie)
        else:
            assert refused(connect, mine["url"], cookie=cookie) == (404, "live_not_found")

    assert here.delete("/api/v1/live", headers=school.as_("li")).status_code == 204
    while (told := client.recv_data())[0] != 8:
        pass
    assert status_of(told) == 1001
    assert refused(connect, mine["url"]) == (404, "live_not_found")
    assert here.get("/api/v1/live", headers=school.as_("li")).json()["code"] == "live_not_found"
    assert key not in caplog.text


def test_a_service_that_stops_closes_all_connections_and_opens_no_car(
    here: httpx.Client, server: uvicorn.Server, cars: LiveCars, school: Any, connect: Connect
) -> None:
    clients = [connect(have(here, school.as_(person))["url"]) for person in ("li", "han", "li")]
    server.should_exit = True
    for client in clients:
        assert status_of(client.recv_data()) in (1001, 1012)
    wait_until(lambda: len(cars) == 0)
    with pytest.raises(RefusedError, match="live_off"):
        asyncio.run(cars.open("li"))


@pytest.mark.parametrize("cars", [LiveCars(1, idle_s=0.2)], ids=["impatient"])
def test_a_car_ends_when_nobody_is_connected(
    here: httpx.Client, cars: LiveCars, school: Any, connect: Connect
) -> None:
    url = have(here, school.as_("li"))["url"]
    with suppress(WebSocketBadStatusException):  # unless it took longer to connect
        client = connect(url)
        client.send(json.dumps({"op": "call_service", "service": "/rosapi/get_time", "id": 1}))
        assert json.loads(client.recv())["result"]
        client.close()
    wait_until(lambda: len(cars) == 0)
    assert here.get("/api/v1/live", headers=school.as_("li")).status_code == 404


@pytest.mark.parametrize(
    "cars", [LiveCars(0), LiveCars(2, may_begin=lambda: False)], ids=["none", "elsewhere"]
)
def test_an_operator_offers_none(here: httpx.Client, school: Any) -> None:
    answer = here.post("/api/v1/live", headers=school.as_("li"))
    assert (answer.status_code, answer.json()["code"]) == (503, "live_off")


def test_other_addresses_take_no_websocket(here: httpx.Client, school: Any, connect: Connect) -> None:
    with pytest.raises(WebSocketBadStatusException, match="403"):
        connect(f"ws://{here.base_url.netloc.decode()}/api/v1/submissions")
