"""The application behind a real server on a free port of loopback."""

import json
import socket
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager, nullcontext
from functools import cache
from pathlib import Path
from typing import Any

import httpx
import uvicorn
from fastapi import FastAPI

from grader.api import create_app
from grader.commands.serve import BoundedConnection
from grader.grading.practice import PracticeRuns
from grader.live.car import LiveCar
from grader.live.cars import CLIENTS, LiveCars
from grader.live.protocol import SETTINGS, BoundedWebSocket
from grader.operation.settings import Settings
from grader.store.clock import Clock
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.queue import Retries
from grader.store.tokens import Tokens
from grader.use_cases.callers import Callers
from grader.use_cases.pictures import PlotCache, Plotter
from grader.use_cases.services import Services
from tests.fakes.grading import FakeAssignments, FakeGrader, FakePreflight
from tests.fakes.waiting import wait_until

TOKEN = "correct-horse-battery-staple"
GOLDEN_OPENAPI = Path(__file__).parents[1] / "golden" / "openapi.json"
PNG = b"\x89PNG\r\n\x1a\n fake"


class FakePlotter:
    """Draws a picture of words and counts how often."""

    def __init__(self) -> None:
        self.drawn = 0

    def __call__(self, assignment, report, trajectory, spec) -> bytes:
        self.drawn += 1
        magic = PNG if spec.form == "png" else b"<svg>"
        return magic + f" {assignment.id} {spec.language} {spec.case} {len(trajectory)}".encode()


@cache
def _plain() -> Settings:
    return Settings()


def settings(**chosen: Any) -> Settings:
    """Return settings of which `chosen` are not as usual; to read the environment each time takes long."""
    return _plain().model_copy(update=chosen)


@contextmanager
def services(
    settings: Settings, clock: Clock, plotter: Plotter | None = None, lease_s: float = 15.0
) -> Iterator[Services]:
    """Yield everything behind the application, over a database that has its tables already."""
    with closing(Database(settings.database_url)) as database:
        made = Services.over(
            database,
            settings,
            clock,
            retries=Retries(lease_s=lease_s, max_tries=3, backoff_s=0),
            assignments=FakeAssignments(),
            preflight=FakePreflight(),
            plots=PlotCache(plotter or FakePlotter(), 8),
            callers=Callers(Courses(database, clock), Tokens(database, clock), TOKEN, clock),
            live=LiveCars(settings.live_cars, make_car=lambda: FakeLiveCar(CLIENTS)),
            practice=PracticeRuns(settings.practice_runs, FakeGrader, lambda: False),
        )
        with (
            closing(made.practice),
            closing(made.watching),
            closing(made.plots),
            closing(made.comparer),
            closing(made.space),
        ):
            yield made


def application(made: Services) -> FastAPI:
    """Return the application around services that somebody else closes."""
    return create_app(lambda: nullcontext(made))


@cache
def openapi_document() -> dict[str, Any]:
    """The OpenAPI document; making it takes a second."""
    return create_app(nullcontext).openapi()


@cache
def committed_document() -> dict[str, Any]:
    """The OpenAPI document as it is committed; `test_public_interface` sees that it is the same."""
    document: dict[str, Any] = json.loads(GOLDEN_OPENAPI.read_text())
    return document


def operations() -> list[tuple[str, str]]:
    """Path and method of every operation, from the committed document: every process of a run asks for them."""
    paths: dict[str, Any] = committed_document()["paths"]
    return [(path, method) for path, methods in paths.items() for method in methods]


@contextmanager
def running_server(config: uvicorn.Config, listener: socket.socket | None = None) -> Iterator[uvicorn.Server]:
    """Run a server in a thread until the context ends.

    Without a listening socket of the caller's this waits until there is the server's own; with one there is no
    need: the first request simply waits until the server answers.
    """
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, args=(None if listener is None else [listener],))
    thread.start()
    try:
        if listener is None:
            wait_until(lambda: server.started)
        yield server
    finally:
        server.should_exit = True
        thread.join()


@contextmanager
def serving(app: FastAPI, *, websockets: bool = False) -> Iterator[httpx.Client]:
    """Yield a client of a running server; the server has stopped when the context ends."""
    # so long that a connection never ends at the moment of the next request
    kinds: dict[str, Any] = {"ws": "none"}
    if websockets:
        kinds = {"http": BoundedConnection, "ws": BoundedWebSocket, **SETTINGS}
    config = uvicorn.Config(app, log_config=None, timeout_keep_alive=3_600, **kinds)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        address = f"http://127.0.0.1:{listener.getsockname()[1]}"
        with (
            running_server(config, listener),
            httpx.Client(base_url=address, timeout=30.0, trust_env=False, verify=False) as client,
        ):
            yield client


class FakeLiveCar(LiveCar):
    """A live car without a process."""

    async def start(self) -> None:
        pass
