"""The server that tests of the routes, the pages and `grader submit` share."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture(scope="session")
def running(migrated_file: Path) -> Iterator[tuple[Any, str]]:
    """One application behind one server, and its address; each test puts its own services in."""
    from grader.operation.settings import Settings
    from tests.fakes import server
    from tests.fakes.clock import FakeClock

    with server.services(Settings(database_url=f"sqlite:///{migrated_file}"), FakeClock()) as made:
        app = server.application(made)
        with server.serving(app) as client:
            client.get("/healthz")
            yield app, str(client.base_url)
