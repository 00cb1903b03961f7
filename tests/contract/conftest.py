"""The same promises on both engines: a SQLite file and a PostgreSQL server."""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.fakes.engines import Engine, PostgresEngine
from tests.fakes.postgres import PostgresServer


@pytest.fixture(params=["embedded", "postgres"])
def engine(request: pytest.FixtureRequest, tmp_path: Path, migrated_file: Path) -> Iterator[Engine]:
    """An engine with an empty queue and a clock that only the test moves."""
    made: Engine
    if request.param == "embedded":
        shutil.copy(migrated_file, tmp_path / "grader.db")
        made = Engine(f"sqlite:///{tmp_path / 'grader.db'}")
    else:
        made = PostgresEngine(request.getfixturevalue("postgres_url"))
    yield made
    made.database.close()


@pytest.fixture
def on_server(postgres_url: str) -> Iterator[PostgresEngine]:
    """An engine on PostgreSQL, for what only it has."""
    made = PostgresEngine(postgres_url)
    yield made
    made.database.close()


@pytest.fixture
def own_server(postgres_server: PostgresServer) -> Iterator[PostgresEngine]:
    """The same in a database of its own, whose tables a test may spoil."""
    name = f"queue_{os.getpid()}"
    made = PostgresEngine(postgres_server.create(name))
    yield made
    made.database.close()
    postgres_server.drop(name)
